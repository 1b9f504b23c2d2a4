//! Contacts as they are written.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use crate::case::choice::Choice;
use crate::laws::friction::FrictionParameters;
use crate::model::method::Method;

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
    /// How far the surfaces may slide on each other: any way (finite), or by a small part of the distance between nodes (small)
    #[serde(default)]
    pub sliding: SlidingInput,
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

/// How far surfaces may slide on each other, and turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SlidingInput {
    /// Any way: every point meets what it faces at the time
    #[default]
    Finite,
    /// A small part of the distance between nodes: every point keeps the foot, the normal, the weights of the nodes and the
    /// length that it has at the start, so that gap and slip are linear in the displacements. With linear bodies nothing but
    /// friction and opening is nonlinear then. For small rotations only; what nothing faces at the start never touches. A run
    /// warns where a point slides by more than a tenth of the distance between nodes, or a surface turns or stretches by more
    /// than 0.02. Not for contact of a surface with itself
    Small,
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
