//! The case file as it is written: JSON types, with the text that the schema shows.

mod along;
mod blocks;
mod contact;
mod damping;
mod drive;
mod imposed;
mod load;
mod output;
mod place;
mod plate;
mod probe;
mod profile;
mod section;
mod step;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

pub use along::{AlongInput, LawChoiceInput};
pub use blocks::{Amount, BlockInput, BlocksInput, GradingInput, MeshInPlace, MiddleInput};
pub use contact::{
    CircleInput, ContactInput, DilatancyInput, InitialInput, MasterInput, NormalInput, PlaneInput, PolylineInput,
    RadiationInput, RigidInput, SlidingInput,
};
pub use damping::DampingInput;
pub use drive::{Components, DriveInput, TimeInput};
pub use imposed::{
    GeostaticInput, InitialStressInput, StressInput, TemperatureInput, TemperatureVariation, ThermalInput,
};
pub use load::{DashpotInput, LoadInput, SpringInput};
pub use output::{ArrivalInput, FrontsInput, OutputInput};
pub use place::{Place, SpotInput};
pub use plate::{LoadingPlateInput, PlateMotion};
pub use probe::ProbeInput;
pub use profile::{ProfileInput, ProfileTable};
pub use section::{PlateInput, SectionInput};
pub use step::{IncrementsInput, RotationInput, RuptureInput, StepInput, SupportInput, UntilInput};

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
    pub contacts: BTreeMap<String, ContactInput>,
    /// Initial velocity [x, y] of whole bodies; supported nodes keep to their supports
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
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
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
    /// Stress of the undeformed body at the start; none unless given
    pub initial_stress: Option<InitialStressInput>,
    /// Thermal expansion; none unless given
    pub thermal: Option<ThermalInput>,
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
