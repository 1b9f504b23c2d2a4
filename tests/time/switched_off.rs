//! Under error control the increments of a dynamic step follow from the motion: they are the same with an aid switched
//! off, as long as each increment is solved.

use crate::common::Blocks;
use crate::common::{self, close};
use fecontact::model::aids::Aids;
use fecontact::model::state::State;
use fecontact::run::Simulation;
use serde_json::{Value, json};

/// A slender block on a ground of linear bodies, pressed and set in motion along it, until it slips; most nodes are away from the
/// contact, so that the bodies are condensed.
fn slipping() -> Value {
    let linear = json!({"material": {"model": "linear", "E": 1000, "nu": 0.3, "density": 1.0}});
    json!({
        "mesh": Blocks::default()
            .rectangle("ground", [8, 8], [0.0, -1.0], [4.0, 0.0])
            .rectangle("block", [4, 8], [1.0, 0.0], [3.0, 1.0]).json(),
        "bodies": {"ground": linear, "block": linear},
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "sliding": "small", "friction":
            {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.3, "r": 2000, "kappa": 50, "xi": 0.02}}},
        "newton": {"tolerance": 1e-9},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.5},
             "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.01}]},
            {"name": "drag", "duration": 1, "scheme": {"generalized_alpha": {"rho_infinity": 0.8}},
             "dt": {"initial": 0.005, "min": 1e-7, "max": 0.05, "error": 1e-5}, "supports": [{"on": "block_top", "ux": {"rate": 0.02}}]},
        ],
    })
}

/// States of the dynamic step, and in how many iterations the bodies were condensed.
fn states(off: impl Fn(&mut Aids)) -> (Vec<State>, usize) {
    let mut model = common::model(&slipping());
    off(&mut model.aids);
    let (mut states, mut condensed) = (Vec::new(), 0);
    for increment in Simulation::new(model) {
        let increment = increment.expect("it is solved");
        condensed += increment.iterations.iter().map(|iteration| iteration.acted.condense).sum::<usize>();
        states.push(State::clone(&increment.state));
    }
    states.retain(|state| state.time > 1.0);
    (states, condensed)
}

/// Switches an aid off.
type Switch = fn(&mut Aids);

#[test]
fn aids_switched_off_leave_the_same_increments_and_states() {
    let (with, condensed) = states(|_| {});
    assert!(condensed > 100, "condensed in {condensed} iterations");
    let slipped = with.last().expect("states").contacts[0].iter().all(|point| point.friction.plastic_slip.abs() > 1e-3);
    assert!(slipped && with.len() > 40, "{} increments, slipped: {slipped}", with.len());
    // Without others, such as `stick`, some of its increments have no solution and are cut.
    let switches: [(&str, Switch); 4] = [
        ("condense", |aids| aids.condense = false),
        ("old_tangents", |aids| aids.old_tangents = false),
        ("start", |aids| aids.start = false),
        ("downhill", |aids| aids.downhill = false),
    ];
    for (aid, off) in switches {
        let (without, condensed) = states(off);
        assert!(aid != "condense" || condensed == 0);
        assert_eq!(with.len(), without.len(), "increments without {aid}");
        for (a, b) in with.iter().zip(&without) {
            close(&format!("time without {aid}"), b.time, a.time, 1e-12);
            let apart = common::distance(&a.displacement, &b.displacement);
            assert!(apart < 1e-7, "displacements without {aid} at {}: {apart:e} apart", a.time);
        }
    }
}
