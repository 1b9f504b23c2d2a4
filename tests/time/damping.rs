//! Damping of bodies: decay of vibrations and waves by closed forms, the tangent by differences, the stable increment.

use crate::common::{Blocks, Finished, close, distance, finish, refusal};
use fecontact::laws::bulk::{Material, MaterialParameters};
use fecontact::mesh::{ElementKind, Section};
use fecontact::model::element::{Formulation, SolidElement};
use fecontact::model::state::Energy;
use nalgebra::{Complex, DMatrix, Rotation2, Vector2};
use serde_json::{Value, json};

const MODELS: [&str; 4] = ["linear", "saint_venant_kirchhoff", "neo_hookean", "hencky"];

fn material(model: &str) -> Box<dyn Material> {
    let given = json!({"model": model, "E": 7.0, "nu": 0.3, "density": 1.0});
    let parameters: MaterialParameters = serde_json::from_value(given).expect("well formed");
    parameters.build().expect("in range")
}

/// A distorted Q4 element, and nodal vectors of a size that are all different.
fn element() -> (SolidElement, [Vector2<f64>; 4]) {
    let positions = [[0.0, 0.0], [1.1, 0.1], [1.3, 0.9], [-0.1, 1.2]].map(Vector2::from);
    (
        SolidElement::new(ElementKind::Q4, Formulation::Displacement, Section::PlaneStrain, &positions)
            .expect("a good element"),
        positions,
    )
}

fn vectors(size: f64, phase: f64) -> Vec<Vector2<f64>> {
    (0..4).map(|a| size * Vector2::new((1.7 * a as f64 + phase).sin(), (2.9 * a as f64 - phase).cos())).collect()
}

fn viscous_forces(material: &dyn Material, u: &[Vector2<f64>], v: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut forces = vec![Vector2::zeros(); 4];
    element().0.viscous_forces(material, 0.3, [u, v], &mut forces);
    forces
}

#[test]
fn the_viscous_tangent_equals_differences() {
    let dvelocity = [3.0, 1.0, 0.0, 2.0, 5.0, -1.0, 4.0, 0.5];
    for model in MODELS {
        let material = material(model);
        let (u, v) = (vectors(0.2, 0.3), vectors(1.5, 1.1));
        let mut tangent = vec![0.0; 64];
        element().0.viscous_tangent(&*material, 0.3, [&u, &v], &dvelocity, &mut tangent);
        let scale = tangent.iter().fold(0.0f64, |scale, k| scale.max(k.abs()));
        for (dof, dvelocity) in dvelocity.iter().enumerate() {
            let moved = |h: f64| {
                let (mut u, mut v) = (u.clone(), v.clone());
                u[dof / 2][dof % 2] += h;
                v[dof / 2][dof % 2] += h * dvelocity;
                viscous_forces(&*material, &u, &v)
            };
            let (ahead, behind) = (moved(1e-5), moved(-1e-5));
            for row in 0..8 {
                let difference = (ahead[row / 2][row % 2] - behind[row / 2][row % 2]) / 2e-5;
                close(&format!("{model}, {row}, {dof}"), tangent[row + 8 * dof], difference, 1e-8 * scale);
            }
        }
    }
}

#[test]
fn a_viscous_stress_takes_energy_and_does_not_resist_rotation() {
    let (_, positions) = element();
    for model in MODELS {
        let material = material(model);
        let (u, v) = (vectors(0.2, 0.3), vectors(1.5, 1.1));
        let power: f64 = viscous_forces(&*material, &u, &v).iter().zip(&v).map(|(f, v)| f.dot(v)).sum();
        assert!(power > 0.1, "{model}: {power}");
        // Turned by 50° and turning on; small strains know small rotations only.
        let angle = if model == "linear" { 0.0 } else { 0.87 };
        let turn = Rotation2::new(angle);
        let turned: Vec<_> = positions.iter().zip(&u).map(|(x, u)| turn * (x + u) - x).collect();
        let turning: Vec<_> = positions.iter().zip(&turned).map(|(x, u)| Vector2::new(-(x + u).y, (x + u).x)).collect();
        if model != "linear" {
            let largest = viscous_forces(&*material, &turned, &turning).iter().fold(0.0f64, |m, f| m.max(f.norm()));
            assert!(largest < 1e-12, "{model}: {largest}");
        }
        // In the turned frame everything else is the same.
        let turned_v: Vec<_> = v.iter().map(|v| turn * v).collect();
        let expected = viscous_forces(&*material, &u, &v);
        for (turned, f) in viscous_forces(&*material, &turned, &turned_v).iter().zip(expected) {
            close(model, (turned - turn * f).norm(), 0.0, 1e-12);
        }
    }
}

fn damped(mass: f64, stiffness: f64) -> Value {
    json!({"material": {"model": "linear", "E": 3, "nu": 0, "density": 1}, "damping": {"mass": mass, "stiffness": stiffness}})
}

/// A one-element bar pulled out by 1e-3 in a static step, then let go. Its consistent mass is L/3, its lumped mass L/2.
fn let_go(body: &Value, scheme: &Value, dt: f64) -> Finished {
    finish(&json!({
        "mesh": Blocks::default().rectangle("bar", [1, 1], [0.0, 0.0], [1.0, 1.0]).json(),
        "bodies": {"bar": body},
        "steps": [
            {"name": "pull", "duration": 1, "dt": {"initial": 1},
             "supports": [{"on": "bar", "uy": 0}, {"on": "bar_left", "ux": 0}],
             "loads": [{"on": "bar_right", "force": {"x": 1.5e-3}}]},
            {"name": "free", "duration": 4, "dt": {"initial": dt}, "scheme": scheme,
             "loads": [{"on": "bar_right", "force": {"x": "0"}}]},
        ],
        "output": {"interval": 0.1},
    }))
}

#[test]
fn a_vibration_decays_at_rayleigh_s_ratio() {
    // u = u₀ e^{−ζωt} (cos ω_d t + ζω/ω_d sin ω_d t), ζ = (η/ω + τω)/2
    for (mass, stiffness) in [(0.4, 0.0), (0.0, 0.08), (0.3, 0.05)] {
        for (scheme, omega, dt) in [
            (json!({"newmark": {}}), 3.0, 0.005),
            (json!({"hht": {"alpha": -0.1}}), 3.0, 0.005),
            (json!({"generalized_alpha": {}}), 3.0, 0.005),
            (json!({"wilson": {}}), 3.0, 0.005),
            (json!({"explicit": {}}), f64::sqrt(6.0), 0.001),
        ] {
            let run = let_go(&damped(mass, stiffness), &scheme, dt);
            let free = 2 * run.nodes("bar_right")[0];
            let zeta = 0.5 * (mass / omega + stiffness * omega);
            let (decay, swing) = (zeta * omega, omega * f64::sqrt(1.0 - zeta * zeta));
            for state in run.states.iter().filter(|state| state.time > 1.0) {
                let t = state.time - 1.0;
                let expected = 1e-3 * f64::exp(-decay * t) * ((swing * t).cos() + decay / swing * (swing * t).sin());
                let what = format!("{scheme}, mass {mass}, stiffness {stiffness}, t = {t}");
                close(&what, state.displacement[free], expected, 2e-3 * 1e-3);
            }
            let energy = &run.last().energy;
            assert!(energy.damping_dissipation > 0.5 * energy.external_work, "{energy:?}");
            close(&format!("{scheme}, energy"), energy.error(), 0.0, 2e-3 * energy.external_work);
        }
    }
}

#[test]
fn a_wave_is_attenuated_as_the_complex_wave_number_says() {
    // ρ (ω² − iηω) = E (1 + iωτ) k²: the amplitude falls by e^{−Im k} a length. One end swings, the other absorbs.
    let (omega, speed) = (12.0, f64::sqrt(3.0));
    for (mass, stiffness) in [(0.6, 0.0), (0.0, 0.006), (0.4, 0.004)] {
        let ratio = Complex::new(1.0, -mass / omega) / Complex::new(1.0, omega * stiffness);
        let k = ratio.sqrt() * (omega / speed);
        for (scheme, dt) in [(json!({"explicit": {}}), 1.0), (json!({"newmark": {}}), 0.004)] {
            let run = finish(&json!({
                "mesh": Blocks::default().rectangle("bar", [240, 1], [0.0, 0.0], [6.0, 0.1]).json(),
                "bodies": {"bar": damped(mass, stiffness)},
                "steps": [{
                    "name": "swing", "duration": 8.0, "scheme": scheme, "dt": {"initial": dt},
                    "supports": [{"on": "bar", "uy": 0}, {"on": "bar_left", "ux": format!("0.001*(1-exp(0-t*t))*sin({omega}*t)")}],
                    "loads": [{"on": "bar_right", "absorbing": true}],
                }],
                "output": {"interval": 0.02},
            }));
            let amplitude = |x: f64| {
                let nodes = run.nodes("bar_bottom").into_iter();
                let node = nodes.min_by(|a, b| {
                    let off = |node: usize| (run.model.mesh.nodes[node].x - x).abs();
                    off(*a).total_cmp(&off(*b))
                });
                let dof = 2 * node.expect("nodes");
                let late = run.states.iter().filter(|state| state.time > 6.5);
                late.fold(0.0f64, |most, state| most.max(state.displacement[dof].abs()))
            };
            let [near, far] = [1.0, 4.0].map(amplitude);
            let expected = f64::exp(3.0 * k.im);
            let what = format!("{scheme}, mass {mass}, stiffness {stiffness}: attenuation");
            close(&what, far / near, expected, 0.01 * expected);
            assert!(expected < 0.6, "{expected}");
            let energy = &run.last().energy;
            close(&format!("{scheme}, energy"), energy.error(), 0.0, 0.01 * energy.external_work);
        }
    }
}

/// A free square of distorted elements, struck, at the limit of stability.
fn square(model: &str, stiffness: f64, duration: f64) -> Value {
    let distorted = |s: f64, t: f64| [s + 0.05 * (3.0 * t).sin() * s, t + 0.04 * (5.0 * s).sin() * t];
    json!({
        "mesh": Blocks::default().block("block", [6, 5], distorted).json(),
        "bodies": {"block": {
            "material": {"model": model, "E": 100.0, "nu": 0.3, "density": 2.0}, "damping": {"stiffness": stiffness},
        }},
        "initial_velocity": {"block": [0.3, -0.2]},
        "steps": [{
            "name": "swing", "duration": duration, "scheme": {"explicit": {"safety": 1.0}},
            "dt": {"initial": 1.0},
            "loads": [{"on": "block_bottom", "spring": {"kx": 300.0, "ky": 500.0}}],
        }],
        "output": {"interval": duration / 4.0},
    })
}

#[test]
fn the_stable_increment_of_a_viscous_body_is_a_close_bound() {
    for stiffness in [0.001, 0.01, 0.1] {
        let run = finish(&square("linear", stiffness, 0.04));
        let dt = run.last().dt;
        let model = &run.model;
        let n = model.dofs();
        let (mut elastic, mut mass) = (DMatrix::<f64>::zeros(n, n), vec![0.0; n]);
        for (e, element) in model.mesh.elements.iter().enumerate() {
            let (mut force, mut tangent) = (vec![0.0; 8], vec![0.0; 64]);
            let material = &*model.bodies[0].material;
            let still = [Vector2::zeros(); 4];
            model.solids[e].force_and_tangent(material, &still, &mut force, &mut tangent).expect("an answer");
            let dofs: Vec<usize> = element.nodes.iter().flat_map(|&node| [2 * node, 2 * node + 1]).collect();
            let lumped = model.element_lumped_mass(e);
            for (i, &row) in dofs.iter().enumerate() {
                mass[row] += lumped[i / 2];
                dofs.iter().enumerate().for_each(|(j, &column)| elastic[(row, column)] += tangent[i + 8 * j]);
            }
        }
        let viscous = stiffness * &elastic;
        for spring in &model.steps[0].loads.springs {
            elastic[(spring.dof, spring.dof)] += spring.stiffness;
        }
        // Stable while the largest eigenvalue of M⁻¹ (Δt² K + 2 Δt C) is at most 4.
        let fastest = |dt: f64| {
            let sum = dt * dt * &elastic + 2.0 * dt * &viscous;
            DMatrix::from_fn(n, n, |i, j| sum[(i, j)] / f64::sqrt(mass[i] * mass[j])).symmetric_eigenvalues().max()
        };
        assert!(fastest(dt) <= 4.0, "{stiffness}: {dt}");
        // Equal increments fill the time to the output: one fewer would have been too long for the bound.
        let count = (0.01 / dt).round();
        assert!(fastest(0.01 / (count - 1.0) / 0.7) > 4.0, "{stiffness}: {dt} is too short");
    }
}

#[test]
fn viscous_bodies_are_stable_at_the_limit_and_the_audit_closes() {
    for model in ["linear", "neo_hookean"] {
        for stiffness in [0.001, 0.05] {
            let run = finish(&square(model, stiffness, 2.0));
            assert!(run.report.increments > 200, "{}", run.report.increments);
            let energy = &run.last().energy;
            let allowed = if model == "linear" { 1e-9 } else { 0.005 };
            close(model, energy.error(), 0.0, allowed * energy.initial);
            assert!(energy.damping_dissipation > 0.005 * energy.initial, "{energy:?}");
            assert!(energy.kinetic + energy.strain < energy.initial, "{energy:?}");
        }
    }
}

#[test]
fn free_flight_is_damped_by_the_masses_alone() {
    for scheme in [json!({"newmark": {}}), json!({"explicit": {}})] {
        let run = finish(&json!({
            "mesh": Blocks::default().rectangle("bar", [2, 2], [0.0, 0.0], [1.0, 1.0]).json(),
            "bodies": {"bar": damped(0.7, 0.02)},
            "initial_velocity": {"bar": [2.0, -1.0]},
            "steps": [{"name": "fly", "duration": 2, "dt": {"initial": 0.01}, "scheme": scheme}],
        }));
        let state = run.last();
        close("v", state.velocity[0], 2.0 * f64::exp(-1.4), 1e-4);
        close("u", state.displacement[1], -(1.0 - f64::exp(-1.4)) / 0.7, 1e-4);
        close("energy", state.energy.error(), 0.0, 1e-4 * state.energy.initial);
    }
}

#[test]
fn damping_is_checked() {
    let refused = |density: f64, damping: Value, words: &str| {
        let case = json!({
            "mesh": Blocks::default().rectangle("bar", [1, 1], [0.0, 0.0], [1.0, 1.0]).json(),
            "bodies": {"bar": {"material": {"model": "linear", "E": 3, "nu": 0, "density": density}, "damping": damping}},
            "steps": [{"name": "hold", "duration": 1, "supports": [{"on": "bar", "ux": 0, "uy": 0}]}],
        });
        let error = refusal(&case);
        assert!(error.contains(words), "{error}");
    };
    refused(1.0, json!({"mass": -1.0}), "bodies.bar.damping.mass: is -1: must be zero or positive");
    refused(1.0, json!({"stiffness": -1e-3}), "bodies.bar.damping.stiffness");
    refused(0.0, json!({"mass": 1.0}), "give material.density");
    refused(1.0, json!({"stifness": 1.0}), "stifness");
}

/// Stress between two equal bars that meet, over ρ c v/2: its mean and its scatter in the middle half of the contact, and how
/// often the contact opens. The contact is ten times as stiff as an element.
fn impact(stiffness: f64) -> [f64; 3] {
    let (n, c) = (100, 2.0);
    let h = 0.5 / n as f64;
    let body = json!({
        "material": {"model": "linear", "E": c * c, "nu": 0, "density": 1}, "damping": {"stiffness": stiffness * h / c},
    });
    let blocks = Blocks::default().rectangle("left", [n, 1], [-0.5, 0.0], [0.0, h]).rectangle(
        "right",
        [n, 1],
        [0.0, 0.0],
        [0.5, h],
    );
    let run = finish(&json!({
        "mesh": blocks.json(),
        "bodies": {"left": body, "right": body},
        "initial_velocity": {"left": [1e-3, 0]},
        "contacts": {"ends": {
            "slave": "left_right", "master": "right_left", "normal": {"alpha_n": 10.0 * c * c / h},
            "friction": {"law": "frictionless"},
        }},
        "steps": [{"name": "hit", "duration": 0.6, "scheme": {"explicit": {}}, "dt": {"initial": 1},
                   "supports": [{"on": "left", "uy": 0}, {"on": "right", "uy": 0}]}],
        "output": {"interval": 5e-4},
    }));
    let stress = |state| run.contact_force(state)[0] / (h * c * 1e-3 / 2.0);
    let middle: Vec<f64> = run.states.iter().filter(|state| (0.125..0.375).contains(&state.time)).map(stress).collect();
    let mean = middle.iter().sum::<f64>() / middle.len() as f64;
    let scatter = (middle.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / middle.len() as f64).sqrt();
    let openings = run.states.windows(2).filter(|pair| stress(&pair[0]) > 0.0 && stress(&pair[1]) == 0.0).count();
    [mean, scatter, openings as f64]
}

#[test]
fn a_stiff_impact_rattles_in_an_elastic_body_and_not_in_a_viscous_one() {
    // The mass of half an element between its element and the contact swings as fast as nothing else in the mesh, so that
    // nothing takes its energy away: the mean is right and the contact opens again and again.
    let [mean, scatter, openings] = impact(0.0);
    println!("elastic: mean {mean}, scatter {scatter}, {openings} openings");
    close("mean stress", mean, 1.0, 0.02);
    assert!(scatter > 0.5 && openings > 20.0, "{scatter}, {openings}: nothing to cure");
    let [mean, scatter, openings] = impact(0.2);
    println!("viscous: mean {mean}, scatter {scatter}, {openings} openings");
    close("mean stress", mean, 1.0, 0.002);
    assert!(scatter < 0.01 && openings <= 10.0, "{scatter}, {openings}");
}

/// A block whose nodes all follow a shear that comes at once and is held: what the supports must put on its top is
/// (G γ + (G₁ γ + (λ₁/2 + G₁) γ³) e^(−t/τ)) × length, in the frames too. An attempt that is dropped leaves no trace, and energies
/// add up.
#[test]
fn a_held_shear_relaxes_in_a_whole_run() {
    let (gamma, young, nu, share, tau) = (0.3f64, 100.0, 0.25, 1.5, 2.0);
    let (lambda, shear) = (young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * young / (1.0 + nu));
    let material = json!({"model": "viscoelastic", "E": young, "nu": nu, "E_1": share * young, "tau": tau});
    let supports = json!([{"on": "bar", "ux": format!("{gamma}*y*min(1, t/1e-9)"), "uy": 0}]);
    for element in ["displacement", "f_bar"] {
        let run = finish(&json!({
            "mesh": Blocks::default().rectangle("bar", [3, 2], [0.0, 0.0], [3.0, 2.0]).json(),
            "bodies": {"bar": {"material": material, "element": element}},
            "newton": {"tolerance": 1e-12},
            "steps": [
                {"name": "shear", "duration": 1e-9, "dt": {"initial": 1e-9}, "supports": supports},
                {"name": "hold", "duration": 8, "dt": {"initial": 0.5}},
            ],
        }));
        let arm = share * (shear * gamma + (0.5 * lambda + shear) * gamma.powi(3));
        for state in &run.states {
            let expected = 3.0 * (shear * gamma + arm * (-state.time / tau).exp());
            close("force on the top", run.reaction("bar_top", state)[0], expected, 1e-7 * expected);
        }
        let Energy { damping_dissipation, strain, external_work, .. } = run.last().energy;
        // The work of a step of shear counts by the mean of its two ends, which is right for the linear part alone.
        close("stored and dissipated", strain + damping_dissipation, external_work, 0.05 * external_work);
        let lost: f64 = run.states.windows(2).map(|pair| pair[0].energy.strain - pair[1].energy.strain).sum();
        let heat = damping_dissipation - run.states[0].energy.damping_dissipation;
        close("held, the arm's energy turns to heat", heat, lost, 1e-9 * lost);
        assert!(lost > 0.1 * external_work);
    }
}

/// A bar that is set swinging, with a Maxwell arm: implicit and explicit increments come to the same displacements, and all of
/// the energy is accounted for.
#[test]
fn a_swinging_viscoelastic_bar_loses_what_its_arm_dissipates() {
    let swing = |scheme: Value, dt: Value| {
        finish(&json!({
            "mesh": Blocks::default().rectangle("bar", [4, 1], [0.0, 0.0], [4.0, 1.0]).json(),
            "bodies": {"bar": {"material": {
                "model": "viscoelastic", "E": 100, "nu": 0.25, "E_1": 100, "tau": 0.5, "density": 1}}},
            "newton": {"tolerance": 1e-10},
            "output": {"interval": 0.5},
            "steps": [{"name": "swing", "duration": 2, "scheme": scheme, "dt": dt,
                       "supports": [{"on": "bar_left", "ux": 0, "uy": 0}],
                       "loads": [{"on": "bar_right", "traction": {"x": "min(1, 4*t)", "y": 0}}]}],
        }))
    };
    let implicit = swing(json!({"newmark": {}}), json!({"initial": 0.002}));
    let explicit = swing(json!({"explicit": {"safety": 0.1}}), json!({"initial": 0.1}));
    for (run, share) in [(&implicit, 1e-5), (&explicit, 1e-4)] {
        let energy = &run.last().energy;
        assert!(energy.damping_dissipation > 0.3 * energy.external_work, "{energy:?}");
        assert!(energy.error().abs() < share * energy.external_work, "{energy:?}");
    }
    let (a, b) = (implicit.last(), explicit.last());
    let size = a.displacement.iter().fold(0.0f64, |most, u| most.max(u.abs()));
    // One has consistent masses and one lumped ones, on four elements.
    close("displacement", distance(&a.displacement, &b.displacement) / size, 0.0, 0.05);
}
