//! States and their files: any number of variables; tangents that come first; runs that are cut back.

use crate::common::{self, Blocks, close, finish};
use fecontact::equations::{Assembler, Trial};
use fecontact::laws::friction::FrictionState;
use fecontact::linear::system::Request;
use fecontact::model::state::State;
use fecontact::solve::contact_iteration::ContactIteration;
use serde_json::{Value, json};

/// μ, the one variable of the super/subloading law.
fn mu_of(state: &FrictionState) -> f64 {
    state.variables[0]
}

/// A block pressed on a ground, then dragged a third of its length; the friction law weakens and heals.
fn dragged(method: &str, dt: f64, max_iterations: usize) -> Value {
    json!({
        "mesh": Blocks::default()
            .rectangle("ground", [20, 3], [0.0, -0.6], [4.0, 0.0])
            .rectangle("block", [7, 3], [1.0, 0.0], [2.0, 0.6]).json(),
        "bodies": {
            "ground": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
            "block": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
        },
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "method": method, "normal": {"alpha_n": 67308}, "friction":
            {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "r": 200, "kappa": 5, "xi": 0.02, "structure": 1.5}}},
        "newton": {"max_iterations": max_iterations},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.25},
             "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.02}]},
            {"name": "drag", "duration": 1, "dt": {"initial": dt, "min": 1e-6},
             "supports": [{"on": "block_top", "ux": 0.3}]},
        ],
    })
}

/// Largest difference of displacements, tractions and pressures, each relative to the largest of its kind.
fn difference(a: &State, b: &State) -> f64 {
    type Values = fn(&State) -> Vec<f64>;
    let kinds: [Values; 4] = [
        |s| s.displacement.clone(),
        |s| s.contacts.concat().iter().map(|c| c.friction.traction).collect(),
        |s| s.contacts.concat().iter().map(|c| c.friction.pressure).collect(),
        |s| s.contacts.concat().iter().map(|c| mu_of(&c.friction)).collect(),
    ];
    kinds.iter().fold(0.0, |largest, values| {
        let (a, b) = (values(a), values(b));
        let scale = a.iter().fold(0.0f64, |m, a| m.max(a.abs()));
        largest.max(common::distance(&a, &b) / scale)
    })
}

/// A tangent that is asked for before any residual predicts nothing: its residual is that of the equations.
#[test]
fn a_tangent_may_come_first() {
    let run = finish(&dragged("gauss_to_segment", 0.05, 25));
    let (old, new, step) = (&run.states[13], &run.states[14], &run.model.steps[1]);
    let trial = Trial::new(old, step, new.time, new.dt);
    let [residual, beside_tangent] = [Request::Residual, Request::Tangent].map(|request| {
        let mut assembler = Assembler::new(&run.model);
        let mut system = assembler.system();
        let mut iteration = ContactIteration::default();
        let responses = iteration.respond(&mut assembler, trial, &new.displacement, request).expect("an answer");
        assembler.assemble(trial, &new.displacement, responses, request, &mut system).expect("an answer");
        system.residual
    });
    assert!(residual == beside_tangent);
}

/// A state remembers as many variables as a law sets, whatever their order; those never set are 0.
#[test]
fn a_state_remembers_any_number_of_variables() {
    let mut state = FrictionState::default().with_variables([1.0, 2.0]);
    state.variables[40] = 40.0;
    state.variables[3] = 3.0;
    state.variables[4] += 4.0;
    let read: FrictionState = serde_json::from_str(&serde_json::to_string(&state).unwrap()).unwrap();
    assert_eq!(read, state);
    let set = [(0, 1.0), (1, 2.0), (3, 3.0), (4, 4.0), (40, 40.0)];
    for k in 0..50 {
        let expected = set.iter().find(|(index, _)| *index == k).map_or(0.0, |(_, value)| *value);
        assert_eq!(read.variables[k], expected, "variable {k}");
    }
}

/// A run cut back from one large increment meets the time-stepping error of one of small increments from the start:
/// against increments of 1/80 the tractions differ by 0.5 % of the largest (by 0.26 % between 1/10 and the cut-back run).
#[test]
fn a_cut_back_run_agrees_with_small_steps() {
    let cut = finish(&dragged("gauss_to_segment", 1.0, 5));
    let small = finish(&dragged("gauss_to_segment", 0.0125, 25));
    assert!(cut.report.cutbacks > 0 && small.report.cutbacks == 0);
    close("difference", difference(cut.last(), small.last()), 0.0, 0.01);
}
