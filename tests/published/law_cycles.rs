//! Cycles of a fault that obeys super/subloading friction, in quasi-dynamic steps: a half-space above a rigid plane, a patch of which
//! weakens with slip and heals with time between parts that creep.

use std::sync::Arc;

use crate::common::model;

use fecontact::run::Simulation;
use serde_json::{Value, json};

const DAMPING: f64 = 1e4;
/// Rate of the far side, and ten times that: the patch slips.
const LOADING: f64 = 1e-5;
const FAST: f64 = 1e-4;
/// Slip of an event, at least.
const LEAST: f64 = 1e-4;

/// The fault on a number of edges such that the patch ends halfway between two nodes. The process zone, 9π/16 G/(1 − ν) μ_k/(κ (μ_s − μ_k) p),
/// is 0.754 long, of a patch of 3.
fn fault(edges: usize, scheme: &Value, dt: &Value) -> Value {
    assert_eq!(edges % 8, 4);
    json!({
        "mesh": {"blocks": [{
            "body": "rock", "corners": [[-2, 0], [2, 0], [2, 4], [-2, 4]], "elements": [edges, edges / 4], "grading": [1, 6],
            "sides": ["fault", null, "top", null],
        }]},
        "bodies": {"rock": {"material": {"model": "linear", "E": 8000, "nu": 0.25}}},
        "contacts": {"fault": {
            "slave": "fault", "master": {"plane": {"point": [0, 0], "normal": [0, 1]}}, "method": "node_to_segment",
            "normal": {"alpha_n": 1e7}, "sliding": "small", "radiation_damping": DAMPING,
            "friction": {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 1e6, "r": 1e4, "kappa": 100, "xi": 0.002},
            "along": {"law": [
                {"where": "abs(x)-1.5", "friction": {"law": "prescribed", "slip_rate": LOADING, "alpha_t": 1e6}},
            ]},
            "initial": {"pressure": 100, "traction": 20, "balanced": true},
        }},
        "steps": [{"name": "cycles", "duration": 2200, "scheme": scheme, "dt": dt,
            "supports": [{"on": "top", "ux": {"rate": LOADING}, "uy": 0}]}],
    })
}

/// Onsets in the middle of the patch, and slips while it is fast.
fn events(case: &Value) -> Vec<[f64; 2]> {
    let shared = Arc::new(model(case));
    let pair = &shared.contacts[0];
    let place = |k: &usize| shared.mesh.nodes[pair.points[*k].position[0].0][0].abs();
    let middle = (0..pair.points.len()).min_by(|a, b| place(a).total_cmp(&place(b))).expect("a point");
    let mut run = Simulation::new(shared.clone());
    let (mut events, mut before): (Vec<[f64; 2]>, [f64; 3]) = (Vec::new(), [0.0, 0.0, LOADING]);
    let mut begun: Option<[f64; 2]> = None;
    while run.next_increment().unwrap_or_else(|error| panic!("{error}")).is_some() {
        let state = &run.state().contacts[0][middle];
        let now = [run.state().time, state.friction.plastic_slip, (state.radiation / DAMPING).max(1e-12)];
        let share = f64::ln(FAST / before[2]) / f64::ln(now[2] / before[2]);
        let at = [0, 1].map(|i| before[i] + share * (now[i] - before[i]));
        match begun {
            None if before[2] < FAST && now[2] >= FAST => begun = Some(at),
            Some([time, slip]) if now[2] < FAST => {
                // The end of an event may be ragged.
                events.extend((at[1] - slip > LEAST).then_some([time, at[1] - slip]));
                begun = None;
            }
            _ => {}
        }
        before = now;
    }
    println!("{} increments: {events:?}", run.report().increments);
    events
}

fn quasi_dynamic(tolerance: f64) -> Value {
    json!({"quasi_dynamic": {"tolerance": tolerance, "every": 1}})
}

/// Periods and slips of three cycles after the first event.
fn cycles(events: &[[f64; 2]]) -> Vec<[f64; 2]> {
    events.windows(2).take(3).map(|pair| [pair[1][0] - pair[0][0], pair[1][1]]).collect()
}

/// Periods and slips agree, each within a share.
fn agree(some: &[[f64; 2]], others: &[[f64; 2]], share: f64) {
    assert_eq!((some.len(), others.len()), (3, 3));
    for (one, other) in some.iter().zip(others) {
        println!("period {} and {}, slip {} and {}", one[0], other[0], one[1], other[1]);
        assert!((0..2).all(|i| (one[i] / other[i] - 1.0).abs() < share), "{one:?} {other:?}");
    }
}

/// Edges, of which the process zone has eleven or more, and tolerance halved change periods and slips by less than 1 % (a minute).
#[test]
#[ignore = "minutes"]
fn edges_and_tolerance_do_not_matter() {
    let dt = json!({"initial": 0.01});
    let [coarse, fine] = [(60, 4e-6), (124, 2e-6)]
        .map(|(edges, tolerance)| cycles(&events(&fault(edges, &quasi_dynamic(tolerance), &dt))));
    agree(&coarse, &fine, 0.01);
}

/// Static increments with radiation damping on the same mesh come to the same within 0.5 %.
#[test]
#[ignore = "minutes"]
fn static_increments_come_to_the_same() {
    let exact = cycles(&events(&fault(60, &quasi_dynamic(4e-6), &json!({"initial": 0.01}))));
    let dt = json!({"initial": 0.01, "max": 2, "min": 1e-8, "error": 2.5e-7});
    agree(&exact, &cycles(&events(&fault(60, &json!("static"), &dt))), 0.005);
}
