//! Two unequal slabs with a fault between them, and how far two runs of them are apart.

use serde_json::{Value, json};

use crate::common::{Blocks, with};

/// Two unequal slabs with a fault between them, node facing node, the upper one twice as fine in height and pulled to the right; `more` is added
/// to the contact.
pub fn slabs(scheme: &Value, duration: f64, more: &Value) -> Value {
    let mesh = Blocks::default().rectangle("lower", [12, 3], [0.0, -1.5], [6.0, 0.0]).rectangle(
        "upper",
        [12, 4],
        [0.0, 0.0],
        [6.0, 1.0],
    );
    let body = |young: f64| json!({"material": {"model": "linear", "E": young, "nu": 0.25, "density": 1e-6}});
    let fault = with(
        json!({
            "slave": "upper_bottom", "master": "lower_top", "method": "node_to_segment", "sliding": "small",
            "normal": {"alpha_n": 4000}, "radiation_damping": 0.02,
            "friction": {"law": "rate_and_state", "f_0": 0.6, "V_0": 1e-3, "a": 0.012, "b": 0.010, "D_c": 2e-3, "theta": 20, "alpha_t": 4000},
            "initial": {"pressure": "2 + 0.1*x", "traction": 1.1, "balanced": true},
        }),
        more,
    );
    json!({
        "mesh": mesh.json(),
        "bodies": {"lower": body(200.0), "upper": body(120.0)},
        "contacts": {"fault": fault},
        "newton": {"tolerance": 1e-12},
        "steps": [{"name": "shear", "duration": duration, "scheme": scheme, "dt": {"initial": 1e-3}, "supports": [
            {"on": "lower_bottom", "ux": 0, "uy": 0}, {"on": "upper_top", "ux": {"rate": 1e-4}, "uy": 0},
        ]}],
    })
}

/// Largest difference of two faults in each quantity of their points, over its largest value.
pub fn differences<const N: usize>(a: &[[f64; N]], b: &[[f64; N]]) -> [f64; N] {
    std::array::from_fn(|i| {
        let largest = a.iter().fold(0.0f64, |most, a| most.max(a[i].abs()));
        a.iter().zip(b).fold(0.0f64, |most, (a, b)| most.max((a[i] - b[i]).abs())) / largest
    })
}
