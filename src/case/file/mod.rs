//! The case file as it is written: JSON types, with the text that the schema shows.

mod contact;
mod drive;
mod load;
mod output;
mod place;
mod step;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

pub use contact::{
    CircleInput, ContactInput, InitialInput, MasterInput, NormalInput, PlaneInput, PolylineInput, ProfileInput,
    ProfileTable, RigidInput, SlidingInput,
};
pub use drive::{Components, DriveInput, TimeInput};
pub use load::{DashpotInput, LoadInput, SpringInput};
pub use output::{FrontsInput, OutputInput};
pub use place::{NodeInput, Place};
pub use step::{IncrementsInput, RotationInput, RuptureInput, StepInput, SupportInput};

use crate::case::choice::Choice;
use crate::laws::bulk::MaterialParameters;
use crate::mesh::InlineMesh;
use crate::model::NewtonSettings;

/// A case: mesh, bodies, contacts and steps.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// What the case shows, in a line
    #[serde(default)]
    pub title: String,
    /// Labels of the units used, for readers; any consistent set will do
    #[serde(default)]
    pub units: BTreeMap<String, String>,
    /// Path of a gmsh MSH 4.1 file relative to the case file, or a small mesh given in place
    pub mesh: MeshSource,
    /// Bodies by the name of their mesh group
    #[serde(default)]
    pub bodies: BTreeMap<String, BodyInput>,
    /// Point masses by the name of a mesh group: a mass at each of its nodes
    #[serde(default)]
    pub point_masses: BTreeMap<String, PointMassInput>,
    /// Periodic sides: pairs of groups whose nodes lie alike. What leaves by one side comes in by the other: each node
    /// moves as its partner does, and what acts on one acts on both
    #[serde(default)]
    pub periodic: Vec<[String; 2]>,
    /// Contacts by a name of your choice
    #[serde(default)]
    pub contacts: BTreeMap<String, ContactInput>,
    /// Initial velocity [x, y] of whole bodies
    #[serde(default)]
    pub initial_velocity: BTreeMap<String, [f64; 2]>,
    /// Steps, one after the other
    pub steps: Vec<StepInput>,
    /// Folder of results, or checkpoint, of a case that has come to its end, relative to this file: this case begins there.
    /// Mesh, bodies and contacts must be the same but for the parameters of friction and damping. The steps follow on those
    /// of that case: supports, loads and time go on from there; energies are counted anew
    pub begin_with: Option<String>,
    /// Groups whose mean displacement and reaction go to the history
    #[serde(default)]
    pub watch: Vec<String>,
    /// When Newton's method stops
    #[serde(default)]
    pub newton: NewtonInput,
    /// What is written
    #[serde(default)]
    pub output: OutputInput,
}

/// A mesh file or a mesh in place.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum MeshSource {
    /// Path relative to the case file
    File(String),
    /// Mesh in place
    Inline(InlineMesh),
}

impl<'de> Deserialize<'de> for MeshSource {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "the path of a mesh file, or a mesh {\"nodes\": …, \"elements\": …, \"edges\": …}";
        Choice { expecting, number: None, text: Self::File, object: Self::Inline }.read(deserializer)
    }
}

/// A body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyInput {
    /// Bulk law
    pub material: MaterialParameters,
    /// Element formulation
    #[serde(default)]
    pub element: Formulation,
    /// Damping of the body in dynamic steps; none unless given
    #[serde(default)]
    pub damping: DampingInput,
}

/// Rayleigh damping. A vibration of angular frequency w decays with the damping ratio (mass/w + stiffness w)/2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DampingInput {
    /// Force per momentum: damps slow motions most, free flight included [1/T]
    pub mass: f64,
    /// Kelvin-Voigt: viscous stress, this time times the elastic stress of the rate of strain; damps fast vibrations most,
    /// and makes explicit increments shorter [T]
    pub stiffness: f64,
}

/// How the elements of a body are integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Formulation {
    /// Displacements only, full integration
    #[default]
    Displacement,
    /// Q4 with the mean dilatation of the centre (F-bar): does not lock for ν → 1/2
    FBar,
}

/// A mass at every node of a group.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointMassInput {
    /// Mass of each node, added to what a body has there [M]
    pub mass: f64,
    /// Initial velocity [x, y] of the nodes [L/T]
    pub velocity: Option<[f64; 2]>,
}

/// When Newton's method stops.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct NewtonInput {
    /// Out-of-balance force relative to the forces at work
    pub tolerance: f64,
    /// Linear solves an increment before it is cut
    pub max_iterations: usize,
}

impl Default for NewtonInput {
    fn default() -> Self {
        let NewtonSettings { tolerance, max_iterations } = NewtonSettings::default();
        Self { tolerance, max_iterations }
    }
}
