//! Residual, and residual with tangent, of the 20k drag problem in full sliding; and of the same bodies where they yield throughout.

use std::path::Path;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use fecontact::case;
use fecontact::equations::{Assembler, Trial, TrialFailure};
use fecontact::laws::bulk::MaterialParameters;
use fecontact::linear::Multifrontal;
use fecontact::linear::system::Request;
use fecontact::model::Model;
use fecontact::solve::Workspace;
use fecontact::solve::contact_iteration::ContactIteration;
use fecontact::time::beginning::begin;
use fecontact::time::increment::advance;

/// Strengths far below the stresses of the dragged block.
const YIELDING: [&str; 3] = [
    r#"{"model": "von_mises", "E": 1000, "nu": 0.3, "sigma_y": 1e-6, "H": 100}"#,
    r#"{"model": "drucker_prager", "E": 1000, "nu": 0.3, "c": 1e-6, "phi": 20, "psi": 10, "matching": "compression"}"#,
    r#"{"model": "mohr_coulomb", "E": 1000, "nu": 0.3, "c": 1e-6, "phi": 20, "psi": 10}"#,
];

fn assembly(criterion: &mut Criterion) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases/coulomb_drag_20k.json");
    let mut case = case::read(&path).expect("a committed case");
    let model = Arc::new(case::build(&case, &path).expect("a committed case"));
    let step = &model.steps[0];
    let mut work = Workspace::new(&model, Box::<Multifrontal>::default());
    let start = begin(&model, step, &model.initial_state(), &mut work).expect("the step begins");
    let state = advance(&model, step, &start, 1.0, &mut work).state.expect("the increment converges");
    measure(criterion, "neo_hookean", &model, Trial::new(&state, step, 2.0, 1.0), &state.displacement);

    for law in YIELDING {
        let material: MaterialParameters = serde_json::from_str(law).expect("a law");
        case.bodies.iter_mut().for_each(|(_, body)| body.material = material.clone().into());
        let model = Arc::new(case::build(&case, &path).expect("a model"));
        let mut work = Workspace::new(&model, Box::<Multifrontal>::default());
        let start = begin(&model, &model.steps[0], &model.initial_state(), &mut work).expect("the step begins");
        let name = law.split('"').nth(3).expect("its name");
        measure(criterion, name, &model, Trial::new(&start, &model.steps[0], 1.0, 1.0), &state.displacement);
    }
}

fn measure(criterion: &mut Criterion, law: &str, model: &Arc<Model>, trial: Trial, displacement: &[f64]) {
    let mut assembler = Assembler::new(model);
    let mut iteration = ContactIteration::default();
    let mut system = assembler.system();
    let mut evaluate = |request| -> Result<(), TrialFailure> {
        let responses = iteration.respond(&mut assembler, trial, displacement, request)?;
        assembler.assemble(trial, displacement, responses, request, &mut system)?;
        assembler.measure(trial, displacement, &mut system);
        if request == Request::Tangent {
            iteration.note(model, displacement, trial.old);
        }
        Ok(())
    };
    // A tangent follows a residual, whichever of the two is measured.
    evaluate(Request::Residual).expect("a residual");
    for (name, request) in [("residual", Request::Residual), ("residual and tangent", Request::Tangent)] {
        criterion.bench_function(&format!("{law}: {name}, {} dofs", model.dofs()), |bench| {
            bench.iter(|| evaluate(request).is_ok());
        });
    }
}

criterion_group!(benches, assembly);
criterion_main!(benches);
