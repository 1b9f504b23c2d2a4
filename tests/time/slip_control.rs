//! Error control of slip by default, where friction is integrated to first order in time: a spring-slider of rate-and-state
//! friction below its critical stiffness, against its differential equations (`slip_control.py`).

use std::path::Path;
use std::sync::Arc;

use crate::common::{self, Blocks, Finished, close, finish, model, refusal};
use fecontact::case::{Halvings, Written, refined, resolved};
use fecontact::model::state::State;
use fecontact::output::warnings::Warnings;
use serde_json::{Value, json};

const D_C: f64 = 1e-5;
/// Longer than an event [s].
const EVENT: f64 = 0.05;

/// The slider of `slip_control.py`: a point on a plane in MPa, m and s, drawn by a spring of half the critical stiffness.
fn slider(scheme: &Value, dt: &Value) -> Value {
    let mut case = json!({
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "point_masses": {"block": {"mass": 5.4e-6}},
        "contacts": {"base": {
            "slave": "block", "area": 1, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 1e6}, "sliding": "small",
            "friction": {"law": "rate_and_state", "f_0": 0.6, "V_0": 1e-6, "a": 0.01, "b": 0.015, "D_c": D_C,
                         "theta": 10, "alpha_t": 3e5},
            "initial": {"pressure": 50, "traction": 30},
        }},
        "steps": [{"name": "draw", "duration": 1.5e6, "scheme": scheme, "dt": dt, "loads": [
            {"on": "block", "force": {"y": "-50", "x": "30"}},
            {"on": "block", "spring": {"kx": 12500, "driver": {"x": {"rate": 1e-9}}}},
        ]}],
    });
    if scheme == "static" {
        case["contacts"]["base"]["radiation_damping"] = json!(4.41);
    }
    case
}

/// Times at which the point comes to slip faster than 1e-3 on average over an increment.
fn events(run: &Finished) -> Vec<f64> {
    let passes = |pair: &[State]| (rate(&pair[0]) <= 1e-3 && rate(&pair[1]) > 1e-3).then_some(pair[1].time);
    run.states.windows(2).filter_map(passes).collect()
}

/// Mean slip rate of the point in the increment.
fn rate(state: &State) -> f64 {
    state.contacts[0][0].friction.plastic_increment / state.dt
}

/// Its fastest rate up to a time.
fn fastest(run: &Finished, until: f64) -> f64 {
    run.states.iter().filter(|state| state.time <= until).map(rate).fold(0.0, f64::max)
}

fn warnings(case: &Value) -> Vec<String> {
    let mut warnings = Warnings::default();
    fecontact::run::run(&Arc::new(model(case)), &mut [&mut warnings]).1.unwrap_or_else(|error| panic!("{error}"));
    for message in &warnings.list {
        assert!(common::warnings::is_listed(message), "docs/reference/warnings.md has no entry for: {message}");
    }
    warnings.list
}

/// Static increments a thousandth of the time between two events: without control there is no event, and this is told; by
/// default there are three, as those of the differential equations, without a warning.
#[test]
fn static_stick_slip_is_followed_by_default() {
    let statics = json!("static");
    let case = slider(&statics, &json!({"initial": 1000}));
    let run = finish(&case);
    let (times, fastest) = (events(&run), fastest(&run, f64::INFINITY));
    let slip = run.last().contacts[0][0].friction.plastic_slip;
    println!("{} increments, events at {times:?} s, fastest {fastest}, slip {slip}", run.report.increments);
    assert_eq!(times.len(), 3);
    for (time, exact) in times.iter().zip([316_444.218, 899_943.415, 1_483_442.611]) {
        close("event", time / exact, 1.0, 3e-3);
    }
    close("fastest", fastest / 1.035_814, 1.0, 0.01);
    close("slip", slip / 1.739_337e-3, 1.0, 3e-3);
    assert!(run.report.increments < 13_000, "{}", run.report.increments);
    assert_eq!(warnings(&case), Vec::<String>::new());
    let off = slider(&statics, &json!({"initial": 1000, "error": null}));
    let none = events(&finish(&off));
    assert!(none.is_empty(), "{none:?}: they are damped away");
    let message = warnings(&off);
    assert!(message.iter().any(|message| message.contains("leave \"error\": null out of dt")), "{message:?}");
    let loose = slider(&statics, &json!({"initial": 1000, "error": 0.3 * D_C}));
    let message = warnings(&loose);
    assert!(message.iter().any(|message| message.contains("lower dt.error, to 1e-9 say")), "{message:?}");
}

/// With inertia the first event and its overshoot follow the differential equations as well; vibrations after it, which the
/// increments do not resolve, do not shorten them.
#[test]
fn implicit_stick_slip_is_followed_by_default() {
    for scheme in [json!({"generalized_alpha": {"rho_infinity": 0.8}}), json!({"hht": {"alpha": -0.1}})] {
        let run = finish(&slider(&scheme, &json!({"initial": 1000})));
        let times = events(&run);
        let fastest = fastest(&run, times[0] + EVENT);
        let after = run.states.iter().find(|state| state.time > times[0] + EVENT).expect("a state");
        let slip = after.contacts[0][0].friction.plastic_slip;
        println!("{scheme}: {} increments, {times:?}, {fastest}, {slip}", run.report.increments);
        close("event", times[0] / 316_444.218, 1.0, 3e-3);
        close("fastest", fastest / 18.5182, 1.0, 0.01);
        close("slip", slip / 1.046_924e-3, 1.0, 2e-3);
        assert!(run.report.increments < 13_000, "{}", run.report.increments);
        let off = slider(&scheme, &json!({"initial": 1000, "error": null}));
        let message = warnings(&off);
        assert!(message.iter().any(|message| message.contains("damp stick-slip away")), "{message:?}");
    }
}

/// Slip that the loads of a new step end at once: the first increment of the step is compared with the last one before it. (Taken for rest,
/// that one let a single increment pass over all that follows, a hundredth of D_c.) No increment has more than the predicted error, and the slip
/// is that of increments of a fixed length 5000 times shorter.
#[test]
fn slip_that_a_new_step_ends_is_followed() {
    let run = |dt: Value| {
        let mut case = slider(&json!("static"), &dt);
        case["contacts"]["base"]["friction"]["a"] = json!(0.015);
        case["contacts"]["base"]["friction"]["b"] = json!(0.01);
        let draw = |rate: f64| json!({"on": "block", "spring": {"kx": 125_000, "driver": {"x": {"rate": rate}}}});
        case["steps"][0]["duration"] = json!(60);
        case["steps"][0]["loads"][1] = draw(1e-6);
        let back = json!({"name": "back", "duration": 10, "dt": dt, "loads": [draw(-1e-4)]});
        case["steps"].as_array_mut().expect("steps").push(back);
        finish(&case)
    };
    let slip_back = |run: &Finished| {
        let at_end = run.states.iter().rfind(|state| state.time <= 60.0).expect("a state");
        run.last().contacts[0][0].friction.plastic_slip - at_end.contacts[0][0].friction.plastic_slip
    };
    let (own, fine) = (run(json!({"initial": 5})), run(json!({"initial": 1e-3, "error": null})));
    let [found, exact] = [&own, &fine].map(slip_back);
    println!("{} increments: slip {found:.4e}, {exact:.4e} in {}", own.report.increments, fine.report.increments);
    for pair in own.states.windows(2) {
        let error = 0.5 * pair[1].dt * (rate(&pair[1]) - rate(&pair[0])).abs();
        assert!(pair[0].increment == 0 || error <= 1.01e-4 * D_C, "{error} at t = {}", pair[1].time);
    }
    close("slip", found, exact, 1e-3 * D_C);
}

/// The control looks at the slip of friction with a D_c only, against its own D_c: another contact, which slides fast and
/// unsteadily under another law, changes no increment.
#[test]
fn other_friction_beside_it_is_not_controlled() {
    let mut case = slider(&json!("static"), &json!({"initial": 1000}));
    case["steps"][0]["duration"] = json!(3.5e5);
    let alone = finish(&case);
    case["mesh"] = json!({"nodes": [[0, 0], [5, 0]], "points": {"block": [0], "other": [1]}});
    case["point_masses"]["other"] = json!({"mass": 1});
    case["contacts"]["slide"] = json!({
        "slave": "other", "area": 1, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "sliding": "small",
        "normal": {"alpha_n": 1e6}, "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 1e6}, "initial": {"pressure": 50},
    });
    case["steps"][0]["supports"] = json!([{"on": "other", "ux": "1e-3*sin(t/3000)"}]);
    let loads = case["steps"][0]["loads"].as_array_mut().expect("loads");
    loads.push(json!({"on": "other", "force": {"y": "-50"}}));
    let both = finish(&case);
    println!("{} increments alone, {} with the other", alone.report.increments, both.report.increments);
    assert!(both.report.increments <= alone.report.increments + alone.report.increments / 50);
    assert_eq!(events(&both).len(), 1);
}

/// `null` switches it off; a convergence study refines what is chosen as what is given; a resolved case has the same control.
#[test]
fn what_is_chosen_is_refined_and_kept() {
    let (statics, newmark) = (json!("static"), json!({"newmark": {}}));
    let chosen = |scheme: &Value, dt: Value| {
        let case = slider(scheme, &dt);
        let increments = model(&case).steps[0].increments;
        let kept: Value =
            serde_json::from_str(&resolved(&serde_json::from_value(case.clone()).expect("a case"), &model(&case)))
                .expect("a case");
        assert_eq!(model(&kept).steps[0].increments, increments, "{kept}");
        (increments.error, increments.slip)
    };
    assert_eq!(chosen(&statics, json!({"initial": 1000})), (None, Some(1e-4)));
    assert_eq!(chosen(&statics, json!({"initial": 1000, "error": 1e-8})), (Some(1e-8), None));
    assert_eq!(chosen(&statics, json!({"initial": 1000, "error": null})), (None, None));
    assert_eq!(chosen(&newmark, json!({"initial": 1000})), (None, Some(1e-4)));
    assert_eq!(chosen(&newmark, json!({"initial": 1000, "error": 1e-8})), (Some(1e-8), Some(1e-4)));
    assert_eq!(chosen(&newmark, json!({"initial": 1000, "error": null})), (None, None));
    assert_eq!(chosen(&json!({"wilson": {}}), json!({"initial": 1000})), (None, Some(1e-4)));
    let message = refusal(&slider(&json!({"wilson": {}}), &json!({"initial": 1000, "error": 1e-8})));
    assert!(message.contains("wilson has no error estimate"), "{message}");
    let mut case = slider(&statics, &json!({"initial": 1000}));
    case["mesh"] = Blocks::default().rectangle("block", [1, 1], [0.0, 0.0], [1.0, 0.002]).json();
    case["bodies"] = json!({"block": {"material": {"model": "linear", "E": 1e7, "nu": 0.25}}});
    case["contacts"]["base"]["slave"] = json!("block_bottom");
    let contact = case["contacts"]["base"].as_object_mut().expect("a contact");
    contact.remove("area");
    let whole = case.as_object_mut().expect("a case");
    whole.remove("point_masses");
    case["steps"][0]["loads"] = json!([{"on": "block_top", "traction": ["30", "-50"]}]);
    let written = Written {
        path: Path::new("test.json").into(),
        case: serde_json::from_value(case.clone()).expect("a case"),
        document: case,
    };
    let finer = refined(&written, Halvings { mesh: 0, increments: 2 }).expect("a case");
    let model = fecontact::case::build(&finer.case, Path::new("test.json")).expect("a model");
    assert_eq!(model.steps[0].increments.slip, Some(1e-4 / 16.0));
}
