//! Steps that follow one another in dynamics: what jumps between them acts at once, and where nothing jumps nothing changes.

use crate::common::{self, Blocks, Finished, close, distance, finish};
use fecontact::model::boundary::Drive;
use fecontact::model::state::State;
use fecontact::output::bodies::BodyMeans;
use fecontact::run::Simulation;
use serde_json::{Value, json};

fn newmark() -> Value {
    json!({"newmark": {}})
}

fn schemes() -> [Value; 4] {
    [
        newmark(),
        json!({"hht": {"alpha": -0.1}}),
        json!({"generalized_alpha": {"rho_infinity": 0.5}}),
        json!({"wilson": {"theta": 1.4}}),
    ]
}

/// A square of mass 1 and, in it, a linear law; 1 × 1 element unless divided.
fn square(divisions: usize, steps: Value) -> Value {
    json!({
        "mesh": Blocks::default().rectangle("body", [divisions; 2], [0.0, 0.0], [1.0, 1.0]).json(),
        "bodies": {"body": {"material": {"model": "linear", "E": 30, "nu": 0.2, "density": 1}}},
        "newton": {"tolerance": 1e-13},
        "steps": steps,
    })
}

/// Total momentum of a body of equal rectangles with four nodes: a quarter of each mass to each node.
fn momentum(run: &Finished, state: &State) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for element in &run.model.mesh.elements {
        let mass = 1.0 / run.model.mesh.elements.len() as f64 / 4.0;
        element.nodes.iter().for_each(|node| (0..2).for_each(|i| sum[i] += mass * state.velocity[2 * node + i]));
    }
    sum
}

/// Springs that are taken away leave a uniform motion at the velocity of that moment: the momentum stays.
#[test]
fn a_spring_that_is_gone_pulls_no_more() {
    for scheme in schemes() {
        let mut case = square(
            1,
            json!([
                {"name": "swing", "duration": 0.5, "dt": {"initial": 0.05, "max": 0.05}, "scheme": scheme,
                    "loads": [{"on": "body_left", "spring": {"kx": 5}}, {"on": "body_right", "spring": {"kx": 5}}]},
                {"name": "free", "duration": 0.5,
                    "loads": [{"on": "body_left", "spring": null}, {"on": "body_right", "spring": null}]},
            ]),
        );
        case["initial_velocity"] = json!({"body": [1, 0]});
        let run = finish(&case);
        let before = momentum(&run, run.at(0.5))[0];
        assert!(before < -0.2, "{scheme}: {before}");
        for state in run.states.iter().filter(|state| state.time > 0.51) {
            close(&format!("{scheme}"), momentum(&run, state)[0], before, 1e-11);
        }
    }
}

/// A gravity of 1 and then of −3, each over half a time: v = ½ − 1½, exact in every scheme.
#[test]
fn a_gravity_that_jumps_acts_at_once() {
    for scheme in schemes() {
        let run = finish(&square(
            1,
            json!([
                {"name": "one way", "duration": 0.5, "dt": {"initial": 0.05}, "scheme": scheme,
                    "loads": [{"on": "body", "gravity": {"y": "1"}}]},
                {"name": "the other", "duration": 0.5, "loads": [{"on": "body", "gravity": {"y": "-3"}}]},
            ]),
        ));
        close(&format!("{scheme}"), momentum(&run, run.last())[1], -1.0, 1e-10);
    }
}

/// By the trapezoidal rule the momentum changes in an increment by the mean of the resultants R at both ends, ½ Δt (R₀ + R₁), R₀
/// being that of the new step: for every kind of load and damper that comes or goes between two steps.
#[test]
fn whatever_jumps_acts_at_once() {
    let dt = 0.02;
    let c_p = (30.0 * 0.8 / (1.2 * 0.6f64)).sqrt();
    /// Resultant along x of what acts in the second step.
    type Resultant = Box<dyn Fn(&Finished, &State) -> f64>;
    let on_right =
        |run: &Finished, of: &dyn Fn(usize) -> f64| -> f64 { run.nodes("body_right").into_iter().map(of).sum() };
    let cases: [(&str, Value, Value, Resultant); 6] = [
        ("force", json!([]), json!([{"on": "body_right", "force": {"x": "7"}}]), Box::new(|_, _| 3.0 * 7.0)),
        (
            "pressure",
            json!([{"on": "body_right", "pressure": "4"}]),
            json!([{"on": "body_right", "pressure": "-1"}]),
            // Of the straight side from its lower to its upper end.
            Box::new(|run, state| {
                let y = |at: [f64; 2]| {
                    let node =
                        run.model.mesh.nodes.iter().position(|x| x.x == at[0] && x.y == at[1]).expect("a corner");
                    at[1] + state.displacement[2 * node + 1]
                };
                y([1.0, 1.0]) - y([1.0, 0.0])
            }),
        ),
        (
            "spring",
            json!([{"on": "body_right", "spring": {"kx": 3}}]),
            json!([{"on": "body_right", "spring": {"kx": 8}}]),
            Box::new(move |run, state| -on_right(run, &|node| 8.0 * state.displacement[2 * node])),
        ),
        (
            "dashpot",
            json!([]),
            json!([{"on": "body_right", "dashpot": {"cx": 2, "driver": {"x": "0.3"}}}]),
            Box::new(move |run, state| on_right(run, &|node| 2.0 * (0.3 - state.velocity[2 * node]))),
        ),
        (
            "absorbing",
            json!([{"on": "body_left", "absorbing": true}]),
            json!([{"on": "body_left", "absorbing": null}, {"on": "body_right", "absorbing": true}]),
            Box::new(move |run, state| {
                let share = |node: usize| if [0.0, 1.0].contains(&run.model.mesh.nodes[node].y) { 0.25 } else { 0.5 };
                -on_right(run, &|node| c_p * share(node) * state.velocity[2 * node])
            }),
        ),
        ("damping", json!([]), json!([]), Box::new(|run, state| -4.0 * momentum(run, state)[0])),
    ];
    for (kind, first, second, resultant) in cases {
        let mut case = square(
            2,
            json!([
                {"name": "before", "duration": 0.2, "dt": {"initial": dt, "max": dt}, "scheme": newmark(), "loads": first},
                {"name": "after", "duration": 0.2, "loads": second},
            ]),
        );
        case["initial_velocity"] = json!({"body": [1, 0.2]});
        if kind == "damping" {
            case["steps"][1]["damping"] = json!({"body": {"mass": 4}});
        }
        let run = finish(&case);
        let at = run.states.iter().position(|state| (state.time - 0.2).abs() < 1e-9).expect("the end of a step");
        for pair in run.states[at..at + 3].windows(2) {
            let [p0, p1] = [0, 1].map(|k| momentum(&run, &pair[k])[0]);
            let [r0, r1] = [0, 1].map(|k| resultant(&run, &pair[k]));
            close(kind, p1 - p0, 0.5 * dt * (r0 + r1), 1e-10);
        }
    }
}

/// One bar, held at its left end, of length, area and density 1: (1/3) a = −E (u − α T) at its right end with the consistent mass, ½ a
/// with the lumped one.
fn bar(steps: Value) -> Value {
    let mut case = json!({
        "mesh": Blocks::default().rectangle("bar", [1, 1], [0.0, 0.0], [1.0, 1.0]).json(),
        "bodies": {"bar": {"material": {"model": "linear", "E": 3, "nu": 0, "density": 1}}},
        "initial_velocity": {"bar": [0.1, 0]},
        "newton": {"tolerance": 1e-13},
        "steps": steps,
    });
    case["steps"][0]["supports"] = json!([{"on": "bar", "uy": 0}, {"on": "bar_left", "ux": 0}]);
    case
}

/// Of every increment from a time on, v₁ − v₀ = ½ Δt (a₀ + a₁) with accelerations by the closed form.
fn check_bar(what: &str, run: &Finished, from: f64, acceleration: impl Fn(f64) -> f64) {
    let dof = 2 * run.nodes("bar_right")[0];
    let mut seen = 0;
    for pair in run.states.windows(2).filter(|pair| pair[0].time > from - 1e-9) {
        let [a0, a1] = [0, 1].map(|k| acceleration(pair[k].displacement[dof]));
        let dt = pair[1].time - pair[0].time;
        close(what, pair[1].velocity[dof] - pair[0].velocity[dof], 0.5 * dt * (a0 + a1), 1e-11);
        seen += 1;
    }
    assert!(seen > 5, "{what}: {seen} increments");
}

/// A bar that swings is heated from one moment to the next, by implicit and by explicit increments; the audit closes.
#[test]
fn a_temperature_that_jumps_acts_at_once() {
    for (scheme, stiffness) in [(newmark(), 9.0), (json!({"explicit": {}}), 6.0)] {
        let mut case = bar(json!([
            {"name": "cold", "duration": 0.5, "dt": {"initial": 0.01, "max": 0.01}, "scheme": scheme},
            {"name": "hot", "duration": 0.5, "temperature": {"bar": "50"}},
        ]));
        case["bodies"]["bar"]["thermal"] = json!({"expansion": 1e-3});
        case["output"] = json!({"interval": 0.01});
        let run = finish(&case);
        let mut states: Vec<State> = run.states.clone();
        states.retain(|state| state.time > 0.495);
        check_bar(&format!("{scheme}"), &Finished { states, ..run }, 0.5, |u| -stiffness * (u - 0.05));
        let run = finish(&case);
        // ½ E (α ΔT)² = 3.75e-3 is stored at once in a bar that is held, and another part of it in one that has moved. In explicit
        // increments the audit counts ½ v₋ m v₊, in which a jump of a is one of ⅛ m Δt² a².
        let swing = if stiffness == 6.0 { 1e-6 } else { 1e-12 };
        close("energy", run.last().energy.error(), 0.0, swing);
        assert!(run.last().energy.external_work.abs() > 1e-4);
    }
}

/// From lumped masses to consistent ones and back: accelerations are those of the new masses, and the audit closes all the time. From
/// rest, under a force of 0.1.
#[test]
fn masses_that_change_keep_the_audit_closed() {
    let mut case = bar(json!([
        {"name": "explicit", "duration": 0.5, "dt": {"initial": 0.01, "max": 0.01}, "scheme": {"explicit": {}},
            "loads": [{"on": "bar_right", "force": {"x": "0.05"}}]},
        {"name": "implicit", "duration": 0.5, "dt": {"initial": 0.01, "max": 0.01}, "scheme": newmark()},
        {"name": "again", "duration": 0.5, "dt": {"initial": 0.01, "max": 0.01}, "scheme": {"explicit": {}}},
    ]));
    case.as_object_mut().expect("a case").remove("initial_velocity");
    case["output"] = json!({"interval": 0.01});
    let run = finish(&case);
    for state in &run.states {
        close(&format!("energy at {}", state.time), state.energy.error(), 0.0, 1e-13);
    }
    let dof = 2 * run.nodes("bar_right")[0];
    // Both nodes of the end, each with a share of 1/6 of the mass and 1/12 of the other's, or with a quarter.
    let kinetic = |share: f64, time: f64| 0.5 * share * run.at(time).velocity[dof].powi(2);
    close("consistent", run.at(0.8).energy.kinetic, kinetic(1.0 / 3.0, 0.8), 1e-14);
    // ½ v₋ m v₊ with the velocities half an increment before and after.
    let swing = 0.5 * 0.01 * (0.2 - 6.0 * run.at(1.2).displacement[dof]);
    close("lumped", run.at(1.2).energy.kinetic, kinetic(0.5, 1.2) - 0.5 * 0.5 * swing * swing, 1e-14);
    let implicit = run.states.iter().filter(|state| state.time < 1.005).cloned().collect();
    check_bar("implicit", &Finished { states: implicit, ..run }, 0.5, |u| 0.3 - 9.0 * u);
}

/// A body that starts with a velocity and is held on a side: the nodes there are at rest, or move as their support does, and only the
/// others have an energy.
#[test]
fn held_nodes_start_with_their_supports() {
    for (scheme, share) in [(newmark(), 1.0 / 3.0), (json!({"explicit": {}}), 0.5)] {
        let mut case =
            bar(json!([{"name": "swing", "duration": 0.5, "dt": {"initial": 0.01, "max": 0.01}, "scheme": scheme}]));
        let run = finish(&case);
        close("initial", run.last().energy.initial, 0.5 * share * 0.01, 1e-17);
        close("energy", run.last().energy.error(), 0.0, 1e-14);
        // A support that moves with the body leaves it as it is.
        case["steps"][0]["supports"][1]["ux"] = json!({"rate": 0.1});
        let run = finish(&case);
        close("mass 1", run.last().energy.initial, 0.5 * 0.01, 1e-16);
        for state in &run.states {
            let dof = 2 * run.nodes("bar_right")[0];
            close("as one", state.displacement[dof], 0.1 * state.time, 1e-13);
            close("energy", state.energy.error(), 0.0, 1e-13);
        }
    }
}

/// A spring that is gone from one body leaves another as it is: in schemes whose accelerations belong to another moment, finding them
/// anew would change it by 1e-2.
#[test]
fn a_load_that_jumps_at_one_body_leaves_the_others_as_they_are() {
    let mesh = Blocks::default().rectangle("body", [2, 2], [0.0, 0.0], [1.0, 1.0]);
    let mesh = mesh.rectangle("other", [2, 2], [5.0, 0.0], [6.0, 1.0]).json();
    let material = json!({"model": "linear", "E": 30, "nu": 0.2, "density": 1});
    for scheme in schemes() {
        let case = |after: Value| {
            json!({
                "mesh": mesh,
                "bodies": {"body": {"material": material}, "other": {"material": material}},
                "initial_velocity": {"body": [1, 0]},
                "steps": [
                    {"name": "swing", "duration": 0.5, "dt": {"initial": 0.05, "max": 0.05}, "scheme": scheme,
                        "supports": [{"on": "other_bottom", "ux": {"rate": 0.1}, "uy": 0}],
                        "loads": [{"on": "body_left", "spring": {"kx": 5}}]},
                    {"name": "free", "duration": 0.5, "loads": after},
                ],
            })
        };
        let [stays, ends] = [json!([]), json!([{"on": "body_left", "spring": null}])].map(|after| finish(&case(after)));
        let of = |run: &Finished, name: &str| -> Vec<f64> {
            let at = |node: &usize| [2 * node, 2 * node + 1].map(|dof| run.last().velocity[dof]);
            run.model.bodies.iter().find(|body| body.name == name).expect("a body").nodes.iter().flat_map(at).collect()
        };
        let moved = distance(&of(&stays, "other"), &of(&ends, "other"));
        close(&format!("{scheme}"), moved, 0.0, 1e-11);
        assert!(distance(&of(&stays, "body"), &of(&ends, "body")) > 0.1, "{scheme}");
    }
}

/// What a free body of quadratic elements is told to have of momentum does not change under explicit increments, although it shakes:
/// lumped masses keep P and L by themselves, and not by the shape functions.
#[test]
fn explicit_increments_keep_the_momentum_that_is_reported() {
    let corners = Blocks::default().rectangle("body", [2, 2], [0.0, 0.0], [1.0, 1.0]).json();
    let case = json!({
        "mesh": common::quadratic(&corners, common::half_way),
        "bodies": {"body": {"material": {"model": "neo_hookean", "E": 30, "nu": 0.2, "density": 1}}},
        "initial_velocity": {"body": [0.1, 0]},
        "output": {"interval": 0.01},
        "steps": [
            {"name": "shake", "duration": 0.3, "scheme": {"explicit": {}}, "dt": {"initial": 0.001, "max": 0.001},
                "loads": [{"on": "body_right", "force": {"x": "0.3", "y": "0.1"}}, {"on": "body_left", "spring": {"kx": 5}}]},
            {"name": "fly", "duration": 0.3, "loads": [
                {"on": "body_right", "force": {"x": "0", "y": "0"}}, {"on": "body_left", "spring": null}]},
        ],
    });
    let run = finish(&case);
    let means = BodyMeans::new(&run.model, &run.model.bodies[0]);
    let flying = || run.states.iter().filter(|state| state.time > 0.305).map(|state| means.motion(&run.model, state));
    let first = flying().next().expect("it flies");
    for motion in flying() {
        close("P_x", motion.momentum.x, first.momentum.x, 1e-14);
        close("P_y", motion.momentum.y, first.momentum.y, 1e-14);
        // To the second order in Δt.
        close("L", motion.angular_momentum, first.angular_momentum, 1e-4 * first.angular_momentum.abs());
    }
    assert!(flying().count() > 20 && first.momentum.norm() > 0.01);
}

/// Wilson's scheme is of second order where loads and supports bend: u at the end against the finest, and its error falls fourfold.
#[test]
fn wilson_keeps_its_order_under_varied_loads() {
    let end = |dt: f64| {
        let run = finish(&{
            let mut case = bar(json!([{"name": "swing", "duration": 1, "dt": {"initial": dt, "max": dt},
                "scheme": {"wilson": {"theta": 1.4}},
                "loads": [{"on": "bar_right", "force": {"x": "0.3*sin(4*t)"}}]}]));
            case["steps"][0]["supports"][1]["ux"] = json!("0.1*t + 0.05*(1 - cos(3*t))");
            case
        });
        run.last().displacement[2 * run.nodes("bar_right")[0]]
    };
    let exact = end(1.0 / 1280.0);
    let errors = [20.0, 40.0].map(|n| (end(1.0 / n) - exact).abs());
    let ratio = errors[0] / errors[1];
    assert!((3.5..4.6).contains(&ratio), "{errors:?}: {ratio}");
}

/// Loads that whoever leads the run changes within a step act at once, too, in one that was saved in between as well.
#[test]
fn loads_changed_on_the_way_act_at_once() {
    for scheme in schemes() {
        let case = square(
            1,
            json!([{"name": "fall", "duration": 1, "dt": {"initial": 0.05, "max": 0.05}, "scheme": scheme,
                "loads": [{"on": "body", "gravity": {"y": "1"}}]}]),
        );
        let mut run = Simulation::new(common::model(&case));
        let mut turned = false;
        while let Some(increment) = run.next_increment().expect("it is solved") {
            if !turned && increment.state.time > 0.495 {
                turned = true;
                run.change(|step| {
                    for load in &mut step.loads.dead {
                        load.amplitude.drive = Drive::Table(vec![[0.0, -3.0]]);
                    }
                });
                // An attempt that is dropped leaves no trace.
                drop(run.try_increment().expect("it begins"));
                run = Simulation::resume(run.model().clone(), run.save());
            }
        }
        let last = run.state();
        close(&format!("{scheme}"), 0.25 * (0..4).map(|node| last.velocity[2 * node + 1]).sum::<f64>(), -1.0, 1e-10);
    }
}

/// The angular momentum of a free body grows by the moment on its plate, ½ Δt (m₀ + m₁) in every increment, as long as it turns by
/// little.
#[test]
fn a_moment_that_jumps_acts_at_once() {
    let mut case = square(
        2,
        json!([
            {"name": "rest", "duration": 0.1, "dt": {"initial": 0.01, "max": 0.01}, "scheme": newmark(),
                "loads": [{"on": "body_top", "moment": "1e-6"}]},
            {"name": "turned", "duration": 0.1, "loads": [{"on": "body_top", "moment": "-3e-6"}]},
        ]),
    );
    case["plates"] = json!([{"on": "body_top", "moves": "rigid"}]);
    let run = finish(&case);
    // The sum over elements of x × M v, with the consistent masses of bilinear rectangles.
    let angular = |state: &State| -> f64 {
        let of = |element: &fecontact::mesh::Element| {
            let (size, nodes) = (0.25, &element.nodes);
            let mut sum = 0.0;
            for (a, &i) in nodes.iter().enumerate() {
                for (b, &j) in nodes.iter().enumerate() {
                    let share = size / 36.0 * [4.0, 2.0, 1.0, 2.0][(4 + a - b) % 4];
                    let x = run.model.mesh.nodes[i];
                    sum += share * (x.x * state.velocity[2 * j + 1] - x.y * state.velocity[2 * j]);
                }
            }
            sum
        };
        run.model.mesh.elements.iter().map(of).sum()
    };
    close("first", angular(run.at(0.1)), 1e-7, 1e-13);
    close("then", angular(run.last()), 1e-7 - 3e-7, 1e-13);
}
