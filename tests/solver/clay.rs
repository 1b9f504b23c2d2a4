//! Clay: whole models of Cam-clay, drained and with a fluid in its pores.

use crate::common::{Blocks, close, finish, model, refusal};
use serde_json::{Value, json};

/// λ̂ = 0.10 and κ̂ = 0.02 of the Kirchhoff stress.
fn clay(more: Value) -> Value {
    let [lambda, kappa] = [0.10, 0.02].map(|slope: f64| slope / (1.0 + slope));
    let mut given = json!({"model": "cam_clay", "lambda": lambda, "kappa": kappa, "M": 1.2, "p_min": 1});
    more.as_object().expect("keys").iter().for_each(|(key, value)| given[key] = value.clone());
    given
}

fn isotropic(pressure: f64) -> Value {
    json!({"components": {"xx": -pressure, "yy": -pressure, "zz": -pressure}})
}

/// A triaxial test of one element, undrained under a constant total lateral pressure: q at ε_a = 0.01, 0.03, 0.05, 0.15 of the closed
/// form, p = p₀ (1 + (η/M)²)^(−Λ) with ε_s of it (p₀ = p_c = 100, G = 3000). As ring and, by the volume that stays, whatever p_w begins with.
#[test]
fn an_undrained_triaxial_test() {
    let mesh = Blocks::default().rectangle("sample", [1, 1], [0.0, 0.0], [1.0, 1.0]).json();
    let run = finish(&json!({
        "section": "axisymmetric", "mesh": mesh,
        "bodies": {"sample": {"material": clay(json!({"G": 3000, "p_c": 100})), "element": "f_bar", "initial_stress": isotropic(100.0),
                              "pore_fluid": {"bulk_modulus": 2.2e6, "porosity": 0.5, "pressure": 50}}},
        "steps": [{"name": "press", "duration": 0.15, "dt": {"initial": 2e-4, "max": 2e-4},
            "loads": [{"on": "sample_right", "pressure": "150"}],
            "supports": [{"on": "sample_left", "ux": 0}, {"on": "sample_bottom", "uy": 0}, {"on": "sample_top", "uy": "exp(-t) - 1"}]}]
    }));
    for (strain, q) in [(0.01, 55.646), (0.03, 67.588), (0.05, 68.671), (0.15, 68.922)] {
        let state = run.states.iter().min_by(|a, b| (a.time - strain).abs().total_cmp(&(b.time - strain).abs()));
        let state = state.expect("an increment");
        let force = run.reaction("sample_top", state)[1];
        let area = std::f64::consts::PI * state.time.exp();
        close("q", -force / area - 150.0, q, 5e-3 * q);
    }
    let energy = run.last().energy;
    close("energy error", energy.error(), 0.0, 5e-3 * energy.external_work.abs());
    assert!(energy.plastic_dissipation > 0.0);
}

/// Saturated ground at rest: the effective stress of its submerged weight and the pressure of its water carry the weight of the mixture, on
/// skewed elements as well.
#[test]
fn saturated_ground_rests() {
    let mesh = Blocks::default().block("ground", [4, 4], |s, t| {
        let bump = 16.0 * s * (1.0 - s) * t * (1.0 - t);
        [s + 0.06 * bump * (9.0 * t).sin(), t - 1.0 + 0.06 * bump * (7.0 * s).cos()]
    });
    for material in [
        clay(json!({"nu": 0.3, "OCR": 1.5, "density": 2})),
        json!({"model": "hencky", "E": 1e4, "nu": 0.3, "density": 2}),
        json!({"model": "linear", "E": 1e4, "nu": 0.3, "density": 2}),
    ] {
        let case = json!({
            "mesh": mesh.json(),
            "bodies": {"ground": {"material": material, "element": "f_bar",
                "initial_stress": {"geostatic": {"surface": 0, "weight": 10, "K0": 0.6}},
                "pore_fluid": {"bulk_modulus": 2.2e6, "porosity": 0.4, "pressure": "-10*y"}}},
            "steps": [{"name": "rest", "duration": 1, "dt": {"initial": 1}, "loads": [{"on": "ground", "gravity": {"y": "-10"}}],
                       "supports": [{"on": "ground_left", "ux": 0}, {"on": "ground_right", "ux": 0}, {"on": "ground_bottom", "uy": 0}]}]
        });
        assert!(model(&case).warnings().is_empty(), "{:?}", model(&case).warnings());
        let run = finish(&case);
        assert!(run.last().displacement.iter().all(|u| u.abs() < 1e-13), "{material}");
    }
}

/// Moduli are those under the mean of the initial stress, and of the fluid: waves, penalties and steps go by them.
#[test]
fn moduli_come_from_the_initial_stress() {
    let mesh = Blocks::default().rectangle("ground", [1, 1], [0.0, -10.0], [1.0, 0.0]).json();
    let case = |fluid: bool| {
        let mut case = json!({
            "mesh": mesh,
            "bodies": {"ground": {"material": clay(json!({"nu": 0.25, "OCR": 2})),
                "initial_stress": {"geostatic": {"surface": 0, "weight": 10, "K0": 1}}}},
            "steps": [{"name": "rest", "duration": 1, "supports": [{"on": "ground", "ux": 0, "uy": 0}]}]
        });
        if fluid {
            case["bodies"]["ground"]["pore_fluid"] = json!({"bulk_modulus": 4e5, "porosity": 0.4});
        }
        case
    };
    // p = 50 at the middle, K = p/κ̂, G = K·3(1 − 2ν)/(2(1 + ν))
    let (bulk, share) = (50.0 / 0.02, 1.5 * 0.5 / 1.25);
    let built = model(&case(false));
    let law = &built.bodies[0].material;
    close("G", law.description().shear_modulus, share * bulk, 1e-9 * bulk);
    close("K + 4G/3", law.description().p_wave_modulus, bulk * (1.0 + 4.0 / 3.0 * share), 1e-9 * bulk);
    let with = model(&case(true));
    close(
        "with K_w/n",
        with.bodies[0].material.description().p_wave_modulus,
        law.description().p_wave_modulus + 1e6,
        1e-6,
    );
    let warnings = with.warnings().join("\n");
    assert!(warnings.contains("fluid in its pores") && warnings.contains("f_bar"), "{warnings}");
}

/// Friction beside pores that hold a fluid is warned of where it goes by the total pressure, and only there.
#[test]
fn friction_of_the_total_pressure_is_warned_of() {
    let mesh = Blocks::default().rectangle("ground", [1, 1], [0.0, 0.0], [1.0, 1.0]).json();
    let said = |change: &dyn Fn(&mut Value)| {
        let mut case = json!({
            "mesh": mesh,
            "bodies": {"ground": {"material": {"model": "linear", "E": 100, "nu": 0.3}, "element": "f_bar",
                "pore_fluid": {"bulk_modulus": 2.2e6, "porosity": 0.4}}},
            "contacts": {"floor": {"slave": "ground_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "friction": {"law": "coulomb", "mu": 0.3}}},
            "steps": [{"name": "rest", "duration": 1, "supports": [{"on": "ground_top", "ux": 0, "uy": -0.01}]}]
        });
        change(&mut case);
        let warnings = model(&case).warnings().join("\n");
        warnings.contains("contact `floor`: its friction goes by the total pressure, part of which the fluid in the pores of body `ground`")
    };
    assert!(said(&|_| ()));
    assert!(!said(&|case| case["bodies"]["ground"]["pore_fluid"] = Value::Null));
    assert!(!said(&|case| case["contacts"]["floor"]["fluid_pressure"] = json!(1)));
    for law in [json!({"law": "frictionless"}), json!({"law": "adhesion", "strength": 2})] {
        assert!(!said(&|case| case["contacts"]["floor"]["friction"] = law.clone()), "{law}");
    }
}

/// What cannot be is refused with its place and what to do.
#[test]
fn what_has_no_pressure_or_no_volume_is_refused() {
    let mesh = Blocks::default().rectangle("ground", [1, 1], [0.0, -1.0], [1.0, 0.0]).json();
    let case = |body: Value| {
        json!({"mesh": mesh, "bodies": {"ground": body},
               "steps": [{"name": "rest", "duration": 1, "supports": [{"on": "ground", "ux": 0, "uy": 0}]}]})
    };
    let material = clay(json!({"G": 3000, "p_c": 100}));
    let why = refusal(&case(json!({"material": material})));
    for part in ["bodies.ground.initial_stress", "is missing", "mean pressure of 0"] {
        assert!(why.contains(part), "{part}: {why}");
    }
    let why = refusal(&case(json!({"material": material, "initial_stress": isotropic(120.0)})));
    for part in ["bodies.ground.initial_stress", "at (", "p_c of 120", "OCR"] {
        assert!(why.contains(part), "{part}: {why}");
    }
    let linear = json!({"model": "linear", "E": 1, "nu": 0.3});
    for (fluid, place) in [
        (json!({"bulk_modulus": 0, "porosity": 0.4}), "pore_fluid.bulk_modulus"),
        (json!({"bulk_modulus": 1, "porosity": 1}), "pore_fluid.porosity"),
        (json!({"bulk_modulus": 1, "porosity": 0.4, "cavitation": -1}), "pore_fluid.cavitation"),
        (json!({"bulk_modulus": 1, "porosity": 0.4, "pressure": "1/y"}), "pore_fluid.pressure"),
    ] {
        let why = refusal(&case(json!({"material": linear, "pore_fluid": fluid})));
        assert!(why.contains(&format!("bodies.ground.{place}")), "{place}: {why}");
    }
    let mut plate = case(json!({"material": linear, "pore_fluid": {"bulk_modulus": 1, "porosity": 0.4}}));
    plate["section"] = json!({"plane_stress": {"thickness": 1}});
    assert!(refusal(&plate).contains("plane stress"));
}

/// A strip footing bonded to undrained Cam-clay under an even pressure p₀: V = (2 + π) s_u B + p₀ B with s_u = M p_f/√3 of the critical
/// state, p_f = p₀ (R/2)^Λ, whatever the fluid and the elasticity are. The corner carries half an element more, B/100 here.
#[test]
fn an_undrained_footing_carries_the_strength_of_the_critical_state() {
    let [n, beside, below] = [12, 16, 16];
    let near = |t: f64, ratio: f64| (ratio.powf(t) - 1.0) / (ratio - 1.0);
    let mesh = Blocks::default().block("soil", [n + beside, below], |s, t| {
        let share = n as f64 / (n + beside) as f64;
        let x =
            if s <= share { 0.5 * near(s / share, 0.1) } else { 0.5 + 2.5 * near((s - share) / (1.0 - share), 30.0) };
        [x, -1.5 + 1.5 * near(t, 0.1)]
    });
    let mut mesh = mesh.json();
    let top = mesh["edges"]["soil_top"].as_array().expect("edges").clone();
    mesh["edges"]["foot"] = json!(top[..n]);
    let [p_0, over] = [100.0, 1.5f64];
    let run = finish(&json!({
        "mesh": mesh,
        "bodies": {"soil": {"material": clay(json!({"G": 30000, "p_c": over * p_0})), "element": "f_bar",
            "initial_stress": isotropic(p_0), "pore_fluid": {"bulk_modulus": 5e6, "porosity": 0.5}}},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.02, "max": 0.02, "min": 1e-4},
            "loads": [{"on": "soil_top", "dead_pressure": p_0.to_string()}],
            "supports": [{"on": "soil_bottom", "ux": 0, "uy": 0}, {"on": "soil_right", "ux": 0}, {"on": "soil_left", "ux": 0},
                {"on": "foot", "ux": 0, "uy": -0.012}]}]
    }));
    let strength = 1.2 / 3f64.sqrt() * p_0 * (0.5 * over).powf(1.0 - 0.02 / 0.10);
    let factor = |state| -2.0 * run.reaction("foot", state)[1] / strength;
    let exact = 2.0 + std::f64::consts::PI;
    let last = factor(run.last());
    assert!((exact * 0.99..exact * 1.03).contains(&last), "{last}");
}
