//! Water that flows along contacts between bodies in which it flows, against closed forms of conduits that leak off into them.

use std::sync::Arc;

use crate::common::{Blocks, Finished, close, finish, half_way, model, quadratic};
use crate::terms::{another_displacement, arbitrary_displacement, tangent_error};
use fecontact::equations::Trial;
use fecontact::model::state::{LastIncrement, State};
use serde_json::{Value, json};

/// Rock that does not deform beside its water, which passes κ and is stored by 1/Q per volume, across the contact alone.
fn rock(kappa: f64, q: f64) -> Value {
    json!({"material": {"model": "linear", "E": 1e5, "nu": 0.2, "density": 1},
           "pore_fluid": {"bulk_modulus": 0.5 * q, "porosity": 0.5, "permeability": 1e-9, "permeability_y": kappa, "unit_weight": 1}})
}

/// Two blocks that are held, from x = 0 to `length` and `depth` above and below their contact, with elements that grow with the distance.
fn held(kind: &str, [nx, ny]: [usize; 2], [length, depth]: [f64; 2], body: &Value, flow: Value, step: Value) -> Value {
    let x = move |s: f64| if nx == 1 { length * s } else { length * s.powi(2) };
    let y = move |s: f64| depth * s.powf(2.5);
    let blocks = Blocks::default().block("low", [nx, ny], move |a, b| [x(a), -y(1.0 - b)]).block(
        "high",
        [nx, ny],
        move |a, b| [x(a), y(b)],
    );
    let mesh = if kind == "q8" { quadratic(&blocks.json(), half_way) } else { blocks.json() };
    let mut all =
        json!({"name": "flow", "supports": [{"on": "low", "ux": 0, "uy": 0}, {"on": "high", "ux": 0, "uy": 0}]});
    step.as_object().expect("keys").iter().for_each(|(key, value)| all[key] = value.clone());
    json!({"mesh": mesh, "bodies": {"low": body, "high": body},
        "contacts": {"slit": {"slave": "high_bottom", "master": "low_top", "friction": {"law": "frictionless"}, "initial": {"pressure": 0.0},
            "fluid_pressure": {"flow": flow}}},
        "steps": [all]})
}

/// p of the conduit at the node nearest to x.
fn along(run: &Finished, state: &State, x: f64) -> f64 {
    let line = &run.model.contacts[0].conduit.as_ref().expect("a conduit").line;
    let places: Vec<f64> = line.nodes.iter().map(|&node| run.model.mesh.nodes[node].x).collect();
    let p = &state.conduits[0].pressure;
    for (a, b) in line.pieces() {
        let (from, to) = (places[a].min(places[b]), places[a].max(places[b]));
        if (from..=to).contains(&x) {
            return p[a] + (p[b] - p[a]) * (x - places[a]) / (places[b] - places[a]);
        }
    }
    panic!("no node beside {x}")
}

fn balance(run: &Finished) {
    let size = run.states.iter().filter_map(|state| run.model.balance_of_water(state)).map(|[_, size]| size);
    let throughput = size.fold(0.0, f64::max);
    for state in &run.states {
        let [error, _] = run.model.balance_of_water(state).expect("water");
        close("balance of water", error, 0.0, 1e-8 * throughput);
    }
}

/// A slit that stores S p is emptied by diffusion into both of its sides: p/p₀ = e^τ erfc √τ, τ = (2κ/(S √c))² t.
#[test]
fn a_slit_leaks_off_into_its_bodies() {
    for kind in ["q4", "q8"] {
        let flow = json!({"storage": 1, "transmissivity": 0.0, "viscosity": 1, "initial": 1});
        let mut step = json!({"duration": 10, "dt": {"initial": 1e-5, "pore_pressure": 1e-4}});
        let mut worst = 0.0f64;
        for (time, expected) in [(0.1, 0.72358), (1.0, 0.42758), (10.0, 0.17058)] {
            step["duration"] = json!(time);
            let run = finish(&held(kind, [1, 28], [1.0, 14.0], &rock(0.5, 2.0), flow.clone(), step.clone()));
            let found = along(&run, run.last(), 0.5);
            println!("{kind}, tau = {time}: {found:.5} ({expected}), {} increments", run.states.len());
            worst = worst.max((found / expected - 1.0).abs());
            balance(&run);
            // What has leaked is what the slit has lost.
            let amounts = run.last().conduits[0].amounts;
            close("leaked", amounts.leaked, 1.0 - found, 1e-3);
        }
        assert!(worst < 5e-3, "{kind}: {worst}");
    }
}

/// Either side takes water by itself, however little the other passes: √τ = (κ_s/√c_s + κ_m/√c_m) √t/S.
#[test]
fn either_side_takes_water_by_itself() {
    let dry = json!({"material": {"model": "linear", "E": 1e5, "nu": 0.2}});
    let flow = json!({"storage": 1, "transmissivity": 0.0, "viscosity": 1, "initial": 1});
    let step = json!({"duration": 1, "dt": {"initial": 1e-4, "pore_pressure": 5e-4}});
    let mut case = held("q4", [1, 28], [1.0, 14.0], &rock(0.5, 2.0), flow, step);
    for (low, expected) in [(rock(1e-4, 1e4), 0.615639), (dry, 0.615690)] {
        case["bodies"]["low"] = low;
        let run = finish(&case);
        let found = along(&run, run.last(), 0.5);
        println!("{found:.5} ({expected})");
        close("p", found / expected, 1.0, 1e-3);
        balance(&run);
    }
}

/// An infinite conduit with T = S = 1, at whose mouth a pressure of 1 is held, with 2κ/√c = b: p at x = 1 and t = 1 by a numerical inversion of
/// exp(−√(s + b √s))/s (Talbot's method).
#[test]
fn a_conduit_leaks_off_into_its_bodies() {
    for (b, expected, scheme) in
        [(1.0, 0.314236, json!("static")), (3.0, 0.170968, json!("static")), (3.0, 0.170968, json!({"newmark": {}}))]
    {
        let flow = json!({"storage": 1, "transmissivity": 1, "viscosity": 1, "wells": [{"at": [0, 0], "pressure": 1}]});
        let step = json!({"scheme": scheme, "duration": 1, "dt": {"initial": 1e-4, "pore_pressure": 5e-4}});
        let run = finish(&held("q4", [28, 14], [8.0, 5.0], &rock(0.5 * b, 2.0 / b), flow, step));
        let found = along(&run, run.last(), 1.0);
        println!("{scheme}, b = {b}: {found:.5} ({expected}), {} increments", run.states.len());
        close("p(1, 1)", found / expected, 1.0, 5e-3);
        close("at the mouth", along(&run, run.last(), 0.0), 1.0, 1e-5);
        let amounts = run.last().conduits[0].amounts;
        let size = run.last().water.channels[0][0].volume;
        close("injected", amounts.injected, -size, 1e-12);
        balance(&run);
    }
}

/// Of sides that let nothing pass the pressures are those of a conduit between dry bodies, which is solved by other means.
#[test]
fn sealed_sides_leave_a_conduit_to_itself() {
    let flow = json!({"storage": 1, "transmissivity": 0.3, "viscosity": 1, "initial": "0.2", "leak": {"coefficient": 0.5, "pressure": "0.1"},
        "source": "0.05*x", "wells": [{"at": [0, 0], "pressure": 1}, {"at": [0.5, 0], "rate": -0.1}]});
    let step = json!({"duration": 0.5, "dt": {"initial": 1e-3, "pore_pressure": 2e-4}});
    let mut case = held("q4", [10, 2], [1.0, 1.0], &rock(1.0, 1.0), flow, step);
    case["contacts"]["slit"]["seal"] = json!(0);
    let wet = finish(&case);
    case["contacts"]["slit"].as_object_mut().expect("a contact").remove("seal");
    for body in ["low", "high"] {
        case["bodies"][body].as_object_mut().expect("a body").remove("pore_fluid");
    }
    case["steps"][0]["dt"].as_object_mut().expect("dt").remove("pore_pressure");
    let dry = finish(&case);
    for (node, (p, expected)) in
        wet.last().conduits[0].pressure.iter().zip(&dry.last().conduits[0].pressure).enumerate()
    {
        close(&format!("p of node {node}"), *p, *expected, 1e-3);
    }
    let [own, other] = [&wet, &dry].map(|run| run.last().conduits[0].amounts);
    close("injected", own.injected, other.injected, 2e-3);
    close("leaked", own.leaked, other.leaked, 2e-3);
    balance(&wet);
}

/// Bodies of large strains pressed together, or apart, with water along their contact: ∂r/∂u of all displacements and pressures.
#[test]
fn the_tangent_is_that_of_the_residual() {
    for kind in ["q4", "q8"] {
        for (gap, more) in [
            (-0.05, json!({})),
            (-0.05, json!({"seal": 0.4, "method": "node_to_segment"})),
            (0.08, json!({})),
            (-0.05, json!({"sliding": "small"})),
        ] {
            let blocks = Blocks::default().rectangle("low", [3, 2], [1.0, 0.0], [2.0, 0.5]).rectangle(
                "high",
                [2, 2],
                [1.1, 0.5],
                [1.9, 1.0],
            );
            let mesh = if kind == "q8" { quadratic(&blocks.json(), half_way) } else { blocks.json() };
            let body = json!({"material": {"model": "hencky", "E": 0.9, "nu": 0.2},
                "pore_fluid": {"bulk_modulus": 20, "porosity": 0.5, "permeability": 0.3, "unit_weight": 1, "pressure": "1 - 0.3*y"}});
            let mut contact = json!({"slave": "high_bottom", "master": "low_top", "friction": {"law": "coulomb", "mu": 0.3}, "normal": {"alpha_n": 20},
                "fluid_pressure": {"flow": {"storage": 0.3, "aperture": 0.3, "viscosity": 1, "initial": "0.4*x",
                    "leak": {"coefficient": 0.2}, "wells": [{"at": [1.1, 0.5], "pressure": 1}]}}});
            more.as_object().expect("keys").iter().for_each(|(key, value)| contact[key] = value.clone());
            let case = json!({"mesh": mesh, "bodies": {"low": body, "high": body}, "contacts": {"cut": contact},
                "steps": [{"name": "load", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "low_bottom", "ux": 0, "uy": 0}]}]});
            let model: Arc<_> = model(&case).into();
            let mut state = model.initial_state();
            let old = arbitrary_displacement(&model, 0.01);
            state.displacement.clone_from(&old);
            state.last_increment = Some(LastIncrement {
                dt: 0.3,
                displacement: arbitrary_displacement(&model, 0.01),
                ends_in_touch: false,
            });
            state.time = 0.1;
            let mut u: Vec<f64> = old.iter().zip(another_displacement(&model, 0.01)).map(|(a, b)| a + b).collect();
            model.bodies[0].nodes.iter().for_each(|&node| u[2 * node + 1] += gap);
            let error = tangent_error(&model, Trial::new(&state, &model.steps[0], 0.3, 0.2), &u, 1e-6);
            println!("{kind}, {gap}, {more}: {error:.1e}");
            assert!(error < 1e-8, "{kind}, {gap}, {more}: {error:.1e}");
        }
    }
}
