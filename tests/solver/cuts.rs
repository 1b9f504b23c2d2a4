//! Normal force, shear force and bending moment at sections across bodies, against closed forms of beams.

use crate::common::{Finished, close, finish, refusal};
use fecontact::model::state::State;
use fecontact::output::sections::{SectionForces, along};
use serde_json::{Value, json};

/// A beam from (0, 0) to (L, 0), of height h, under pressure p on its top.
const LONG: f64 = 4.0;
const HIGH: f64 = 0.2;

fn beam(kind: &str, elements: [usize; 2], number: Value) -> Value {
    let half = 0.5 * HIGH;
    json!({
        "mesh": {"blocks": [{"body": "beam", "corners": [[0, -half], [LONG, -half], [LONG, half], [0, half]], "elements": elements, "kind": kind,
            "sides": ["bottom", "right", "top", "left"], "points": {"one": [0, 0], "other": [LONG, 0]}}]},
        "bodies": {"beam": {"material": {"model": "linear", "E": 1e6, "nu": 0.2}}},
        "sections": {"cut": {"body": "beam", "from": [0, 0], "to": [LONG, 0], "number": number}},
        "steps": [{"name": "load", "duration": 1, "dt": {"initial": 1}}]
    })
}

fn cut(run: &Finished, state: &State) -> Vec<SectionForces> {
    along(&run.model.requests.sections[0], &run.model, state)
}

/// A cantilever under a pressure, and a force at its end: M = −p (L − x)²/2 − F (L − x), Q = p (L − x) + F, N = the pull at its end. At lines of
/// the mesh to round-off, with any kind of element, however coarse: the forces are in equilibrium.
#[test]
fn a_cantilever_has_its_moments() {
    let [p, force, pull] = [3.0, 2.0, 5.0];
    for (kind, elements) in [("Q4", [16, 2]), ("Q8", [8, 1]), ("T6", [8, 2])] {
        let mut case = beam(kind, elements, Value::Null);
        case["steps"][0]["supports"] = json!([{"on": "left", "ux": 0, "uy": 0}]);
        case["steps"][0]["loads"] = json!([{"on": "top", "dead_pressure": p}, {"on": "right", "traction": {"x": pull / HIGH, "y": -force / HIGH}}]);
        let run = finish(&case);
        let found = cut(&run, run.last());
        assert_eq!(found.len(), elements[0] + 1);
        for (k, SectionForces { place, axial_force, shear_force, moment }) in found.iter().enumerate() {
            let rest = LONG - place.x;
            // At the free end the pressure of half an element acts at the cut; where it is held, all acts but that of the first.
            let share = if [0.0, LONG].contains(&place.x) { 0.5 * p * LONG / elements[0] as f64 } else { 0.0 };
            close(&format!("{kind} N {k}"), *axial_force, pull, 1e-7);
            close(&format!("{kind} Q {k}"), *shear_force, p * rest + force, share + 1e-7);
            close(
                &format!("{kind} M {k}"),
                *moment,
                -0.5 * p * rest * rest - force * rest,
                1e-8 * p * LONG * LONG + share * HIGH,
            );
        }
    }
}

/// A beam on two supports under a pressure: M = p x (L − x)/2. Between the lines of the mesh a station is off by p d²/2 at most, d being its
/// distance from the cut.
#[test]
fn a_beam_on_two_supports_sags() {
    for (kind, elements) in [("Q4", [40, 2]), ("Q8", [20, 1]), ("T6", [20, 2])] {
        let mut case = beam(kind, elements, json!(33));
        case["steps"][0]["supports"] = json!([{"on": "one", "ux": 0, "uy": 0}, {"on": "other", "uy": 0}]);
        case["steps"][0]["loads"] = json!([{"on": "top", "dead_pressure": 3}]);
        let run = finish(&case);
        let h = LONG / elements[0] as f64;
        for SectionForces { place, moment, shear_force, .. } in cut(&run, run.last()) {
            let expected = 1.5 * place.x * (LONG - place.x);
            close(&format!("{kind} M at {}", place.x), moment, expected, 1.5 * h * h + 1e-9);
            close(&format!("{kind} Q at {}", place.x), shear_force, 3.0 * (0.5 * LONG - place.x), 3.0 * h + 1e-9);
        }
        let greatest = cut(&run, run.last()).iter().map(|of| of.moment).fold(0.0, f64::max);
        close("p L²/8", greatest, 3.0 * LONG * LONG / 8.0, 1.5 * h * h);
    }
}

/// A cantilever bent to a quarter of a circle by a couple at its end, and carried away by a turn: M is the couple everywhere, N = Q = 0. Under
/// a dead force at its end, what its ends bear: M = F (x_end − x) with the places by then.
#[test]
fn large_rotations_turn_the_axis() {
    let mut case = beam("Q8", [20, 1], Value::Null);
    case["bodies"]["beam"]["material"] = json!({"model": "saint_venant_kirchhoff", "E": 1e6, "nu": 0});
    case["steps"][0]["dt"] = json!({"initial": 0.1});
    case["steps"][0]["supports"] = json!([{"on": "left", "ux": 0, "uy": 0}]);
    let inertia = HIGH.powi(3) / 12.0;
    let force = 4.0 * 1e6 * inertia / (LONG * LONG);
    case["steps"][0]["loads"] = json!([{"on": "right", "traction": {"y": -force / HIGH}}]);
    let run = finish(&case);
    let state = run.last();
    let end = run.nodes("other")[0];
    let tip = LONG + state.displacement[2 * end];
    assert!(state.displacement[2 * end + 1] < -0.5 * LONG, "{:?}", &state.displacement[2 * end..2 * end + 2]);
    let found = cut(&run, state);
    for (k, SectionForces { place, axial_force, shear_force, moment }) in found.iter().enumerate() {
        let near = (0..run.model.mesh.nodes.len()).find(|&node| (run.model.mesh.nodes[node] - place).norm() < 1e-9);
        close(&format!("|F| at {k}"), axial_force.hypot(*shear_force), force, 1e-6 * force);
        if let Some(node) = near {
            let x = place.x + state.displacement[2 * node];
            close(&format!("M at {k}"), *moment, -force * (tip - x), 2e-3 * force * LONG);
        }
    }
    // The end hangs down: it is pulled.
    let last = &found[found.len() - 2];
    assert!(last.axial_force > 0.8 * force, "{last:?}");
}

/// N, Q and M are those of the beam, wherever it lies: moved far, turned, and in other units; seen in a mirror the other side of the axis is pulled.
#[test]
fn sections_are_objective() {
    let found = |angle: f64, origin: f64, mirrored: bool, [length, stress]: [f64; 2]| {
        let side = if mirrored { -1.0 } else { 1.0 };
        let direction = |[x, y]: [f64; 2]| {
            let y = side * y;
            [angle.cos() * x - angle.sin() * y, angle.sin() * x + angle.cos() * y]
        };
        let at = |point: [f64; 2]| direction(point).map(|x| length * (x + origin));
        let half = 0.5 * HIGH;
        let mut corners = [[0.0, -half], [LONG, -half], [LONG, half], [0.0, half]].map(at).to_vec();
        let mut sides = ["bottom", "right", "top", "left"].to_vec();
        if mirrored {
            corners.swap(0, 3);
            corners.swap(1, 2);
            sides.swap(0, 2);
        }
        let [pull, push] = direction([5.0 / HIGH, -2.0 / HIGH]).map(|traction| stress * traction);
        let run = finish(&json!({
            "mesh": {"blocks": [{"body": "beam", "corners": corners, "elements": [16, 2], "kind": "Q8", "sides": sides}]},
            "bodies": {"beam": {"material": {"model": "neo_hookean", "E": 1e6 * stress, "nu": 0.2}}},
            "sections": {"cut": {"body": "beam", "from": at([0.0, 0.0]), "to": at([LONG, 0.0])}},
            "newton": {"tolerance": 1e-11},
            "steps": [{"name": "load", "duration": 1, "dt": {"initial": 1}, "supports": [{"on": "left", "ux": 0, "uy": 0}],
                "loads": [{"on": "top", "dead_pressure": 3.0 * stress}, {"on": "right", "traction": {"x": pull, "y": push}}]}]
        }));
        let forces = cut(&run, run.last());
        let canonical = |of: &SectionForces| {
            let force = length * stress;
            [of.axial_force / force, side * of.shear_force / force, side * of.moment / (force * length)]
        };
        forces.iter().map(canonical).collect::<Vec<_>>()
    };
    let plain = found(0.0, 0.0, false, [1.0, 1.0]);
    assert!(plain.len() == 17 && plain[0][2].abs() > 30.0);
    for (name, other) in [
        ("moved", found(0.0, 1e3, false, [1.0, 1.0])),
        ("turned", found(2.2, 0.0, false, [1.0, 1.0])),
        ("mirrored", found(0.0, 0.0, true, [1.0, 1.0])),
        ("in mm and MPa", found(0.4, 0.0, true, [1e3, 1e-6])),
    ] {
        for (k, (plain, other)) in plain.iter().zip(&other).enumerate() {
            for (what, (plain, other)) in ["N", "Q", "M"].iter().zip(plain.iter().zip(other)) {
                close(&format!("{name}: {what} {k}"), *other, *plain, 1e-6 * 30.0);
            }
        }
        assert_eq!(plain.len(), other.len());
    }
}

/// Sections of a body that is not there are blank; what cannot be meant is refused with its place.
#[test]
fn bad_sections_are_refused() {
    let with = |sections: Value| {
        let mut case = beam("Q4", [8, 2], Value::Null);
        case["sections"] = json!({"cut": sections});
        case["steps"][0]["supports"] = json!([{"on": "left", "ux": 0, "uy": 0}]);
        refusal(&case)
    };
    for (given, fragment) in [
        (json!({"body": "bean", "from": [0, 0], "to": [4, 0]}), "sections.cut.body"),
        (json!({"body": "beam", "from": [0, 0], "to": [0, 0]}), "sections.cut.to: is (0, 0), the start of the axis"),
        (json!({"body": "beam", "from": [0, 0], "to": [5, 0]}), "sections.cut: (5, 0) lies outside of `beam`"),
        (json!({"body": "beam", "from": [0, 0], "to": [4, 0], "number": 1}), "sections.cut.number: is 1"),
    ] {
        let said = with(given);
        assert!(said.contains(fragment), "{said}");
    }
}
