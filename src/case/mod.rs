//! The case: JSON as written, translated to the builder of a model ([`crate::model::builder`]).

mod again;
mod choice;
mod error;
mod explain;
pub mod file;
pub mod law_test;
mod read;
mod report;
mod schema;
mod translate;

pub use again::Opened;
pub use error::CaseError;
pub use report::report;

use std::path::Path;

use serde_json::Value;

use crate::mesh::{Mesh, gmsh};
use crate::model::Model;
use error::{Checked, Complaint};
use file::{Case, MeshSource};

/// Read a case file.
///
/// # Errors
/// [`CaseError`] when the file cannot be read or is not a case.
pub fn read(path: &Path) -> Result<Case, CaseError> {
    read::read(path)
}

/// Read the mesh of a case, check everything, and build the model. `path` is the case file.
///
/// # Errors
/// [`CaseError`] names file, key, value and what to do.
pub fn build(case: &Case, path: &Path) -> Result<Model, CaseError> {
    let mesh = mesh(case, path).map_err(|complaint| complaint.in_file(path))?;
    build_on(case, mesh, path)
}

/// As [`build`], on a mesh at hand.
///
/// # Errors
/// As [`build`].
pub fn build_on(case: &Case, mesh: Mesh, path: &Path) -> Result<Model, CaseError> {
    built(case, mesh).map_err(|complaint| complaint.in_file(path))
}

fn built(case: &Case, mesh: Mesh) -> Checked<Model> {
    if case.begin_with.is_some() {
        return Err(Complaint::new("begin_with", "another case must be opened first: see case::Opened"));
    }
    let model = translate::model(case, mesh)?.build()?;
    if case.output.every == 0 {
        let message = "is 0: must be at least 1 (to write no fields, give \"fields\": false)";
        return Err(Complaint::new("output.every", message));
    }
    if let Some(minutes) = case.output.checkpoint.filter(|minutes| !(*minutes >= 0.0 && minutes.is_finite())) {
        return Err(Complaint::new("output.checkpoint", format!("is {minutes}: must be minutes, or null for none")));
    }
    match case.output.fronts.filter(|fronts| !(fronts.slip_rate > 0.0 && fronts.slip_rate.is_finite())) {
        Some(fronts) => {
            Err(Complaint::new("output.fronts.slip_rate", format!("is {}: must be positive", fronts.slip_rate)))
        }
        None => Ok(model),
    }
}

fn mesh(case: &Case, path: &Path) -> Checked<Mesh> {
    let mesh = match &case.mesh {
        MeshSource::Inline(mesh) => mesh.build(),
        MeshSource::File(file) => gmsh::read(&path.parent().unwrap_or(Path::new("")).join(file)),
    };
    mesh.map_err(|error| Complaint::new("mesh", error))
}

/// The JSON Schema of a case file.
pub fn schema() -> Value {
    schema::schema_of::<Case>()
}
