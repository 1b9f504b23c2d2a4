//! `fecontact law` with a `slider`: a mass behind the spring of a machine, against closed forms.

use serde_json::{Value, json};

use crate::law::{Done, close, refused};

/// Force of a mass that sticks and swings on two springs, from rest: M ü = k V t − (k + α_t) u.
fn swinging([stiffness, mass, alpha_t]: [f64; 3], rate: f64, time: f64) -> f64 {
    let whole = stiffness + alpha_t;
    let omega = (whole / mass).sqrt();
    stiffness * (rate * time - stiffness * rate / whole * (time - (omega * time).sin() / omega))
}

fn sticking() -> Value {
    json!({
        "friction": {"law": "coulomb", "mu": 10, "alpha_t": 20},
        "slider": {"stiffness": 3, "mass": 0.5, "tolerance": 1e-11},
        "by": ["stiffness", "mass", "alpha_t", "mu"],
        "initial": {"pressure": 1, "traction": 0.1},
        "dt": 0.05,
        "path": [{"duration": 5, "slip": {"rate": 0.2}}]
    })
}

/// The force, and its derivatives against differences of the closed form.
#[test]
fn a_slider_that_sticks_swings_on_two_springs() {
    let done = Done::of(&sticking());
    let own = [3.0, 0.5, 20.0];
    for (row, time) in done.column("time").iter().enumerate() {
        let force = swinging(own, 0.2, *time);
        let value = |name: &str| done.column(name)[row];
        close("force", value("force"), 0.1 + force, 1e-6);
        close("load point", value("load_point"), 0.2 * time, 1e-15);
        close("slip", value("slip"), 0.2 * time - force / 3.0, 1e-6);
        for (k, name) in ["stiffness", "mass", "alpha_t"].iter().enumerate() {
            let beside =
                |step: f64| swinging(std::array::from_fn(|i| own[i] + if i == k { step } else { 0.0 }), 0.2, *time);
            close(name, value(&format!("dforce_d{name}")), (beside(1e-4) - beside(-1e-4)) / 2e-4, 1e-4);
        }
        close("strength", value("dforce_dmu"), 0.0, 0.0);
    }
    assert_eq!(done.column("time").len(), 101);
}

/// A light mass slides on an interface that dilates against a normal stiffness K: q = μ (p + K tan ψ (u − q/α_t)) = k (w − u).
#[test]
fn a_slider_dilates_against_what_surrounds_it() {
    let [mu, rate, around, alpha_t, spring, end] = [0.5, 0.2, 50.0, 100.0, 10.0, 0.3];
    let done = Done::of(&json!({
        "friction": {"law": "coulomb", "mu": mu, "alpha_t": alpha_t},
        "dilatancy": {"rate": rate},
        "normal": {"stiffness": around},
        "slider": {"stiffness": spring, "mass": 1e-6, "tolerance": 1e-6},
        "initial": {"pressure": 1},
        "path": [{"duration": 1, "slip": end}]
    }));
    let hardening = mu * around * rate;
    let both = 1.0 + hardening / alpha_t;
    let slip = (spring * end * both - mu) / (hardening + spring * both);
    let last = |name: &str| *done.column(name).last().expect("a row");
    close("slip", last("slip"), slip, 1e-4);
    close("force", last("force"), spring * (end - slip), 1e-3);
    close("pressure", last("pressure"), spring * (end - slip) / mu, 2e-3);
}

/// Derivatives along a given slip: q = μ p and q = α_t u.
#[test]
fn a_traction_is_differentiated() {
    let done = Done::of(&json!({
        "friction": {"law": "coulomb", "mu": 0.5, "alpha_t": 20},
        "by": ["alpha_t", "mu"],
        "table": [[0, 0, 2], [1, 0.025, 2], [2, 1, 2]]
    }));
    assert_eq!(done.column("dtraction_dalpha_t"), [0.0, 0.025, 0.0]);
    assert_eq!(done.column("dtraction_dmu"), [0.0, 0.0, 2.0]);
}

#[test]
fn bad_sliders_are_named() {
    let with = |key: &str, value: Value| {
        let mut test = sticking();
        test[key] = value;
        test
    };
    let slider = |mass: f64| json!({"stiffness": 3, "mass": mass});
    refused(&with("slider", slider(0.0)), &["slider.mass: ", "is 0: must be positive"]);
    refused(
        &with("by", json!(["mass", "mu_s"])),
        &["by[1]: ", "no derivative of the law by mu_s; there are derivatives by mu, alpha_t, stiffness, mass"],
    );
    refused(&with("by", json!(["mass", "mass"])), &["by[1]: ", "is mass once more"]);
    refused(
        &with("slider", Value::Null),
        &["by[0]: ", "no derivative of the law by stiffness; there are derivatives by mu, alpha_t"],
    );
    refused(&with("normal", json!({"stiffness": 1})), &["by: ", "at given pressures: leave out `normal`"]);
    let bond = json!({"strength": 1, "tension": 1, "opening": 0.1});
    refused(&with("bond", bond), &["bond: ", "a slider has friction alone"]);
}
