//! Bodies that come and go with the water that flows through them: excavations and fills below water, and steps that end with consolidation.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::common::{Finished, close, column, finish, model, refusal};
use crate::terms::{another_displacement, arbitrary_displacement, tangent_error};
use fecontact::equations::Trial;
use fecontact::model::{Model, State};
use fecontact::run::{Saved, Simulation};
use serde_json::{Value, json};

/// Numbers of the bodies, in the order of their names.
const HIGH: usize = 0;
const LOW: usize = 1;

/// Weight of ground with its water per volume.
const WEIGHT: f64 = 20.0;
/// The same of the water.
const OF_WATER: f64 = 10.0;

/// Saturated ground of stiffness M = 1200 and c = 1 below a table at y = 3.
fn ground(law: &str) -> Value {
    json!({"material": {"model": law, "E": 1000, "nu": 0.25, "density": 2},
        "pore_fluid": {"bulk_modulus": 1e9, "porosity": 0.5, "permeability": OF_WATER / 1200.0, "unit_weight": OF_WATER, "weighs": true, "pressure": "10*(3 - y)"},
        "initial_stress": {"geostatic": {"surface": 3, "weight": WEIGHT - OF_WATER, "K0": 0.5}}})
}

/// Rest; the upper third goes at once, as good as; the bared face drains.
fn excavation(n: usize, law: &str) -> Value {
    let gravity = |body: &str| json!({"on": body, "gravity": {"y": "-10"}});
    json!({
        "mesh": column(n, 0.1, ["low", "high"], Some("between")), "bodies": {"low": ground(law), "high": ground(law)},
        "steps": [
            {"name": "rest", "duration": 1, "dt": {"initial": 1.0}, "loads": [gravity("low"), gravity("high")],
             "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "side", "ux": 0}],
             "drainage": [{"on": "top", "pressure": 0}]},
            {"name": "dig", "duration": 1e-6, "dt": {"initial": 1e-6}, "remove": ["high"]},
            {"name": "wait", "duration": 2, "dt": {"initial": 0.01, "max": 0.05, "pore_pressure": 0.05}, "drainage": [{"on": "between", "pressure": 0}]},
        ],
    })
}

/// Excess pressure at the base over that at the start, and degree of consolidation, of Terzaghi's series at T.
fn terzaghi(time: f64) -> [f64; 2] {
    (0..2000).fold([0.0, 1.0], |[pressure, settled], k| {
        let m = 0.5 * PI * f64::from(2 * k + 1);
        let decay = (-m * m * time).exp();
        [pressure + 2.0 / m * m.sin() * decay, settled - 2.0 / (m * m) * decay]
    })
}

/// Bodies that share nodes start with one pressure there.
#[test]
fn adjacent_bodies_start_with_one_pressure() {
    let mut case = excavation(6, "linear");
    case["bodies"]["low"]["pore_fluid"]["pressure"] = json!("10*(3 - y) + 1");
    let message = refusal(&case);
    let words = [
        "bodies.high.pore_fluid.pressure: is 10 ",
        " where an adjacent body starts with 11: the pressure of flowing water is continuous there",
    ];
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
}

/// Water that weighs and flows down at the start where nothing drains it is reported; where water that does not weigh takes it on, it is not.
#[test]
fn water_that_begins_to_flow_is_reported() {
    let warned = |drainage: Value| {
        let mut case = excavation(3, "linear");
        case["mesh"] = column(3, 0.1, ["low", "high"], None);
        case["steps"][0]["drainage"] = drainage;
        case["steps"].as_array_mut().expect("steps").truncate(1);
        // k times the gradient 1 of its head flows down in `high`, and as much in `low`.
        case["bodies"]["high"]["pore_fluid"]["pressure"] = json!(0);
        case["bodies"]["low"]["pore_fluid"]["pressure"] = json!("10*(y - 2)");
        case["bodies"]["low"]["pore_fluid"]["weighs"] = json!(false);
        model(&case).warnings().join("\n").contains("water flows at the start where nothing drains it")
    };
    assert!(!warned(json!([{"on": "top", "pressure": 0}, {"on": "bottom", "pressure": -20}])));
    assert!(warned(json!([{"on": "bottom", "pressure": -20}])));
}

fn node_at(model: &Model, y: f64) -> usize {
    model.mesh.nodes.iter().position(|x| x.x < 1e-9 && (x.y - y).abs() < 1e-9).expect("a node")
}

fn pressure(run: &Finished, state: &State, y: f64) -> f64 {
    let flow = run.model.flow.as_ref().expect("water flows");
    flow.pressure(flow.of_node[node_at(&run.model, y)].expect("a corner"), Some(&state.displacement))
}

fn first_after(run: &Finished, time: f64) -> &State {
    run.states.iter().find(|state| state.time > time - 1e-9).expect("a state after it")
}

/// Unloading by γ h takes the pressure down by as much at once; as water enters at the bared face, up to which it stands in the end, ground heaves by
/// γ′ h H/M times Terzaghi's degree.
#[test]
fn ground_heaves_as_water_enters_below_an_excavation() {
    for law in ["linear", "hencky"] {
        let run = finish(&excavation(8, law));
        let (dug, top) = (run.at(1.0 + 1e-6), node_at(&run.model, 2.0));
        let rest = run.at(1.0).displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()));
        close("rest", rest, 0.0, 1e-10);
        close("p at the base", pressure(&run, dug, 0.0), 30.0 - WEIGHT, 1e-2);
        close("p at the bared face", pressure(&run, dug, 2.0), 10.0 - WEIGHT, 1e-2);
        for time in [0.4, 1.0, 2.0] {
            let state = first_after(&run, 1.0 + time);
            let [excess, degree] = terzaghi((state.time - 1.0) / 4.0);
            let below = WEIGHT - OF_WATER;
            // The strain of 1.7 % stiffens the column of large strains.
            close(
                "p at the base",
                pressure(&run, state, 0.0),
                20.0 - below * excess,
                if law == "linear" { 0.06 } else { 0.2 },
            );
            let heave = state.displacement[2 * top + 1] * 1200.0 / (2.0 * below);
            close("heave", heave, degree, if law == "linear" { 4e-3 } else { 2e-2 });
        }
        let mut throughput = 0.0f64;
        for state in &run.states {
            let [error, size] = run.model.balance_of_water(state).expect("water");
            throughput = throughput.max(size);
            close("balance", error, 0.0, 1e-7 * throughput.max(1e-3));
        }
        let gone = run.model.water_of(HIGH, run.last()).expect("water");
        assert!(
            gone[1].is_nan() && gone[0] == run.model.water_of(HIGH, dug).expect("water")[0],
            "it takes its water along"
        );
        assert!(run.last().water.outlets[1].volume < -1e-4, "water enters");
        let energy = run.last().energy;
        let tolerance = if law == "linear" { 1e-6 } else { 1e-4 };
        close("energy", energy.error(), 0.0, tolerance * energy.external_work.abs().max(energy.strain.abs()));
    }
}

/// A fill that comes on ground that has moved down by 0.2 is 1.2 thick, and consolidates as such: T = c t/1.44.
#[test]
fn a_fill_consolidates_in_the_shape_in_which_it_comes() {
    let mut case = excavation(12, "linear");
    case["mesh"] = column(12, 0.1, ["low", "high"], None);
    case["bodies"]["low"] = json!({"material": {"model": "linear", "E": 1000, "nu": 0.25}});
    let high = case["bodies"]["high"].as_object_mut().expect("a body");
    high["pore_fluid"]["weighs"] = json!(false);
    high["pore_fluid"]["pressure"] = json!(0.0);
    high.remove("initial_stress");
    case["steps"] = json!([
        {"name": "sink", "duration": 1, "dt": {"initial": 1.0},
         "supports": [{"on": "low", "ux": 0, "uy": -0.2}, {"on": "side", "ux": 0}]},
        {"name": "fill", "duration": 1, "dt": {"initial": 1.0}, "add": ["high"]},
        {"name": "load", "duration": 0.72, "dt": {"initial": 0.004}, "loads": [{"on": "top", "dead_pressure": "1"}], "drainage": [{"on": "top", "pressure": 0}]},
    ]);
    let run = finish(&case);
    let top = node_at(&run.model, 3.0);
    for time in [0.144, 0.72] {
        let state = first_after(&run, 2.0 + time);
        let [excess, degree] = terzaghi(time / 1.44);
        // The lowest element alone takes up what the ground has moved: 3.4 times the others.
        close("p at the base of the fill", pressure(&run, state, 2.0), excess, 8e-3);
        close("settlement", -state.displacement[2 * top + 1] * 1200.0 / 1.2, degree, 4e-3);
        let [error, size] = run.model.balance_of_water(state).expect("water");
        close("balance", error, 0.0, 1e-7 * size);
    }
}

/// A fill comes with the pressure that its own fluid has; where it shares nodes, with that of the ground. Its water counts from there.
#[test]
fn water_comes_with_a_fill() {
    let mut case = excavation(4, "hencky");
    let mut rest = case["steps"][0].clone();
    rest["drainage"] = json!([{"on": "between", "pressure": 25}]);
    case["steps"] = json!([
        rest,
        {"name": "seep", "duration": 5, "dt": {"initial": 1}},
        {"name": "fill", "duration": 1, "dt": {"initial": 0.25}, "add": ["high"], "drainage": [{"on": "between", "impervious": true}, {"on": "top", "pressure": 0}]},
        {"name": "dig", "duration": 1, "dt": {"initial": 0.25}, "remove": ["high"]},
        {"name": "fill again", "duration": 1, "dt": {"initial": 0.25}, "add": ["high"]},
        {"name": "dig again", "duration": 1, "dt": {"initial": 0.25}, "remove": ["high"]},
    ]);
    let run = finish(&case);
    close("p below", pressure(&run, run.at(6.0), 2.0), 25.0, 1e-3);
    assert_eq!(pressure(&run, run.at(6.0), 2.5), 5.0, "what is not there waits with what it starts with");
    assert_eq!(pressure(&run, run.at(8.0), 2.5), 5.0, "and starts anew");
    let mut throughput = 0.0f64;
    for state in &run.states {
        let [error, size] = run.model.balance_of_water(state).expect("water");
        throughput = throughput.max(size);
        close("balance", error, 0.0, 1e-7 * throughput.max(1e-6));
    }
    let bytes = |steps: usize| {
        let shared: Arc<Model> = model(&case).into();
        let mut simulation = Simulation::new(shared.clone());
        (0..steps).for_each(|_| drop(simulation.next_increment().expect("it runs")));
        let saved = simulation.save().bytes().expect("it can be written");
        let mut simulation =
            Simulation::resume(shared.clone(), Saved::from_bytes(&saved, &shared).expect("it can be read"));
        while simulation.next_increment().expect("it runs").is_some() {}
        simulation.state().clone()
    };
    assert!(bytes(8) == *run.last(), "a resumed run has other bits");
}

/// ∂r/∂u with elements that came into a deformed body, and with others that are away.
#[test]
fn the_tangent_counts_elements_as_they_came() {
    for (law, section) in [("hencky", "plane_strain"), ("hencky", "axisymmetric"), ("linear", "axisymmetric")] {
        let mut case = excavation(3, law);
        case["section"] = json!(section);
        case["mesh"] = column(3, 0.1, ["low", "high"], None);
        case["steps"][1]["remove"] = json!([]);
        case["steps"][1]["add"] = json!(["high"]);
        (0..3).for_each(|k| case["steps"][k]["drainage"] = json!([]));
        let model: Arc<Model> = model(&case).into();
        let mut state = model.initial_state();
        state.displacement = arbitrary_displacement(&model, 0.008);
        for (k, factor) in [(0, 1.0), (1, 1.3)] {
            let step = &model.steps[k];
            state.begin_step(&step.absent);
            model.let_water_go(step, &mut state);
            model.bear(step, &mut state).expect("there is room");
            model.forget(step, &mut state);
            let other = another_displacement(&model, 0.008);
            let mut u: Vec<f64> = state.displacement.iter().zip(other).map(|(a, b)| a + factor * b).collect();
            let flow = model.flow.as_ref().expect("water");
            if k == 0 {
                // Nodes of bodies that are away are held.
                let idle = model.idle_nodes(&step.absent);
                idle.iter().flat_map(|node| [2 * node, 2 * node + 1]).for_each(|dof| u[dof] = state.displacement[dof]);
            }
            assert!(u.len() > flow.dof(0));
            let error = tangent_error(&model, Trial::new(&state, step, state.time + 0.2, 0.2), &u, 1e-6);
            assert!(error < 1e-8, "{law}, {section}, step {k}: {error:.1e}");
        }
    }
}

/// A step ends where the lower two thirds of Terzaghi's column are consolidated by 0.9, T = 0.95412 by the mean of the series over them.
#[test]
fn a_step_ends_at_a_degree_of_consolidation() {
    let mut case = excavation(8, "linear");
    case["steps"][2]["until"] = json!({"on": "low", "consolidation": 0.5});
    let message = refusal(&{
        let mut wrong = case.clone();
        wrong["steps"][1]["until"] = case["steps"][2]["until"].clone();
        wrong
    });
    assert!(message.contains("bodies that come or go"), "{message}");
    for (until, expected) in [
        (json!({"on": "low", "consolidation": 1.5}), "must be above 0 and below 1"),
        (json!({"on": "high", "consolidation": 0.5}), "is not a body whose water flows in this step"),
        (json!({"on": "low"}), "exactly one of fx, fy, force and consolidation"),
    ] {
        let mut wrong = case.clone();
        wrong["steps"][2]["until"] = until;
        let message = refusal(&wrong);
        assert!(message.contains(expected), "{message}");
    }
    let mut simple = case.clone();
    simple["mesh"] = column(8, 0.1, ["low", "high"], None);
    for body in ["low", "high"] {
        simple["bodies"][body] = json!({"material": {"model": "linear", "E": 1000, "nu": 0.25},
            "pore_fluid": {"bulk_modulus": 1e9, "porosity": 0.5, "permeability": 1, "unit_weight": 1200}});
    }
    simple["steps"] = json!([{"name": "load", "duration": 20, "dt": {"initial": 0.02, "max": 0.1, "pore_pressure": 0.01},
        "until": {"on": "low", "consolidation": 0.9}, "loads": [{"on": "top", "dead_pressure": "1"}],
        "supports": [{"on": "bottom", "ux": 0, "uy": 0}, {"on": "side", "ux": 0}], "drainage": [{"on": "top", "pressure": 0}]}]);
    let run = finish(&simple);
    close("time of 90 %", run.last().time / 9.0, 0.95412, 4e-3);
    close("degree", run.last().water.consolidation(LOW), 0.9, 1e-6);
}

/// What drains a body that is not there waits with it; what a step gives there is refused.
#[test]
fn places_of_absent_bodies_do_not_drain() {
    let good = excavation(2, "linear");
    let model = model(&good);
    assert_eq!(model.steps.iter().map(|step| step.drains.len()).collect::<Vec<_>>(), [1, 0, 1]);
    let mut wrong = good.clone();
    wrong["steps"][2]["drainage"] = json!([{"on": "top", "pressure": 0}]);
    let message = refusal(&wrong);
    assert!(
        message.contains("steps[2].drainage[0].on: `top` is on bodies that are not there in this step"),
        "{message}"
    );
}
