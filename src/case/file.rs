//! The case file as it is written: JSON types, with the text that the schema shows.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use super::choice::Choice;
use crate::laws::bulk::MaterialParameters;
use crate::laws::friction::FrictionParameters;
use crate::mesh::InlineMesh;
use crate::model::scheme::Scheme;

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

/// A contact pair.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ContactInput {
    /// Edge group whose points are kept out of the master, the finer or softer side; or a group of points, each with the
    /// `area`
    pub slave: String,
    /// Area that each point of a slave group of points stands for; it does not change. Edges have lengths of their own
    /// [L, the thickness being 1]
    pub area: Option<f64>,
    /// Edge group, or a rigid body. The slave's group again: contact of the surface with itself, each point of which then
    /// stands for half its length, because every contact is met from both sides
    pub master: MasterInput,
    /// Where contact is evaluated. Unless given: mortar where an edge of either side is quadratic or a side curved (its
    /// direction turns by more than 1° between two corners of more than 45°); gauss_to_segment between straight linear
    /// edges, with a `smooth` master, and where `points` are given
    pub method: Option<Method>,
    /// Gauss points a slave edge (gauss_to_segment), 2 to 4; 2 unless given
    pub points: Option<usize>,
    /// Whether the master's straight edges are taken for a smooth curve through their nodes (not by mortar), so that nothing
    /// jumps where a slave slides from one to the next. Corners of more than 45° stay
    #[serde(default)]
    pub smooth: bool,
    /// Normal contact
    #[serde(default)]
    pub normal: NormalInput,
    /// Whether what the surfaces overlap at the start is brought in over the first step (shrink fit) instead of at once
    #[serde(default)]
    pub shrink_fit: bool,
    /// Implicit dynamics: the mass of the slave's nodes is moved to the other nodes of their elements, so that an impact does
    /// not set them ringing on the contact's stiffness, and the contact force with them
    #[serde(default)]
    pub massless: bool,
    /// Friction law
    pub friction: FrictionParameters,
    /// Parameters of the friction law that vary along the slave, by name: they replace the numbers given in `friction`
    #[serde(default)]
    pub along: BTreeMap<String, ProfileInput>,
    /// Tractions and structure at the start of a contact that starts closed. The gap of every slave point is then counted
    /// from where the pressure acts at its initial position, all through the run
    pub initial: Option<InitialInput>,
}

impl ContactInput {
    /// Whether the slave is its own master.
    pub fn is_own(&self) -> bool {
        matches!(&self.master, MasterInput::Group(group) if *group == self.slave)
    }

    /// Whether the case gives `alpha_t`; `None` for a law that has none.
    pub fn gives_alpha_t(&self) -> Option<bool> {
        let law = serde_json::to_value(self.friction).ok()?;
        law.get("alpha_t").map(|given| !given.is_null())
    }
}

/// The state of a contact that starts closed.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InitialInput {
    /// p: contact pressure, zero or positive [F/L²]
    pub pressure: ProfileInput,
    /// q: traction that resists the slip of the slave along +s, the master's normal turned by −90° [F/L²]
    #[serde(default)]
    pub traction: ProfileInput,
    /// 1/R*: structure of the super/subloading law, from 1 to μ_s/μ_k; that of the law unless given [-]
    pub structure: Option<ProfileInput>,
    /// Whether an initial stress of the bodies is in equilibrium with these tractions. Displacements and stresses of the
    /// run are then those that come on top of the initial stress
    #[serde(default)]
    pub balanced: bool,
}

/// How a quantity varies along a surface.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum ProfileInput {
    /// The same everywhere
    Constant(f64),
    /// Expression in the reference position x, y
    Expression(String),
    /// Table by a coordinate
    Table(ProfileTable),
}

impl Default for ProfileInput {
    fn default() -> Self {
        Self::Constant(0.0)
    }
}

impl<'de> Deserialize<'de> for ProfileInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "a number, an expression in x, y such as \"1 + 0.1*x\", or {\"x\": [[x, v], …]}";
        Choice { expecting, number: Some(Self::Constant), text: Self::Expression, object: Self::Table }
            .read(deserializer)
    }
}

/// Values by a coordinate of the reference position: linear between, constant outside. The same coordinate twice is a
/// jump.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProfileTable {
    /// Pairs of x and value, x ascending
    X(Vec<[f64; 2]>),
    /// Pairs of y and value, y ascending
    Y(Vec<[f64; 2]>),
}

/// The master side.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum MasterInput {
    /// Edge group of the mesh
    Group(String),
    /// Rigid body given by a formula
    Rigid(RigidInput),
}

impl<'de> Deserialize<'de> for MasterInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting =
            "the name of an edge group, or a rigid body such as {\"plane\": {\"point\": [x, y], \"normal\": [x, y]}}";
        Choice { expecting, number: None, text: Self::Group, object: Self::Rigid }.read(deserializer)
    }
}

/// A rigid body at rest, given by a formula.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RigidInput {
    /// A half-space
    Plane(PlaneInput),
    /// A disk, or the rim of a hole
    Circle(CircleInput),
    /// A body bounded by straight lines
    Polyline(PolylineInput),
}

/// A rigid half-space.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneInput {
    /// A point of its surface [L]
    pub point: [f64; 2],
    /// Direction out of the solid, of any length
    pub normal: [f64; 2],
}

/// A rigid circle.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CircleInput {
    /// Centre [L]
    pub centre: [f64; 2],
    /// Radius [L]
    pub radius: f64,
    /// Whether the solid is outside the circle
    #[serde(default)]
    pub hole: bool,
}

/// A rigid polyline.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PolylineInput {
    /// Its corners, the solid on the right of the way; the first again at the end closes it [L]
    pub points: Vec<[f64; 2]>,
}

/// Where contact is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// At the slave's nodes, with tributary lengths
    NodeToSegment,
    /// At Gauss points of the slave's edges
    GaussToSegment,
    /// Averaged around the slave's nodes, integrated exactly over non-matching meshes
    Mortar,
}

impl Method {
    /// Its name in a case.
    pub fn name(self) -> &'static str {
        match self {
            Self::NodeToSegment => "node_to_segment",
            Self::GaussToSegment => "gauss_to_segment",
            Self::Mortar => "mortar",
        }
    }
}

/// Normal contact.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NormalInput {
    /// α_n: pressure per penetration [F/L³]; unless given 10 (λ + 2G)/h, with λ + 2G of the softer of the two sides and the
    /// depth h of the elements behind the slave. A slave group of points has none behind it and needs a number
    pub alpha_n: Option<f64>,
    /// Largest penetration left [L]: the pressure is raised until no closed gap is larger (augmented Lagrangian by Uzawa's
    /// method), so that the answer does not depend on alpha_n; penalty alone unless given
    pub penetration: Option<f64>,
}

/// A step.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StepInput {
    /// Name in messages and results
    pub name: String,
    /// Length of the step [T]
    pub duration: f64,
    /// Time scheme; inherited from the step before unless given, static in the first step
    pub scheme: Option<Scheme>,
    /// Increments; inherited from the step before unless given
    pub dt: Option<IncrementsInput>,
    /// Static steps only, where bodies are held by nothing until contact holds them: dashpots at all nodes of every body
    /// resist motion, at the start of the step as if this share of the body's stiffness lambda + 2G moved it in the
    /// time of the step; they fade linearly and are gone at its end, which takes at least two increments. 1e-3 is a good
    /// start. Not inherited
    pub stabilize: Option<f64>,
    /// Static and implicit steps: the step goes on explicitly while a contact slips fast. Not inherited
    pub rupture: Option<RuptureInput>,
    /// Supports; inherited, and replaced where the same group and direction is named again. One that null frees is gone at
    /// once in dynamic and explicit steps; in a static step, also while `rupture` makes it explicit, its reaction stays as a
    /// force that fades linearly over the step
    #[serde(default)]
    pub supports: Vec<SupportInput>,
    /// Loads; inherited, and replaced where the same group and kind is named again. In any scheme null takes a pressure,
    /// traction, force or gravity linearly to zero over the step, as the value 0 would, and ends springs, dashpots and
    /// absorbing sides at once. A table or expression makes an end as sudden as it is to be
    #[serde(default)]
    pub loads: Vec<LoadInput>,
}

/// When a step goes on explicitly, and returns to its own scheme. An increment in which a contact point slips faster than
/// `slip_rate`, or that cannot be solved, is halved down to `dt.min` and, if that does not help, made explicitly. The step
/// returns when no point has slipped that fast, on the mean of the time that a shear wave takes across the model. What slides
/// without friction does not count. To be noticed, an event must slip more than `slip_rate` times `dt.max`. Waves that are
/// left die in a static step, and their energy counts as damped
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RuptureInput {
    /// Slip rate above which increments are explicit [L/T]
    pub slip_rate: f64,
    /// Explicit increments as a share of the longest that is stable, above 0 and at most 1; 0.9 unless given [-]
    #[serde(default = "nine_tenths")]
    pub safety: f64,
}

fn nine_tenths() -> f64 {
    0.9
}

/// Increments of a step.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IncrementsInput {
    /// First increment [T]
    pub initial: f64,
    /// Increments are not cut below this [T]; initial/1000 unless given, with `error` initial/10⁶
    pub min: Option<f64>,
    /// Increments do not grow beyond this [T]; initial unless given, with `error` a tenth of the step
    pub max: Option<f64>,
    /// Increments are as long as the estimated error of each stays below this [L]: in dynamic steps the error of a
    /// displacement, and events of contact (slip sets in, stops or turns round) are located to ten times this; in static
    /// steps the error of the slip of a contact point, half of what its plastic slip differs from that at the last rate
    pub error: Option<f64>,
}

/// A support on a group or a node.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportInput {
    /// Where
    pub on: Place,
    /// Displacement in x [L]; null frees it, see `supports`
    #[serde(default, deserialize_with = "present")]
    pub ux: Option<Option<DriveInput>>,
    /// Displacement in y [L]; null frees it, see `supports`
    #[serde(default, deserialize_with = "present")]
    pub uy: Option<Option<DriveInput>>,
    /// Rigid rotation about a point, instead of ux and uy; null frees it, see `supports`
    #[serde(default, deserialize_with = "present")]
    pub rotation: Option<Option<RotationInput>>,
}

/// A group or a single node.
#[derive(Clone, Debug, PartialEq, JsonSchema)]
#[schemars(untagged)]
pub enum Place {
    /// Group of the mesh
    Group(String),
    /// Single node
    Node(NodeInput),
}

impl<'de> Deserialize<'de> for Place {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "the name of a group, or {\"node\": tag}";
        Choice { expecting, number: None, text: Self::Group, object: Self::Node }.read(deserializer)
    }
}

/// A single node.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodeInput {
    /// Its tag in the mesh file (its number from 0 in a mesh given in place)
    pub node: u64,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::Group(name) => f.write_str(name),
            Self::Node(NodeInput { node }) => write!(f, "node {node}"),
        }
    }
}

/// A rigid rotation.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotationInput {
    /// Centre [L]
    pub about: [f64; 2],
    /// Angle, counter-clockwise [rad]
    pub angle: DriveInput,
}

/// How a quantity varies.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum DriveInput {
    /// Value at the end of the step, reached linearly
    Constant(f64),
    /// Expression in the reference position x, y and the run time t
    Expression(String),
    /// Variation in time
    InTime(TimeInput),
}

impl<'de> Deserialize<'de> for DriveInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting =
            "a number, an expression in x, y, t such as \"0.01*y*t\", {\"rate\": v}, or {\"table\": [[t, v], …]}";
        Choice { expecting, number: Some(Self::Constant), text: Self::Expression, object: Self::InTime }
            .read(deserializer)
    }
}

/// A variation in time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TimeInput {
    /// Value at the start of the step plus rate × time since [1/T]
    Rate(f64),
    /// Pairs of run time and value, times ascending; linear between, constant outside
    Table(Vec<[f64; 2]>),
}

/// A load: exactly one kind an entry.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadInput {
    /// Where
    pub on: Place,
    /// Pressure on edges that follows the surface, positive toward the body [F/L²]
    #[serde(default, deserialize_with = "present")]
    pub pressure: Option<Option<DriveInput>>,
    /// Traction on reference edges that keeps its direction [F/L²]
    #[serde(default, deserialize_with = "present")]
    pub traction: Option<Option<Components>>,
    /// Acceleration of gravity on a body or on point masses [L/T²]
    #[serde(default, deserialize_with = "present")]
    pub gravity: Option<Option<Components>>,
    /// Force on every node of the group [F]
    #[serde(default, deserialize_with = "present")]
    pub force: Option<Option<Components>>,
    /// Spring at every node of the group, to the ground or to a moving driver; what it does to the node counts as work
    /// from outside
    #[serde(default, deserialize_with = "present")]
    pub spring: Option<Option<SpringInput>>,
    /// Dashpot at every node of the group, to the ground or to a moving driver
    #[serde(default, deserialize_with = "present")]
    pub dashpot: Option<Option<DashpotInput>>,
    /// true: a side of a body absorbs waves, as if the body went on (Lysmer-Kuhlemeyer: dashpots rho c_p along the normal
    /// and rho c_s along the side, of the undeformed body); false ends it
    pub absorbing: Option<bool>,
}

/// Components of a vector; zero unless given.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Components {
    /// x component
    pub x: Option<DriveInput>,
    /// y component
    pub y: Option<DriveInput>,
}

/// A spring.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringInput {
    /// Stiffness in x [F/L]
    #[serde(default)]
    pub kx: f64,
    /// Stiffness in y [F/L]
    #[serde(default)]
    pub ky: f64,
    /// Displacement of the far end; the ground unless given [L]
    pub driver: Option<Components>,
}

/// A dashpot: force c (v_driver − v). In statics v is the mean velocity of the increment.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DashpotInput {
    /// Coefficient in x [F T/L]
    #[serde(default)]
    pub cx: f64,
    /// Coefficient in y [F T/L]
    #[serde(default)]
    pub cy: f64,
    /// Velocity of the far end; the ground unless given [L/T]
    pub driver: Option<Components>,
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
        Self { tolerance: 1e-8, max_iterations: 25 }
    }
}

/// What is written.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OutputInput {
    /// Fields are written with every n-th row of the history, and at the end of each step
    pub every: usize,
    /// Whether fields are written at all
    pub fields: bool,
    /// Explicit steps write a row of the history (and fields, every n-th time) at multiples of this since the start of the
    /// step [T]; a hundredth of the step unless given. Implicit steps do so at every increment
    pub interval: Option<f64>,
    /// Slip over time and place (slip_map.csv), and the fronts that run along contacts with friction (fronts.csv)
    pub fronts: Option<FrontsInput>,
}

/// What counts as a front.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FrontsInput {
    /// Slip rate whose passage from below is the arrival of a front [L/T]
    pub slip_rate: f64,
}

impl Default for OutputInput {
    fn default() -> Self {
        Self { every: 1, fields: true, interval: None, fronts: None }
    }
}

/// Tell a key that is `null` (Some(None)) from one that is absent (None, by default).
fn present<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Option<T>>, D::Error> {
    Option::deserialize(deserializer).map(Some)
}
