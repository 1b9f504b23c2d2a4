//! Residual, and residual with tangent, of the 20k drag problem in full sliding.

use std::path::Path;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use fecontact::case;
use fecontact::equations::{Assembler, Trial};
use fecontact::linear::Multifrontal;
use fecontact::linear::system::Request;
use fecontact::solve::Workspace;
use fecontact::solve::contact_iteration::ContactIteration;
use fecontact::time::beginning::begin;
use fecontact::time::increment::advance;

fn assembly(criterion: &mut Criterion) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/coulomb_drag_20k.json");
    let case = case::read(&path).expect("a committed case");
    let model = case::build(&case, &path).expect("a committed case");
    let model = Arc::new(model);
    let step = &model.steps[0];
    let mut work = Workspace::new(&model, Box::<Multifrontal>::default());
    let start = begin(&model, step, &model.initial_state(), &mut work).expect("the step begins");
    let state = advance(&model, step, &start, 1.0, &mut work).1.expect("the increment converges");

    let trial = Trial::new(&state, step, 2.0, 1.0);
    let mut assembler = Assembler::new(&model);
    let mut iteration = ContactIteration::default();
    let mut system = assembler.system();
    for (name, request) in [("residual", Request::Residual), ("residual and tangent", Request::Tangent)] {
        criterion.bench_function(&format!("{name}, {} dofs", model.dofs()), |bench| {
            bench.iter(|| {
                iteration.evaluate_all(&mut assembler, trial, &state.displacement, request, &mut system).is_ok()
            });
        });
    }
}

criterion_group!(benches, assembly);
criterion_main!(benches);
