//! Contact of rings and plates against closed forms: patches, a sphere pressed on an elastic half-space with and without
//! friction, shrink fits.

use std::f64::consts::PI;

use crate::common::{Blocks, Finished, close, finish, half_way, quadratic};
use fecontact::laws::friction::{FrictionParameters, Regime, Sliding};
use fecontact::model::state::State;
use serde_json::{Value, json};

const E: f64 = 200.0;
const NU: f64 = 0.3;

fn body(model: &str) -> Value {
    json!({"material": {"model": model, "E": E, "nu": NU}})
}

/// Two cylinders of one material and radius 1.5 on each other, of n elements along the radius, pressed by σ on smooth planes.
fn cylinders(section: &Value, n: [usize; 2], contact: &Value, sigma: f64, model: &str, refined: bool) -> Finished {
    let bent = |s: f64, t: f64| s + 0.12 * (PI * s).sin() * t * (1.0 - t);
    let mesh = Blocks::default()
        .block("lower", [n[0], 2], |s, t| [1.5 * bent(s, t), t - 1.0])
        .block("upper", [n[1], 2], |s, t| [1.5 * bent(s, t), t])
        .json();
    let mesh = if refined { quadratic(&mesh, half_way) } else { mesh };
    let mut contact = contact.clone();
    let more = json!({"slave": "upper_bottom", "master": "lower_top", "friction": {"law": "coulomb", "mu": 0.5}});
    contact.as_object_mut().expect("keys").extend(more.as_object().expect("keys").clone());
    finish(&json!({
        "section": section, "mesh": mesh, "bodies": {"lower": body(model), "upper": body(model)},
        "contacts": {"interface": contact}, "newton": {"tolerance": 1e-12},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 1},
                   "supports": [{"on": "lower_bottom", "uy": 0}, {"on": "lower_left", "ux": 0}, {"on": "upper_left", "ux": 0}],
                   "loads": [{"on": "upper_top", "traction": {"y": -sigma}}]}]
    }))
}

/// The total force against σ times the area, and σ_yy and σ_xx at all quadrature points against −σ and 0, as shares of σ.
fn errors_of_patch(run: &Finished, sigma: f64, area: f64) -> [f64; 2] {
    let state = run.last();
    let [normal, _] = run.contact_force(state);
    let mut worst = 0.0f64;
    for (e, element) in run.model.mesh.elements.iter().enumerate() {
        let u: Vec<nalgebra::Vector2<f64>> = element
            .nodes
            .iter()
            .map(|&k| nalgebra::Vector2::new(state.displacement[2 * k], state.displacement[2 * k + 1]))
            .collect();
        let material = &*run.model.bodies[run.model.body_of_element[e]].material;
        for stress in run.model.solids[e].stresses(material, &[], &u).expect("stresses") {
            worst = worst.max((stress.yy + sigma).abs() / sigma).max(stress.xx.abs() / sigma);
        }
    }
    [(normal / (sigma * area) - 1.0).abs(), worst]
}

/// Uniform pressure passes through contacts of rings and of plates: exactly by mortar on meshes that do not match, linear and
/// quadratic, in finite and small sliding; and at nodes or Gauss points where nodes face nodes.
#[test]
fn uniform_pressure_passes_through_rings_and_plates() {
    let (sigma, mut failed) = (0.02, Vec::new());
    for (section, area) in
        [(json!("axisymmetric"), PI * 1.5 * 1.5), (json!({"plane_stress": {"thickness": 0.4}}), 0.4 * 1.5)]
    {
        for (n, method, sliding, refined) in [
            ([5, 7], "mortar", "finite", false),
            ([7, 5], "mortar", "finite", false),
            ([5, 7], "mortar", "small", false),
            ([3, 4], "mortar", "finite", true),
            ([5, 5], "node_to_segment", "finite", false),
            ([5, 5], "node_to_segment", "small", false),
            ([5, 5], "gauss_to_segment", "finite", false),
            ([5, 5], "gauss_to_segment", "small", false),
        ] {
            let run = cylinders(&section, n, &json!({"method": method, "sliding": sliding}), sigma, "linear", refined);
            let [force, stress] = errors_of_patch(&run, sigma, area);
            // The force by the tolerance of Newton's method, the stress by round-off.
            if force > 1e-8 || stress > 1e-10 {
                failed.push(format!("{section} {n:?} {method} {sliding}: force {force:.1e}, stress {stress:.1e}"));
            }
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// A rigid sphere of radius R pressed by δ into an elastic half-space: a = √(Rδ), p = (2 E* a/(πR)) √(1 − r²/a²), P = 4/3 E* a δ, with
/// E* = E/(1 − ν²) (Hertz). The half-space ends at 500 a, which takes 0.2 % of δ.
fn sphere(contact: &Value, [fine, rows]: [usize; 2]) -> Finished {
    let (radius, delta, far) = (50.0, 0.02, 500.0);
    // Evenly to 1.5, then ever larger.
    let graded = |s: f64| {
        let (even, q) = (0.5, 1.5f64);
        if s <= even { q * s / even } else { q * (far / q).powf((s - even) / (1.0 - even)) }
    };
    let mesh = Blocks::default().block("ground", [fine, rows], |s, t| [graded(s), -graded(1.0 - t)]).json();
    let mut contact = contact.clone();
    let more = json!({"slave": "ground_top",
                      "master": {"circle": {"centre": [0.0, radius], "radius": radius}}});
    contact.as_object_mut().expect("keys").extend(more.as_object().expect("keys").clone());
    finish(&json!({
        "section": "axisymmetric", "mesh": mesh, "bodies": {"ground": body("linear")},
        "contacts": {"interface": contact},
        "steps": [{"name": "press", "duration": 1, "dt": {"initial": 0.1, "max": 0.1},
                   "supports": [{"on": "ground_bottom", "ux": 0, "uy": delta}, {"on": "ground_right", "ux": 0, "uy": delta}]}]
    }))
}

#[test]
fn a_sphere_on_a_half_space_is_hertzs() {
    let star = E / (1.0 - NU * NU);
    let (radius, delta) = (50.0f64, 0.02);
    let a = (radius * delta).sqrt();
    for method in ["gauss_to_segment", "mortar", "node_to_segment"] {
        let contact = json!({"method": method, "friction": {"law": "frictionless"}, "normal": {"alpha_n": 1e5 * E}});
        let run = sphere(&contact, [220, 100]);
        let state = run.last();
        let [force, _] = run.contact_force(state);
        let closed = state.contacts[0].iter().filter(|point| point.friction.pressure > 0.0);
        let area: f64 = closed.clone().map(|point| point.length).sum();
        let highest = closed.map(|point| point.friction.pressure).fold(0.0, f64::max);
        let p_0 = 2.0 * star * a / (PI * radius);
        println!(
            "{method}: P {:.4}, a {:.4}, p_0 {:.4}",
            force / (4.0 / 3.0 * star * a * delta),
            (area / PI).sqrt() / a,
            highest / p_0
        );
        close("force", force / (4.0 / 3.0 * star * a * delta), 1.0, 0.01);
        close("radius", (area / PI).sqrt() / a, 1.0, 0.01);
        close("pressure", highest / p_0, 1.0, 0.01);
        let x = run.model.configuration(&state.displacement);
        for (slave, point) in run.model.contacts[0].points.iter().zip(&state.contacts[0]) {
            let r = slave.at(&x).x;
            let exact = p_0 * (1.0 - (r / a).powi(2)).max(0.0).sqrt();
            if r < 0.9 * a {
                close(&format!("{method} at {r}"), point.friction.pressure, exact, 0.015 * p_0);
            }
        }
    }
}

/// Spence: under a rigid sphere (or punch) pressed with friction, a disk of radius c sticks for good,
///
/// ```text
/// (a/2c) ln((a + c)/(a − c)) = (μ/β) K(√(1 − c²/a²)),   β = (1 − 2ν)/(2 (1 − ν))
/// ```
/// whatever the load. Spence (1975), J. Elasticity 5, 297.
#[test]
fn a_sphere_with_friction_sticks_in_spences_disk() {
    let mu = 0.15;
    let beta = (1.0 - 2.0 * NU) / (2.0 * (1.0 - NU));
    // K(k) by the arithmetic-geometric mean.
    let elliptic = |k: f64| {
        let (mut a, mut b) = (1.0f64, (1.0 - k * k).sqrt());
        for _ in 0..30 {
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
        }
        0.5 * PI / a
    };
    let excess = |c: f64| 0.5 / c * ((1.0 + c) / (1.0 - c)).ln() - mu / beta * elliptic((1.0 - c * c).sqrt());
    let (mut low, mut high) = (1e-6, 1.0 - 1e-12);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 { low = middle } else { high = middle }
    }
    let exact = 0.5 * (low + high);
    let contact = json!({"method": "gauss_to_segment", "normal": {"alpha_n": 1e5 * E},
                         "friction": {"law": "coulomb", "mu": mu, "alpha_t": 1e5 * E}});
    let run = sphere(&contact, [220, 100]);
    let state = run.last();
    let area = |regime: Regime| -> f64 {
        let pair = &run.model.contacts[0];
        let points = pair.points.iter().zip(&state.contacts[0]);
        points.filter(|(slave, point)| pair.regime(slave, point) == regime).map(|(_, point)| point.length).sum()
    };
    let (stick, slip) = (area(Regime::Stick), area(Regime::Slip));
    let found = (stick / (stick + slip)).sqrt();
    println!("c/a {found:.4}, Spence {exact:.4}");
    close("c/a", found, exact, 0.012);
}

/// A rod of radius a and length l fitted with the overlap δ into a rigid sleeve, which is a plane of the meridian, and pulled
/// out: p (a − w) = E w, w = δ − p/α_n, for ν = 0. While all sticks, the shear lag of the bond q = α_t u has (Cox)
///
/// ```text
/// E a/2 u″ = α_t u,   F = π a² E β u₀ tanh βl,   β² = 2 α_t/(E a)
/// ```
/// but for the shear of the rod itself, O(β²a²/4); and sliding as a whole it bears μ p 2π a l.
#[test]
fn a_press_fit_is_pulled_out_by_the_shear_lag() {
    let (a, l, delta, beta, mu, alpha_n) = (1.0, 10.0, 1e-3, 0.1f64, 0.5, 1e4);
    let alpha_t = 0.5 * beta.powi(2) * E * a;
    for method in ["gauss_to_segment", "mortar", "node_to_segment"] {
        let mesh = Blocks::default().rectangle("rod", [4, 60], [0.0, 0.0], [a, l]).json();
        let run = finish(&json!({
            "section": "axisymmetric", "mesh": mesh,
            "bodies": {"rod": {"material": {"model": "linear", "E": E, "nu": 0}}},
            "contacts": {"fit": {"slave": "rod_right", "master": {"plane": {"point": [a - delta, 0], "normal": [-1, 0]}},
                "method": method, "shrink_fit": true, "normal": {"alpha_n": alpha_n},
                "friction": {"law": "coulomb", "mu": mu, "alpha_t": alpha_t}}},
            "newton": {"tolerance": 1e-10},
            "steps": [
                {"name": "fit", "duration": 1, "dt": {"initial": 0.5}, "supports": [{"on": "rod_top", "uy": 0}]},
                {"name": "pull", "duration": 1, "dt": {"initial": 0.5}, "supports": [{"on": "rod_top", "uy": 0.05}]},
                {"name": "slide", "duration": 1, "dt": {"initial": 0.1}, "supports": [{"on": "rod_top", "uy": 1}]}
            ]
        }));
        // The pressure acts on the squeezed rod, the law of small strains in the one that was.
        let p = (0..60).fold(0.0, |p, _| {
            let squeezed = delta - p / alpha_n;
            E * squeezed / (a - squeezed)
        });
        for point in &run.at(1.0).contacts[0] {
            close(&format!("{method}: p"), point.friction.pressure, p, 1e-9 * p);
        }
        let pull = PI * a * a * E * beta * 0.05 * (beta * l).tanh();
        close(
            &format!("{method}: stuck"),
            run.reaction("rod_top", run.at(2.0))[1] / pull,
            1.0,
            0.25 * (beta * a).powi(2) + 1e-3,
        );
        let slide = mu * p * 2.0 * PI * a * l;
        // The interface is at the radius to which the rod is squeezed, and the rod is stretched.
        close(
            &format!("{method}: slides"),
            run.reaction("rod_top", run.at(3.0))[1] / slide,
            1.0,
            2.0 * p * l / E + 1e-3,
        );
    }
}

/// The pile of `cases/pile.json`, with friction that weakens over 0.2 m instead of 2 mm: the whole shaft comes to its peak before
/// any part has lost much of it, and the pull at the head is the integral of μ_p p over the shaft within 2 %, μ_p being the
/// largest q/p that the law reaches at a steady pressure, driven alone. With the case's own friction the top has lost it all
/// when the toe comes to its peak.
#[test]
fn a_pile_bears_the_integral_over_its_shaft() {
    let path = crate::common::repository("cases/pile.json");
    let case: Value = serde_json::from_str(&std::fs::read_to_string(&path).expect("the case")).expect("JSON");
    let pulled = |kappa: f64| {
        let mut case = case.clone();
        case["contacts"]["shaft"]["friction"]["kappa"] = json!(kappa);
        let run = crate::common::finish_at(&case, &path);
        let pull = |state: &State| run.reaction("pile_head", state)[1];
        let peak = run.states.iter().max_by(|a, b| pull(a).total_cmp(&pull(b))).expect("increments").clone();
        let [normal, tangential] = run.contact_force(&peak);
        // The wall leans a little.
        close("equilibrium", pull(&peak) / tangential.abs(), 1.0, 1e-4);
        let pressed = 2.0 * PI * 0.5 * (5.0 * 10.0 + 4.0 * 100.0);
        close("pressed as at the start", normal / pressed, 1.0, 0.05);
        pull(&peak) / normal
    };
    let alone = |kappa: f64| {
        let mut friction = case["contacts"]["shaft"]["friction"].clone();
        friction["kappa"] = json!(kappa);
        let parameters: FrictionParameters = serde_json::from_value(friction).expect("a law");
        let law = parameters.build(1e6).expect("good parameters");
        let (mut state, mut largest) = (law.initial_state(0.0, 0.0), 0.0f64);
        for _ in 0..4000 {
            let pressure = 45.0;
            state = law.respond(&state, Sliding { slip: 2e-6, pressure, dt: 1e-3 }).expect("an answer").state;
            largest = largest.max(state.traction / pressure);
        }
        largest
    };
    let (slow, fast) = (pulled(5.0), pulled(500.0));
    println!("F/N {slow:.4} of {:.4} in the law; progressive {fast:.4} of {:.4}", alone(5.0), alone(500.0));
    close("peak", slow / alone(5.0), 1.0, 0.02);
    assert!(fast < 0.9 * alone(500.0), "the shaft fails bit by bit: {fast}");
}
