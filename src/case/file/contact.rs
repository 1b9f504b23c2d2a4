//! Contacts as they are written.
//!
//! Friction that varies along a contact, as it is written.

use std::collections::BTreeMap;
use std::fmt;

use schemars::JsonSchema;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::case::choice::Choice;
use crate::laws::friction::FrictionParameters;
use crate::model::boundary::Profile;
use crate::model::method::Method;

/// A contact pair.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ContactInput {
    /// Edge group whose points are kept out of the master, the finer or softer side; or a group of points, each with the
    /// `area`
    pub slave: String,
    /// Area that each point of a slave group of points stands for, with the thickness or the full turn; it does not change.
    /// Edges have lengths of their own [L, the thickness being 1, or L²]
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
    /// How far the surfaces move apart with plastic slip
    pub dilatancy: Option<DilatancyInput>,
    /// k of Archard's law: the surfaces wear away by dw = k p × plastic slip, whichever way it goes, and come nearer; k is the wear
    /// coefficient over the hardness. The depth w stands in tables and frames as `wear` [L²/F]
    pub wear: Option<f64>,
    /// Static steps: a traction η × slip rate that resists slip beside friction, in place of the inertia that is left out: the
    /// shear waves that slip would send into unbounded bodies take it away. A number is η [F·T/L³]; true is that of the
    /// bodies, 1/η = 1/Z₁ + 1/Z₂ with Z = ρ c_s of each side: G/(2 c_s) where both are alike, Z on a rigid master. Dynamic and
    /// explicit steps have inertia, and leave it out
    #[serde(default)]
    pub radiation_damping: RadiationInput,
    /// p_w: pressure of a fluid between the surfaces, zero or positive; expressions may have the run time t besides the
    /// reference position x, y of the slave. It pushes both sides apart wherever the master faces the slave, closed or open, beside
    /// the pressure p that the surfaces carry; friction, `initial.pressure` and all outputs called pressure are this effective p
    /// alone. It is given, and does not flow. Not for quasi_dynamic steps [F/L²]
    pub fluid_pressure: Option<Profile>,
    /// What of friction varies along the slave, and in time
    #[serde(default)]
    pub along: AlongInput,
    /// Tractions and structure at the start of a contact that starts closed. The gap of every slave point is then counted
    /// from where the pressure acts at its initial position, all through the run
    pub initial: Option<InitialInput>,
}

/// Dilatancy of a contact, with any friction law.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DilatancyInput {
    /// tan ψ: opening per plastic slip at the start, whichever way it goes; below the least coefficient that friction can come to
    /// (mu, mu_k, mu_d), for the work that lifts the load is friction's [-]
    pub rate: f64,
    /// d_max: opening that much slip leads to, dδ = tan ψ (1 − δ/d_max) × plastic slip; no limit unless given. The opening δ stands
    /// in tables and frames as `dilation` [L]
    pub limit: Option<f64>,
}

/// Radiation damping: whether, or how much.
#[derive(Clone, Copy, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum RadiationInput {
    /// That of the bodies, or none
    OfBodies(bool),
    /// η [F·T/L³]
    Given(f64),
}

impl Default for RadiationInput {
    fn default() -> Self {
        Self::OfBodies(false)
    }
}

impl<'de> Deserialize<'de> for RadiationInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(WhetherOrHowMuch)
    }
}

/// Reads `true`, `false` or a number.
struct WhetherOrHowMuch;

impl Visitor<'_> for WhetherOrHowMuch {
    type Value = RadiationInput;

    fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        formatter.write_str("true, false or a number")
    }

    fn visit_bool<E: serde::de::Error>(self, value: bool) -> Result<RadiationInput, E> {
        Ok(RadiationInput::OfBodies(value))
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<RadiationInput, E> {
        Ok(RadiationInput::Given(value))
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<RadiationInput, E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<RadiationInput, E> {
        self.visit_f64(value as f64)
    }
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
    pub pressure: Option<Profile>,
    /// q: traction that resists the slip of the slave along +s, the master's normal turned by −90° [F/L²]
    pub traction: Option<Profile>,
    /// 1/R*: structure of the super/subloading law, from 1 to μ_s/μ_k; that of the law unless given [-]
    pub structure: Option<Profile>,
    /// Whether an initial stress of the bodies is in equilibrium with these tractions. Displacements and stresses of the
    /// run are then those that come on top of the initial stress
    #[serde(default)]
    pub balanced: bool,
    /// Instead of pressure and traction: those with which the `initial_stress` of the slave's body ends at the contact, p = −n·σn
    /// (less the pressure of a fluid at the start) and q = s·σn, with the normal n and the tangent s of the master
    #[serde(default)]
    pub of_bodies: bool,
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

/// What of friction varies along the slave, and in time: expressions may have the run time t besides x and y.
#[derive(Clone, Debug, Default, JsonSchema)]
pub struct AlongInput {
    /// Other laws than `friction` on parts of the slave; where several say so, the first holds
    #[schemars(default)]
    pub law: Vec<LawChoiceInput>,
    /// Parameters of `friction`, by name: they replace the numbers given there. A rate enters by its mean over an increment,
    /// any other parameter by its value at the end. Those of the start (structure, theta) and alpha_t do not vary in time
    #[schemars(flatten)]
    pub parameters: BTreeMap<String, Profile>,
}

impl AlongInput {
    /// Whether nothing varies.
    pub fn is_empty(&self) -> bool {
        self.law.is_empty() && self.parameters.is_empty()
    }
}

/// A law on a part of the slave.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LawChoiceInput {
    /// It holds where this is positive
    #[serde(rename = "where")]
    pub place: Profile,
    /// Friction law
    pub friction: FrictionParameters,
    /// Its parameters that vary along the slave, and in time, by name
    #[serde(default)]
    pub along: BTreeMap<String, Profile>,
}

impl<'de> Deserialize<'de> for AlongInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Entries)
    }
}

/// Reads entry by entry, so that a complaint about one names its place.
struct Entries;

impl<'de> Visitor<'de> for Entries {
    type Value = AlongInput;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("parameters of the friction law by name")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<AlongInput, A::Error> {
        let mut along = AlongInput::default();
        while let Some(name) = entries.next_key::<String>()? {
            match name.as_str() {
                "law" => along.law = entries.next_value()?,
                _ => drop(along.parameters.insert(name, entries.next_value()?)),
            }
        }
        Ok(along)
    }
}
