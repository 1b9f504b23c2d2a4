//! The case: JSON of the types from which a model is built ([`crate::model::builder`]) and of what only a file contains
//! ([`mod@file`]); run by [`job`].

mod again;
mod by_name;
pub mod convergence;
mod error;
pub mod file;
mod gradients;
pub mod job;
pub mod law_test;
pub mod loading;
mod measure;
mod read;
mod refined;
mod report;
mod resolved;
pub mod safety;
pub mod safety_trials;
mod schema;
pub mod units;
mod words;

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::mesh::{Mesh, MeshError, Section, gmsh};
use crate::model::builder::{
    Builder, Checked, Contact, FluidPressure, Gauge, ModelError, SectionsInput, check_name, refuse_if,
};
use crate::model::{Measured, Model, PoreField};
pub use again::Opened;
pub use error::CaseError;
use file::{Case, MeshSource, blocks};
pub use refined::{Halvings, refined, refined_on};
pub use report::{report, understood};
pub use resolved::resolved;

/// Reads a case file.
///
/// # Errors
/// Returns [`CaseError`] if the file cannot be read or is not a case.
pub fn read(path: &Path) -> Result<Case, CaseError> {
    Written::read(path).map(|written| written.case)
}

/// Reads a case from its text; `path` is used in messages and for relative paths.
///
/// # Errors
/// The same as for [`read()`].
pub fn from_text(text: &str, path: &Path) -> Result<Case, CaseError> {
    Written::from_text(text, path).map(|written| written.case)
}

/// Reads the mesh of a case, checks everything, and builds the model. `path` is the case file.
///
/// # Errors
/// Returns [`CaseError`] with file, key, value and remedy if the case is invalid.
pub fn build(case: &Case, path: &Path) -> Result<Model, CaseError> {
    let mesh = mesh(case, path).map_err(|complaint| complaint.in_file(path))?;
    build_on(case, mesh, path)
}

/// Builds the model as [`build`], on a mesh in memory.
///
/// # Errors
/// The same as for [`build`].
pub fn build_on(case: &Case, mesh: Mesh, path: &Path) -> Result<Model, CaseError> {
    built(case, mesh, path).map_err(|complaint| complaint.in_file(path))
}

fn built(case: &Case, mesh: Mesh, path: &Path) -> Checked<Model> {
    refuse_if(case.begin_with.is_some(), "begin_with", "another case must be opened first: see case::Opened")?;
    let mut builder = builder(case, mesh)?;
    read_measured(&mut builder, path)?;
    let model = builder.build()?;
    let message = "is 0: must be at least 1 (to write no fields, give \"fields\": false)";
    refuse_if(case.output.every == Some(0), "output.every", message)?;
    if let Some(minutes) = case.output.checkpoint.filter(|minutes| !(*minutes >= 0.0 && minutes.is_finite())) {
        return Err(ModelError::new("output.checkpoint", format!("is {minutes}: must be minutes, or null for none")));
    }
    if let Some(fronts) = case.output.fronts {
        fronts.check()?;
    }
    Ok(model)
}

/// Returns the builder of a case on its mesh.
fn builder(case: &Case, mesh: Mesh) -> Checked<Builder> {
    let mesh = with_groups(case, mesh)?;
    let section = if case.section == Section::PlaneStrain { mesh.section } else { case.section };
    units::check(&case.units, section)?;
    let given = case.clone();
    let contact = |(name, contact)| Contact { name, ..contact };
    let gauge = |(name, gauge)| Gauge { name, ..gauge };
    let sections = |(name, sections)| SectionsInput { name, ..sections };
    Ok(Builder {
        title: given.title,
        bodies: given.bodies.into_iter().collect(),
        point_masses: given.point_masses.into_iter().collect(),
        periodic: given.periodic,
        plates: given.plates,
        rigid_bodies: given.rigid_bodies.into_iter().collect(),
        bars: given.bars.into_iter().collect(),
        contacts: given.contacts.into_iter().map(contact).collect(),
        velocities: given.initial_velocity.into_iter().collect(),
        steps: given.steps,
        watch: given.watch,
        newton: given.newton,
        interval: given.output.interval,
        times: given.output.times,
        gauges: given.probes.into_iter().map(gauge).collect(),
        sections: given.sections.into_iter().map(sections).collect(),
        ..Model::builder(mesh).section(section)
    })
}

/// Reads the tables of measured pressures, relative to the case file.
fn read_measured(builder: &mut Builder, path: &Path) -> Checked<()> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let read = |measured: &mut Measured, place: String| {
        measured.read(folder).map_err(|message| ModelError::new(format!("{place}.measured.file"), message))
    };
    for Contact { name, fluid_pressure, .. } in &mut builder.contacts {
        if let Some(FluidPressure::Measured(measured)) = fluid_pressure {
            read(measured, format!("contacts.{name}.fluid_pressure"))?;
        }
    }
    for (name, body) in &mut builder.bodies {
        if let Some(PoreField::Measured(measured)) = body.pore_pressure.as_mut().map(|given| &mut given.pressure) {
            read(measured, format!("bodies.{name}.pore_pressure.pressure"))?;
        }
    }
    Ok(())
}

/// Warnings about a case before it is run: those of its model, and labels of units that nothing checks.
pub fn warnings(case: &Case, model: &Model) -> Vec<String> {
    model.warnings().into_iter().chain(units::concerns(&case.units, model.mesh.section)).collect()
}

/// The mesh with the groups that the case gives by place.
fn with_groups(case: &Case, mesh: Mesh) -> Checked<Mesh> {
    case.groups.keys().try_for_each(|name| check_name("groups", name))?;
    mesh.with_placed(&case.groups).map_err(|(name, defect)| ModelError::new(format!("groups.{name}"), defect))
}

fn mesh(case: &Case, path: &Path) -> Checked<Mesh> {
    let read = |file: &String| gmsh::read(&path.parent().unwrap_or(Path::new("")).join(file));
    let mesh = match &case.mesh {
        MeshSource::Inline(mesh) => mesh.build(),
        MeshSource::Blocks(blocks) => file::blocks(blocks, "mesh")?.build(),
        MeshSource::File(file) => read(file),
        MeshSource::Files(files) if files.is_empty() => {
            return Err(ModelError::new("mesh", "is an empty list: give the paths of mesh files"));
        }
        MeshSource::Files(files) => files.iter().map(read).collect::<Result<Vec<_>, _>>().and_then(Mesh::join),
    };
    mesh.map_err(|error| match (error, &case.mesh) {
        (MeshError::InTwoMeshes { group, meshes: [first, second] }, MeshSource::Files(files)) => {
            let message =
                format!("the group `{group}` is in {} and in {}: rename it in one", files[first], files[second]);
            ModelError::new(format!("mesh[{second}]"), message)
        }
        (error, _) => ModelError::new("mesh", error),
    })
}

/// Builds a mesh of blocks from the text of `mesh` in a case.
///
/// # Errors
/// Returns [`CaseError`] as [`build`]; the file it names is `mesh`.
pub fn blocks_from_text(text: &str) -> Result<Mesh, CaseError> {
    let path = Path::new("mesh");
    let input = read::read_text(text, path)?;
    let mesh = blocks(&input, "").and_then(|mesh| mesh.build().map_err(|error| ModelError::new("", error)));
    mesh.map_err(|complaint| complaint.in_file(path))
}

/// Returns the JSON Schema of a case file.
pub fn schema() -> Value {
    schema::of_case()
}

/// A case as written in a file or by a program.
#[derive(Clone, Debug)]
pub struct Written {
    /// its file, or a path for messages
    pub path: PathBuf,
    /// the case as JSON, without notes and with each law where it is used
    pub document: Value,
    /// the case
    pub case: Case,
}

impl Written {
    /// Reads a case file.
    ///
    /// # Errors
    /// Returns [`CaseError`] if the file cannot be read or is not a case.
    pub fn read(path: &Path) -> Result<Self, CaseError> {
        let (document, case) = read::read_document(path, by_name::with_laws)?;
        Ok(Self { path: path.to_owned(), document, case })
    }

    /// Reads a case from its text; `path` is used in messages and for relative paths.
    ///
    /// # Errors
    /// The same as for [`Written::read`].
    pub fn from_text(text: &str, path: &Path) -> Result<Self, CaseError> {
        let (document, case) = read::read_document_text(text, path, by_name::with_laws)?;
        Ok(Self { path: path.to_owned(), document, case })
    }
}
