//! Fluid pressure of a contact by place and time, in every scheme: quasi-dynamic steps, ruptures, and tables that were measured.

use std::fs;

use crate::common::{Blocks, Finished, close, finish, finish_at, refusal};
use crate::slabs::{differences, slabs};
use fecontact::contact::force::ContactState;
use fecontact::model::state::State;
use serde_json::{Value, json};

const YEAR: f64 = 365.0 * 86400.0;

fn quasi_dynamic(tolerance: f64, every: usize) -> Value {
    json!({"quasi_dynamic": {"tolerance": tolerance, "every": every}})
}

/// The spring-slider of `quasi_dynamic.rs` under a weight of which water bears a part: p = 50 − p_w(t), whatever the contact spring.
/// Against LSODA at 1e-10 (`spring_slider.py`): slip and rate at the end, and the times of the events.
#[test]
fn a_spring_slider_under_water_follows_its_differential_equation() {
    let case = json!({
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "point_masses": {"block": {"mass": 1}},
        "contacts": {"base": {
            "slave": "block", "area": 1, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 1e6}, "radiation_damping": 4.62, "sliding": "small",
            "fluid_pressure": format!("12*(1 - exp(-t/{y:e}))*(1 + 0.2*sin(2*t/{y:e}))", y = 2.0 * YEAR),
            "friction": {"law": "rate_and_state", "f_0": 0.6, "V_0": 1e-6, "a": 0.01, "b": 0.015, "D_c": 0.008,
                         "theta": 0.5 * 0.008 / 1e-9, "alpha_t": 1e6},
            "initial": {"pressure": 50, "traction": 30},
        }},
        "steps": [{"name": "load", "duration": 40.0 * YEAR, "scheme": quasi_dynamic(1e-7, 1),
            "dt": {"initial": 1e4, "max": 0.02 * YEAR}, "loads": [
            {"on": "block", "force": {"y": "-50", "x": "30"}},
            {"on": "block", "spring": {"kx": 10, "driver": {"x": {"rate": 1e-9}}}},
        ]}],
    });
    let run = finish(&case);
    let mut onsets = Vec::new();
    for [before, now] in run.states.array_windows::<2>() {
        let rate = |state: &State| state.contacts[0][0].radiation / 4.62;
        if rate(before) <= 1e-3 && rate(now) > 1e-3 {
            onsets.push(now.time / YEAR);
        }
    }
    println!("{} steps, events at {onsets:?}", run.report.increments);
    let expected = [0.684973, 5.980796, 15.279825, 32.084859];
    assert_eq!(onsets.len(), expected.len());
    onsets.iter().zip(expected).for_each(|(onset, expected)| close("event", *onset, expected, 2e-4));
    let last = &run.last().contacts[0][0];
    close("slip", last.friction.plastic_slip, 2.036446136, 1e-5);
    close("rate", last.radiation / 4.62 / 7.756610239e-13, 1.0, 1e-3);
    for state in &run.states {
        let contact = &state.contacts[0][0];
        close("p + p_w", contact.friction.pressure + contact.fluid, 50.0, 1e-9);
    }
    let energy = &run.last().energy;
    close("energy", energy.error(), 0.0, 2e-3 * energy.friction_dissipation);
}

/// The slabs with a pressure of water in their fault.
fn wet_slabs(scheme: &Value, duration: f64, fluid: &Value) -> Value {
    slabs(scheme, duration, &json!({"fluid_pressure": fluid}))
}

/// Slip, traction, pressure and gap of every point of the fault.
fn fault(run: &Finished) -> Vec<[f64; 4]> {
    let of = |state: &ContactState| {
        let friction = &state.friction;
        [friction.plastic_slip, friction.traction + state.radiation, friction.pressure, state.gap]
    };
    run.last().contacts[0].iter().map(of).collect()
}

/// Largest difference of two faults in each of the four, over the largest value.
fn apart(a: &Finished, b: &Finished) -> [f64; 4] {
    differences(&fault(a), &fault(b))
}

/// Water that spreads along a fault between unequal bodies: static increments come nearer and nearer to the stages of quasi-dynamic
/// steps as they are shorter, and the audit knows of its work. After it the same static step goes on without a jump.
#[test]
fn water_at_the_stages_is_that_of_static_increments() {
    let fluid = json!("1.2*(1 - exp(-t/5))*exp(-(x - 2)^2/(0.5 + 0.2*t))");
    let exact = finish(&wet_slabs(&quasi_dynamic(1e-8, 20), 10.0, &fluid));
    let slips = fault(&exact).iter().fold(0.0f64, |most, point| most.max(point[0].abs()));
    let errors = [0.05, 0.0125].map(|dt| {
        let mut case = wet_slabs(&json!("static"), 10.0, &fluid);
        case["steps"][0]["dt"] = json!({"initial": dt, "min": 1e-6, "max": dt});
        let run = finish(&case);
        println!("{dt}: {:?}", apart(&exact, &run));
        apart(&exact, &run)
    });
    assert!(slips > 1e-3, "{slips}");
    for (coarse, fine) in errors[0].iter().zip(errors[1]) {
        assert!(fine < 2e-4 && (fine < 0.6 * coarse || fine < 1e-6), "{errors:?}");
    }
    for state in &exact.states {
        close("energy", state.energy.error(), 0.0, 1e-3 * exact.last().energy.external_work);
    }
    let mut case = wet_slabs(&quasi_dynamic(1e-8, 20), 10.0, &fluid);
    let rest = json!({"name": "rest", "duration": 1e-6, "scheme": "static", "dt": {"initial": 1e-6}});
    case["steps"] = json!([case["steps"][0], rest]);
    let run = finish(&case);
    let [before, after] = [run.at(10.0), run.last()];
    for (before, after) in before.contacts[0].iter().zip(&after.contacts[0]) {
        close("p", after.friction.pressure, before.friction.pressure, 1e-6);
        close("p_w", after.fluid, before.fluid, 1e-6);
        close("q", after.friction.traction + after.radiation, before.friction.traction + before.radiation, 1e-5);
    }
}

/// A table of times and places is linear between them: its file and the expression of the same come to the same in both schemes. Steps
/// end at its corners, between which the rates are smooth.
#[test]
fn a_measured_pressure_is_linear_between_times_and_places() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = "# pressure of the fault\nt, 0, 3, 6\n0, 0, 0, 0\n4, 0, 0.8, 0\n12, 0.2, 0.8, 0\n";
    fs::write(folder.path().join("water.csv"), table).expect("a file");
    let path = folder.path().join("case.json");
    let measured = json!({"measured": {"file": "water.csv", "along": "x"}});
    let [left, right] = ["max(0, 1 - x/3)", "max(0, 1 - abs(x - 3)/3)"];
    let written = json!(format!("0.8*min(t/4, 1)*{right} + 0.2*min(max((t - 4)/8, 0), 1)*{left}"));
    let mut told = wet_slabs(&json!("static"), 16.0, &measured);
    told["steps"][0]["dt"] = json!({"initial": 0.2, "max": 0.2});
    let mut plain = told.clone();
    plain["contacts"]["fault"]["fluid_pressure"] = written.clone();
    let gap = apart(&finish(&plain), &finish_at(&told, &path));
    assert!(gap.iter().all(|gap| *gap < 1e-9), "static: {gap:?}");
    let fast = |fluid: &Value| finish_at(&wet_slabs(&quasi_dynamic(1e-8, 1), 16.0, fluid), &path);
    let [one, other] = [fast(&written), fast(&measured)];
    let gap = apart(&one, &other);
    assert!(gap.iter().all(|gap| *gap < 1e-6), "quasi-dynamic: {gap:?}");
    assert!([4.0, 12.0].iter().all(|corner| other.states.iter().any(|state| state.time == *corner)));
    let says = |text: &str, why: &str| {
        fs::write(folder.path().join("water.csv"), text).expect("a file");
        let told = crate::common::built(&told, &path).expect_err("it is refused").to_string();
        assert!(
            told.contains("contacts.fault.fluid_pressure.measured.file: `water.csv`: ") && told.contains(why),
            "{told}"
        );
    };
    says("t, 0, 6\n0, 1\n", "line 2 has 2 numbers: a time and 2 pressures were expected");
    says("t, 0, 6\n0, 1, a\n", "line 2, column 3: `a` is not a number");
    says("t, 0, 6\n1, 0, 0\n1, 0, 0\n", "the times must increase: 1 follows 1");
    says("t, 6, 0\n1, 0, 0\n", "the places must increase: 0 follows 6");
    says("\n", "is empty");
    fs::write(folder.path().join("water.csv"), "t, 0\n0, 0\n1, -1").expect("a file");
    let why = crate::common::built(&told, &path).expect_err("it is refused").to_string();
    assert!(why.contains("zero or positive"), "{why}");
    fs::remove_file(folder.path().join("water.csv")).expect("a file");
    let why = crate::common::built(&told, &path).expect_err("there is none").to_string();
    assert!(why.contains("`water.csv` cannot be read"), "{why}");
}

/// Where water bears all of the pressure a quasi-dynamic step ends with what to do.
#[test]
fn water_that_bears_all_is_told_of() {
    let case = wet_slabs(&quasi_dynamic(1e-5, 20), 20.0, &json!("0.2*t"));
    let mut run = fecontact::run::Simulation::new(crate::common::model(&case));
    let told = loop {
        match run.next_increment() {
            Ok(Some(_)) => {}
            Ok(None) => panic!("it opens"),
            Err(error) => break error.to_string(),
        }
    };
    assert!(told.contains("the pressure has dropped to") && told.contains("or lower fluid_pressure"), "{told}");
    let mut case = wet_slabs(&quasi_dynamic(1e-5, 20), 20.0, &json!("of_bodies"));
    case["bodies"]["upper"]["pore_fluid"] = json!({"bulk_modulus": 1e3, "porosity": 0.3});
    assert!(refusal(&case).contains("quasi_dynamic"), "{}", refusal(&case));
}

/// A slab on a plane whose water rises until the interface breaks within milliseconds, and falls afterwards: `scheme` follows it.
fn flooded(steps: Value) -> Finished {
    let mut steps = steps;
    steps[0]["supports"] = json!([{"on": "slab_top", "ux": 0, "uy": 0}]);
    finish(&json!({
        "mesh": Blocks::default().rectangle("slab", [40, 8], [0.0, 0.0], [1.0, 0.2]).json(),
        "bodies": {"slab": {
            "material": {"model": "linear", "E": 2.5, "nu": 0.25, "density": 1e-6}, "damping": {"stiffness": 2e-6},
        }},
        "contacts": {"base": {
            "slave": "slab_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 800.0}, "fluid_pressure": WATER,
            "friction": {"law": "slip_weakening", "mu_s": 0.6, "mu_d": 0.4, "D_c": 8e-6, "alpha_t": 800.0},
            "along": {"mu_s": {"x": [[0.2, 0.57], [0.3, 0.6]]}},
            "initial": {"pressure": 1e-3, "traction": 5e-4, "balanced": true},
        }},
        "steps": steps,
        "output": {"interval": 2e-5},
    }))
}

const WATER: &str = "2.5e-4*min(t, max(0, 2 - t))*(1 + 0.1*x)";

/// Into a rupture and out of it the water goes on with time: it breaks as explicit increments alone have it, the pressures are those of
/// the place and time in each state, and the audit closes.
#[test]
fn water_goes_on_in_a_rupture_and_after_it() {
    let run = flooded(json!([{
        "name": "flood", "duration": 1.8, "dt": {"initial": 0.005, "min": 1e-4, "max": 0.05}, "rupture": {"slip_rate": 1e-3},
    }]));
    println!("{} increments, {} ruptures", run.report.increments, run.report.ruptures);
    assert!((1..=3).contains(&run.report.ruptures), "{}", run.report.ruptures);
    let x = run.model.mesh.undeformed();
    for state in &run.states {
        for (slave, contact) in run.model.contacts[0].points.iter().zip(&state.contacts[0]) {
            let (t, x) = (state.time, slave.at(&x).x);
            close("p_w", contact.fluid, 2.5e-4 * t.min(2.0 - t) * (1.0 + 0.1 * x), 1e-15);
        }
        close("energy", state.energy.error(), 0.0, 0.01 * run.last().energy.friction_dissipation);
    }
    let slip = |state: &State| state.contacts[0].iter().map(|c| c.friction.plastic_slip.abs()).sum::<f64>() / 41.0;
    let onset = run.states.iter().find(|state| slip(state) > 4e-6).expect("it breaks").time;
    let until = |time: f64| run.states.iter().rfind(|state| state.time <= time).expect("a state");
    let after = until(onset + 0.006);
    let explicit = flooded(json!([
        {"name": "flood", "duration": onset - 0.002, "dt": {"initial": 0.005, "min": 1e-6}},
        {"name": "break", "duration": 0.008, "scheme": {"explicit": {}}, "dt": {"initial": 1.0}},
    ]));
    println!("breaks at {onset}, mean slip {} and {}", slip(after), slip(explicit.last()));
    close("slip", slip(after) / slip(explicit.last()), 1.0, 0.01);
    // The water that falls leaves the interface as it is, under the whole weight.
    close("no slip afterwards", slip(run.last()) / slip(until(onset + 0.05)), 1.0, 0.02);
    let weight: f64 = run.last().contacts[0].iter().map(|c| c.length * (c.friction.pressure + c.fluid)).sum();
    let before: f64 = run.states[0].contacts[0].iter().map(|c| c.length * (c.friction.pressure + c.fluid)).sum();
    close("weight", weight / before, 1.0, 0.02);
}

/// A fault between periodic sides, under conditions that vary along it with its period and are shifted by a part of it.
fn periodic(scheme: &Value, shift: f64) -> Value {
    let mut case = wet_slabs(scheme, 20.0, &json!(format!("0.6*(1 - exp(-t/5))*(1 + cos(2*pi*(x - {shift})/6))")));
    case["periodic"] = json!([["lower_left", "lower_right"], ["upper_left", "upper_right"]]);
    let fault = &mut case["contacts"]["fault"];
    fault["along"] = json!({"a": format!("0.014 + 0.003*sin(2*pi*(x - {shift})/6)")});
    fault["initial"] =
        json!({"pressure": format!("2 + 0.2*cos(4*pi*(x - {shift})/6)"), "traction": 1.1, "balanced": true});
    case
}

/// The ends that periodic sides join are one node: what is shifted by a part of the period slips alike at places that are shifted, the ends
/// alike with each other, as in static increments; the audit closes.
#[test]
fn a_periodic_fault_has_no_ends() {
    let [one, other] = [0.0, 2.5].map(|shift| finish(&periodic(&quasi_dynamic(1e-8, 10), shift)));
    let points = &one.model.contacts[0].points;
    let x = one.model.mesh.undeformed();
    let at = |run: &Finished, place: f64| {
        let k = points.iter().position(|slave| (slave.at(&x).x - place).abs() < 1e-9).expect("a node");
        fault(run)[k]
    };
    let largest = fault(&one).iter().fold([0.0f64; 4], |most, point| [0, 1, 2, 3].map(|i| most[i].max(point[i].abs())));
    for k in 0..12 {
        let place = 0.5 * f64::from(k);
        let [here, there] = [at(&one, place), at(&other, (place + 2.5) % 6.0)];
        (0..4).for_each(|i| close("shifted", there[i], here[i], 1e-7 * largest[i]));
    }
    for run in [&one, &other] {
        let [first, last] = [at(run, 0.0), at(run, 6.0)];
        (0..4).for_each(|i| close("ends", first[i], last[i], 1e-12 * largest[i]));
        close("energy", run.last().energy.error(), 0.0, 1e-3 * run.last().energy.friction_dissipation);
    }
    let mut case = periodic(&json!("static"), 2.5);
    case["steps"][0]["dt"] = json!({"initial": 0.02, "max": 0.02, "min": 1e-6});
    let gap = apart(&other, &finish(&case));
    assert!(gap.iter().all(|gap| *gap < 1e-3), "{gap:?}");
    let refused = |key: &str, value: Value| {
        let mut case = periodic(&quasi_dynamic(1e-6, 10), 0.0);
        case["contacts"]["fault"][key] = value;
        refusal(&case)
    };
    for (key, value) in [
        ("fluid_pressure", json!("0.1*x*t")),
        ("along", json!({"a": "0.014 + 0.001*x"})),
        ("initial", json!({"pressure": "2 + 0.1*x", "traction": 1.1, "balanced": true})),
    ] {
        let why = refused(key, value);
        assert!(
            why.contains("contacts.fault: periodic sides make one node of (") && why.contains("periodic too"),
            "{why}"
        );
    }
    let why = refused("method", json!("mortar"));
    assert!(why.contains("contacts.fault.method: averages by mortar reach across periodic sides"), "{why}");
}
