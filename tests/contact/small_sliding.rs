//! Small sliding.

use crate::common::{self, Blocks, Finished, close, distance, finish};
use fecontact::model::state::State;
use serde_json::{Value, json};

fn body(model: &str) -> Value {
    json!({"material": {"model": model, "E": 1000, "nu": 0.3}})
}

fn tractions(state: &State) -> [Vec<f64>; 2] {
    [state.contacts[0].iter().map(|c| c.friction.pressure).collect(), state.contacts[0].iter().map(|c| c.friction.traction).collect()]
}

fn l2(a: &[f64], b: &[f64]) -> f64 {
    let square = |x: f64| x * x;
    let d: f64 = a.iter().zip(b).map(|(a, b)| square(a - b)).sum();
    (d / b.iter().map(|b| square(*b)).sum::<f64>()).sqrt()
}

/// A block with a round bottom (round > 0) pressed by `press`, then slid by d.
fn slid(sliding: &str, round: f64, n: usize, press: f64, d: f64, method: &str) -> Finished {
    let ground = Blocks::default()
        .rectangle("ground", [4 * n, n], [-2.0, -1.0], [2.0, 0.0])
        .block("block", [n + 1, n], |s, t| {
            let x = s - 0.5;
            [x, 0.5 * round * x * x + t * (0.5 - 0.5 * round * x * x)]
        });
    finish(&json!({
        "mesh": ground.json(),
        "bodies": {"ground": body("linear"), "block": body("linear")},
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "method": method, "sliding": sliding,
            "friction": {"law": "coulomb", "mu": 0.3}}},
        "newton": {"tolerance": 1e-10},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.25},
             "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -press}]},
            {"name": "slide", "duration": 1, "dt": {"initial": 0.125}, "supports": [{"on": "block_top", "ux": d}]}
        ]
    }))
}

#[test]
fn experiment_slip() {
    for round in [0.0, 0.3] {
        for n in [8, 16] {
            for method in ["gauss_to_segment", "node_to_segment", "mortar"] {
                for share in [0.05, 0.1, 0.2, 0.5, 1.0] {
                    let d = share / n as f64;
                    let runs = ["finite", "small"].map(|sliding| slid(sliding, round, n, 0.02, d, method));
                    let [a, b] = [0, 1].map(|k: usize| tractions(runs[k].last()));
                    let [fa, fb] = [0, 1].map(|k: usize| runs[k].contact_force(runs[k].last()));
                    let way = runs[0].last().contacts[0].iter().map(|c| c.friction.plastic_slip).fold(0.0, f64::max);
                    let top = |v: &[f64]| v.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                    println!(
                        "round {round} n {n} {method} d/h {share}: slip/h {:.3} p {:.4} max p {:.4} N {:.5} T {:.5} u {:.5}",
                        way * n as f64,
                        l2(&b[0], &a[0]),
                        top(&b[0]) / top(&a[0]) - 1.0,
                        fb[0] / fa[0] - 1.0,
                        fb[1] / fa[1] - 1.0,
                        l2(&runs[1].last().displacement, &runs[0].last().displacement),
                    );
                }
            }
        }
    }
}
