//! Models from JSON, and their runs.

use std::path::Path;
use std::sync::Arc;

use fecontact::case::{self, CaseError};
use fecontact::model::Model;
use fecontact::output::fields::{Fields, Frames, Selection};
use fecontact::output::gradients::Motions;
use fecontact::run::{Saved, Simulation};
use serde_json::{Value, json};

use super::{Blocks, Finished, finished};

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

/// The frames of a model, one every some rows, with exact numbers.
pub fn frames(folder: &Path, model: &Arc<Model>, every: usize) -> Fields {
    let frames = Frames { of: Selection::Rows(every), points: false, exact: true, derived: false };
    Fields::create(folder, model.clone(), &model.initial_state(), frames, Motions::default(), &Default::default())
        .expect("frames")
}

/// A softer block of this length, in halves, that is pushed over a faceted ridge by its top.
pub fn over_a_ridge(height: f64, length: f64, method: &str, friction: Value) -> Value {
    let top = |x: f64| -height * x.abs();
    let block = |s: f64| -0.75 + 0.5 * length * s;
    json!({
        "mesh": Blocks::default()
            .block("ground", [20, 3], |s, t| [2.0 * s - 1.0, -0.5 + t * (0.5 + top(2.0 * s - 1.0))])
            .block("block", [7, 4], |s, t| [block(s), top(block(s)) * (1.0 - t) + 0.4 * t]).json(),
        "bodies": {
            "ground": {"material": {"model": "neo_hookean", "E": 1000, "nu": 0.3}},
            "block": {"material": {"model": "neo_hookean", "E": 100, "nu": 0.3}},
        },
        "contacts": {"base": {"slave": "block_bottom", "master": "ground_top", "method": method, "friction": friction}},
        "steps": [
            {"name": "press", "duration": 1, "dt": {"initial": 0.25},
             "supports": [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "ux": 0, "uy": -0.04}]},
            {"name": "push", "duration": 1, "dt": {"initial": 0.05, "min": 1e-5}, "supports": [{"on": "block_top", "ux": 1}]},
        ],
    })
}
