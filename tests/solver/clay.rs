//! Clay: whole models of Cam-clay, drained and with a fluid in its pores.

use crate::common::{self, Blocks, close, finish, model, refusal};
use serde_json::{Value, json};

/// λ̂ = 0.10 and κ̂ = 0.02 of the Kirchhoff stress.
fn clay(more: Value) -> Value {
    let [lambda, kappa] = [0.10, 0.02].map(|slope: f64| slope / (1.0 + slope));
    common::with(json!({"model": "cam_clay", "lambda": lambda, "kappa": kappa, "M": 1.2, "p_min": 1}), &more)
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

/// The same of clay with structure, 1/R* = 8, m = 5, a = 0.6: q of the rate equations that `tests/laws/sys_cam_clay.rs` integrates. It softens,
/// of which the mesh is warned.
#[test]
fn clay_with_structure_softens_undrained() {
    let mesh = Blocks::default().rectangle("sample", [1, 1], [0.0, 0.0], [1.0, 1.0]).json();
    let mut material = clay(json!({"G": 3000, "OCR": 1, "structure": 8, "m": 5, "a": 0.6}));
    material["model"] = json!("sys_cam_clay");
    let case = json!({
        "section": "axisymmetric", "mesh": mesh,
        "bodies": {"sample": {"material": material, "element": "f_bar", "initial_stress": isotropic(100.0),
                              "pore_fluid": {"bulk_modulus": 2.2e6, "porosity": 0.5}}},
        "steps": [{"name": "press", "duration": 0.1, "dt": {"initial": 2e-4, "max": 2e-4},
            "loads": [{"on": "sample_right", "pressure": "100"}],
            "supports": [{"on": "sample_left", "ux": 0}, {"on": "sample_bottom", "uy": 0}, {"on": "sample_top", "uy": "exp(-t) - 1"}]}]
    });
    let run = finish(&case);
    for (strain, q) in [(0.01, 53.5583), (0.03, 57.0712), (0.1, 38.4021)] {
        let state = run.states.iter().min_by(|a, b| (a.time - strain).abs().total_cmp(&(b.time - strain).abs()));
        let state = state.expect("an increment");
        let force = run.reaction("sample_top", state)[1];
        close("q", -force / (std::f64::consts::PI * state.time.exp()) - 100.0, q, 5e-3 * q);
    }
    let energy = run.last().energy;
    close("energy error", energy.error(), 0.0, 5e-3 * energy.external_work.abs());
    let concern = model(&case).bodies[0].material.description().concern.map(String::from);
    assert!(concern.is_some_and(|concern| concern.contains("loses its structure")));
}

/// Saturated ground at rest: the effective stress of its submerged weight and the pressure of its water carry the weight of the mixture, on
/// skewed elements as well.
#[test]
fn saturated_ground_rests() {
    let mesh = Blocks::default().block("ground", [4, 4], |s, t| {
        let bump = 16.0 * s * (1.0 - s) * t * (1.0 - t);
        [s + 0.06 * bump * (9.0 * t).sin(), t - 1.0 + 0.06 * bump * (7.0 * s).cos()]
    });
    let mut skeleton =
        clay(json!({"nu": 0.3, "OCR": 1.5, "density": 2, "structure": 4, "m": 3, "b_r": 0.1, "m_b": 0.9, "zeta": 0.5}));
    skeleton["model"] = json!("sys_cam_clay");
    for material in [
        clay(json!({"nu": 0.3, "OCR": 1.5, "density": 2})),
        skeleton,
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
    let mesh = Blocks::default().rectangle("ground", [1, 2], [0.0, -10.0], [1.0, 0.0]).json();
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
        warnings.contains("contact `floor`: its friction depends on the total pressure, part of which is carried by the fluid in the pores of body `ground`")
    };
    assert!(said(&|_| ()));
    assert!(!said(&|case| case["bodies"]["ground"]["pore_fluid"] = Value::Null));
    assert!(!said(&|case| case["contacts"]["floor"]["fluid_pressure"] = json!(1)));
    for law in [json!({"law": "frictionless"}), json!({"law": "adhesion", "strength": 2})] {
        assert!(!said(&|case| case["contacts"]["floor"]["friction"] = law.clone()), "{law}");
    }
}

/// A block under a total pressure σ that cannot widen, with a fluid in its pores: σ = (M + K_w/n) ε, and the grains carry
/// p = σ M/(M + K_w/n) + what p_w began with. Dragged as a whole, its interface sticks to q = α_t U and slips at q = μ p, whatever the method; by a
/// prescribed p_w alike. With suction it holds more than μ σ.
#[test]
fn an_interface_slips_where_the_effective_stress_says() {
    let mesh = Blocks::default().rectangle("block", [2, 2], [0.0, 0.0], [1.0, 1.0]).json();
    let [sigma, mu, alpha_t, modulus, fluid] = [12.0, 0.4, 2000.0, 1000.0 / 0.9, 500.0];
    let constrained = modulus * 0.9; // nu = 0
    for method in ["node_to_segment", "gauss_to_segment", "mortar"] {
        for initial in [0.0, 2.0, -3.0] {
            let share = fluid / (constrained + fluid);
            let pore = initial + (sigma - initial) * share;
            let pressure = sigma - pore;
            let slips_at = mu * pressure / alpha_t;
            let run = finish(&json!({
                "mesh": mesh,
                "bodies": {"block": {"material": {"model": "linear", "E": constrained, "nu": 0}, "element": "displacement",
                    "pore_fluid": {"bulk_modulus": 0.4 * fluid, "porosity": 0.4, "pressure": initial}}},
                "contacts": {"floor": {"slave": "block_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                    "method": method, "sliding": "small", "fluid_pressure": "of_bodies", "normal": {"alpha_n": 1e5},
                    "friction": {"law": "coulomb", "mu": mu, "alpha_t": alpha_t}}},
                "steps": [
                    {"name": "press", "duration": 1, "dt": {"initial": 1}, "loads": [{"on": "block_top", "dead_pressure": sigma.to_string()}],
                     "supports": [{"on": "block", "ux": 0}]},
                    {"name": "drag", "duration": 1, "dt": {"initial": 0.1, "max": 0.1},
                     "supports": [{"on": "block", "ux": 2.0 * slips_at}]}]
            }));
            for state in &run.states {
                let moved = 2.0 * slips_at * (state.time - 1.0).max(0.0);
                for point in &state.contacts[0] {
                    let told = format!("{method}, p_w0 = {initial} at {}", state.time);
                    let at = if state.time == 0.0 { continue } else { state.time };
                    close(&told, point.friction.pressure, pressure, 1e-9 * sigma);
                    close(&told, point.pores, pore, 1e-9 * sigma);
                    close(&told, point.friction.traction, (alpha_t * moved).min(mu * pressure), 1e-9 * sigma);
                    let slips = point.regime() == fecontact::laws::friction::Regime::Slip;
                    assert!(slips == (at > 1.5) || (at - 1.5).abs() < 1e-9, "{told}");
                }
            }
            let energy = run.last().energy;
            close("energy error", energy.error(), 0.0, 1e-9 * energy.external_work.abs());
        }
    }
}

/// Undrained Cam-clay sheared under a constant total pressure by an interface at its foot: at the critical state of simple shear the
/// interface bears τ = M p_f/√3 under the effective pressure p_f = p₀ 2^(−Λ). With μ < M/√3 it slips before, whatever p_w
/// has become, and with more never; friction of the total pressure would hold with 0.6 M/√3 as well.
#[test]
fn clay_slips_on_its_interface_below_the_critical_stress_ratio() {
    let mesh = Blocks::default().rectangle("clay", [1, 2], [0.0, 0.0], [1.0, 1.0]).json();
    let p_f = 100.0 * 0.5f64.powf(1.0 - 0.02 / 0.10);
    for share in [0.6, 0.9, 1.1] {
        let mu = share * 1.2 / 3f64.sqrt();
        let run = finish(&json!({
            "mesh": mesh, "periodic": [["clay_left", "clay_right"]],
            "bodies": {"clay": {"material": clay(json!({"G": 3000, "p_c": 100})), "element": "f_bar", "initial_stress": isotropic(100.0),
                "pore_fluid": {"bulk_modulus": 1e6, "porosity": 0.5, "pressure": 20}}},
            "contacts": {"floor": {"slave": "clay_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "sliding": "small", "fluid_pressure": "of_bodies", "initial": {"of_bodies": true},
                "normal": {"alpha_n": 1e7}, "friction": {"law": "coulomb", "mu": mu, "alpha_t": 1e6}}},
            "steps": [{"name": "shear", "duration": 1, "dt": {"initial": 2e-3, "max": 4e-3},
                "loads": [{"on": "clay_top", "dead_pressure": "120"}], "supports": [{"on": "clay_top", "ux": 0.5}]}]
        }));
        let last = run.last();
        for point in &last.contacts[0] {
            let friction = point.friction.clone();
            close("total pressure", point.contact_pressure(), 120.0, 0.5);
            if share < 1.0 {
                close("q/p", friction.traction.abs() / friction.pressure, mu, 1e-9);
                assert!(friction.plastic_slip.abs() > 0.2, "{share}: {}", friction.plastic_slip);
            } else {
                assert!(friction.plastic_slip == 0.0, "{share}: {}", friction.plastic_slip);
                close("p", friction.pressure, p_f, 0.02 * p_f);
                close("q", friction.traction.abs(), 1.2 * p_f / 3f64.sqrt(), 0.02 * p_f);
            }
        }
    }
}

/// What has no pores behind it, or opens, is refused with what to do.
#[test]
fn friction_by_effective_stress_needs_pores_behind_it() {
    let mesh = Blocks::default().rectangle("ground", [1, 1], [0.0, 0.0], [1.0, 1.0]).json();
    let case = |fluid: bool, more: (&str, Value)| {
        let mut case = json!({
            "mesh": mesh,
            "bodies": {"ground": {"material": {"model": "linear", "E": 100, "nu": 0.3}}},
            "contacts": {"floor": {"slave": "ground_bottom", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
                "fluid_pressure": "of_bodies", "friction": {"law": "coulomb", "mu": 0.3}}},
            "steps": [{"name": "rest", "duration": 1, "supports": [{"on": "ground_top", "ux": 0, "uy": -0.01}]}]
        });
        if fluid {
            case["bodies"]["ground"]["pore_fluid"] = json!({"bulk_modulus": 2.2e6, "porosity": 0.4, "pressure": 5});
        }
        case["contacts"]["floor"][more.0] = more.1;
        case
    };
    let sliding = || ("sliding", json!("finite"));
    let why = refusal(&case(false, sliding()));
    assert!(why.contains("contacts.floor.fluid_pressure: of bodies needs a `pore_fluid` of body `ground`"), "{why}");
    let why = refusal(&case(true, ("wear", json!(1e-6))));
    assert!(why.contains("leave out dilatancy and wear"), "{why}");
    let why = refusal(&case(true, ("fluid_pressure", json!("of_body"))));
    assert!(
        why.contains("contacts.floor.fluid_pressure") && why.contains("`of_body` is not one of the variables"),
        "{why}"
    );
    let warnings = model(&case(true, sliding())).warnings().join("\n");
    assert!(!warnings.contains("depends on the total pressure"), "{warnings}");
    // Written with all defaults it is the same.
    let text = case(true, sliding()).to_string();
    let parsed = fecontact::case::from_text(&text, std::path::Path::new("test.json")).expect("well formed");
    assert_eq!(serde_json::to_value(&parsed).expect("JSON")["contacts"]["floor"]["fluid_pressure"], "of_bodies");
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
