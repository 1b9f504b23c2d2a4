//! Water that flows along a contact, in quasi-dynamic steps, in explicit increments, and into a rupture and out of it.

use crate::common::{Blocks, Finished, close, finish, goes_on};
use crate::slabs::{differences, slabs};
use fecontact::contact::force::ContactState;
use fecontact::model::state::State;
use serde_json::{Value, json};

fn quasi_dynamic(tolerance: f64) -> Value {
    json!({"quasi_dynamic": {"tolerance": tolerance, "every": 10}})
}

/// The slabs with water that flows along their fault.
fn wet_slabs(scheme: &Value, flow: &Value) -> Value {
    slabs(scheme, 10.0, &json!({"fluid_pressure": {"flow": flow}}))
}

/// Slip, pressure and p_w of every point of the fault.
fn fault(run: &Finished) -> Vec<[f64; 3]> {
    let of = |state: &ContactState| [state.friction.plastic_slip, state.friction.pressure, state.fluid];
    run.last().contacts[0].iter().map(of).collect()
}

/// Largest difference of two faults in each of the three, over the largest value.
fn apart(a: &Finished, b: &Finished) -> [f64; 3] {
    differences(&fault(a), &fault(b))
}

fn balances(run: &Finished) {
    for state in &run.states {
        let water = &state.conduits[0];
        let share = water.mass_error.abs() / water.amounts.throughput.max(1e-6);
        assert!(share < 1e-10, "{share:e} of {:e} at {}", water.amounts.throughput, state.time);
    }
}

/// A well that is shut after a while, in a fault whose transmissivity goes by slip and by the pressure on it: the steps of a quasi-dynamic run
/// have the water of short static increments, and a run that goes on from a file the same bits.
#[test]
fn quasi_dynamic_water_is_that_of_static_increments() {
    let flow = json!({
        "storage": 0.05, "transmissivity": 0.01, "viscosity": 1, "per_slip": 0.5, "closing": 4,
        "wells": [{"at": [2, 0], "rate": 0.03, "until": 6}],
    });
    let case = wet_slabs(&quasi_dynamic(1e-7), &flow);
    let exact = finish(&case);
    balances(&exact);
    close("injected", exact.last().conduits[0].amounts.injected, 0.18, 1e-12);
    let errors = [0.1, 0.025].map(|dt| {
        let mut case = wet_slabs(&json!("static"), &flow);
        case["steps"][0]["dt"] = json!({"initial": dt, "min": 1e-6, "max": dt});
        let run = finish(&case);
        balances(&run);
        println!("{dt}: {:?}", apart(&exact, &run));
        apart(&exact, &run)
    });
    assert!(errors[1].iter().all(|error| *error < 2e-3), "{errors:?}");
    let slips = fault(&exact).iter().fold(0.0f64, |most, point| most.max(point[0].abs()));
    assert!(slips > 1e-3, "{slips}");
    goes_on(&case, &exact, 3);
}

/// Periodic sides of a quasi-dynamic fault are joined: what is shifted by a part of the period has the same water at places that are shifted.
#[test]
fn water_goes_round_a_periodic_fault() {
    let [one, other] = [0.0, 2.5].map(|shift| {
        let flow = json!({"storage": 0.05, "transmissivity": 0.01, "viscosity": 1, "wells": [{"at": [(5.0 + shift) % 6.0, 0], "rate": 0.015}]});
        let mut case = wet_slabs(&quasi_dynamic(1e-7), &flow);
        case["periodic"] = json!([["lower_left", "lower_right"], ["upper_left", "upper_right"]]);
        case["contacts"]["fault"]["initial"] = json!({"pressure": 2, "traction": 1.1, "balanced": true});
        let run = finish(&case);
        balances(&run);
        run
    });
    let x = one.model.mesh.undeformed();
    let points = &one.model.contacts[0].points;
    let at = |run: &Finished, place: f64| {
        let k = points.iter().position(|slave| (slave.at(&x).x - place).abs() < 1e-9).expect("a node");
        fault(run)[k]
    };
    let largest = fault(&one).iter().fold([0.0f64; 3], |most, point| [0, 1, 2].map(|i| most[i].max(point[i].abs())));
    for k in 0..12 {
        let place = 0.5 * f64::from(k);
        let [here, there] = [at(&one, place), at(&other, (place + 2.5) % 6.0)];
        (0..3).for_each(|i| close("shifted", there[i], here[i], 1e-7 * largest[i]));
    }
    let [first, last] = [at(&one, 0.0), at(&one, 6.0)];
    (0..3).for_each(|i| close("ends", first[i], last[i], 1e-12 * largest[i]));
}

/// A slab on a plane whose water rises until the interface breaks within milliseconds.
fn flooded(flow: &Value, dilatancy: f64, steps: Value) -> Finished {
    let mut steps = steps;
    steps[0]["supports"] = json!([{"on": "slab_top", "ux": 0, "uy": 0}]);
    let mut case = json!({
        "mesh": Blocks::default().rectangle("slab", [40, 8], [0.0, 0.0], [1.0, 0.2]).json(),
        "bodies": {"slab": {
            "material": {"model": "linear", "E": 2.5, "nu": 0.25, "density": 1e-6}, "damping": {"stiffness": 2e-6},
        }},
        "contacts": {"base": {
            "slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 800.0}, "fluid_pressure": {"flow": flow},
            "friction": {"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.4, "D_c": 8e-6, "alpha_t": 800.0},
            "along": {"mu_s": {"x": [[0.2, 0.57], [0.3, 0.6]]}},
            "initial": {"pressure": 1e-3, "traction": 5e-4, "balanced": true},
        }},
        "steps": steps,
        "output": {"interval": 2e-5},
    });
    if dilatancy > 0.0 {
        case["contacts"]["base"]["dilatancy"] = json!({"rate": dilatancy});
    }
    finish(&case)
}

/// Into a rupture and out of it the water goes on: p_w = Q t/S at every place without a transmissivity, in every state, until the source ends;
/// it breaks as explicit increments alone have it, and the audit closes.
#[test]
fn water_rises_into_a_rupture_and_after_it() {
    let source = "1.25e-4*(1 + 0.1*x)*max(0, signum(1 - t))";
    let flow = json!({"storage": 0.5, "transmissivity": 0, "viscosity": 1, "source": source});
    let run = flooded(
        &flow,
        0.0,
        json!([{
            "name": "flood", "duration": 1.2, "dt": {"initial": 0.005, "min": 1e-4, "max": 0.05}, "rupture": {"slip_rate": 1e-3},
        }]),
    );
    println!("{} increments, {} ruptures", run.report.increments, run.report.ruptures);
    assert!((1..=3).contains(&run.report.ruptures), "{}", run.report.ruptures);
    balances(&run);
    let x = run.model.mesh.undeformed();
    for state in &run.states {
        for (slave, contact) in run.model.contacts[0].points.iter().zip(&state.contacts[0]) {
            let (t, x) = (state.time, slave.at(&x).x);
            // But for what opens at the ends, some micrometres, which sucks: S p_w + w is what has come in.
            let opening = contact.water.expect("water").aperture;
            // The source ends with a jump, within an increment.
            let allowed = if t < 1.0 { 1e-8 } else { 1e-6 };
            close("p_w + w/S", contact.fluid + opening / 0.5, 2.5e-4 * t.min(1.0) * (1.0 + 0.1 * x), allowed);
        }
        close("energy", state.energy.error(), 0.0, 0.01 * run.last().energy.friction_dissipation);
    }
    let slip = |state: &State| state.contacts[0].iter().map(|c| c.friction.plastic_slip.abs()).sum::<f64>() / 41.0;
    let onset = run.states.iter().find(|state| slip(state) > 4e-6).expect("it breaks").time;
    let after = run.states.iter().rfind(|state| state.time <= onset + 0.006).expect("a state");
    let explicit = flooded(
        &flow,
        0.0,
        json!([
            {"name": "flood", "duration": onset - 0.002, "dt": {"initial": 0.005, "min": 1e-6}},
            {"name": "break", "duration": 0.008, "scheme": {"explicit": {}}, "dt": {"initial": 1.0}},
        ]),
    );
    println!("breaks at {onset}, mean slip {} and {}", slip(after), slip(explicit.last()));
    close("slip", slip(after) / slip(explicit.last()), 1.0, 0.01);
}

/// The same with dilatancy: what opens within milliseconds takes its water from what is there, p_w = p₀ + Q t/S − d/S at every place and in
/// every state, and slip is less.
#[test]
fn dilatancy_sucks_within_a_rupture() {
    let flow = json!({"storage": 0.5, "transmissivity": 0, "viscosity": 1, "initial": 1e-4, "source": 1.25e-4});
    let steps = || {
        json!([
            {"name": "flood", "duration": 0.5, "dt": {"initial": 0.05, "max": 0.05}},
            {"name": "break", "duration": 0.01, "scheme": {"explicit": {}}, "dt": {"initial": 1.0},
             "supports": [{"on": "slab_top", "ux": {"rate": 1e-2}, "uy": 0}]},
        ])
    };
    let [dilatant, plain] = [0.05, 0.0].map(|dilatancy| flooded(&flow, dilatancy, steps()));
    balances(&dilatant);
    let lifted = dilatant.last().contacts[0].iter().fold(0.0f64, |most, state| most.max(state.friction.opening));
    assert!(lifted > 1e-7, "{lifted}");
    for state in &dilatant.states {
        // In the mean: a point has the water of the nodes beside it.
        let mean = |of: fn(&ContactState) -> f64| {
            let states = &state.contacts[0];
            states.iter().map(|contact| contact.length * of(contact)).sum::<f64>()
        };
        let opening = mean(|contact| contact.friction.opening.max(contact.gap));
        let expected = 1e-4 + (1.25e-4 * state.time - opening) / 0.5;
        close("p_w", mean(|contact| contact.fluid), expected, 1e-7);
    }
    let slip = |run: &Finished| run.last().contacts[0].iter().map(|c| c.friction.plastic_slip.abs()).sum::<f64>();
    println!("slip {} and {}, opening {lifted}", slip(&dilatant), slip(&plain));
    assert!(slip(&dilatant) < slip(&plain));
}

/// A block, driven as a whole or at its top, that slides at a given rate on a fault that slip opens, in a step of this scheme, with this friction.
fn opened_by_slip(scheme: &Value, young: f64, driven: &str, more: &Value) -> Finished {
    let mut case = json!({
        "mesh": Blocks::default().rectangle("block", [20, 1], [0.0, 0.0], [10.0, 0.5]).json(),
        "bodies": {"block": {"material": {"model": "linear", "E": young, "nu": 0.2, "density": 10}}},
        "contacts": {"base": {
            "slave": "block_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "method": "node_to_segment", "sliding": "small",
            "fluid_pressure": {"flow": {
                "storage": 1e-3, "transmissivity": 1e-3, "viscosity": 1, "per_slip": 2e-2, "wells": [{"at": [0, 0], "pressure": 0.03}],
            }},
        }},
        "steps": [{"name": "slide", "duration": 1, "scheme": scheme, "dt": {"initial": 1},
                   "supports": [{"on": driven, "ux": {"rate": 0.5}}, {"on": "block_top", "uy": 0}]}],
        "output": {"interval": 0.1},
    });
    let base = case["contacts"]["base"].as_object_mut().expect("keys");
    base.extend(more.as_object().expect("keys").clone());
    finish(&case)
}

/// T = k₀ + k₁ v t everywhere, and p is that of a constant diffusivity at the time ∫ T/(S η) dt, P (1 − Σ 2 sin(λ x)/(λ L) exp(−λ² ∫ D dt)),
/// λ = (k + ½) π/L: in explicit increments, and in quasi-dynamic steps that are a good part of the time.
#[test]
fn slip_opens_the_fault_as_it_goes() {
    let pressure = |x: f64| {
        let of = |k: i32| {
            let wave = (f64::from(k) + 0.5) * std::f64::consts::PI / 10.0;
            0.2 / wave * (wave * x).sin() * (-wave * wave * (1e-3 + 0.5 * 2e-2 * 0.5) / 1e-3).exp()
        };
        0.03 * (1.0 - (0..400).map(of).sum::<f64>())
    };
    let coulomb = json!({"friction": {"law": "coulomb", "mu": 1e-3}, "initial": {"pressure": 100, "balanced": true}});
    let sliding = json!({
        "friction": {"law": "rate_and_state", "f_0": 10, "V_0": 0.5, "a": 1, "b": 0, "D_c": 1, "theta": 2, "alpha_t": 1e6},
        "radiation_damping": 1e-3,
        "initial": {"pressure": 100, "traction": 1000, "balanced": true},
    });
    let explicit = opened_by_slip(&json!({"explicit": {}}), 1e5, "block", &coulomb);
    let quasi_dynamic = opened_by_slip(&quasi_dynamic(1e-6), 1e3, "block_top", &sliding);
    for run in [explicit, quasi_dynamic] {
        balances(&run);
        let x = run.model.mesh.undeformed();
        let points = run.model.contacts[0].points.iter().zip(&run.last().contacts[0]);
        let off = points.map(|(slave, state)| (state.fluid - pressure(slave.at(&x).x)).abs()).fold(0.0, f64::max);
        println!("off by {off}, {} increments", run.report.increments);
        assert!(off < 1e-4, "{off}");
    }
}

/// Water that can hardly be stored presses back by a spring of 1/S an area, stiffer than all others here: the stable increment of the mass on
/// it falls with √S.
#[test]
fn stiff_water_shortens_explicit_increments() {
    let [longer, shorter] = [1e-7, 1e-9].map(|storage| {
        let run = finish(&json!({
            "mesh": Blocks::default().rectangle("block", [4, 4], [0.0, 0.0], [1.0, 1.0]).json(),
            "bodies": {"block": {"material": {"model": "linear", "E": 100, "nu": 0, "density": 1}}},
            "contacts": {"base": {
                "slave": "block_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "sliding": "small",
                "normal": {"alpha_n": 1000}, "friction": {"law": "frictionless"}, "initial": {"pressure": 1, "balanced": true},
                "fluid_pressure": {"flow": {"storage": storage, "transmissivity": 0, "viscosity": 1}},
            }},
            "steps": [{"name": "rest", "duration": 0.02, "scheme": {"explicit": {}}, "dt": {"initial": 1},
                       "supports": [{"on": "block", "ux": 0}]}],
        }));
        run.last().dt
    });
    println!("{longer:e}, {shorter:e}");
    close("ratio", longer / shorter, 10.0, 0.5);
}
