//! Models from JSON, and their runs.

use std::path::Path;
use std::sync::Arc;

use fecontact::case::{self, CaseError};
use fecontact::model::Model;
use fecontact::run::{Saved, Simulation};
use serde_json::Value;

use super::{Finished, finished};

/// The model of a case whose mesh is found from a path, or why it is refused. It is read as text, which the library does itself:
/// a value would make every program of tests compile the reading of cases anew.
pub fn built(case: &Value, path: &Path) -> Result<Model, CaseError> {
    case::from_text(&case.to_string(), path).and_then(|case| case::build(&case, path))
}

/// Why a case is refused.
pub fn refusal(case: &Value) -> String {
    built(case, Path::new("test.json")).map(drop).expect_err("it is refused").to_string()
}

/// The model of a case.
pub fn model(case: &Value) -> Model {
    model_at(case, Path::new("test.json"))
}

/// The model of a case whose mesh is found from a path.
pub fn model_at(case: &Value, path: &Path) -> Model {
    built(case, path).unwrap_or_else(|error| panic!("{error}"))
}

/// Run a case to its end.
pub fn finish(case: &Value) -> Finished {
    finish_at(case, Path::new("test.json"))
}

/// Run a case whose mesh is found from a path.
pub fn finish_at(case: &Value, path: &Path) -> Finished {
    finished(model_at(case, path))
}

/// A run of a case that is stopped after so many increments, and read from what was written, goes on to the bits of the whole one.
pub fn goes_on(case: &Value, whole: &Finished, increments: usize) {
    let model = Arc::new(model(case));
    let mut run = Simulation::new(model.clone());
    for _ in 0..increments {
        run.next_increment().expect("it runs");
    }
    let bytes = run.save().bytes().expect("it can be written");
    let mut run = Simulation::resume(model.clone(), Saved::from_bytes(&bytes, &model).expect("it can be read"));
    while run.next_increment().expect("it runs").is_some() {}
    assert!(run.state() == whole.last(), "a resumed run has other bits");
}
