//! One whole increment of the 5k drag problem, all Newton iterations included: pressing, and full sliding.

use std::path::Path;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use fecontact::case;
use fecontact::linear::Multifrontal;
use fecontact::model::{Model, State};
use fecontact::solve::Workspace;
use fecontact::time::beginning::begin;
use fecontact::time::increment::advance;

fn model() -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases/coulomb_drag_5k.json");
    let case = case::read(&path).expect("a committed case");
    case::build(&case, &path).expect("a committed case")
}

/// The state after `count` increments of 1 of each step so far.
fn reach(model: &Model, work: &mut Workspace, counts: &[usize]) -> State {
    let mut state = model.initial_state();
    for (step, &count) in model.steps.iter().zip(counts) {
        state = begin(model, step, &state, work).expect("the step begins");
        for _ in 0..count {
            state = advance(model, step, &state, 1.0, work).state.expect("the increment converges");
        }
    }
    state
}

fn increments(criterion: &mut Criterion) {
    let model = model();
    let model = Arc::new(model);
    let mut work = Workspace::new(&model, Box::<Multifrontal>::default());
    for (name, counts) in
        [("press, first increment", &[0][..]), ("drag, first increment", &[5, 0]), ("drag, sliding", &[5, 9])]
    {
        let state = reach(&model, &mut work, counts);
        let step = &model.steps[counts.len() - 1];
        let iterations = advance(&model, step, &state, 1.0, &mut work).iterations;
        let label = format!("{name} ({} linear solves)", iterations.len());
        criterion
            .bench_function(&label, |bench| bench.iter(|| advance(&model, step, &state, 1.0, &mut work).state.is_ok()));
    }
}

criterion_group!(benches, increments);
criterion_main!(benches);
