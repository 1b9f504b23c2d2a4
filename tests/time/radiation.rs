//! Radiation damping in static steps: q + η v stands for q.

use crate::common::{Blocks, close, finish, model, refusal};
use serde_json::{Value, json};

/// η A of the slider
const DAMPING: f64 = 6.0;
const SPRING: f64 = 10.0;
const DRIVER: f64 = 0.5;
const DURATION: f64 = 2.0;

/// A point on a plane, pulled by a spring whose other end moves steadily.
fn slider(law: &Value, scheme: &Value, dt: f64) -> Value {
    json!({
        "mesh": {"nodes": [[0, 0]], "points": {"block": [0]}},
        "point_masses": {"block": {"mass": 1}},
        "contacts": {"base": {
            "slave": "block", "area": 2, "master": {"plane": {"point": [0, 0], "normal": [0, 1]}},
            "normal": {"alpha_n": 1000}, "friction": law, "radiation_damping": 3, "initial": {"pressure": 2},
        }},
        "newton": {"tolerance": 1e-13},
        "steps": [{"name": "pull", "duration": DURATION, "scheme": scheme, "dt": {"initial": dt}, "loads": [
            {"on": "block", "force": {"y": "-4"}},
            {"on": "block", "spring": {"kx": SPRING, "driver": {"x": {"rate": DRIVER}}}},
        ]}],
    })
}

/// c ẋ = k (V t − x): x = V (t − T (1 − e^(−t/T))) with T = c/k, and what is radiated, ∫ c ẋ² dt. Increments are backward
/// Euler's, of the first order; the audit is exact for any of them.
#[test]
fn a_spring_pulls_a_damped_slider() {
    let time = DAMPING / SPRING;
    let decay = (-DURATION / time).exp();
    let exact = DRIVER * (DURATION - time * (1.0 - decay));
    let heat = DAMPING * DRIVER * DRIVER * (DURATION - 2.0 * time * (1.0 - decay) + 0.5 * time * (1.0 - decay * decay));
    let errors = [50, 100, 200].map(|count| {
        let dt = DURATION / f64::from(count);
        let run = finish(&slider(&json!({"law": "frictionless"}), &json!("static"), dt));
        let (mut x, mut taken) = (0.0, 0.0);
        for k in 1..=count {
            let new = (DAMPING / dt * x + SPRING * DRIVER * dt * f64::from(k)) / (DAMPING / dt + SPRING);
            taken += DAMPING * (new - x) * (new - x) / dt;
            x = new;
        }
        let last = run.last();
        close("x of backward Euler", last.displacement[0], x, 1e-12);
        close("η v", 2.0 * last.contacts[0][0].radiation, SPRING * (DRIVER * DURATION - x), 1e-11);
        close("energy error", last.energy.error(), 0.0, 1e-12);
        // The mean of the forces at both ends, where the sum above takes that at the end.
        close("radiated", last.energy.radiated, taken, 1.5 * heat / f64::from(count));
        [last.displacement[0] - exact, last.energy.radiated - heat]
    });
    for pair in errors.windows(2) {
        close("order of x", (pair[0][0] / pair[1][0]).log2(), 1.0, 0.1);
        // At the first increment the force comes up at once.
        assert!((pair[0][1] / pair[1][1]).log2() > 0.9, "{errors:?}");
    }
    assert!(errors[2][0].abs() < 2e-3 * exact, "{errors:?}");
}

/// Friction and radiation side by side: steady sliding at the driver's speed under μ p A + η V A.
#[test]
fn friction_is_added() {
    let coulomb = json!({"law": "coulomb", "mu": 0.25, "alpha_t": 1000});
    let mut case = slider(&coulomb, &json!("static"), 0.05);
    case["steps"][0]["duration"] = json!(12);
    let run = finish(&case);
    let last = run.last();
    let force = SPRING * (DRIVER * 12.0 - last.displacement[0]);
    close("force", force, 0.25 * 4.0 + DAMPING * DRIVER, 1e-7);
    close("q", last.contacts[0][0].friction.traction, 0.5, 1e-12);
    close("energy error", last.energy.error(), 0.0, 1e-3 * last.energy.external_work);
}

/// Inertia radiates by itself: in dynamic and explicit steps there is none.
#[test]
fn dynamic_steps_have_none() {
    for scheme in [json!({"newmark": {}}), json!({"explicit": {}})] {
        let case = slider(&json!({"law": "frictionless"}), &scheme, 0.01);
        let mut without = case.clone();
        without["contacts"]["base"].as_object_mut().expect("a contact").remove("radiation_damping");
        let [with, without] = [finish(&case), finish(&without)];
        assert_eq!(with.last().displacement, without.last().displacement, "{scheme}");
        assert_eq!(with.last().energy.radiated, 0.0);
    }
}

/// Two slabs, the upper one dragged over the lower, in units of length, force and time.
fn slabs([l, f, t]: [f64; 3], densities: [f64; 2]) -> Value {
    let at = |x: f64, y: f64| [x * l, y * l];
    let mesh = Blocks::default().rectangle("lower", [4, 2], at(0.0, -1.0), at(2.0, 0.0)).rectangle(
        "upper",
        [4, 2],
        at(0.0, 0.0),
        at(2.0, 1.0),
    );
    let body = |young: f64, density: f64| {
        let density = density * f * t * t / l.powi(4);
        json!({"material": {"model": "linear", "E": young * f / (l * l), "nu": 0.25, "density": density}})
    };
    json!({
        "mesh": mesh.json(),
        "bodies": {"lower": body(1000.0, densities[0]), "upper": body(3000.0, densities[1])},
        "contacts": {"fault": {"slave": "upper_bottom", "master": "lower_top", "friction": {"law": "coulomb", "mu": 0.3},
                               "sliding": "small", "radiation_damping": true,
                               "initial": {"pressure": 4.0 * f / (l * l), "balanced": true}}},
        "steps": [{"name": "drag", "duration": 0.5 * t, "scheme": "static", "dt": {"initial": 0.125 * t}, "supports": [
            {"on": "lower_bottom", "ux": 0, "uy": 0}, {"on": "upper_top", "ux": {"rate": 0.025 * l / t}, "uy": 0},
        ]}],
    })
}

/// By default 1/η = 1/Z₁ + 1/Z₂, Z = √(ρ G): with G = 400 and 1200, ρ = 1 and 3 these are 20 and 60. A rigid master takes no
/// share, and of two bodies alike η = G/(2 c_s).
#[test]
fn the_default_is_that_of_the_bodies() {
    let eta = |case: &Value| model(case).contacts[0].radiation;
    close("different bodies", eta(&slabs([1.0; 3], [1.0, 3.0])), 15.0, 1e-12);
    let mut alike = slabs([1.0; 3], [1.0, 1.0]);
    alike["bodies"]["upper"] = alike["bodies"]["lower"].clone();
    close("alike", eta(&alike), 400.0 / (2.0 * 20.0), 1e-12);
    let mut rigid = slabs([1.0; 3], [1.0, 3.0]);
    rigid["contacts"]["fault"]["master"] = json!({"plane": {"point": [0, 0], "normal": [0, 1]}});
    close("rigid master", eta(&rigid), 60.0, 1e-12);
}

/// What is wrong with a damping is told with its place.
#[test]
fn bad_dampings_are_refused() {
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut case = slabs([1.0; 3], [1.0, 3.0]);
        change(&mut case);
        refusal(&case)
    };
    let message = refused(&|case| case["contacts"]["fault"]["radiation_damping"] = json!(-1));
    assert!(message.contains("contacts.fault.radiation_damping") && message.contains("must be positive"), "{message}");
    let message = refused(&|case| case["bodies"]["upper"]["material"]["density"] = json!(0));
    assert!(
        message.contains("contacts.fault.radiation_damping") && message.contains("density of body `upper`"),
        "{message}"
    );
    let message = refused(&|case| case["contacts"]["fault"]["radiation_damping"] = json!("yes"));
    assert!(message.contains("true, false or a number"), "{message}");
}

/// The forces of a contact count what slip radiates, in sum and node by node, as the reactions do that hold against them:
/// k (V t − x) = (q + η v) A with q = μ p.
#[test]
fn forces_of_a_contact_count_what_slip_radiates() {
    let law = json!({"law": "coulomb", "mu": 0.25, "alpha_t": 1e4});
    let run = finish(&slider(&law, &json!("static"), 0.02));
    let last = run.last();
    let pull = SPRING * (DRIVER * DURATION - last.displacement[0]);
    let pair = &run.model.contacts[0];
    let x = run.model.configuration(&last.displacement);
    let sum = pair.resultant(&last.contacts[0], &x, nalgebra::Vector2::new(0.0, -1.0));
    assert!(last.contacts[0][0].radiation > 0.1, "it slides");
    close("force_x", sum.force.x, -pull, 1e-10);
    close("force_y", sum.force.y, 4.0, 1e-10);
    // About a point one below the plane, and as far behind as the block has come.
    close("moment", sum.moment, last.displacement[0] * 4.0 + (1.0 + last.displacement[1]) * pull, 1e-9);
    let on_node: nalgebra::Vector2<f64> =
        pair.forces_on_nodes(&last.contacts[0], &x).iter().map(|(_, force)| *force).sum();
    close("contact_force", on_node.x, -pull, 1e-10);
}
