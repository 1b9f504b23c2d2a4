//! Quasi-dynamic steps: an interface that is integrated by itself, against differential equations and static increments.

use std::path::Path;

use crate::common::{Finished, close, finish, finish_at, model, refusal};
use crate::slabs::{differences, slabs};
use fecontact::laws::friction::FrictionState;
use fecontact::run::Simulation;
use serde_json::{Value, json};

const YEAR: f64 = 365.0 * 86400.0;

/// The spring-slider of `spring_slider.py`: a point on a plane, in MPa and m, with a contact spring of 10⁶ beside the one of 10.
fn slider(evolution: &str, years: f64, scheme: &Value) -> Value {
    json!({
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "point_masses": {"block": {"mass": 1}},
        "contacts": {"base": {
            "slave": "block", "area": 1, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 1e6}, "radiation_damping": 4.62, "sliding": "small",
            "friction": {"law": "rate_and_state", "f_0": 0.6, "V_0": 1e-6, "a": 0.01, "b": 0.015, "D_c": 0.008,
                         "evolution": evolution, "theta": 0.5 * 0.008 / 1e-9, "alpha_t": 1e6},
            "initial": {"pressure": 50, "traction": 30},
        }},
        "steps": [{"name": "load", "duration": years * YEAR, "scheme": scheme, "dt": {"initial": 1e4}, "loads": [
            {"on": "block", "force": {"y": "-50", "x": "30"}},
            {"on": "block", "spring": {"kx": 10, "driver": {"x": {"rate": 1e-9}}}},
        ]}],
    })
}

fn quasi_dynamic(tolerance: f64, every: usize) -> Value {
    json!({"quasi_dynamic": {"tolerance": tolerance, "every": every}})
}

/// Times at which the first point comes to slip faster than a rate, its slip then and its fastest rate in the event.
fn events(run: &Finished, rate: f64) -> Vec<[f64; 3]> {
    let mut events: Vec<[f64; 3]> = Vec::new();
    let mut before = 0.0;
    for state in &run.states {
        let friction = &state.contacts[0][0].friction;
        let now = state.contacts[0][0].radiation / 4.62;
        if now > rate && before <= rate {
            events.push([state.time / YEAR, friction.plastic_slip, now]);
        }
        if let Some(last) = events.last_mut().filter(|_| now > rate) {
            last[2] = last[2].max(now);
        }
        before = now;
    }
    events
}

/// Ten decades of slip rate in one run, against LSODA at 1e-10 (`spring_slider.py`): slip and rate at the end, the times of the
/// events, their slip and their fastest rate. The errors fall with the tolerance.
#[test]
fn a_spring_slider_follows_its_differential_equation() {
    for (evolution, end, times, fastest) in [
        ("ageing", [3.415499422, 2.028843598e-14], [10.971917, 32.969380, 54.966843, 76.964306, 98.961769], 1.115_18),
        ("slip", [3.072944438, 3.364094051e-11], [9.108962, 28.576221, 48.043480, 67.510739, 86.977999], 1.151_29),
    ] {
        let mut errors = Vec::new();
        for tolerance in [1e-4, 1e-6, 1e-8] {
            let run = finish(&slider(evolution, 100.0, &quasi_dynamic(tolerance, 1)));
            let events = events(&run, 1e-3);
            let last = run.last();
            println!("{evolution}, {tolerance:e}: {} steps, {events:?}", run.report.increments);
            assert_eq!(events.len(), times.len());
            let error = |k: usize| (events[k][0] - times[k]).abs();
            errors.push((0..times.len()).map(error).fold(0.0, f64::max));
            if tolerance == 1e-8 {
                close("fastest", events[4][2], fastest, 5e-4);
                close("slip at the end", last.contacts[0][0].friction.plastic_slip, end[0], 1e-5);
                close("rate at the end", last.contacts[0][0].radiation / 4.62 / end[1], 1.0, 1e-3);
            }
            // The way of the spring follows: k (V t − u) = τ − τ₀.
            let contact = &last.contacts[0][0];
            let pulled = 10.0 * (1e-9 * last.time - last.displacement[0]);
            close("spring", pulled, contact.friction.traction + contact.radiation - 30.0, 1e-9);
            let energy = &last.energy;
            close("energy", energy.error(), 0.0, 1e-3 * energy.friction_dissipation);
            assert!(energy.radiated > 1e-3 * energy.friction_dissipation, "{energy:?}");
        }
        assert!(
            errors[2] < 2e-4 && errors[2] < 0.2 * errors[1] && errors[1] < 0.2 * errors[0],
            "{evolution}: {errors:?}"
        );
    }
}

/// A second state of the law, which strengthens over ten times the slip, against LSODA at 1e-10 (`spring_slider.py`). Without effect
/// it changes no bit of the run.
#[test]
fn two_states_follow_their_differential_equations() {
    let with_second = |evolution: &str, b_2: f64, tolerance: f64| {
        let mut case = slider(evolution, 60.0, &quasi_dynamic(tolerance, 1));
        let friction = case["contacts"]["base"]["friction"].as_object_mut().expect("an object");
        let second = json!({"b_2": b_2, "D_c2": 0.08, "theta_2": 0.5 * 0.08 / 1e-9});
        friction.extend(second.as_object().expect("an object").clone());
        case
    };
    for (evolution, [slip, x, x_2], times) in [
        ("ageing", [2.119412429, 9.554447914, 7.257691579], [4.329076, 21.662281, 39.040317, 56.418819]),
        ("slip", [1.618509630, 8.590653414, -5.455897535], [4.356442, 19.641543, 33.907449, 48.159156]),
    ] {
        let run = finish(&with_second(evolution, -0.004, 1e-8));
        let events = events(&run, 1e-3);
        println!("{evolution}: {} steps, {events:?}", run.report.increments);
        assert_eq!(events.len(), times.len());
        (0..times.len()).for_each(|k| close("onset", events[k][0], times[k], 2e-4));
        let friction = &run.last().contacts[0][0].friction;
        close("slip", friction.plastic_slip, slip, 1e-5);
        close("ln θ", (1e-6 * friction.variables[0] / 0.008).ln(), x, 1e-3);
        close("ln θ₂", (1e-6 * friction.variables[1] / 0.08).ln(), x_2, 1e-3);
        let one = finish(&slider(evolution, 60.0, &quasi_dynamic(1e-6, 1)));
        let idle = finish(&with_second(evolution, 0.0, 1e-6));
        let ends = [one, idle].map(|run| {
            let contact = &run.last().contacts[0][0];
            let FrictionState { plastic_slip, traction, .. } = contact.friction;
            (run.report.increments, plastic_slip, traction, contact.friction.variables[0])
        });
        assert_eq!(ends[0], ends[1]);
    }
}

/// Static increments with radiation damping come to the same: backward Euler's, of the first order.
#[test]
fn static_increments_come_to_the_same() {
    let mut case = slider("ageing", 12.0, &json!("static"));
    case["newton"] = json!({"tolerance": 1e-11});
    let duration = 12.0 * YEAR;
    let off = [2e-5, 5e-6].map(|error| {
        case["steps"][0]["dt"] = json!({"initial": 1e3, "min": 1e-5, "max": 0.02 * duration, "error": error});
        let run = finish(&case);
        let events = events(&run, 1e-3);
        println!(
            "{error:e}: {} increments, {events:?}, slip {}",
            run.report.increments,
            run.last().contacts[0][0].friction.plastic_slip
        );
        assert_eq!(events.len(), 1);
        // 10.971917 yr and 0.998812 m/s, as above; LSODA
        close("fastest", events[0][2], 0.998_812, 0.02);
        events[0][0] - 10.971_917
    });
    // An increment is as long as the root of its error: of the first order, half of the error is left.
    close("order", off[0] / off[1], 2.0, 0.25);
    close("extrapolated", 2.0 * off[1] - off[0], 0.0, 0.01);
}

/// The slabs, moved faster and apart; the fault weakens but for its ends, which creep.
fn weak_slabs(scheme: &Value, duration: f64) -> Value {
    let creeps = json!({"law": "prescribed", "slip_rate": 1e-3, "alpha_t": 4000});
    let along = json!({"a": "0.01 + 0.002*(x - 3)^2", "law": [{"where": "abs(x - 3) - 2.6", "friction": creeps}]});
    let mut case = slabs(scheme, duration, &json!({"along": along}));
    let friction = &mut case["contacts"]["fault"]["friction"];
    (friction["a"], friction["b"]) = (json!(0.01), json!(0.016));
    let top = &mut case["steps"][0]["supports"][1];
    (top["ux"], top["uy"]) = (json!({"rate": 1e-3}), json!({"rate": -1e-5}));
    case
}

/// Slip, traction and pressure of every point of the fault.
fn fault(run: &Finished) -> Vec<[f64; 3]> {
    let of = |state: &fecontact::contact::force::ContactState| {
        [state.friction.plastic_slip, state.friction.traction + state.radiation, state.friction.pressure]
    };
    run.last().contacts[0].iter().map(of).collect()
}

/// A whole interface: static increments come nearer and nearer to it as they are shorter, in slip, traction and pressure, and the
/// bodies' displacements are those of equilibrium.
#[test]
fn an_interface_between_bodies() {
    let exact = finish(&weak_slabs(&quasi_dynamic(1e-8, 20), 30.0));
    let errors = [0.2, 0.1].map(|dt| {
        let mut case = weak_slabs(&json!("static"), 30.0);
        case["steps"][0]["dt"] = json!({"initial": dt, "min": 1e-6, "max": dt});
        let run = finish(&case);
        let (one, other) = (&run.last().displacement, &exact.last().displacement);
        let far = one.iter().zip(other).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
        let largest = other.iter().fold(0.0f64, |most, u| most.max(u.abs()));
        println!("{dt}: {:?}, displacement {}", differences(&fault(&exact), &fault(&run)), far / largest);
        let [slip, traction, pressure] = differences(&fault(&exact), &fault(&run));
        [slip, traction, pressure, far / largest]
    });
    for (coarse, fine) in errors[0].iter().zip(errors[1]) {
        assert!(fine < 2e-3 && fine < 0.7 * coarse, "{errors:?}");
    }
    let energy = &exact.last().energy;
    close("energy", energy.error(), 0.0, 1e-3 * energy.external_work);
}

/// A static step goes on from where a quasi-dynamic one has ended, and the other way round, with no jump: in a static increment of
/// hardly any length nothing moves, and all is in equilibrium.
#[test]
fn steps_of_other_schemes_follow_and_precede() {
    let mut case = weak_slabs(&json!("static"), 5.0);
    case["steps"][0]["dt"] = json!({"initial": 0.1, "min": 1e-6, "max": 0.1});
    let go_on = json!({"name": "go on", "duration": 10, "scheme": quasi_dynamic(1e-6, 10), "dt": {"initial": 1e-3}});
    let rest = json!({"name": "rest", "duration": 1e-5, "scheme": "static", "dt": {"initial": 1e-5}});
    case["steps"] = json!([case["steps"][0], go_on, rest]);
    let run = finish(&case);
    let before = run.at(15.0);
    let last = run.last();
    let moved = before.displacement.iter().zip(&last.displacement).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(moved < 1e-7, "{moved:e}");
    for (before, after) in before.contacts[0].iter().zip(&last.contacts[0]) {
        close("q", after.friction.traction + after.radiation, before.friction.traction + before.radiation, 1e-4);
        close("p", after.friction.pressure, before.friction.pressure, 1e-6);
    }
    // All in one go is the same but for the error of static increments in the first step.
    let whole = finish(&weak_slabs(&quasi_dynamic(1e-6, 10), 15.0));
    let slip = |state: &fecontact::model::state::State| state.contacts[0][6].friction.plastic_slip;
    close("slip", slip(before) / slip(whole.last()), 1.0, 0.01);
}

/// After a dynamic step what was left out of balance moves the bodies at once, and the audit knows of it.
#[test]
fn motion_before_comes_to_rest() {
    let mut case = weak_slabs(&json!({"newmark": {}}), 1e-3);
    case["steps"][0]["dt"] = json!({"initial": 5e-5});
    case["steps"][0]["supports"][1]["ux"] = json!({"rate": 1.0});
    let go_on = json!({"name": "go on", "duration": 10, "scheme": quasi_dynamic(1e-6, 10), "dt": {"initial": 1e-3},
        "supports": [{"on": "upper_top", "ux": {"rate": 1e-3}}]});
    case["steps"] = json!([case["steps"][0], go_on]);
    let run = finish(&case);
    let last = run.last();
    let free = |dof: &usize| last.reaction[*dof] == 0.0;
    let out = (0..last.force.len()).filter(free).fold(0.0f64, |most, dof| most.max(last.force[dof].abs()));
    assert!(out < 1e-9, "{out:e} is out of balance");
    close("energy", last.energy.error(), 0.0, 0.01 * last.energy.external_work);
}

/// What such a step cannot do is refused with its place, before anything is solved.
#[test]
fn what_it_cannot_do_is_refused() {
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut case = weak_slabs(&quasi_dynamic(1e-5, 10), 1.0);
        change(&mut case);
        refusal(&case)
    };
    type Change = fn(&mut Value);
    let changes: [(Change, &str, &str); 12] = [
        (|c| c["contacts"]["fault"]["sliding"] = json!("finite"), "contacts.fault.sliding", "need small"),
        (|c| c["contacts"]["fault"]["radiation_damping"] = json!(false), "contacts.fault.radiation_damping", "missing"),
        (|c| c["contacts"]["fault"]["method"] = json!("gauss_to_segment"), "contacts.fault", "coincide: quasi"),
        (
            |c| {
                c["contacts"]["fault"]["along"]["law"][0]["friction"] = json!({"law": "coulomb", "mu": 0.7});
                c["contacts"]["fault"]["stick"] = json!(1e-6);
            },
            "contacts.fault.stick",
            "raise alpha_t",
        ),
        (
            |c| c["contacts"]["fault"]["normal"]["penetration"] = json!(1e-3),
            "contacts.fault.normal.penetration",
            "leave it out",
        ),
        (|c| c["bodies"]["lower"]["material"]["model"] = json!("neo_hookean"), "steps[0].scheme", "`lower`"),
        (|c| c["steps"][0]["supports"][1]["ux"] = json!("0.001*t^2"), "steps[0].supports", "linearly"),
        (
            |c| c["steps"][0]["supports"][1]["ux"] = json!({"table": [[0, 0], [0.5, 1], [1, 1]]}),
            "steps[0].supports",
            "linearly",
        ),
        (|c| c["steps"][0]["supports"][0]["on"] = json!("lower"), "steps[0].supports", "no node of a contact"),
        (
            |c| c["steps"][0]["loads"] = json!([{"on": "upper_right", "pressure": 1}]),
            "steps[0].loads",
            "take a dead_pressure or a traction",
        ),
        (|c| c["steps"][0]["scheme"]["quasi_dynamic"]["tolerance"] = json!(0), "steps[0].scheme", "tolerance"),
        (|c| c["steps"][0]["rupture"] = json!({"slip_rate": 1}), "steps[0].rupture", "by itself"),
    ];
    for (change, place, what) in changes {
        let message = refused(&change);
        assert!(message.contains(place) && message.contains(what), "{place}, {what}: {message}");
    }
}

/// Where the interface opens, the run stops with the place and the reason.
#[test]
fn an_interface_that_opens_stops_the_run() {
    let mut case = weak_slabs(&quasi_dynamic(1e-5, 10), 100.0);
    case["steps"][0]["supports"][1]["uy"] = json!({"rate": 1e-3});
    let mut run = Simulation::new(model(&case));
    let message = loop {
        match run.next_increment() {
            Ok(Some(_)) => {}
            Ok(None) => panic!("it ended"),
            Err(error) => break error.to_string(),
        }
    };
    assert!(message.contains("contact `fault` at (") && message.contains("keep every point closed"), "{message}");
    assert!(!message.contains("smallest allowed"), "no increment is to blame: {message}");
    let pressure =
        run.state().contacts[0].iter().map(|contact| contact.friction.pressure).fold(f64::INFINITY, f64::min);
    assert!((0.0..0.1).contains(&pressure), "{pressure}");
}

/// Strength that varies in time acts at its time in the middle of steps: a given rate is integrated by the scheme itself.
#[test]
fn given_rates_may_vary_in_time() {
    let mut case = weak_slabs(&quasi_dynamic(1e-7, 10), 10.0);
    case["contacts"]["fault"]["along"]["law"][0]["along"] = json!({"slip_rate": "1e-3*(1 + sin(t))"});
    let run = finish_at(&case, Path::new("test.json"));
    let slip = run.last().contacts[0][0].friction.plastic_slip;
    close("slip", slip, 1e-3 * (10.0 + 1.0 - 10f64.cos()), 1e-8);
}

/// Where no step may be as short as its error asks for, the run says how long the shortest was, and what the least is.
#[test]
fn steps_that_may_not_be_short_enough_are_reported_of() {
    let mut case = slider("ageing", 20.0, &quasi_dynamic(1e-6, 10));
    case["steps"][0]["dt"] = json!({"initial": 1e4, "min": 1e4});
    let mut run = Simulation::new(model(&case));
    let message = loop {
        match run.next_increment() {
            Ok(Some(_)) => {}
            Ok(None) => panic!("a rupture in steps of three hours"),
            Err(error) => break error.to_string(),
        }
    };
    assert!(
        ["a step of 1.000e4 is above the tolerance", "dt.min = 1e4"].iter().all(|what| message.contains(what)),
        "{message}"
    );
    assert!(!message.contains("smallest allowed"), "{message}");
}

/// A bond of c = 4 that softens over D beside the friction of the spring-slider, driven at 1e-9 until it has slid off it, against
/// Runge and Kutta's method of the fourth order with ten thousand steps a time constant or more:
///
/// ```text
/// τ = τ₀ + k (V_p t − s),   τ − c ⟨1 − s/D⟩ = a p arsinh(V/(2 V_0) exp((f_0 + b ln(V_0 θ/D_c))/a)) + η V,   θ̇ = 1 − V θ/D_c
/// ```
#[test]
fn a_bond_softens_by_slip() {
    let [a, b, d_c, v_0, f_0, p, eta] = [0.015, 0.01, 0.008, 1e-6, 0.6, 50.0, 4.62];
    let [c, d, k, driven, tau_0, theta_0] = [4.0, 0.02, 1e3, 1e-8, 30.0, 0.5 * 0.008 / 1e-9];
    let mut case = slider("ageing", 1.0, &quasi_dynamic(1e-8, 1));
    let friction = &mut case["contacts"]["base"]["friction"];
    (friction["a"], friction["b"]) = (json!(a), json!(b));
    case["contacts"]["base"]["bond"] = json!({"strength": c, "slip": d});
    case["steps"][0]["loads"][1]["spring"] = json!({"kx": k, "driver": {"x": {"rate": driven}}});
    case["steps"][0]["duration"] = json!(5e6);
    let run = finish(&case);
    // α_t of friction and of the bond are springs in series with k.
    let k = 1.0 / (1.0 / k + 1.0 / 2e6);
    let rate = |time: f64, slip: f64, theta: f64| {
        let held: f64 = if slip < d { c * (1.0 - slip / d) } else { 0.0 };
        let tau = tau_0 + k * (driven * time - slip) - held;
        let law =
            |v: f64| a * p * (v / (2.0 * v_0) * ((f_0 + b * (v_0 * theta / d_c).ln()) / a).exp()).asinh() + eta * v;
        let [mut low, mut high] = [-60.0f64, 5.0];
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if law(middle.exp()) > tau { high = middle } else { low = middle }
        }
        if tau > 0.0 { low.exp() } else { 0.0 }
    };
    let rates = |time: f64, [slip, theta]: [f64; 2]| {
        let v = rate(time, slip, theta);
        [v, 1.0 - v * theta / d_c]
    };
    let (mut y, mut time, h) = ([0.0, theta_0], 0.0, 250.0);
    let mut states = run.states.iter().filter(|state| state.time > 0.0).peekable();
    let mut compared = 0;
    while time < 5e6 {
        let add = |y: [f64; 2], dy: [f64; 2], h: f64| [y[0] + h * dy[0], y[1] + h * dy[1]];
        let k1 = rates(time, y);
        while let Some(state) = states.next_if(|state| state.time <= time + h) {
            let slip = y[0] + k1[0] * (state.time - time);
            let point = &state.contacts[0][0];
            close(&format!("slip at {}", state.time), point.friction.plastic_slip, slip, 2e-4 * d);
            let held = if slip < d { c * (1.0 - slip / d) } else { 0.0 };
            close(&format!("bond at {}", state.time), point.bond.expect("a bond").traction, held, 2e-3 * c);
            compared += 1;
        }
        let k2 = rates(time + 0.5 * h, add(y, k1, 0.5 * h));
        let k3 = rates(time + 0.5 * h, add(y, k2, 0.5 * h));
        let k4 = rates(time + h, add(y, k3, h));
        y = [0, 1].map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        time += h;
    }
    assert!(compared > 20 && y[0] > d, "{compared} states, slip {}", y[0]);
    let energy = &run.last().energy;
    close("energy", energy.error(), 0.0, 1e-3 * energy.friction_dissipation);
}

/// What needs an opening is refused by its name; the resolved case is accepted.
#[test]
fn a_bond_without_an_opening_alone_goes_there() {
    for (bond, place) in [
        (json!({"strength": 4, "tension": 1}), "bond.tension"),
        (json!({"strength": 4, "limit": 40}), "bond.limit"),
        (json!({"strength": 4, "opening": 1}), "bond.opening"),
    ] {
        let mut case = slider("ageing", 1.0, &quasi_dynamic(1e-6, 1));
        case["contacts"]["base"]["bond"] = bond;
        let refused = refusal(&case);
        assert!(refused.contains(&format!("contacts.base.{place}: is not for quasi_dynamic")), "{refused}");
    }
}
