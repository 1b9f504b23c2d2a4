//! A case: read, checked, built, told, and tried for a few increments if it is small.
#![no_main]

use std::path::Path;

use fecontact::case::{self, file::MeshSource};
use fecontact::mesh::{InlineMesh, Mesh};
use fecontact::run::Simulation;
use libfuzzer_sys::fuzz_target;

/// What a case finds whose mesh is a file, or blocks.
fn blocks() -> Mesh {
    let blocks = InlineMesh::default().rectangle("ground", [4, 1], [0.0, -1.0], [4.0, 0.0]);
    blocks.rectangle("block", [3, 1], [0.5, 0.0], [3.5, 1.0]).build().expect("a mesh")
}

fuzz_target!(|text: &str| {
    let path = Path::new("case.json");
    let Ok(case) = case::from_text(text, path) else { return };
    let built = match case.mesh {
        MeshSource::Inline(_) => case::build(&case, path),
        MeshSource::File(_) | MeshSource::Blocks(_) => case::build_on(&case, blocks(), path),
    };
    let model = match built {
        Ok(model) => model,
        Err(error) => return assert!(!error.message.trim().is_empty()),
    };
    assert!(!case::report(&case, &model).is_empty());
    if model.dofs() > 100 || model.interval.is_some_and(|interval| interval > 1e-3) {
        return;
    }
    let mut simulation = Simulation::new(model);
    for _ in 0..3 {
        let Ok(Some(candidate)) = simulation.try_increment() else { return };
        assert!(candidate.state().is_none_or(|state| state.displacement.iter().all(|u| u.is_finite())));
        if simulation.apply(candidate).is_err() {
            return;
        }
    }
});
