//! The case file as it is written: JSON types, with the text that the schema shows.
//!
//! Damping as it is written.
//!
//! What the plane stands for.
//!
//! Loading plates as they are written.

mod blocks;
mod output;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use crate::case::choice::Choice;
use crate::laws::bulk::MaterialParameters;
use crate::mesh::InlineMesh;
use crate::model::builder::{Contact, LoadStep};
use crate::model::imposed::{InitialStress, Thermal};
use crate::model::{Damping, NewtonSettings};
pub use blocks::{Amount, BlockInput, BlocksInput, GradingInput, MeshInPlace, MiddleInput};
pub use output::{ArrivalInput, FrontsInput, OutputInput, ProbeInput};

/// A case: mesh, bodies, contacts and steps.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// What the case shows, in a line
    #[serde(default)]
    pub title: String,
    /// Labels of the units used, for readers; any consistent set will do
    #[serde(default)]
    pub units: BTreeMap<String, String>,
    /// Path of a gmsh MSH 4.1 file relative to the case file, or a mesh given in place: as blocks that are divided into elements, or
    /// node by node
    pub mesh: MeshSource,
    /// What the plane stands for in space: "plane_strain", a plate {"plane_stress": {"thickness": …}}, or "axisymmetric"
    #[serde(default)]
    pub section: SectionInput,
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
    /// Loading plates: groups whose nodes all move alike, as if glued to a rigid plate that does not turn. A support, force, spring
    /// or dashpot on one of its nodes acts on the whole plate once, a `total_force` on its group as well. Its reaction counts in the
    /// watched groups that all of the plate belongs to. In axisymmetry a plate keeps its radius, ux = 0. Other plates say how they
    /// `moves`: only one component alike, or as a rigid body that turns
    #[serde(default)]
    pub plates: Vec<LoadingPlateInput>,
    /// Contacts by a name of your choice
    #[serde(default)]
    pub contacts: BTreeMap<String, Contact>,
    /// Initial velocity [x, y] of whole bodies; supported nodes keep to their supports
    #[serde(default)]
    pub initial_velocity: BTreeMap<String, [f64; 2]>,
    /// Steps, one after the other
    pub steps: Vec<LoadStep>,
    /// Folder of results, or checkpoint, of a case that has come to its end, relative to this file: this case begins there.
    /// Mesh, bodies and contacts must be the same but for the parameters of friction and damping. The steps follow on those
    /// of that case: supports, loads and time go on from there; energies are counted anew
    pub begin_with: Option<String>,
    /// Groups whose mean displacement and reaction go to the history
    #[serde(default)]
    pub watch: Vec<String>,
    /// Gauges by a name of your choice: displacement, velocity, strain and stress at points of the bodies, at every row of
    /// the history (probes.csv)
    #[serde(default)]
    pub probes: BTreeMap<String, ProbeInput>,
    /// When Newton's method stops
    #[serde(default)]
    pub newton: NewtonInput,
    /// What is written
    #[serde(default)]
    pub output: OutputInput,
}

/// A mesh file or a mesh in place.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum MeshSource {
    /// Path relative to the case file
    File(String),
    /// Blocks, divided into elements
    Blocks(BlocksInput),
    /// Node by node
    Inline(InlineMesh),
}

impl<'de> Deserialize<'de> for MeshSource {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting =
            "the path of a mesh file, or a mesh {\"blocks\": …} or {\"nodes\": …, \"elements\": …, \"edges\": …}";
        let object = |mesh| match mesh {
            MeshInPlace::Inline(mesh) => Self::Inline(mesh),
            MeshInPlace::Blocks(blocks) => Self::Blocks(blocks),
        };
        Choice { expecting, number: None, text: Self::File, object }.read(deserializer)
    }
}

/// A body.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyInput {
    /// Bulk law
    pub material: MaterialParameters,
    /// Element formulation
    #[serde(default)]
    pub element: Formulation,
    /// Damping of the body in dynamic steps; none unless given
    #[serde(default)]
    pub damping: Damping,
    /// Stress of the undeformed body at the start; none unless given
    pub initial_stress: Option<InitialStress>,
    /// Thermal expansion; none unless given
    pub thermal: Option<Thermal>,
}

/// How the elements of a body are integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Formulation {
    /// Displacements only, full integration
    #[default]
    Displacement,
    /// Q4 with the mean dilatation of the centre (F-bar): does not lock for ν → 1/2
    FBar,
}

/// A mass at every node of a group.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointMassInput {
    /// Mass of each node, added to what a body has there [M]
    pub mass: f64,
    /// Initial velocity [x, y] of the nodes [L/T]
    pub velocity: Option<[f64; 2]>,
}

/// When Newton's method stops.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
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

/// What the plane stands for in space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SectionInput {
    /// A slice of thickness 1 of bodies that go on without end across the plane: forces, masses and energies per unit of
    /// thickness
    #[default]
    PlaneStrain,
    /// A plate, free of stress across the plane: forces, masses and energies of its whole thickness. Pressures and tractions,
    /// those of contact included, count the undeformed thickness
    PlaneStress(PlateInput),
    /// Rings about the axis x = 0: x is the radius and y the axis. Forces, masses and energies are per full turn, pressures
    /// and tractions per area, and zz is the hoop direction. No node may have x < 0, and nodes on the axis keep ux = 0 without
    /// being told. A contact's length is the area of its full turn
    Axisymmetric,
}

/// A plate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlateInput {
    /// Undeformed thickness, above 0 [L]
    pub thickness: f64,
}

/// A loading plate.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum LoadingPlateInput {
    /// Group that moves as one, without turning
    Group(String),
    /// Group that moves in another way
    Moving(MovingPlateInput),
}

impl<'de> Deserialize<'de> for LoadingPlateInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "the name of a group, or {\"on\": group, \"moves\": \"ux_alike\", \"uy_alike\" or \"rigid\"}";
        Choice { expecting, number: None, text: Self::Group, object: Self::Moving }.read(deserializer)
    }
}

/// A loading plate that moves in another way than as one.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MovingPlateInput {
    /// Group of its nodes
    pub on: String,
    /// How they move
    pub moves: PlateMotion,
}

/// How the nodes of a loading plate move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PlateMotion {
    /// Alike, without turning: what the name of the group alone says
    AsOne,
    /// Alike in x, each as it will in y: a greased plate
    UxAlike,
    /// Alike in y, each as it will in x
    UyAlike,
    /// As a rigid body, which turns under forces, springs and a `moment`; supports hold at most one of its nodes
    Rigid,
}

impl LoadingPlateInput {
    /// Its group, and how it moves.
    pub fn parts(&self) -> (&str, PlateMotion) {
        match self {
            Self::Group(name) => (name, PlateMotion::AsOne),
            Self::Moving(MovingPlateInput { on, moves }) => (on, *moves),
        }
    }
}
