//! Bonds in motion, in rings, beside fluids, and taken up from a checkpoint.

use std::f64::consts::PI;

use fecontact::model::state::State;
use serde_json::{Value, json};

use crate::common::{close, finish, with};

/// A point of mass 10 on a plane, of area 1, on which a force acts from the start on, or which swings on a spring.
fn mass(contact: &Value, step: &Value) -> Value {
    let base = json!({"slave": "mass", "area": 1, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "normal": {"alpha_n": 1e7}});
    let only = json!({"name": "move", "duration": 0.15, "dt": {"initial": 1e-4}});
    let (base, only) = (with(base, contact), with(only, step));
    json!({
        "mesh": {"nodes": [[0, 0]], "points": {"mass": [0]}},
        "point_masses": {"mass": {"mass": 10}},
        "contacts": {"base": base},
        "steps": [only],
        "output": {"interval": 1e-3, "fields": false}
    })
}

fn schemes() -> [Value; 4] {
    [
        json!({"explicit": {}}),
        json!({"newmark": {}}),
        json!({"hht": {"alpha": -0.05}}),
        json!({"generalized_alpha": {}}),
    ]
}

/// m v²/2 is the work of the force less that of friction, f s, and of the bond, c s − c s²/2D up to D and c D/2 beyond.
#[test]
fn a_mass_slides_off_its_softening_bond() {
    let [force, friction, c, d] = [60.0, 0.3 * 98.1, 20.0, 0.01];
    let contact = json!({
        "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 1e7}, "initial": {"pressure": 98.1},
        "bond": {"strength": c, "slip": d, "opening": 0.01}
    });
    for scheme in schemes() {
        let step = json!({"scheme": scheme, "loads": [{"on": "mass", "force": {"x": "60", "y": "-98.1"}}]});
        let run = finish(&mass(&contact, &step));
        let mut seen = [false; 2];
        for state in &run.states {
            let [slip, speed] = [state.displacement[0], state.velocity[0]];
            if slip < 1e-3 {
                continue;
            }
            let lost = friction * slip + if slip < d { c * slip * (1.0 - 0.5 * slip / d) } else { 0.5 * c * d };
            close(
                &format!("{scheme}: m v²/2 at {slip}"),
                5.0 * speed * speed,
                force * slip - lost,
                1e-3 * force * slip,
            );
            seen[usize::from(slip > d)] = true;
        }
        assert_eq!(seen, [true; 2], "{scheme}");
        let energy = run.last().energy;
        close("dissipation", energy.friction_dissipation, friction * run.last().displacement[0] + 0.5 * c * d, 1e-3);
        close("balance", energy.error(), 0.0, 2e-4 * energy.external_work);
    }
}

/// Pulled off by F > t: m ẅ = F − t (1 − w/δ), w = (F − t) (cosh ωt − 1) δ/t + (v₀/ω) sinh ωt with ω² = t/(m δ), and free from w = δ on.
#[test]
fn a_mass_is_pulled_off_its_bond() {
    let [force, t, opening] = [30.0f64, 20.0, 0.01];
    let contact = json!({"friction": {"law": "frictionless"}, "bond": {"strength": 20, "tension": t, "opening": opening, "bonded": true}});
    // First elastic up to w_e = t/α_n, at 1 − cos Ωt = t/F with Ω² = α_n/m, and m v²/2 = F w_e − t w_e/2.
    let [elastic, swing] = [t / 1e7, 1000.0f64];
    let (from, start) = ((1.0 - t / force).acos() / swing, (0.2 * (force - 0.5 * t) * elastic).sqrt());
    let rate = (t / (10.0 * (opening - elastic))).sqrt();
    let grown = |time: f64| {
        let (growth, rest) = ((force - t) * (opening - elastic) / t, rate * (time - from));
        [
            elastic + growth * (rest.cosh() - 1.0) + start / rate * rest.sinh(),
            growth * rate * rest.sinh() + start * rest.cosh(),
        ]
    };
    let mut torn = [0.0, 1.0];
    for _ in 0..60 {
        let middle = 0.5 * (torn[0] + torn[1]);
        torn[usize::from(grown(middle)[0] > opening)] = middle;
    }
    for scheme in schemes() {
        let step = json!({"scheme": scheme, "duration": 0.2, "loads": [{"on": "mass", "force": {"x": 0, "y": "30"}}]});
        let run = finish(&mass(&contact, &step));
        for state in run.states.iter().filter(|state| state.time > 0.02) {
            let (before, after) = (state.time.min(torn[0]), (state.time - torn[0]).max(0.0));
            let [opened, speed] = grown(before);
            let expected = opened + speed * after + 0.5 * force / 10.0 * after * after;
            close(&format!("{scheme}: w at {}", state.time), state.displacement[1], expected, 5e-3 * expected);
        }
        let energy = run.last().energy;
        close("dissipation", energy.friction_dissipation, 0.5 * t * opening, 1e-3);
        close("balance", energy.error(), 0.0, 1e-3 * energy.external_work);
    }
}

/// Where the limit τ is below c + μ p the mass swings as under dry friction of τ alone: it turns 2 τ/k nearer every time, and energy is
/// neither gained nor lost otherwise.
#[test]
fn a_limit_in_motion_gains_no_energy() {
    let [stiffness, limit] = [1000.0, 30.0];
    let contact = json!({
        "friction": {"law": "coulomb", "mu": 0.3, "alpha_t": 1e6}, "initial": {"pressure": 98.1},
        "bond": {"strength": 20, "opening": 0.01, "limit": limit}
    });
    for scheme in schemes() {
        let loads = json!([{"on": "mass", "force": {"x": 0, "y": "-98.1"}}, {"on": "mass", "spring": {"kx": stiffness, "ky": 0}}]);
        let step = json!({"scheme": scheme, "duration": 1.5, "dt": {"initial": 2e-4, "max": 2e-4}, "loads": loads});
        let mut case = mass(&contact, &step);
        case["point_masses"]["mass"]["velocity"] = json!([3, 0]);
        let run = finish(&case);
        // m v²/2 = k x²/2 + τ x up to the first turn
        let mut turn = (limit * limit + stiffness * 10.0 * 9.0f64).sqrt() / stiffness - limit / stiffness;
        let turned = |states: &[State]| {
            let [from, to] = [0, 1].map(|k| (states[k].velocity[0], states[k].displacement[0].abs()));
            (from.0 * to.0 < 0.0).then_some(from.1.max(to.1))
        };
        let turns: Vec<f64> = run.states.windows(2).filter_map(turned).collect();
        assert!(turns.len() >= 4, "{scheme}: {turns:?}");
        for found in &turns[..4] {
            close(&format!("{scheme}: turn"), *found, turn, 1e-3);
            turn -= 2.0 * limit / stiffness;
        }
        for state in &run.states {
            let energy = state.energy;
            close(&format!("{scheme}: balance"), energy.error(), 0.0, 2e-3 * energy.initial);
        }
    }
}

/// Friction of the total pressure less that of the fluid; the bond bears c whatever the fluid does.
#[test]
fn only_friction_sees_the_pressure_of_a_fluid() {
    let bond = json!({"strength": 5, "opening": 0.01});
    let block = |body: Value, fluid: Value| {
        json!({
            "mesh": {"blocks": [{"body": "b", "corners": [[0, 0], [1, 0], [1, 1], [0, 1]], "elements": [2, 2], "sides": ["bottom", null, "top", null]}]},
            "bodies": {"b": body},
            "contacts": {"c": {"slave": "bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "sliding": "small",
                "fluid_pressure": fluid, "friction": {"law": "coulomb", "mu": 0.4}, "bond": bond}},
            "steps": [
                {"name": "press", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "b", "ux": 0}],
                 "loads": [{"on": "top", "dead_pressure": "12"}]},
                {"name": "drag", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "b", "ux": 0.02}]}
            ]
        })
    };
    let body = json!({"material": {"model": "linear", "E": 1000, "nu": 0}});
    let mut wet = body.clone();
    wet["element"] = json!("displacement");
    wet["pore_fluid"] = json!({"bulk_modulus": 200, "porosity": 0.4, "pressure": 0});
    // K_f/n beside E takes a third of the stress.
    for (case, fluid) in [(block(body, json!(7)), 7.0), (block(wet, json!("of_bodies")), 12.0 * 500.0 / 1500.0)] {
        let run = finish(&case);
        for point in &run.last().contacts[0] {
            close("p", point.friction.pressure, 12.0 - fluid, 1e-6);
            close("q", point.shear(), 5.0 + 0.4 * (12.0 - fluid), 1e-6);
            close("q of the bond", point.bond.expect("a bond").traction, 5.0, 1e-6);
        }
    }
    // Fluid that lifts the block leaves the bond alone, which pulls up to t, the lever of ν = 0.
    let mut lifted = block(json!({"material": {"model": "linear", "E": 1000, "nu": 0}}), json!("12 + 2*min(t, 1)"));
    lifted["contacts"]["c"]["bond"]["tension"] = json!(3);
    let run = finish(&lifted);
    for point in &run.last().contacts[0] {
        close("T", point.tension(), 2.0, 1e-6);
        close("c − μ T", point.shear(), 5.0 - 0.4 * 2.0, 1e-6);
    }
}

/// A shaft of D = 1 and L = 8 in soil under 400: c π D L = 804.25 whatever the pressure, by every method.
#[test]
fn a_round_shaft_bears_its_adhesion() {
    for (method, friction, bond) in [
        ("node_to_segment", json!({"law": "adhesion", "strength": 32}), json!({"opening": 1e-3})),
        ("gauss_to_segment", json!({"law": "frictionless"}), json!({"strength": 32, "opening": 1e-3})),
        ("mortar", json!({"law": "coulomb", "mu": 0.02}), json!({"strength": 24, "opening": 1e-3})),
    ] {
        let run = finish(&json!({
            "section": "axisymmetric",
            "mesh": {"blocks": [{
                "body": "soil", "corners": [[0.5, -8], [6.5, -8], [6.5, 0], [0.5, 0]], "elements": [8, 16], "sides": [null, "far", null, "shaft"]
            }]},
            "bodies": {"soil": {"material": {"model": "linear", "E": 50000, "nu": 0}}},
            "contacts": {"c": {
                "slave": "shaft", "master": {"plane": {"point": [0.5, 0], "normal": [1, 0]}}, "sliding": "small", "method": method,
                "friction": friction, "bond": bond, "initial": {"pressure": 400, "balanced": true}
            }},
            "steps": [{"name": "drag", "duration": 1, "dt": {"initial": 0.2},
                "supports": [{"on": "far", "ux": 0, "uy": 0.1}]}]
        }));
        let shear: f64 = run.last().contacts[0].iter().map(|point| point.length * point.shear()).sum();
        close(method, shear.abs(), 32.0 * PI * 8.0, 1e-3 * 804.25);
        close(method, run.reaction("far", run.last())[1], 32.0 * PI * 8.0, 1e-3 * 804.25);
    }
}
