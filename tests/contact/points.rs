//! Points as cases: masses, springs and dashpots against closed forms; a slave point with an area on planes and on
//! meshes; contacts that start closed.

mod dashpots;

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::{self, Blocks, Finished, close, distance, finish, model, turned};
use fecontact::laws::friction::{FrictionParameters, FrictionState, Sliding};
use fecontact::model::{Model, State};
use fecontact::output::history::History;
use fecontact::output::warnings::Warnings;
use fecontact::run::run;
use fecontact::run::{Attempt, Error, Observer};
use nalgebra::{Matrix2, Vector2};
use serde_json::{Value, json};

/// μ, the one variable of the super/subloading law.
fn mu_of(state: &FrictionState) -> f64 {
    state.variables[0]
}

/// Mass, spring stiffness, dashpot coefficient, contact stiffness (both directions), area, pressure of most tests here.
const M: f64 = 10.0;
const K: f64 = 40.0;
const C: f64 = 6.0;
const ALPHA: f64 = 1000.0;
const AREA: f64 = 0.5;
const G: f64 = 9.81;

fn trapezoidal() -> Value {
    json!({"newmark": {}})
}

/// A mass at the origin, free but for `loads`.
fn lone_mass(velocity: [f64; 2], scheme: Value, [dt, duration]: [f64; 2], loads: Value) -> Finished {
    finish(&json!({
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "point_masses": {"block": {"mass": M, "velocity": velocity}},
        "newton": {"tolerance": 1e-13},
        "steps": [{"name": "move", "duration": duration, "scheme": scheme, "dt": {"initial": dt}, "loads": loads}],
    }))
}

/// The law of the tests that only need friction to stick, or to slide at a constant coefficient.
fn coulomb(mu: f64) -> Value {
    json!({"law": "coulomb", "mu": mu, "alpha_t": ALPHA})
}

fn super_subloading() -> Value {
    json!({"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": ALPHA, "r": 100, "kappa": 10, "xi": 0.002})
}

/// A point mass on a plane that is turned by `angle`, and everything given in the axes (s, n) of the plane with it.
struct Slider {
    angle: f64,
    friction: Value,
    /// of the contact, `null` for one that starts open
    initial: Value,
    velocity: [f64; 2],
    scheme: Value,
    /// Δt, duration
    times: [f64; 2],
    /// in the turned axes
    loads: Value,
}

impl Default for Slider {
    fn default() -> Self {
        Self {
            angle: 0.0,
            friction: coulomb(0.4),
            initial: Value::Null,
            velocity: [0.0, 0.0],
            scheme: trapezoidal(),
            times: [0.01, 1.0],
            loads: json!([]),
        }
    }
}

impl Slider {
    fn case(&self) -> Value {
        json!({
            "mesh": {"nodes": [turned([0.3, 0.2], self.angle)], "points": {"block": [0]}},
            "point_masses": {"block": {"mass": M, "velocity": turned(self.velocity, self.angle)}},
            "contacts": {"base": {
                "slave": "block", "area": AREA, "normal": {"alpha_n": ALPHA},
                "master": {"plane": {"point": turned([-2.0, 0.2], self.angle), "normal": turned([0.0, 3.0], self.angle)}},
                "friction": self.friction, "initial": self.initial
            }},
            "newton": {"tolerance": 1e-12},
            "steps": [{"name": "slide", "duration": self.times[1], "scheme": self.scheme,
                       "dt": {"initial": self.times[0]}, "loads": self.loads}],
            "watch": ["block"],
        })
    }

    fn run(&self) -> Finished {
        finish(&self.case())
    }

    /// Displacement in the axes of the plane.
    fn displacement(&self, state: &State) -> [f64; 2] {
        turned([state.displacement[0], state.displacement[1]], -self.angle)
    }
}

/// A force on the block, given in axes turned by `angle` and acting from the start.
fn force(angle: f64, [along, normal]: [f64; 2]) -> Value {
    let [x, y] = turned([along, normal], angle);
    json!({"on": "block", "force": {"x": format!("{x:?}"), "y": format!("{y:?}")}})
}

/// A spring and dashpot to the ground along x.
fn spring_and_dashpot() -> Value {
    json!([{"on": "block", "spring": {"kx": K, "ky": K}}, {"on": "block", "dashpot": {"cx": C, "cy": 0}}])
}

/// A mass that falls: u = −g t²/2, and its kinetic energy is the work of gravity. At the nodes of a body the masses of
/// both add up: the acceleration under a force F is F/(m_body + 3 M).
#[test]
fn point_masses_fall_and_add_to_a_body() {
    let run = lone_mass(
        [0.0, 0.0],
        trapezoidal(),
        [0.05, 1.0],
        json!([{"on": "block", "gravity": {"x": "0", "y": format!("{}", -G)}}]),
    );
    close("u", run.last().displacement[1], -0.5 * G, 1e-12);
    close("kinetic energy", run.last().energy.kinetic, 0.5 * M * G * G, 1e-9);
    close("energy error", run.last().energy.error(), 0.0, 1e-9);

    let run = finish(&json!({
        "mesh": Blocks::default().rectangle("body", [2, 1], [0.0, 0.0], [1.0, 1.0]).json(),
        "bodies": {"body": {"material": {"model": "linear", "E": 1e6, "nu": 0.3, "density": 4}}},
        "point_masses": {"body_top": {"mass": M, "velocity": [0.5, 0]}},
        "initial_velocity": {"body": [0.5, 0]},
        "steps": [{"name": "push", "duration": 1, "scheme": {"hht": {"alpha": -0.3}}, "dt": {"initial": 0.01},
                   "supports": [{"on": "body", "uy": 0}],
                   "loads": [{"on": "body", "gravity": {"x": "2"}}, {"on": "body_top", "gravity": {"x": "2"}}]}],
    }));
    close("kinetic energy at the start", run.states[0].energy.initial, 0.5 * (4.0 + 3.0 * M) * 0.25, 1e-9);
    for u in run.last().displacement.chunks(2) {
        close("ux", u[0], 0.5 + 1.0, 1e-9);
    }
}

/// Pressed in statics on a plane of any slope: p = N/A, and the traction that holds it q = T/A; pushed harder than μ N a
/// spring takes the rest. Turning everything turns the answer.
#[test]
fn a_point_rests_on_a_plane_of_any_slope() {
    let (normal, along) = (30.0, 9.0);
    for angle in [0.0, 0.4, -1.2, PI / 2.0, 2.5] {
        let slider = Slider {
            angle,
            scheme: json!("static"),
            times: [0.25, 1.0],
            loads: json!([force(angle, [along, -normal])]),
            ..Default::default()
        };
        let run = slider.run();
        let friction = &run.last().contacts[0][0].friction;
        close("p", friction.pressure, normal / AREA, 1e-9);
        close("q", friction.traction, along / AREA, 1e-9);
        let [u, w] = slider.displacement(run.last());
        close("elastic slip", u, along / AREA / ALPHA, 1e-12);
        close("penetration", w, -normal / AREA / ALPHA, 1e-12);

        let pushed = Slider {
            loads: json!([force(angle, [20.0, -normal]), {"on": "block", "spring": {"kx": K, "ky": K}}]),
            ..slider
        };
        let run = pushed.run();
        let friction = &run.last().contacts[0][0].friction;
        let [u, w] = pushed.displacement(run.last());
        let pressure = normal / (AREA + K / ALPHA);
        close("p beside the spring", friction.pressure, pressure, 1e-9);
        close("q beside the spring", friction.traction, 0.4 * pressure, 1e-9);
        close("slip against the spring", u, (20.0 - 0.4 * pressure * AREA) / K, 1e-10);
        close("penetration beside the spring", w, -pressure / ALPHA, 1e-12);
    }
}

/// A block on a slope holds while tan θ < μ and slides with g (sin θ − μ cos θ) beyond; it starts in equilibrium.
#[test]
fn a_block_on_a_slope_holds_up_to_the_angle_of_friction() {
    let mu: f64 = 0.4;
    for (slope, slides) in [(0.39f64, false), (0.41, true), (0.8, true)] {
        let angle = -slope.atan();
        let pressure = M * G * angle.cos() / AREA;
        let held = (-M * G * angle.sin() / AREA).min(mu * pressure);
        let slider = Slider {
            angle,
            initial: json!({"pressure": pressure, "traction": held}),
            times: [0.02, 2.0],
            loads: json!([{"on": "block", "gravity": {"x": "0", "y": format!("{}", -G)}}]),
            ..Default::default()
        };
        let run = slider.run();
        let pull = G * (-angle.sin() - mu * angle.cos());
        for state in &run.states {
            let [u, w] = slider.displacement(state);
            let expected = if slides { 0.5 * pull * state.time.powi(2) } else { 0.0 };
            close("way down", u, expected, 1e-9);
            close("normal motion", w, 0.0, 1e-12);
            close("energy error", state.energy.error(), 0.0, 1e-9);
        }
    }
}

/// A mass that sticks rings on the contact spring: along the plane beside a spring with ω = √((K + α A)/M), across it with
/// √(α A/M). The trapezoidal rule turns by φ a step, tan(φ/2) = ω Δt/2: u = v/ω sin nφ.
#[test]
fn a_point_rings_on_its_contact() {
    let (angle, v, dt, pressure) = (0.7, 1e-2, 0.02, 50.0);
    let press = force(angle, [0.0, -pressure * AREA]);
    for (component, spring) in [(0, K), (1, 0.0)] {
        let mut velocity = [0.0, 0.0];
        velocity[component] = v;
        let slider = Slider {
            angle,
            friction: coulomb(10.0),
            initial: json!({"pressure": pressure}),
            velocity,
            times: [dt, 4.0],
            loads: json!([press, {"on": "block", "spring": {"kx": spring, "ky": spring}}]),
            ..Default::default()
        };
        let run = slider.run();
        let omega = ((spring + ALPHA * AREA) / M).sqrt();
        let phase = 2.0 * (0.5 * omega * dt).atan();
        for (n, state) in run.states.iter().enumerate() {
            let turn = (n + 1) as f64 * phase;
            close("u", slider.displacement(state)[component], v / omega * turn.sin(), 1e-12);
            close("u", slider.displacement(state)[1 - component], 0.0, 1e-12);
            close("energy error", state.energy.error(), 0.0, 1e-12);
        }
    }
}

/// What starts in equilibrium stays there, and keeps its tractions: on a slope, held by friction alone at R = 0.6.
#[test]
fn an_equilibrium_stays_at_rest() {
    let angle = -0.15f64.atan();
    let (pressure, traction) = (M * G * angle.cos() / AREA, -M * G * angle.sin() / AREA);
    for scheme in [trapezoidal(), json!({"hht": {"alpha": -0.1}}), json!("static")] {
        let slider = Slider {
            angle,
            friction: super_subloading(),
            initial: json!({"pressure": pressure, "traction": traction, "structure": 1.25}),
            scheme,
            times: [0.05, 50.0],
            loads: json!([{"on": "block", "gravity": {"x": "0", "y": format!("{}", -G)}}]),
            ..Default::default()
        };
        let run = slider.run();
        assert_eq!(run.states.len(), 1000);
        let energy = 0.5 * AREA * (pressure.powi(2) + traction.powi(2)) / ALPHA;
        for state in &run.states {
            close("motion", distance(&state.displacement, &[0.0; 2]), 0.0, 1e-14);
            let friction = &state.contacts[0][0].friction;
            close("p", friction.pressure, pressure, 1e-11);
            close("q", friction.traction, traction, 1e-11);
            close("contact energy", state.energy.contact_elastic, energy, 1e-11);
            close("initial energy", state.energy.initial, energy, 1e-11);
            close("energy error", state.energy.error(), 0.0, 1e-11);
        }
    }
}

/// A block slides on with v₀ while friction is steady at μ_k p: it stops after v₀/(g (μ_k cos θ − sin θ)).
#[test]
fn a_block_that_slides_from_the_start_is_braked_at_once() {
    let (angle, speed) = (-0.15f64.atan(), 1.0);
    let pressure = M * G * angle.cos() / AREA;
    let mut friction = super_subloading();
    friction["kappa"] = json!(0);
    friction["xi"] = json!(0);
    let slider = Slider {
        angle,
        friction,
        initial: json!({"pressure": pressure, "traction": 0.2 * pressure, "structure": 1}),
        velocity: [speed, 0.0],
        times: [0.02, 2.0],
        loads: json!([{"on": "block", "gravity": {"x": "0", "y": format!("{}", -G)}}]),
        ..Default::default()
    };
    let braking = G * (0.2 * angle.cos() + angle.sin());
    assert!(speed / braking > 2.0, "it slides all the time");
    let run = slider.run();
    for state in &run.states {
        let way = speed * state.time - 0.5 * braking * state.time.powi(2);
        close("way", slider.displacement(state)[0], way, 1e-10);
        close("dissipation", state.energy.friction_dissipation, 0.2 * pressure * AREA * way, 1e-9);
        close("energy error", state.energy.error(), 0.0, 1e-9);
    }
}

/// Through stick and slip the books are balanced. (Friction switched off, nothing is dissipated.)
#[test]
fn stick_slip_keeps_account_of_its_energy() {
    let errors = [0.01, 0.0025].map(|dt| {
        let slider = Slider {
            friction: super_subloading(),
            initial: json!({"pressure": 80, "traction": 4, "structure": 1.7}),
            times: [dt, 8.0],
            loads: json!([
                force(0.0, [2.0, -40.0]),
                {"on": "block", "spring": {"kx": K, "driver": {"x": {"rate": 0.1}}}},
                {"on": "block", "dashpot": {"cx": C, "cy": 1, "driver": {"x": {"rate": 0.01}}}}
            ]),
            ..Default::default()
        };
        let energy = slider.run().last().energy;
        assert!(energy.friction_dissipation > 2.0 && energy.damping_dissipation > 0.05, "{energy:?}");
        (energy.error() / energy.external_work).abs()
    });
    println!("energy errors {errors:?}");
    assert!(errors[0] < 1e-3 && errors[1] < 1e-4, "{errors:?}");
}

/// A block pulled to and fro over Coulomb friction by a spring whose end moves as 2 sin 2πt, four times.
fn shaken(friction: Value, scheme: Value, parts: u32) -> State {
    let slider = Slider {
        friction,
        initial: json!({"pressure": 80}),
        scheme,
        times: [1.0 / f64::from(parts), 4.0],
        loads: json!([
            force(0.0, [0.0, -40.0]),
            {"on": "block", "spring": {"kx": K, "driver": {"x": format!("2*sin({:?}*t)", 2.0 * PI)}}},
        ]),
        ..Default::default()
    };
    slider.run().last().clone()
}

/// In statics the end of the spring goes 2, seven times 4, and 2 at last, of which what spring and contact take up in series
/// is no slip; the reversals lie inside increments of any length, and the dissipation does not know. The work of the spring
/// is that of the trapezoidal rule: the books are balanced to the second order.
#[test]
fn a_block_pulled_to_and_fro_dissipates_its_slip_at_any_increment() {
    let limit = 0.4 * 40.0;
    let elastic = limit / K + limit / (ALPHA * AREA);
    let slip = (2.0 - elastic) + 7.0 * (4.0 - 2.0 * elastic) + (2.0 - 2.0 * elastic);
    let error = |parts| {
        let energy = shaken(coulomb(0.4), json!("static"), parts).energy;
        close("dissipation", energy.friction_dissipation, limit * slip, 1e-11 * limit * slip);
        (energy.error() / energy.friction_dissipation).abs()
    };
    let [_, coarse, fine] = [20, 160, 5120].map(error);
    println!("energy errors {coarse:e}, {fine:e}");
    // A factor of 1024, give or take where in their increments the reversals and yields lie.
    assert!(fine < 1e-6 && coarse / fine > 300.0, "{coarse:e} became {fine:e}");
}

/// By the trapezoidal rule: of second order too, for a law of no and of much memory.
#[test]
fn the_books_of_a_block_in_motion_to_and_fro_are_balanced_to_the_second_order() {
    for friction in [coulomb(0.4), super_subloading()] {
        let [coarse, fine] = [160, 5120].map(|parts| {
            let energy = shaken(friction.clone(), trapezoidal(), parts).energy;
            assert!(energy.friction_dissipation > 30.0);
            (energy.error() / energy.friction_dissipation).abs()
        });
        println!("energy errors {coarse:e}, {fine:e}");
        assert!(fine < 1e-6 && coarse / fine > 300.0, "{coarse:e} became {fine:e}");
    }
}

/// Two columns with a gap between them, pressed with what their contact starts with: the gap stays what it was, whatever
/// the penalty. Without an initial state the upper column falls through the gap.
#[test]
fn surfaces_may_start_closed_across_a_gap() {
    let pressure = 3.0;
    let columns = |initial: Value, scheme: Value| {
        json!({
            "mesh": Blocks::default()
                .rectangle("lower", [2, 2], [0.0, 0.0], [1.0, 1.0])
                .rectangle("upper", [2, 3], [0.0, 1.01], [1.0, 2.01]).json(),
            "bodies": {
                "lower": {"material": {"model": "linear", "E": 100, "nu": 0, "density": 1}},
                "upper": {"material": {"model": "linear", "E": 100, "nu": 0, "density": 1}},
            },
            "contacts": {"joint": {"slave": "upper_bottom", "master": "lower_top", "normal": {"alpha_n": 2000},
                                   "friction": super_subloading(), "initial": initial}},
            "newton": {"tolerance": 1e-12},
            "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.25}, "scheme": scheme,
                       "supports": [{"on": "lower_bottom", "uy": 0}, {"on": "lower", "ux": 0}, {"on": "upper", "ux": 0}],
                       "loads": [{"on": "upper_top", "pressure": pressure.to_string()}]}],
        })
    };
    let run = finish(&columns(json!({"pressure": pressure, "structure": 1.5}), json!("static")));
    let mean = |group: &str| {
        let nodes = run.nodes(group);
        nodes.iter().map(|&node| run.last().displacement[2 * node + 1]).sum::<f64>() / nodes.len() as f64
    };
    close("lower column", mean("lower_top"), -pressure / 100.0, 1e-9);
    close("upper column", mean("upper_bottom"), -pressure / 100.0, 1e-9);
    close("top", mean("upper_top"), -2.0 * pressure / 100.0, 1e-9);
    for state in &run.last().contacts[0] {
        close("p", state.friction.pressure, pressure, 1e-8);
        close("gap counted from touch", state.gap, -pressure / 2000.0, 1e-12);
        close("mu", mu_of(&state.friction), 0.4 - 0.1 * (-0.002f64 / 0.4).exp(), 1e-6);
    }
    let start = model(&columns(json!({"pressure": pressure, "traction": 0.4}), trapezoidal())).initial_state();
    for state in &start.contacts[0] {
        assert_eq!([state.friction.pressure, state.friction.traction, mu_of(&state.friction)], [pressure, 0.4, 0.4]);
    }
    let open = model(&columns(Value::Null, trapezoidal())).initial_state();
    close("gap", open.contacts[0][0].gap, 0.01, 1e-12);
}

/// A point mass on a block of elements: it rests on a segment with its weight, and slides over the nodes between segments
/// at μ p with the pressure unchanged.
#[test]
fn a_point_slides_over_a_mesh() {
    let weight = 5.0;
    for angle in [0.0, 1.1] {
        let ground = Blocks::default().rectangle("ground", [8, 2], [0.0, 0.0], [4.0, 1.0]).turned(angle);
        let mut mesh = ground.json();
        mesh["nodes"].as_array_mut().unwrap().push(json!(turned([0.7, 1.0], angle)));
        mesh["points"] = json!({"block": [ground.nodes.len()]});
        let run = finish(&json!({
            "mesh": mesh,
            "bodies": {"ground": {"material": {"model": "neo_hookean", "E": 1e7, "nu": 0.3}}},
            "contacts": {"base": {"slave": "block", "master": "ground_top", "area": AREA, "normal": {"alpha_n": 1e6},
                                  "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 1e6}}},
            "newton": {"tolerance": 1e-11},
            "steps": [
                {"name": "press", "duration": 1, "dt": {"initial": 1},
                 "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}], "loads": [force(angle, [0.0, -weight])]},
                {"name": "drag", "duration": 1, "dt": {"initial": 0.1},
                 "loads": [{"on": "block", "spring": {"kx": 1e3, "ky": 1e3, "driver": {
                     "x": {"rate": turned([2.0, 0.0], angle)[0]}, "y": {"rate": turned([2.0, 0.0], angle)[1]}}}}]},
            ],
        }));
        let nodes = run.nodes("block");
        let [way, _] =
            turned([run.last().displacement[2 * nodes[0]], run.last().displacement[2 * nodes[0] + 1]], -angle);
        close("way", way, 2.0 - 0.3 * weight / 1e3, 1e-4);
        for state in &run.states[1..] {
            let friction = &state.contacts[0][0].friction;
            close("p", friction.pressure, weight / AREA, 1e-2 * weight / AREA);
            close("q", friction.traction, 0.3 * friction.pressure, 1e-9 * weight);
        }
        let reaction = turned(run.reaction("ground_bottom", run.last()), -angle);
        close("reaction along", reaction[0], -0.3 * weight, 1e-2 * weight);
        close("reaction across", reaction[1], weight, 1e-2 * weight);
    }
}

/// The frames hold a vertex for the point, the history its area; the pressure past the uniqueness bound is told once with
/// its place, and an elastic penetration is not measured against an edge that is not there.
#[test]
fn points_are_written_and_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let slider = Slider {
        friction: super_subloading(),
        initial: json!({"pressure": 80}),
        times: [0.1, 1.0],
        loads: json!([{"on": "block", "force": {"x": "0", "y": "-40 - 20*t"}}]),
        ..Default::default()
    };
    let model = Arc::new(model(&slider.case()));
    let mut history = History::create(folder.path(), &model).unwrap();
    let mut fields = common::frames(folder.path(), &model, 1);
    let mut warnings = Warnings::default();
    let model = Arc::new(model);
    run(&model, &mut [&mut history, &mut fields, &mut warnings]).1.unwrap();
    drop((history, fields));

    let text = std::fs::read_to_string(folder.path().join("history.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|row| row.split(',').collect()).collect();
    let column = rows[0].iter().position(|name| *name == "base.contact_length").unwrap();
    assert!(rows[1..].len() == 10 && rows[1..].iter().all(|row| row[column].parse() == Ok(AREA)), "{text}");

    let frame = vtkio::Vtk::import(folder.path().join("contact/00003.vtu")).unwrap();
    let vtkio::model::DataSet::UnstructuredGrid { pieces, .. } = frame.data else { panic!("an unstructured grid") };
    let piece = pieces[0].load_piece_data(None).unwrap();
    assert_eq!(piece.cells.types, [vtkio::model::CellType::Vertex]);

    assert_eq!(warnings.list.len(), 1, "{:?}", warnings.list);
    let warning = &warnings.list[0];
    assert!(warning.contains("`base` at (0.3") && warning.contains("exceeds 100,"), "{warning}");
}

/// Time, traction, pressure, displacement along x and the force that holds it there but for inertia, of one point over a
/// run.
#[derive(Default)]
struct Trace(Vec<[f64; 5]>);

impl Observer for Trace {
    fn record(&mut self, _: &Model, attempt: &Attempt) -> Result<(), Error> {
        let trace = attempt.accepted.map(|state| {
            let friction = &state.contacts[0][0].friction;
            let held = state.reaction[0] - M * state.acceleration[0];
            [state.time, friction.traction, friction.pressure, state.displacement[0], held]
        });
        self.0.extend(trace);
        Ok(())
    }
}

/// A case of `cases/paper` run for a while with increments of one length.
fn paper(name: &str, [dt, duration]: [f64; 2]) -> Vec<[f64; 5]> {
    let path = crate::common::repository(format!("cases/paper/{name}.json"));
    let mut case: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    case["steps"][0]["dt"] = json!({"initial": dt});
    case["steps"][0]["duration"] = json!(duration);
    let mut trace = Trace::default();
    run(&Arc::new(model(&case)), &mut [&mut trace]).1.unwrap();
    trace.0
}

/// Without weakening friction rises to μ_s p = 39.24 and stays there.
#[test]
fn the_first_spring_mass_case_slides_at_the_static_strength() {
    let trace = paper("spring_mass_1", [0.1, 4600.0]);
    let [time, traction, _, u, _] = trace[trace.len() - 1];
    close("q", traction, 39.24, 1e-3);
    close("spring", 10.0 * (0.001 * time - u), 39.24, 0.1);
    assert!(trace.iter().all(|[_, traction, ..]| *traction < 39.24 + 1e-6));
}

/// With weakening the peak is where s(R) = −li(R)/r and μ = μ_k + (μ_s − μ_k) exp(−κ s/μ_k) give the largest R μ p,
/// 25.0175 at u = 0.040384, which the driver reaches at (q/K + u)/v = 2542.1. Then friction falls to μ_k p = 19.62.
#[test]
fn the_second_spring_mass_case_peaks_at_the_attained_strength_and_slips_once() {
    let trace = paper("spring_mass_2", [0.05, 3600.0]);
    let peak = trace.iter().max_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
    println!("peak {peak:?}");
    close("peak", peak[1], 25.0175, 0.005);
    close("time of the peak", peak[0], 2542.1, 1.0);
    close("q at the end", trace[trace.len() - 1][1], 19.62, 1e-3);
}

/// The block stops for the first time after v₀/(g (μ_k cos θ − sin θ)) = 20.6155, v₀²/(2 g (…)) = 103.0772 down the slope.
#[test]
fn the_block_on_the_slope_stops_in_time() {
    let trace = paper("slope", [0.005, 21.0]);
    let velocity = |k: usize| (trace[k + 1][3] - trace[k][3]) / (trace[k + 1][0] - trace[k][0]);
    let back = (0..trace.len() - 1).find(|&k| velocity(k) < 0.0).expect("it swings back on the contact spring");
    let share = velocity(back - 1) / (velocity(back - 1) - velocity(back));
    let middle = |k: usize| 0.5 * (trace[k][0] + trace[k + 1][0]);
    close("first stop", middle(back - 1) + share * (middle(back) - middle(back - 1)), 20.6155, 0.002);
    close("way", trace[back][3] * 1.0225f64.sqrt(), 103.0772, 1e-3);
}

/// With its motion prescribed, the point answers with what its law alone gives along the same path.
#[test]
fn the_forced_oscillation_is_the_law_along_a_path() {
    let trace = paper("forced_oscillation", [0.01, 7.0]);
    let law: FrictionParameters = serde_json::from_value(super_subloading()).unwrap();
    let law = law.build(0.0).unwrap();
    let mut friction =
        FrictionState { traction: 19.62, pressure: 98.1, ..law.initial_state(0.0, 0.0).with_variables([0.2]) };
    let (mut time, mut way) = (0.0, 0.0);
    for &[t, traction, pressure, u, held] in &trace {
        close("u", u, t.sin(), 1e-12);
        close("p", pressure, 98.1, 1e-9);
        friction = law.respond(&friction, Sliding { slip: u - way, pressure: 98.1, dt: t - time }).unwrap().state;
        close("q", traction, friction.traction, 1e-8);
        close("what drives it", held, friction.traction, 1e-8);
        (time, way) = (t, u);
    }
    let least = trace.iter().fold(0.0f64, |least, row| least.min(row[1]));
    close("backward friction", least, -19.62, 0.1);
}
