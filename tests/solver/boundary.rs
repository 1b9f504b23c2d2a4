//! Supports and loads: what they prescribe at every increment, what they hand on to the next step, and the forces that
//! answer them.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::{Blocks, Finished, close, distance, finish};
use fecontact::mesh::configuration::Configuration;
use fecontact::model::boundary::{Expression, Profile};
use fecontact::model::element::follower_pressure;
use fecontact::model::state::State;
use nalgebra::Vector2;
use serde_json::{Value, json};

/// A unit square in one element, E = 3, ν = 0; its left side held in x, all nodes in y: a bar of stiffness 3 along x.
fn bar(steps: Value) -> Finished {
    finish(&json!({
        "mesh": Blocks::default().rectangle("bar", [1, 1], [0.0, 0.0], [1.0, 1.0]).json(),
        "bodies": {"bar": {"material": {"model": "linear", "E": 3, "nu": 0, "density": 1}}},
        "steps": steps,
    }))
}

/// The supports of the bar and one more.
fn held_and(more: Value) -> Value {
    json!([{"on": "bar", "uy": 0}, {"on": "bar_left", "ux": 0}, more])
}

fn mean_ux(run: &Finished, group: &str, state: &State) -> f64 {
    let nodes = run.nodes(group);
    nodes.iter().map(|&node| state.displacement[2 * node]).sum::<f64>() / nodes.len() as f64
}

/// Each kind of drive at each increment, inherited by a second step and replaced in a third.
#[test]
fn drives_are_met_at_every_increment_inherited_and_replaced() {
    type Expected = fn(f64) -> f64;
    let drives: [(Value, Expected); 4] = [
        // Ramped over the first step, kept in the second.
        (json!(0.1), |t| 0.1 * (t / 2.0).min(1.0)),
        // Goes on in the second step.
        (json!({"rate": 0.03}), |t| 0.03 * t),
        (json!({"table": [[0.5, 0.02], [1.5, -0.04], [2.5, 0.0]]}), |t| match t {
            t if t <= 0.5 => 0.02,
            t if t <= 1.5 => 0.02 - 0.06 * (t - 0.5),
            t if t <= 2.5 => -0.04 + 0.04 * (t - 1.5),
            _ => 0.0,
        }),
        (json!("0.01*x*(1+y)*sin(t)"), |t| 0.015 * t.sin()),
    ];
    for (drive, expected) in drives {
        let run = bar(json!([
            {"name": "first", "duration": 2, "dt": {"initial": 0.25},
             "supports": held_and(json!({"on": "bar_right", "ux": drive}))},
            {"name": "inherits", "duration": 1},
            {"name": "replaces", "duration": 1, "supports": [{"on": "bar_right", "ux": 0.2}]},
        ]));
        assert_eq!(run.states.len(), 16);
        for state in &run.states {
            let (t, held) = (state.time, expected(3.0));
            let value = if t <= 3.0 { expected(t) } else { held + (0.2 - held) * (t - 3.0) };
            close(&format!("{drive} at {t}"), mean_ux(&run, "bar_right", state), value, 1e-12);
        }
    }
}

/// The same drives on a load; the reaction of the left side is −force, the stretch force/3.
#[test]
fn loads_are_ramped_replaced_and_taken_away() {
    let run = bar(json!([
        {"name": "load", "duration": 1, "dt": {"initial": 0.25}, "supports": held_and(json!({"on": "bar_left", "ux": 0})),
         "loads": [{"on": "bar_right", "traction": {"x": 0.3}}]},
        {"name": "keep", "duration": 1},
        {"name": "more", "duration": 1, "loads": [{"on": "bar_right", "traction": {"x": {"rate": 0.6}}}]},
        {"name": "less", "duration": 1, "loads": [{"on": "bar_right", "traction": null}]},
        {"name": "none", "duration": 1},
    ]));
    for state in &run.states {
        let force = match state.time {
            t if t <= 1.0 => 0.3 * t,
            t if t <= 2.0 => 0.3,
            t if t <= 3.0 => 0.3 + 0.6 * (t - 2.0),
            t if t <= 4.0 => 0.9 * (4.0 - t),
            _ => 0.0,
        };
        close("reaction", run.reaction("bar_left", state)[0], -force, 1e-12);
        close("stretch", mean_ux(&run, "bar_right", state), force / 3.0, 1e-12);
    }
}

/// A freed support hands its reaction over to a load that fades linearly over the step, in equilibrium all the way.
#[test]
fn a_freed_support_fades() {
    let run = bar(json!([
        {"name": "pull", "duration": 1, "dt": {"initial": 0.5},
         "supports": held_and(json!({"on": "bar_right", "ux": 0.1}))},
        {"name": "free", "duration": 2, "dt": {"initial": 0.25}, "supports": [{"on": "bar_right", "ux": null}]},
        {"name": "after", "duration": 1},
    ]));
    for state in run.states.iter().filter(|state| state.time >= 1.0) {
        let force = 0.3 * (1.0 - (state.time - 1.0) / 2.0).max(0.0);
        close("reaction", run.reaction("bar_left", state)[0], -force, 1e-12);
        close("stretch", mean_ux(&run, "bar_right", state), force / 3.0, 1e-12);
        let freed = if state.time > 1.0 { 0.0 } else { 0.3 };
        close("reaction of the freed side", run.reaction("bar_right", state)[0], freed, 1e-12);
    }
}

fn stresses(run: &Finished, state: &State) -> Vec<[f64; 4]> {
    let elements = run.model.mesh.elements.iter().zip(&run.model.solids);
    elements
        .flat_map(|(element, solid)| {
            let u: Vec<_> = element.nodes.iter().map(|&n| &state.displacement[2 * n..][..2]).collect();
            let u: Vec<_> = u.iter().map(|u| Vector2::new(u[0], u[1])).collect();
            solid.stresses(&*run.model.bodies[0].material, &[], &u).unwrap()
        })
        .map(|s| [s.xx, s.yy, s.zz, s.xy])
        .collect()
}

/// A quarter turn about a point outside, in two steps of which the second inherits nothing but the angle reached.
#[test]
fn a_rotation_support_turns_without_stress() {
    let run = finish(&json!({
        "mesh": Blocks::default().rectangle("body", [3, 2], [0.0, 0.0], [1.5, 1.0]).json(),
        "bodies": {"body": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}}},
        "steps": [
            {"name": "turn", "duration": 1, "dt": {"initial": 0.125},
             "supports": [{"on": "body_left", "rotation": {"about": [2, -1], "angle": 1}}]},
            {"name": "on", "duration": 1,
             "supports": [{"on": "body_left", "rotation": {"about": [2, -1], "angle": FRAC_PI_2}}]},
            {"name": "stay", "duration": 1},
        ],
    }));
    for state in &run.states {
        let stress = stresses(&run, state).iter().flatten().fold(0.0f64, |m, s| m.max(s.abs()));
        close("stress", stress, 0.0, 1e-6);
    }
    for state in [run.at(2.0), run.last()] {
        let x = run.model.configuration(&state.displacement);
        for (node, reference) in run.model.mesh.nodes.iter().enumerate() {
            let x = x.at(node);
            let arm = reference - Vector2::new(2.0, -1.0);
            close("x", (x - Vector2::new(2.0 - arm.y, -1.0 + arm.x)).norm(), 0.0, 1e-7);
        }
    }
}

/// A rotation turns what is there: a stretched body keeps its stretch, and its stress turns with it: σ_yy, σ_xx, −σ_xy.
#[test]
fn a_rotation_support_turns_a_deformed_body() {
    let run = finish(&json!({
        "mesh": Blocks::default().rectangle("body", [3, 2], [0.0, 0.0], [1.5, 1.0]).json(),
        "bodies": {"body": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}}},
        "newton": {"tolerance": 1e-12},
        "steps": [
            {"name": "stretch", "duration": 1, "dt": {"initial": 0.125},
             "supports": [{"on": "body_left", "ux": 0, "uy": 0}, {"on": "body_right", "ux": 0.2, "uy": 0.1}]},
            {"name": "turn", "duration": 1, "supports": [
                {"on": "body_left", "rotation": {"about": [0, 0], "angle": FRAC_PI_2}},
                {"on": "body_right", "rotation": {"about": [0, 0], "angle": FRAC_PI_2}}]},
        ],
    }));
    let before = stresses(&run, run.at(1.0));
    let largest = before.iter().flatten().fold(0.0f64, |m, s| m.max(s.abs()));
    assert!(largest > 10.0);
    for ([xx, yy, zz, xy], after) in before.iter().zip(stresses(&run, run.last())) {
        close("stress", distance(&after, &[*yy, *xx, *zz, -xy]), 0.0, 1e-9 * largest);
    }
}

/// Forces of a follower pressure sum to zero round a closed contour of any shape, and their tangent is that of
/// differences; both for linear and quadratic edges. (The force is linear in x: differences are exact but for round-off.)
#[test]
fn follower_pressure_is_closed_and_has_an_exact_tangent() {
    let contour: Vec<Vector2<f64>> = (0..8)
        .map(|k| (k as f64 * PI / 4.0, 1.0 + 0.3 * (k as f64).sin()))
        .map(|(angle, radius)| Vector2::new(radius * angle.cos(), 2.0 * radius * angle.sin()))
        .collect();
    let linear: Vec<Vec<usize>> = (0..8).map(|k| vec![k, (k + 1) % 8]).collect();
    let quadratic: Vec<Vec<usize>> = (0..4).map(|k| vec![2 * k, (2 * k + 2) % 8, 2 * k + 1]).collect();
    for edges in [linear, quadratic] {
        let mut total = Vector2::zeros();
        for edge in &edges {
            let result = follower_pressure(edge, |_| 3.0, &Configuration::undeformed(&contour));
            total += result.force.as_slice().chunks(2).map(|f| Vector2::new(f[0], f[1])).sum::<Vector2<f64>>();
            for column in 0..2 * edge.len() {
                let moved = |h: f64| {
                    let mut x = contour.clone();
                    x[edge[column / 2]][column % 2] += h;
                    follower_pressure(edge, |_| 3.0, &Configuration::undeformed(&x)).force
                };
                let difference = (moved(0.5) - moved(-0.5)) - result.tangent.column(column);
                close("tangent", difference.amax(), 0.0, 1e-13);
            }
        }
        close("total force", total.norm(), 0.0, 1e-13);
    }
}

/// A block held at its bottom, pressed with p = 2 at its top, then turned by 90°: the pressure stays normal, so the
/// reaction is p × current top length along the turned normal; the stress is the turned one.
#[test]
fn follower_pressure_turns_with_the_body() {
    let run = finish(&json!({
        "mesh": Blocks::default().rectangle("body", [2, 2], [0.0, 0.0], [1.0, 1.0]).json(),
        "bodies": {"body": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}}},
        "newton": {"tolerance": 1e-12},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.1}, "loads": [{"on": "body_top", "pressure": 2}],
             "supports": [{"on": "body_bottom", "ux": 0, "uy": 0}]},
            {"name": "turn", "duration": 1,
             "supports": [{"on": "body_bottom", "rotation": {"about": [0, 0], "angle": FRAC_PI_2}}]},
        ],
    }));
    let (before, after) = (run.at(1.0), run.last());
    let top = run.nodes("body_top");
    let length = run.model.configuration(&before.displacement).between(top[0], top[2]).x;
    let [fx, fy] = run.reaction("body_bottom", before);
    close("Fx", fx, 0.0, 1e-9);
    close("Fy", fy, 2.0 * length, 1e-9);
    let turned = run.reaction("body_bottom", after);
    close("turned reaction", distance(&turned, &[-fy, fx]), 0.0, 1e-9);
    for ([xx, yy, zz, xy], after) in stresses(&run, before).iter().zip(stresses(&run, after)) {
        close("stress", distance(&after, &[*yy, *xx, *zz, -xy]), 0.0, 1e-8);
    }
}

/// A pressure over all four sides of a block compresses it evenly and leaves its three support reactions zero:
/// σ_xx = σ_yy = −p.
#[test]
fn pressure_all_round_needs_no_support() {
    let all = ["body_bottom", "body_right", "body_top", "body_left"];
    let run = finish(&json!({
        "mesh": Blocks::default().block("body", [3, 3], |s, t| [s + 0.3 * t, t + 0.2 * s * t]).json(),
        "bodies": {"body": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}}},
        "newton": {"tolerance": 1e-12},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.25},
                   "supports": [{"on": {"node": 0}, "ux": 0, "uy": 0}, {"on": {"node": 3}, "uy": 0}],
                   "loads": all.map(|side| json!({"on": side, "pressure": 20}))}],
    }));
    let reaction = run.last().reaction.iter().fold(0.0f64, |m, r| m.max(r.abs()));
    close("reaction", reaction, 0.0, 1e-9);
    for [xx, yy, _, xy] in stresses(&run, run.last()) {
        close("stress", distance(&[xx, yy, xy], &[-20.0, -20.0, 0.0]), 0.0, 1e-9);
    }
}

/// A dead traction acts on the reference length whatever the body does: total force 0.7 × 2, the slanted side included.
/// Gravity on it adds ρ g A, the weight.
#[test]
fn dead_traction_and_gravity_add_up_to_the_reaction() {
    // Top side from (0, 1) to (1.6, 2.2): length 2, a 3-4-5 slope; area 1.6 × 1.6.
    let run = finish(&json!({
        "mesh": Blocks::default().block("body", [4, 3], |s, t| [1.6 * s, t * (1.0 + 1.2 * s)]).json(),
        "bodies": {"body": {"material": {"model": "neo_hookean", "E": 50, "nu": 0.3, "density": 0.25}}},
        "newton": {"tolerance": 1e-12},
        "steps": [{"name": "load", "duration": 1, "dt": {"initial": 0.2},
                   "supports": [{"on": "body_bottom", "ux": 0, "uy": 0}],
                   "loads": [{"on": "body_top", "traction": {"x": 0.7, "y": -0.2}},
                             {"on": "body", "gravity": {"x": 1, "y": -10}}]}],
    }));
    let moved = run.last().displacement.iter().fold(0.0f64, |m, u| m.max(u.abs()));
    assert!(moved > 0.05, "the body yields visibly");
    let mass = 0.25 * 1.6 * 1.6;
    let [fx, fy] = run.reaction("body_bottom", run.last());
    close("Fx", fx, -(0.7 * 2.0 + mass), 1e-9);
    close("Fy", fy, 0.2 * 2.0 + 10.0 * mass, 1e-9);
}

/// Tractions that vary along upright and level sides: the reactions balance their resultants ∫ y² dy = 1/3 and ∫ x dx = 1/2, and their
/// moments about the origin, −∫ y³ dy = −1/4 and −∫ x² dx = −1/3.
#[test]
fn tractions_that_vary_in_place_have_their_resultants_and_moments() {
    let run = finish(&json!({
        "mesh": Blocks::default().rectangle("body", [3, 4], [0.0, 0.0], [1.0, 1.0]).json(),
        "bodies": {"body": {"material": {"model": "linear", "E": 50, "nu": 0.3}}},
        "newton": {"tolerance": 1e-12},
        "steps": [{"name": "load", "duration": 1, "dt": {"initial": 1},
                   "supports": [{"on": "body_bottom", "ux": 0, "uy": 0}],
                   "loads": [{"on": "body_right", "traction": {"x": "y^2"}}, {"on": "body_top", "traction": {"y": "-x"}}]}],
    }));
    let [fx, fy] = run.reaction("body_bottom", run.last());
    close("Fx", fx, -1.0 / 3.0, 1e-12);
    close("Fy", fy, 0.5, 1e-12);
    let moment = |node: usize| run.model.mesh.nodes[node].x * run.last().reaction[2 * node + 1];
    close("moment", run.nodes("body_bottom").into_iter().map(moment).sum(), 0.25 + 1.0 / 3.0, 1e-12);
}

/// The bar (stiffness 3) in series with two springs of 1 each to a driver that moves by d: u = 2 d/(2 + 3), reaction of
/// the left side −3 u. With the driver left out the springs go to the ground and only add stiffness to a nodal force.
#[test]
fn springs_pull_with_k_times_the_driver_less_the_node() {
    let run = bar(json!([
        {"name": "drive", "duration": 1, "dt": {"initial": 0.25}, "supports": held_and(json!({"on": "bar_left", "ux": 0})),
         "loads": [{"on": "bar_right", "spring": {"kx": 1, "driver": {"x": 0.5}}}]},
        {"name": "back", "duration": 1, "loads": [{"on": "bar_right", "spring": {"kx": 1}}]},
        {"name": "force", "duration": 1, "loads": [{"on": {"node": 1}, "force": {"x": 0.3}},
                                                  {"on": {"node": 3}, "force": {"x": 0.3}}]},
    ]));
    for state in &run.states {
        let (driver, force) = match state.time {
            t if t <= 1.0 => (0.5 * t, 0.0),
            t if t <= 2.0 => (0.5 * (2.0 - t), 0.0),
            t => (0.0, 0.6 * (t - 2.0)),
        };
        let u = (2.0 * driver + force) / 5.0;
        close("u", mean_ux(&run, "bar_right", state), u, 1e-12);
        close("reaction", run.reaction("bar_left", state)[0], -3.0 * u, 1e-12);
    }
}

/// Exponents as in JSON; e stands for nothing else, and what is no number is told.
#[test]
fn numbers_in_expressions_may_have_exponents() {
    let value =
        |text: &str| Expression::parse(text).map(|expression| Profile::Expression(expression).value([2.0, 3.0].into()));
    for (text, expected) in [
        ("1e6", 1e6),
        ("2.5E-3*x", 5e-3),
        ("1e+2-1e1", 90.0),
        ("x-1e-3", 2.0 - 1e-3),
        (".5e1+4.e0", 9.0),
        ("exp(0)+1e2^2", 1e4 + 1.0),
        ("-3e2", -300.0),
    ] {
        close(text, value(text).unwrap_or_else(|error| panic!("{text}: {error}")), expected, 1e-12 * expected.abs());
    }
    for text in ["1e", "2e+", "1ex", "e6", "1e6.5e"] {
        assert!(value(text).is_err(), "{text} was read");
    }
}

/// Abramowitz & Stegun, tables 7.1 and 7.3, with more digits by mpmath.
#[test]
fn error_functions_of_expressions_are_those_of_tables() {
    let value = |text: &str| Expression::parse(text).map(|expression| expression.value([2.0, 0.25].into(), 4.0));
    for (text, expected) in [
        ("erf(0)", 0.0),
        ("erf(0.5)", 0.520_499_877_813_046_5),
        ("erf(-1)", -0.842_700_792_949_714_9),
        ("erf(x)", 0.995_322_265_018_952_7),
        ("erfc(2*y)", 0.479_500_122_186_953_5),
        ("erfc(x)", 0.004_677_734_981_047_266),
        ("erfc(x/(2*sqrt(y*t/16)))", 1.541_725_790_028_002e-8),
        ("erfc(-3)", 1.999_977_909_503_001_4),
    ] {
        close(
            text,
            value(text).unwrap_or_else(|error| panic!("{text}: {error}")),
            expected,
            1e-15 + 1e-14 * expected.abs(),
        );
    }
    assert!(Expression::parse("erfx(x)").is_err_and(|message| {
        ["`erf`?", "`erfc`?"].iter().any(|near| message.to_string().contains(&format!("did you mean {near}")))
    }));
}

/// A quarter of a plane under 45°: a trapezoid whose right side runs from (2, 0) to (1, 1), with the normal (1, 1)/√2.
fn trapezoid(section: Value, steps: Value) -> Finished {
    let mesh = Blocks::default().block("body", [3, 2], |s, t| [s * (2.0 - t), t]);
    finish(&json!({
        "section": section, "mesh": mesh.json(),
        "bodies": {"body": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3, "density": 1}}},
        "newton": {"tolerance": 1e-12},
        "steps": steps,
    }))
}

/// What the reactions of the left side balance while it is turned by 0.8 rad, over the last half under all of the load.
fn turned_under(section: Value, load: Value) -> [f64; 2] {
    let turned = json!([{"on": "body_left", "rotation": {"about": [0, 0], "angle": 0.8}}]);
    let run = trapezoid(
        section,
        json!([{"name": "turn", "duration": 1, "dt": {"initial": 0.125}, "supports": turned, "loads": [load]}]),
    );
    run.reaction("body_left", run.last()).map(|force| -force)
}

/// A dead pressure p puts −p ∫ n dS of the undeformed side on the body, −p (1, 1) here, however the body turns and stretches;
/// one that follows turns with the side.
#[test]
fn a_dead_pressure_keeps_its_force() {
    let plate = json!({"plane_stress": {"thickness": 0.25}});
    for (section, depth) in [(json!("plane_strain"), 1.0), (plate, 0.25)] {
        let force = turned_under(section.clone(), json!({"on": "body_right", "dead_pressure": 3}));
        force.iter().for_each(|force| close("dead", *force, -3.0 * depth, 1e-7));
        let [x, y] = turned_under(section, json!({"on": "body_right", "pressure": 3}));
        assert!((x - y).abs() > 1.0 * depth, "a pressure that follows has turned: ({x}, {y})");
    }
}

/// On rings, −p ∫ n_y 2πr dS = −p π (2² − 1²) along the axis.
#[test]
fn a_dead_pressure_acts_on_the_full_turn() {
    let run = trapezoid(
        json!("axisymmetric"),
        json!([{"name": "load", "duration": 1, "dt": {"initial": 0.5}, "supports": [{"on": "body_bottom", "ux": 0, "uy": 0}],
                "loads": [{"on": "body_right", "dead_pressure": 0.5}]}]),
    );
    close("force", run.reaction("body_bottom", run.last())[1], 0.5 * 3.0 * PI, 1e-8);
}

/// A total force is the force on the side, whatever its length and the section, and as even as the traction F/(√2 w).
#[test]
fn a_total_force_is_spread_evenly() {
    let plate = json!({"plane_stress": {"thickness": 0.25}});
    for (section, area) in [(json!("plane_strain"), 2f64.sqrt()), (plate, 0.25 * 2f64.sqrt())] {
        let force = turned_under(section.clone(), json!({"on": "body_right", "total_force": {"x": 3, "y": -4}}));
        close("x", force[0], 3.0, 1e-7);
        close("y", force[1], -4.0, 1e-7);
        let loaded = |load: Value| {
            let supports = json!([{"on": "body_left", "ux": 0, "uy": 0}]);
            let step = json!([{"name": "load", "duration": 1, "supports": supports, "loads": [load]}]);
            trapezoid(section.clone(), step).last().displacement.clone()
        };
        let even = loaded(json!({"on": "body_right", "traction": {"x": 3.0 / area, "y": -4.0 / area}}));
        let total = loaded(json!({"on": "body_right", "total_force": {"x": 3, "y": -4}}));
        assert!(distance(&even, &total) < 1e-11, "off by {}", distance(&even, &total));
    }
    let run = trapezoid(
        json!("axisymmetric"),
        json!([{"name": "load", "duration": 1, "supports": [{"on": "body_bottom", "ux": 0, "uy": 0}],
                "loads": [{"on": "body_right", "total_force": {"y": -4}}]}]),
    );
    close("on the full turn", run.reaction("body_bottom", run.last())[1], 4.0, 1e-8);
}

/// A place by coordinates is the node nearest to it: the same run as with the node's tag, to the bit, and a load given by the
/// one way is replaced by the other.
#[test]
fn a_place_by_coordinates_is_the_nearest_node() {
    let run = |corner: Value, again: Value| {
        let steps = json!([
            {"name": "load", "duration": 1, "supports": [{"on": "bar_left", "ux": 0, "uy": 0}, {"on": corner, "uy": 0.1}],
             "loads": [{"on": corner, "force": {"x": 0.3}}]},
            {"name": "more", "duration": 1, "loads": [{"on": again, "force": {"x": 0.6}}]},
        ]);
        bar(steps).last().clone()
    };
    let tag = || json!({"node": 3});
    let [tagged, near] = [run(tag(), tag()), run(json!({"near": [0.9, 1.05]}), tag())];
    assert_eq!(tagged, near);
    close("force", near.external.iter().step_by(2).filter(|force| **force > 0.0).sum(), 0.6, 1e-12);
}
