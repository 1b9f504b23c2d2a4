//! The case file: what a model is built from, under its keys, and what only a file has.

mod blocks;
mod output;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use crate::laws::bulk::MaterialParameters;
use crate::mesh::InlineMesh;
use crate::mesh::section::Section;
use crate::model::builder::{Contact, Gauge, LoadStep, Plate};
use crate::model::imposed::{InitialStress, Thermal};
use crate::model::written::Written;
use crate::model::{Damping, NewtonSettings};
pub use blocks::{Amount, BlockInput, BlocksInput, GradingInput, MeshInPlace, MiddleInput};
pub use output::{ArrivalInput, FrontsInput, OutputInput};

/// A case: mesh, bodies, contacts and steps.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Title of the case, in one line
    #[serde(default)]
    pub title: String,
    /// Labels of the units used, for readers; any consistent set will do
    #[serde(default)]
    pub units: BTreeMap<String, String>,
    /// Path of a gmsh MSH 4.1 file relative to the case file, or a mesh given in place: as blocks that are divided into elements, or
    /// node by node
    pub mesh: MeshSource,
    /// Kind of plane section: "plane_strain", a plate {"plane_stress": {"thickness": …}}, or "axisymmetric"
    #[serde(default)]
    pub section: Section,
    /// Bodies by the name of their mesh group
    #[serde(default)]
    pub bodies: BTreeMap<String, BodyInput>,
    /// Point masses by the name of a mesh group: a mass at each of its nodes
    #[serde(default)]
    pub point_masses: BTreeMap<String, PointMassInput>,
    /// Periodic sides: pairs of groups with matching nodes. Each node has the displacement of its partner, and forces
    /// on one act on both
    #[serde(default)]
    pub periodic: Vec<[String; 2]>,
    /// Loading plates: groups whose nodes all have the same displacement, as if bonded to a rigid platen that does not
    /// rotate. A support, force, spring or dashpot on one of its nodes acts once on the whole plate, as does a
    /// `total_force` on its group. Its reaction counts in the watched groups that contain the whole plate. In
    /// axisymmetry a plate keeps its radius, ux = 0. Other plates are given by `moves`: only one component equal, or a
    /// rigid body that can rotate
    #[serde(default)]
    pub plates: Vec<LoadingPlateInput>,
    /// Contacts by a name of your choice
    #[serde(default)]
    pub contacts: BTreeMap<String, Contact>,
    /// Initial velocity [x, y] of whole bodies; supported nodes follow their supports
    #[serde(default)]
    pub initial_velocity: BTreeMap<String, [f64; 2]>,
    /// Steps, one after the other
    pub steps: Vec<LoadStep>,
    /// Folder of results, or checkpoint, of a completed case, relative to this file: this case begins with its final
    /// state. Mesh, bodies and contacts must be the same except for the parameters of friction and damping. The steps
    /// follow those of that case: supports, loads and time continue; energies start from zero
    pub begin_with: Option<String>,
    /// Groups whose mean displacement and reaction are written to the history
    #[serde(default)]
    pub watch: Vec<String>,
    /// Gauges by a name of your choice: displacement, velocity, strain and stress at points of the bodies, at every row of
    /// the history (probes.csv)
    #[serde(default)]
    pub probes: BTreeMap<String, Gauge>,
    /// Stopping criteria of Newton's method
    #[serde(default)]
    pub newton: NewtonSettings,
    /// Output
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

impl Written for MeshSource {
    const EXPECTING: &'static str =
        "the path of a mesh file, or a mesh {\"blocks\": …} or {\"nodes\": …, \"elements\": …, \"edges\": …}";

    fn text(text: &str) -> Result<Self, String> {
        Ok(Self::File(text.into()))
    }

    fn object<'de, D: Deserializer<'de>>(object: D) -> Result<Self, D::Error> {
        Ok(match MeshInPlace::deserialize(object)? {
            MeshInPlace::Inline(mesh) => Self::Inline(mesh),
            MeshInPlace::Blocks(blocks) => Self::Blocks(blocks),
        })
    }
}

impl<'de> Deserialize<'de> for MeshSource {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::read(deserializer)
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

/// A loading plate.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum LoadingPlateInput {
    /// Group that moves as one, without turning
    Group(String),
    /// Group that moves in another way
    Moving(MovingPlateInput),
}

impl Written for LoadingPlateInput {
    const EXPECTING: &'static str =
        "the name of a group, or {\"on\": group, \"moves\": \"ux_alike\", \"uy_alike\" or \"rigid\"}";

    fn text(text: &str) -> Result<Self, String> {
        Ok(Self::Group(text.into()))
    }

    fn object<'de, D: Deserializer<'de>>(object: D) -> Result<Self, D::Error> {
        MovingPlateInput::deserialize(object).map(Self::Moving)
    }
}

impl<'de> Deserialize<'de> for LoadingPlateInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::read(deserializer)
    }
}

/// A loading plate that moves in another way than as one.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MovingPlateInput {
    /// Group of its nodes
    pub on: String,
    /// How they move
    pub moves: Plate,
}

impl LoadingPlateInput {
    /// Its group, and how it moves.
    pub fn parts(&self) -> (&str, Plate) {
        match self {
            Self::Group(name) => (name, Plate::AsOne),
            Self::Moving(MovingPlateInput { on, moves }) => (on, *moves),
        }
    }
}
