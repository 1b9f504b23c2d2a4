//! Case file: the input of a model, and what only a file contains.

mod blocks;
mod output;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, SeqAccess};
use serde::{Deserialize, Deserializer, Serialize};

use crate::mesh::{InlineMesh, PlacedGroup, Section};
use crate::model::NewtonSettings;
use crate::model::builder::{
    BarInput, BodyInput, Contact, Gauge, LoadStep, LoadingPlateInput, Place, PointMassInput, RigidBodyInput,
    SectionsInput,
};
use crate::model::written::Written;
use blocks::MeshKeys;
pub use blocks::{Amount, BlockInput, BlocksInput, GradingInput, MiddleInput};
pub(super) use blocks::{blocks, evaluated};
pub use output::OutputInput;

/// A case: mesh, bodies, contacts and steps.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Title of the case, in one line
    #[serde(default)]
    pub title: String,
    /// Labels of the units used, for readers: `length`, `force`, `time`; any consistent set will do. Those of `stress`, `energy` and
    /// whatever else follows may be left out: they are composed ("kN/m²"), and one that contradicts is refused. In plane strain,
    /// the label of a force may be one per length of thickness ("kN/m")
    #[serde(default)]
    pub units: BTreeMap<String, String>,
    /// Path of a gmsh file (MSH 4.1, or 2.2 ASCII) relative to the case file, a list of such paths, or a mesh given in place:
    /// blocks divided into elements, or node by node
    pub mesh: MeshSource,
    /// Groups of sides or nodes by place, by a name of your choice, for meshes that lack them: `{"top": {"y": 1.0}}`
    #[serde(default)]
    pub groups: BTreeMap<String, PlacedGroup>,
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
    /// rotate. A support of a node of it holds the whole plate, and a force, spring or dashpot at a node acts on the
    /// whole plate: on its group once for every node, a `total_force` once. Its reaction counts in the watched groups that
    /// contain the whole plate. In axisymmetry a plate keeps its radius, ux = 0. Other plates are given by `moves`: only
    /// one component equal, or a rigid body that can rotate
    #[serde(default)]
    pub plates: Vec<LoadingPlateInput>,
    /// Moving rigid bodies, by a name of your choice: rigid masters of contacts refer to them. Supports on the name prescribe
    /// the path, `ux`, `uy` and `angle`, 0 where it is fixed; free components move under contact and loads on the name
    #[serde(default)]
    pub rigid_bodies: BTreeMap<String, RigidBodyInput>,
    /// Trusses, beams, anchors and geogrids by a name of your choice
    #[serde(default)]
    pub bars: BTreeMap<String, BarInput>,
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
    /// Groups, or single nodes {"near": [x, y]} or {"node": tag}, whose mean displacement and reaction are written to the history, under
    /// the name of the group, `near_X_Y` or `node_TAG`
    #[serde(default)]
    pub watch: Vec<Place>,
    /// Gauges by a name of your choice: displacement, velocity, strain and stress at points of the bodies, at every row of
    /// the history (probes.csv)
    #[serde(default)]
    pub probes: BTreeMap<String, Gauge>,
    /// Sections across bodies by a name of your choice: normal force, shear force and bending moment along an axis, such as the depth
    /// of a wall, at every row of the history (sections.csv)
    #[serde(default)]
    pub sections: BTreeMap<String, SectionsInput>,
    /// Places of values by which the history is differentiated (gradients.csv): "contacts.base.friction.mu_k",
    /// "bodies.block.material.E", "steps.drag.supports[0].uy". The derivatives are those of the run with its increments as they are;
    /// not for explicit and quasi-dynamic steps, nor where a step may become explicit
    #[serde(default)]
    pub gradients: Vec<String>,
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
    /// Paths of several files: their meshes share no nodes, and each group is in one of them
    Files(Vec<String>),
    /// Blocks, divided into elements
    Blocks(BlocksInput),
    /// Node by node
    Inline(InlineMesh),
}

impl Written for MeshSource {
    const EXPECTING: &'static str = "the path of a mesh file, a list of such paths, or a mesh {\"blocks\": …} or {\"nodes\": …, \"elements\": …, \"edges\": …}";

    fn text<E: Error>(text: &str) -> Result<Self, E> {
        Ok(Self::File(text.into()))
    }

    fn list<'de, A: SeqAccess<'de>>(list: A) -> Result<Self, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(list)).map(Self::Files)
    }

    fn object<'de, D: Deserializer<'de>>(object: D) -> Result<Self, D::Error> {
        MeshKeys::deserialize(object)?.source()
    }
}

impl<'de> Deserialize<'de> for MeshSource {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::read(deserializer)
    }
}
