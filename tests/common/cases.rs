//! Models from JSON, and their runs.

use std::path::Path;

use fecontact::case;
use fecontact::model::Model;
use serde_json::Value;

use super::{Finished, finished};

/// The model of a case.
pub fn model(case: &Value) -> Model {
    model_at(case, Path::new("test.json"))
}

/// The model of a case whose mesh is found from a path.
pub fn model_at(case: &Value, path: &Path) -> Model {
    let parsed = serde_json::from_value(case.clone()).unwrap_or_else(|error| panic!("{error}"));
    case::build(&parsed, path).unwrap_or_else(|error| panic!("{error}"))
}

/// Run a case to its end.
pub fn finish(case: &Value) -> Finished {
    finish_at(case, Path::new("test.json"))
}

/// Run a case whose mesh is found from a path.
pub fn finish_at(case: &Value, path: &Path) -> Finished {
    finished(model_at(case, path))
}
