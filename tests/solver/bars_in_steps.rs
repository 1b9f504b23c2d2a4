//! Bars in steps: stressed by jacks, coming and going, in motion, resumed; an anchored wall; input that is refused.

use std::f64::consts::PI;

use serde_json::{Value, json};

use crate::common::{self, Blocks, Finished, close, distance, finish, refusal};

/// A rod of length 2 between two points, the right one of which moves as the steps say.
fn rod(bar: Value, steps: Value) -> Value {
    let all = common::with(
        json!({"points": [[0, 0], [2, 0]], "ea": 100, "start": {"on": "left"}, "end": {"on": "right"}}),
        &bar,
    );
    json!({"mesh": {"nodes": [[0, 0], [2, 0]], "points": {"left": [0], "right": [1]}}, "bars": {"rod": all}, "steps": steps})
}

fn hold(on: &str, x: Value) -> Value {
    json!({"on": on, "ux": x, "uy": 0})
}

fn force(run: &Finished, time: f64) -> f64 {
    run.at(time).bars[0].segments[0].force
}

/// Between fixed points a jack raises the force to P and stores P²l/2EA; then the length is locked, and a motion δ adds EA δ/l.
#[test]
fn a_jack_locks_a_force_in() {
    let steps = json!([
        {"name": "wait", "duration": 1, "dt": {"initial": 0.5}, "supports": [hold("left", json!(0)), hold("right", json!(0.01))]},
        {"name": "stress", "duration": 1, "dt": {"initial": 0.25}, "prestress": {"rod": 7}},
        {"name": "pull", "duration": 1, "supports": [hold("right", json!(0.03))]},
    ]);
    let run = finish(&rod(json!({}), steps));
    close("before", force(&run, 1.0), 0.5, 1e-12);
    close("on the way", force(&run, 1.5), 3.75, 1e-12);
    close("locked off", force(&run, 2.0), 7.0, 1e-12);
    close("reaction", run.reaction("right", run.at(2.0))[0], 7.0, 1e-12);
    close("pulled", force(&run, 3.0), 8.0, 1e-12);
    close("stored", run.at(2.0).energy.strain, 7.0 * 7.0 * 2.0 / 200.0, 1e-12);
    for state in &run.states {
        close("energy", state.energy.error(), 0.0, 1e-12);
    }
}

/// A bar yields at its limit; what it loses is dissipated, and it unloads elastically.
#[test]
fn a_bar_yields_at_its_limit() {
    let steps = json!([
        {"name": "pull", "duration": 1, "dt": {"initial": 0.1}, "supports": [hold("left", json!(0)), hold("right", json!(0.1))]},
        {"name": "push", "duration": 1, "supports": [hold("right", json!(0.0))]},
    ]);
    let run = finish(&rod(json!({"limit": 2.0}), steps));
    close("yields", force(&run, 1.0), 2.0, 1e-12);
    close("dissipated", run.at(1.0).energy.plastic_dissipation, 2.0 * (0.1 - 0.04), 1e-12);
    // From 0.1 on it unloads by 100/2 per length, and yields in compression from 0.1 − 0.08 on.
    close("unloads", force(&run, 1.5), 2.0 - 50.0 * 0.05, 1e-12);
    close("yields again", force(&run, 2.0), -2.0, 1e-12);
    assert!(run.last().energy.error().abs() < 0.02, "{}", run.last().energy.error());
}

/// A bar that comes in a later step has no force where its points are then, and one that goes takes its force with it over the step.
#[test]
fn bars_come_and_go() {
    let support = |x: f64| json!([hold("left", json!(0)), hold("right", json!(x))]);
    let steps = json!([
        {"name": "wait", "duration": 1, "dt": {"initial": 0.5}, "supports": support(0.5)},
        {"name": "build", "duration": 1, "add": ["rod"], "supports": support(0.6)},
        {"name": "let go", "duration": 1, "remove": ["rod"]},
    ]);
    let run = finish(&rod(json!({}), steps));
    close("absent", force(&run, 1.0), 0.0, 0.0);
    close("stretched since it came", force(&run, 2.0), 100.0 * 0.1 / 2.5, 1e-12);
    close("holds half", run.reaction("right", run.at(2.5))[0], 2.0, 1e-12);
    close("gone", run.reaction("right", run.last())[0], 0.0, 1e-12);
    assert!(!run.last().bars[0].is_there && run.last().energy.strain == 0.0);
    for state in &run.states {
        close("energy", state.energy.error(), 0.0, 1e-12);
    }
}

/// A cantilever swings with 1.8751² √(EI/m L⁴) (Euler–Bernoulli), and keeps its energy.
#[test]
fn a_cantilever_swings_at_its_frequency() {
    let omega = 1.875_104_f64.powi(2) * (3.0_f64 / 0.5).sqrt();
    let period = 2.0 * PI / omega;
    let bar =
        json!({"points": [[0, 0], [1, 0]], "ea": 1e5, "ei": 3, "mass": 0.5, "start": {"on": "wall", "clamped": true}});
    let case = json!({"mesh": {"nodes": [[0, 0]], "points": {"wall": [0]}}, "bars": {"beam": bar}, "watch": ["beam_end"], "steps": [
        {"name": "bend", "duration": 1, "dt": {"initial": 1.0}, "supports": [hold("wall", json!(0))],
            "loads": [{"on": "beam_end", "force": {"y": 0.01}}]},
        {"name": "swing", "duration": 2.0 * period, "scheme": {"newmark": {}}, "dt": {"initial": period / 100.0},
            "loads": [{"on": "beam_end", "force": {"y": {"table": [[0, 0.0], [100, 0.0]]}}}]},
    ]});
    let run = finish(&case);
    let tip = 2 * run.nodes("beam_end")[0] + 1;
    let path: Vec<(f64, f64)> = run
        .states
        .iter()
        .filter(|state| state.time > 1.0)
        .map(|state| (state.time - 1.0, state.displacement[tip]))
        .collect();
    let crossings: Vec<f64> = path
        .windows(2)
        .filter(|two| two[0].1 * two[1].1 < 0.0)
        .map(|two| two[0].0 + (two[1].0 - two[0].0) * two[0].1 / (two[0].1 - two[1].1))
        .collect();
    close("quarter of a period", crossings[0], 0.25 * period, 0.03 * period);
    close("half a period", (crossings[2] - crossings[0]) / 2.0, 0.5 * period, 0.006 * period);
    let energy = &run.last().energy;
    close("energy", energy.error(), 0.0, 1e-4 * energy.supplied());
}

/// Ground with a wall that shares no nodes with it, an anchor of a free length and a grouted one, in all kinds of steps.
fn anchored(scheme: Value) -> Value {
    let mesh = Blocks::default().rectangle("soil", [6, 4], [0.0, 0.0], [6.0, 4.0]).rectangle(
        "wall",
        [1, 4],
        [-0.3, 0.0],
        [0.0, 4.0],
    );
    let material = |young: f64| json!({"model": "neo_hookean", "E": young, "nu": 0.3, "density": 0.01});
    json!({"mesh": mesh.json(), "bodies": {"soil": {"material": material(100.0)}, "wall": {"material": material(1e4)}},
    "bars": {
        "tendon": {"points": [[-0.3, 3], [2, 2]], "ea": 60, "mass": 0.01, "start": {"on": "wall"}, "end": {"on": "grout"}},
        "grout": {"points": [[2, 2], [5, 0.7]], "ea": 60, "ei": 2, "mass": 0.02, "limit": 2, "segments": 6,
            "embedded": {"in": ["soil"], "bond": {"strength": 0.8, "residual": 0.4, "slip": 0.1, "stiffness": 50}}},
        "late": {"points": [[1, 3.5], [4, 3.5]], "ea": 40, "mass": 0.02, "embedded": {"in": ["soil"]}},
    },
    "contacts": {"back": {"slave": "wall_right", "master": "soil_left", "friction": {"law": "coulomb", "mu": 0.3}}},
    "steps": [
        {"name": "rest", "duration": 1, "dt": {"initial": 0.5}, "supports": [hold("soil_bottom", json!(0)), hold("wall_bottom", json!(0))]},
        {"name": "stress", "duration": 1, "prestress": {"tendon": 1}, "add": ["late"]},
        {"name": "load", "duration": 1, "scheme": scheme, "dt": {"initial": 0.25}, "loads": [{"on": "wall_left", "force": {"x": -0.4}}]},
        {"name": "cut", "duration": 1, "remove": ["tendon"]},
    ]})
}

/// The forces of a grouted anchor in the steps above: the tendon has its force, the grout takes it up by bond, and energies balance.
#[test]
fn an_anchor_holds_a_wall() {
    let run = finish(&anchored(json!("static")));
    let [stressed, loaded] = [run.at(2.0), run.at(3.0)];
    close("tendon", stressed.bars[2].segments[0].force, 1.0, 1e-12);
    assert!(loaded.bars[2].segments[0].force > 1.15, "{}", loaded.bars[2].segments[0].force);
    let grout = &run.model.bars[0];
    let taken: f64 =
        grout.grips.iter().zip(&stressed.bars[0].grips).map(|(grip, state)| grip.length * state.bond.traction).sum();
    // The tendon pulls the grout back along nearly its own direction.
    let [tendon, own] = [[2.3, -1.0], [3.0, -1.3]].map(|v: [f64; 2]| nalgebra::Vector2::from(v).normalize());
    close("bond", -taken, tendon.dot(&own), 0.02);
    let energy = &run.last().energy;
    assert!(energy.error().abs() < 0.01 * energy.supplied(), "{energy:?}, {}", energy.error());
}

/// What bars say of input that they cannot take: key, value and remedy.
#[test]
fn bad_bars_are_refused_by_name() {
    let with = |bar: Value| {
        let mesh = Blocks::default().rectangle("soil", [4, 2], [0.0, 0.0], [4.0, 2.0]);
        let mut case = json!({"mesh": mesh.json(), "bodies": {"soil": {"material": {"model": "linear", "E": 1, "nu": 0.3, "density": 1}}},
            "bars": {"bar": {"points": [[1, 1], [3, 1]], "ea": 1, "embedded": {"in": ["soil"]}}},
            "steps": [{"name": "step", "duration": 1, "supports": [hold("soil_bottom", json!(0))]}]});
        for (path, value) in bar.as_object().expect("keys") {
            *case.pointer_mut(path).unwrap_or_else(|| panic!("{path}")) = value.clone();
        }
        case
    };
    let bar = |more: Value| {
        let bar = common::with(json!({"points": [[1, 1], [3, 1]], "ea": 1}), &more);
        with(json!({"/bars/bar": bar}))
    };
    let bond = |bond: Value| bar(json!({"embedded": {"in": ["soil"], "bond": bond}}));
    let cases = [
        (
            bar(json!({"points": [[1, 1], [5, 1]], "segments": 4, "embedded": {"in": ["soil"]}})),
            "bars.bar.embedded.in: the point (5, 1) lies outside of `soil`; its nearest node is at (4, 1)",
        ),
        (
            bar(json!({"start": {"on": "soil"}, "points": [[1, 3], [3, 1]]})),
            "bars.bar.start.on: the point (1, 3) lies outside of `soil`",
        ),
        (bar(json!({"start": {"on": "rock"}})), "bars.bar.start.on: there is no body and no bar `rock`"),
        (bar(json!({"start": {"clamped": true}})), "bars.bar.start.clamped: a truss is hinged at its ends"),
        (bar(json!({"ea": 0})), "bars.bar.ea: is 0: must be positive"),
        (bar(json!({"ei": -1})), "bars.bar.ei: is -1: must be zero or positive"),
        (bar(json!({"segments": 3})), "bars.bar.segments: a truss divided into segments is a chain that folds"),
        (bar(json!({"points": [[1, 1]]})), "bars.bar.points: is one point"),
        (bar(json!({"points": []})), "bars.bar: give either `points`, two or more, or `on`"),
        (bar(json!({"points": [[1, 1], [1, 1]]})), "bars.bar.points[1]: is the point before it"),
        (bar(json!({"points": [], "on": "soil"})), "bars.bar.on: `soil` is a group of solid elements, not of lines"),
        (bond(json!({"residual": 1})), "bars.bar.embedded.bond.residual: belongs to a `strength`"),
        (
            bond(json!({"strength": 1, "residual": 2})),
            "bars.bar.embedded.bond.residual: is 2: it must lie between zero and `strength`",
        ),
        (
            bond(json!({"strength": 1, "slip": 0.1, "stiffness": 5})),
            "bars.bar.embedded.bond.slip: is 0.1: the strength would fall faster",
        ),
        (bar(json!({"embedded": {"in": []}})), "bars.bar.embedded.in: is empty: name the bodies"),
        (bond(json!({"normal": 0})), "bars.bar.embedded.bond.normal: is 0: must be positive"),
    ];
    for (case, words) in &cases {
        let said = refusal(case);
        assert!(said.contains(words), "{said}\nis not\n{words}");
    }
    let mut cases: Vec<(Value, &str)> = Vec::new();
    let mut case = with(json!({}));
    case["section"] = json!("axisymmetric");
    cases.push((case, "bars.bar: a bar in axisymmetry would be a shell"));
    let mut case = with(json!({}));
    case["bars"]["bar"]["embedded"]["bond"] = json!({"strength": 1});
    case["steps"][0]["prestress"] = json!({"bar": 1});
    cases.push((case, "steps[0].prestress.bar: has bond, and no one force along it"));
    let mut case = with(json!({}));
    case["steps"][0]["prestress"] = json!({"tie": 1});
    cases.push((case, "steps[0].prestress.tie: there is no bar `tie`; the bars are bar"));
    let mut case = with(json!({}));
    case["steps"][0]["add"] = json!(["bar"]);
    cases.push((case, "steps[0].add[0]: bars cannot be added or removed in the first step"));
    let mut case = with(json!({}));
    case["bars"]["soil"] = case["bars"]["bar"].clone();
    cases.push((case, "bars.soil: is also the name of a group of the mesh"));
    let mut case = bar(json!({"start": {"on": "soil"}, "end": {"on": "soil"}, "ei": 1}));
    case["steps"][0]["scheme"] = json!({"newmark": {}});
    cases.push((case, "bars.bar.mass: is 0, but the dynamic step `step` (steps[0]) needs a mass"));
    for (case, words) in &cases {
        let said = refusal(case);
        assert!(said.contains(words), "{said}\nis not\n{words}");
    }
}

/// A free bar is said to move before the run.
#[test]
fn a_loose_bar_is_found_before_the_run() {
    let mesh = Blocks::default().rectangle("soil", [4, 2], [0.0, 0.0], [4.0, 2.0]);
    let case = json!({"mesh": mesh.json(), "bodies": {"soil": {"material": {"model": "linear", "E": 1, "nu": 0.3}}},
        "bars": {"post": {"points": [[1, 1], [1, 4]], "ea": 1, "start": {"on": "soil"}}},
        "steps": [{"name": "step", "duration": 1, "supports": [hold("soil_bottom", json!(0))]}]});
    let said = refusal(&case);
    assert!(said.contains("can move freely") && said.contains("post"), "{said}");
}

/// A bar that moves with the ground stiffens it as much as a bar on the same nodes does.
#[test]
fn a_bar_without_slip_is_a_bar_on_the_nodes() {
    let run = |bar: Value| {
        let mesh = Blocks::default().rectangle("soil", [4, 2], [0.0, 0.0], [4.0, 2.0]);
        finish(
            &json!({"mesh": mesh.json(), "bodies": {"soil": {"material": {"model": "neo_hookean", "E": 10, "nu": 0.3}}}, "bars": {"bar": bar},
            "steps": [{"name": "step", "duration": 1, "dt": {"initial": 0.5}, "supports": [hold("soil_left", json!(0))],
                "loads": [{"on": "soil_right", "force": {"y": -0.2}}]}]}),
        )
    };
    let inside =
        run(json!({"points": [[0, 2], [4, 2]], "ea": 30, "ei": 2, "segments": 4, "embedded": {"in": ["soil"]}}));
    let top = run(json!({"on": "soil_top", "ea": 30, "ei": 2}));
    assert!(distance(&inside.last().displacement, &top.last().displacement) < 1e-12);
    let force = |run: &Finished| {
        run.last().bars[0].segments.iter().fold(0.0_f64, |most, segment| most.max(segment.force.abs()))
    };
    close("N", force(&inside), force(&top), 1e-10);
    assert!(force(&top) > 0.1);
}

/// A rod that is let go swings between its ends with 2 cos(2π/T t) of its lumped chain, in explicit increments as in implicit ones; they are
/// stable by themselves.
#[test]
fn explicit_bars_swing_like_implicit_ones() {
    let run = |scheme: Value, dt: Value| {
        let bar = json!({"points": [[0, 0], [1, 0]], "ea": 50, "ei": 3, "mass": 0.5, "start": {"on": "wall", "clamped": true}});
        finish(&json!({"mesh": {"nodes": [[0, 0]], "points": {"wall": [0]}}, "bars": {"beam": bar}, "steps": [
            {"name": "bend", "duration": 1, "dt": {"initial": 0.5}, "supports": [hold("wall", json!(0))],
                "loads": [{"on": "beam_end", "force": {"x": 1, "y": 0.5}}]},
            {"name": "swing", "duration": 0.3, "scheme": scheme, "dt": dt,
                "loads": [{"on": "beam_end", "force": {"x": {"table": [[0, 0.0], [100, 0.0]]}, "y": {"table": [[0, 0.0], [100, 0.0]]}}}]},
        ]}))
    };
    let [explicit, implicit] =
        [(json!({"explicit": {}}), json!({"initial": 0.01})), (json!({"newmark": {}}), json!({"initial": 0.0005}))]
            .map(|(scheme, dt)| run(scheme, dt));
    let tip = 2 * explicit.nodes("beam_end")[0] + 1;
    let [bent, e, i] = [explicit.at(1.0), explicit.last(), implicit.last()].map(|state| state.displacement[tip]);
    close("tip", e, i, 0.02 * bent.abs());
    assert!((e - bent).abs() > 0.3 * bent.abs(), "it moves: {bent}, {e}");
    let energy = &explicit.last().energy;
    close("energy", energy.error(), 0.0, 1e-2 * energy.supplied());
}

/// A strip pulled out of ground under an even pressure p bears 2 μ p L, and c L more with a strength.
#[test]
fn a_strip_is_held_by_the_pressure_on_it() {
    let pulled = |bond: Value| {
        let mesh = Blocks::default().rectangle("soil", [8, 4], [0.0, 0.0], [4.0, 2.0]);
        let run = finish(
            &json!({"mesh": mesh.json(), "bars": {"strip": {"points": [[0, 1], [3, 1]], "ea": 1e5, "embedded": {"in": ["soil"], "bond": bond}}},
            "bodies": {"soil": {"material": {"model": "linear", "E": 1e5, "nu": 0.0}, "initial_stress": {"components": {"xx": -10, "yy": -30, "zz": -10}}}},
            "steps": [{"name": "pull", "duration": 1, "dt": {"initial": 0.25}, "loads": [{"on": "soil_top", "dead_pressure": "30"}],
                "supports": [hold("soil_bottom", json!(0)), {"on": "soil_left", "ux": 0}, {"on": "soil_right", "ux": 0}, {"on": "strip_start", "ux": -0.1}]}]}),
        );
        -run.reaction("strip_start", run.last())[0]
    };
    close("friction", pulled(json!({"mu": 0.8, "stiffness": 1e4})), 0.8 * 30.0 * 3.0, 0.02 * 72.0);
    close(
        "and strength",
        pulled(json!({"mu": 0.8, "strength": 10, "stiffness": 1e4})),
        (0.8 * 30.0 + 10.0) * 3.0,
        0.02 * 102.0,
    );
}

/// A smooth wall, 4 high, turns about its toe, held by a grouted anchor at a height of 3 behind the wedge. Limit equilibrium (Rankine): the
/// active pressure K_a γ z − 2 c √K_a from the depth z₀ = 2 c/(γ √K_a) on has the moment K_a γ (H − z₀)³/6 about the toe, which is that of
/// the anchor's force, 22.2. At rest the ground would ask for 30 (K₀ = ν/(1 − ν)).
#[test]
fn an_anchored_wall_bears_the_active_pressure() {
    let block = |body: &str, x: [f64; 2], elements: [usize; 2], grading: f64, sides: Value, points: Value| {
        json!({"body": body, "corners": [[x[0], 0], [x[1], 0], [x[1], 4], [x[0], 4]], "elements": elements,
            "grading": [grading, 1], "kind": "Q8", "sides": sides, "points": points})
    };
    let soil = json!({"model": "mohr_coulomb", "E": 2e4, "nu": 0.3, "c": 0.5, "phi": 30, "psi": 10, "density": 2});
    let case = json!({
        "mesh": {"blocks": [
            block("soil", [0.0, 10.0], [9, 6], 3.0, json!(["floor", "far", null, "face"]), json!({})),
            block("wall", [-0.5, 0.0], [1, 6], 1.0, json!([null, "back", null, null]), json!({"toe": [0, 0], "out": [-0.5, 0]})),
        ]},
        "bodies": {"soil": {"material": soil, "element": "reduced"},
            "wall": {"material": {"model": "linear", "E": 1e7, "nu": 0.2, "density": 1e-4}}},
        "bars": {
            "tendon": {"points": [[-0.25, 3], [6, 3]], "ea": 8000, "start": {"on": "wall"}, "end": {"on": "grout"}},
            "grout": {"points": [[6, 3], [9, 3]], "ea": 1e6, "segments": 6,
                "embedded": {"in": ["soil"], "bond": {"stiffness": 1e5, "strength": 40}}},
        },
        "contacts": {"back": {"slave": "face", "master": "back", "friction": {"law": "frictionless"}}},
        "steps": [
            {"name": "weight", "duration": 1, "dt": {"initial": 0.2}, "loads": [{"on": "soil", "gravity": {"y": -10}}],
                "supports": [hold("floor", json!(0)), {"on": "far", "ux": 0}, hold("toe", json!(0)), hold("out", json!(0))]},
            {"name": "release", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "out", "ux": null, "uy": null}]},
        ],
    });
    let run = finish(&case);
    let depth = 2.0 * 0.5 * 3.0_f64.sqrt() / 20.0;
    let needed = 20.0 / 3.0 * (4.0 - depth).powi(3) / 6.0 / 3.0;
    close("N", run.last().bars[1].segments[0].force, needed, 0.04 * needed);
}

/// A jack stresses a beam that is divided, and a tendon along points of a body, to the same force in all segments.
#[test]
fn a_jack_stresses_all_segments() {
    let mesh = Blocks::default().rectangle("block", [4, 2], [0.0, 0.0], [4.0, 2.0]);
    let steps = json!([{"name": "stress", "duration": 1, "dt": {"initial": 0.5}, "supports": [hold("block_bottom", json!(0))], "prestress": {"duct": 0.3, "beam": 0.2}},
        {"name": "wait", "duration": 1}]);
    let case = json!({"mesh": mesh.json(), "bodies": {"block": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}}},
        "bars": {"duct": {"points": [[0.3, 1.6], [2, 0.7], [3.6, 1.5]], "ea": 50, "embedded": {"in": ["block"]}},
            "beam": {"points": [[0.4, 1.9], [3.5, 1.8]], "ea": 50, "ei": 2, "segments": 5, "start": {"on": "block"}, "end": {"on": "block"}}},
        "steps": steps});
    let run = finish(&case);
    for (bar, force, tolerance) in [(1, 0.3, 1e-12), (0, 0.2, 1e-4)] {
        let states = &run.at(1.0).bars[bar].segments;
        states.iter().for_each(|segment| close("N", segment.force, force, tolerance));
        assert!(states.len() > 3);
        close("at rest", run.last().bars[bar].segments[0].force, states[0].force, 1e-9);
    }
}

/// A simple beam of length L, at rest under its weight: it sags by 5 q L⁴/(384 E I), and its supports bear q L. Let go of, it swings in its first
/// mode, nearly, with ω = π² √(E I/m)/L²; damping by mass and stiffness takes the share exp(−2 π ζ/√(1 − ζ²)) of it a cycle, 2 ζ = η/ω + τ ω.
#[test]
fn a_beam_sags_and_swings() {
    let [long, ei, mass, g] = [2.0_f64, 3.0, 0.5, 0.02];
    let omega = PI * PI * (ei / mass).sqrt() / (long * long);
    let period = 2.0 * PI / omega;
    let run = |damping: Value| {
        let bar = json!({"points": [[0, 0], [long, 0]], "ea": 1e5, "ei": ei, "mass": mass, "segments": 20, "damping": damping,
            "start": {"on": "left"}, "end": {"on": "right"}});
        let mesh = json!({"nodes": [[0, 0], [long, 0]], "points": {"left": [0], "right": [1]}});
        finish(&json!({"mesh": mesh, "bars": {"beam": bar}, "steps": [
            {"name": "sag", "duration": 1, "dt": {"initial": 0.5}, "supports": [hold("left", json!(0)), {"on": "right", "uy": 0}],
                "loads": [{"on": "beam", "gravity": {"y": -g}}]},
            {"name": "swing", "duration": 3.2 * period, "scheme": {"newmark": {}}, "dt": {"initial": period / 100.0},
                "loads": [{"on": "beam", "gravity": {"y": {"table": [[0, 0.0], [100, 0.0]]}}}]},
        ]}))
    };
    let middle = |run: &Finished| -> usize {
        let far = |node: &usize| (run.model.mesh.nodes[*node].x - 0.5 * long).abs();
        let nodes = run.nodes("beam");
        2 * *nodes.iter().min_by(|a, b| far(a).total_cmp(&far(b))).expect("a node") + 1
    };
    let (eta, tau) = (0.1 * omega, 0.06 / omega);
    for (damping, zeta) in [
        (json!({}), 0.0),
        (json!({"mass": eta}), 0.05),
        (json!({"stiffness": tau}), 0.03),
        (json!({"mass": eta, "stiffness": tau}), 0.08),
    ] {
        let run = run(damping);
        let dof = middle(&run);
        let sag = run.at(1.0).displacement[dof];
        let expected = -5.0 * mass * g * long.powi(4) / (384.0 * ei);
        close("sag", sag, expected, 4e-3 * expected.abs());
        let borne = ["left", "right"].map(|end| run.reaction(end, run.at(1.0))[1]);
        close("supports", borne[0] + borne[1], mass * g * long, 1e-9);
        let path: Vec<(f64, f64)> = run
            .states
            .iter()
            .filter(|state| state.time >= 1.0)
            .map(|state| (state.time - 1.0, state.displacement[dof]))
            .collect();
        let rises = |two: &&[(f64, f64)]| two[0].1 > 0.0 && two[1].1 <= 0.0;
        let crossings: Vec<f64> = path
            .windows(2)
            .filter(rises)
            .map(|two| two[0].0 + (two[1].0 - two[0].0) * two[0].1 / (two[0].1 - two[1].1))
            .collect();
        let damped = period / f64::sqrt(1.0 - zeta * zeta);
        close("period", (crossings[2] - crossings[0]) / 2.0, damped, 6e-3 * period);
        let highest = |from: f64| -> f64 {
            let there = path.iter().filter(|(time, _)| (from..from + period).contains(time));
            there.map(|of| of.1).fold(0.0, f64::max)
        };
        // All modes have turned after half a period.
        let turns = [0.0, 1.0, 2.0].map(|k| highest(k * period));
        let decrement = 0.5 * (turns[0] / turns[2]).ln();
        println!("ζ = {zeta}: decrement {decrement}");
        close("decrement", decrement, 2.0 * PI * zeta / (1.0 - zeta * zeta).sqrt(), 0.02 * 2.0 * PI * zeta + 2e-3);
        let energy = &run.last().energy;
        close("energy", energy.error(), 0.0, 2e-3 * energy.supplied());
    }
}

/// A truss that flies is slowed by its damping by mass alone, v = v₀ exp(−η t), in explicit increments as in implicit ones; damping by stiffness,
/// which resists no rigid motion, leaves a turning one alone. Explicit increments refuse it.
#[test]
fn damping_by_mass_slows_a_bar_that_flies() {
    let case = |scheme: Value, damping: Value, velocities: [[f64; 2]; 2]| {
        let bar = json!({"points": [[0, 0], [1, 0]], "ea": 50, "mass": 0.5, "damping": damping, "start": {"on": "left"}, "end": {"on": "right"}});
        json!({"mesh": {"nodes": [[0, 0], [1, 0]], "points": {"left": [0], "right": [1]}}, "bars": {"rod": bar},
            "point_masses": {"left": {"mass": 1e-9, "velocity": velocities[0]}, "right": {"mass": 1e-9, "velocity": velocities[1]}},
            "steps": [{"name": "fly", "duration": 1, "scheme": scheme, "dt": {"initial": 0.002}}]})
    };
    for scheme in [json!({"explicit": {}}), json!({"newmark": {}})] {
        let run = finish(&case(scheme, json!({"mass": 0.7}), [[2.0, 1.0]; 2]));
        close("v", run.last().velocity[0], 2.0 * (-0.7_f64).exp(), 1e-5);
        let (energy, left) = (&run.last().energy, 0.5 * 0.5 * 5.0 * (-1.4_f64).exp());
        close("kinetic", energy.kinetic, left, 1e-5);
        close("taken", energy.damping_dissipation, 0.5 * 0.5 * 5.0 - left, 1e-4);
    }
    let turning = finish(&case(json!({"newmark": {}}), json!({"stiffness": 0.5}), [[0.0, -0.5], [0.0, 0.5]]));
    close("turns", turning.last().energy.kinetic, 0.5 * 0.5 * 0.25, 0.02 * 0.0625);
    let said = refusal(&case(json!({"explicit": {}}), json!({"stiffness": 0.5}), [[0.0; 2]; 2]));
    assert!(said.contains("bars.rod.damping.stiffness: is not for explicit increments"), "{said}");
    let mut without = case(json!({"newmark": {}}), json!({"mass": 0.5}), [[0.0; 2]; 2]);
    without["bars"]["rod"]["mass"] = json!(0);
    assert!(refusal(&without).contains("bars.rod.damping.mass: has no effect on a bar without mass"));
}

/// The weight of a bar that lies in a body is borne with it, and comes and goes at once when the bar does.
#[test]
fn the_weight_of_a_bar_comes_and_goes_with_it() {
    let mesh = Blocks::default().rectangle("soil", [4, 2], [0.0, 0.0], [4.0, 2.0]);
    let case = json!({"mesh": mesh.json(), "bodies": {"soil": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3, "density": 1}}},
        "bars": {"bar": {"points": [[0.5, 1.2], [3.5, 1.2]], "ea": 30, "ei": 2, "mass": 0.2, "embedded": {"in": ["soil"]}}},
        "steps": [
            {"name": "rest", "duration": 1, "dt": {"initial": 0.5}, "supports": [hold("soil_bottom", json!(0))],
                "loads": [{"on": "soil", "gravity": {"y": -1}}, {"on": "bar", "gravity": {"y": -1}}]},
            {"name": "add", "duration": 1, "add": ["bar"]},
            {"name": "remove", "duration": 1, "remove": ["bar"]}]});
    let run = finish(&case);
    for (time, own) in [(1.0, 0.0), (1.5, 1.0), (2.0, 1.0), (2.5, 0.0), (3.0, 0.0)] {
        close("borne", run.reaction("soil_bottom", run.at(time))[1], 8.0 + own * 0.2 * 3.0, 1e-6);
    }
    let mut light = case.clone();
    light["bars"]["bar"]["mass"] = json!(0);
    let said = refusal(&light);
    assert!(said.contains("gravity needs a mass: give bars.bar.mass"), "{said}");
}
