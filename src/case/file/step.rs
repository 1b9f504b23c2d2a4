//! Steps as they are written.
//!
//! Loads as they are written.
//!
//! Where supports and loads act, and whether they end.
//!
//! How a prescribed quantity varies, as it is written.
//!
//! What is imposed on bodies, as it is written.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use super::DampingInput;
use super::contact::ProfileInput;
use crate::case::choice::Choice;
use crate::model::builder::MET;
use crate::model::scheme::{Scheme, nine_tenths};

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
    /// Velocity [x, y] that whole bodies or point masses take when this step begins, a dynamic or explicit one: settle under gravity,
    /// then launch. What it changes of the kinetic energy counts as work from outside. Supported nodes keep to their supports [L/T]
    #[serde(default)]
    pub velocity: BTreeMap<String, [f64; 2]>,
    /// Damping of bodies from this step on, in place of what the body or a step before has; inherited. Statics know none
    #[serde(default)]
    pub damping: BTreeMap<String, DampingInput>,
    /// Static and implicit steps: the step ends before its time when a reaction comes to a value, and those after it begin then.
    /// A step that comes to its own end without stops the run. Not inherited
    pub until: Option<UntilInput>,
    /// Temperature of bodies that have `thermal` [Θ]; inherited, and replaced where the same body is named again. A number is reached
    /// linearly at the end of the step, from the temperature at its start; expressions may have the reference position x, y
    /// and the run time t
    #[serde(default)]
    pub temperature: BTreeMap<String, TemperatureInput>,
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

/// A reaction that ends a step: displacement control up to a force. The increment in which the force passes its value is made
/// shorter until it has it. Supports that were to come to a value stay where the step has ended; tables and expressions go on by
/// the time of the run. Exactly one of `fx`, `fy` and `force` is given
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UntilInput {
    /// Whose reaction: what supports put on these nodes
    pub on: Place,
    /// Its x component [F]
    pub fx: Option<f64>,
    /// Its y component [F]
    pub fy: Option<f64>,
    /// Its size [F]
    pub force: Option<f64>,
    /// Share of the value, or of the reaction at the start of the step if that is larger, within which it is met, at most 0.1;
    /// 1e-6 unless given [-]
    #[serde(default = "met")]
    pub tolerance: f64,
}

fn met() -> f64 {
    MET
}

/// Increments of a step.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IncrementsInput {
    /// First increment [T]
    pub initial: f64,
    /// Increments are not cut below this [T]; initial/1000 unless given, with `error` initial/10⁶, in quasi_dynamic steps what
    /// round-off of the time allows
    pub min: Option<f64>,
    /// Increments do not grow beyond this [T]; initial unless given, with `error` and in quasi_dynamic steps a tenth of the step
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
    /// Direction [x, y] of the displacement u; it need not be of unit length
    pub along: Option<[f64; 2]>,
    /// Displacement along the direction `along`; what is across is free, unless another support of the node holds that as well:
    /// two directions at a node hold both of its components. null frees it, see `supports` [L]
    #[serde(default, deserialize_with = "present")]
    pub u: Option<Option<DriveInput>>,
    /// Displacement along the normal of a side, positive out of the body; the side slides. The normal is that of the undeformed
    /// body, averaged over the edges at a node; where edges of the group meet at 45 degrees or more, both normals hold. null
    /// frees it, see `supports` [L]
    #[serde(default, deserialize_with = "present")]
    pub un: Option<Option<DriveInput>>,
    /// Rigid rotation about a point, instead of all others; null frees it, see `supports`
    #[serde(default, deserialize_with = "present")]
    pub rotation: Option<Option<RotationInput>>,
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

/// A load: exactly one kind an entry.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadInput {
    /// Where
    pub on: Place,
    /// Pressure on edges that follows the surface, positive toward the body [F/L²]
    #[serde(default, deserialize_with = "present")]
    pub pressure: Option<Option<DriveInput>>,
    /// Pressure on edges that keeps the force and direction it has on the undeformed edges, positive toward the body [F/L²]
    #[serde(default, deserialize_with = "present")]
    pub dead_pressure: Option<Option<DriveInput>>,
    /// Traction on reference edges that keeps its direction [F/L²]
    #[serde(default, deserialize_with = "present")]
    pub traction: Option<Option<Components>>,
    /// Acceleration of gravity on a body or on point masses [L/T²]
    #[serde(default, deserialize_with = "present")]
    pub gravity: Option<Option<Components>>,
    /// Force on every node of the group [F]
    #[serde(default, deserialize_with = "present")]
    pub force: Option<Option<Components>>,
    /// Force on edges as a whole, spread over them as an even traction: a unit of depth in plane strain, the thickness of a
    /// plate, the full turn of a ring. Its expressions depend on t alone [F]
    #[serde(default, deserialize_with = "present")]
    pub total_force: Option<Option<Components>>,
    /// Moment on a plate that moves as a rigid body, counter-clockwise; it turns with the plate [F L]
    #[serde(default, deserialize_with = "present")]
    pub moment: Option<Option<DriveInput>>,
    /// Spring at every node of the group, to the ground or to a moving driver; what it does to the node counts as work
    /// from outside
    #[serde(default, deserialize_with = "present")]
    pub spring: Option<Option<SpringInput>>,
    /// Dashpot at every node of the group, to the ground or to a moving driver
    #[serde(default, deserialize_with = "present")]
    pub dashpot: Option<Option<DashpotInput>>,
    /// true: a side of a body absorbs waves, as if the body went on (Lysmer-Kuhlemeyer: dashpots rho c_p along the normal
    /// and rho c_s along the side, of the undeformed body); false or null ends it
    #[serde(default, deserialize_with = "present")]
    pub absorbing: Option<Option<bool>>,
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

/// A group or a single node.
#[derive(Clone, Debug, PartialEq, JsonSchema)]
#[schemars(untagged)]
pub enum Place {
    /// Group of the mesh
    Group(String),
    /// Single node
    Spot(SpotInput),
}

impl<'de> Deserialize<'de> for Place {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "the name of a group, {\"node\": tag}, or {\"near\": [x, y]}";
        Choice { expecting, number: None, text: Self::Group, object: Self::Spot }.read(deserializer)
    }
}

/// A single node.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SpotInput {
    /// Its tag in the mesh file (its number from 0 in a mesh given in place)
    Node(u64),
    /// The node of the undeformed mesh that is nearest to this point [x, y]. It must be the only one, and no farther away than
    /// the elements there are long [L]
    Near([f64; 2]),
}

/// Tell a key that is `null` (Some(None)) from one that is absent (None, by default).
pub fn present<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Option<T>>, D::Error> {
    Option::deserialize(deserializer).map(Some)
}

/// How a quantity varies.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum DriveInput {
    /// Value at the end of the step, reached linearly
    Constant(f64),
    /// Expression in the reference position x, y and the run time t, with + - * / ^, brackets, pi, tau, e, and functions: abs, acos,
    /// acosh, asin, asinh, atan, atanh, atan2(y, x), cbrt, ceil, cos, cosh, exp, floor, fract, ln, log (= ln), log10, log2,
    /// max(a, b), min(a, b), round, signum, sin, sinh, sqrt, tan, tanh, trunc. -x^2 is -(x^2)
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

/// Components of a vector; zero unless given.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Components {
    /// x component
    pub x: Option<DriveInput>,
    /// y component
    pub y: Option<DriveInput>,
}

/// Stress of a body before anything has moved. Displacements and strains count from there, stresses are whole. The run tells how far
/// it is out of balance with what acts at the start of the first step; loads that are there from the start are expressions,
/// such as "-9.81" for a gravity, for a number grows from zero over the step
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InitialStressInput {
    /// Ground at rest under its weight along -y
    Geostatic(GeostaticInput),
    /// Components of the stress, tension positive
    Components(StressInput),
}

/// Ground at rest: σ_yy = −weight (surface − y), and σ_xx = σ_zz = K0 σ_yy; σ_zz = 0 in a plate.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GeostaticInput {
    /// Level y at which the vertical stress is zero: the top of the body, or above it if it lies deeper [L]
    pub surface: f64,
    /// γ: weight per volume, the density times gravity, above 0 [F/L³]
    pub weight: f64,
    /// K₀: horizontal over vertical stress, zero or positive; 1 − sin φ of loose ground, ν/(1 − ν) of an elastic body that cannot
    /// widen [-]
    #[serde(rename = "K0")]
    pub k0: f64,
}

/// Components of a stress.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StressInput {
    /// σ_xx [F/L²]
    pub xx: ProfileInput,
    /// σ_yy [F/L²]
    pub yy: ProfileInput,
    /// σ_xy; 0 unless given [F/L²]
    #[serde(default)]
    pub xy: ProfileInput,
    /// σ_zz: across the plane, of rings along the hoops. Needed but in plane stress, where it is 0 [F/L²]
    pub zz: Option<ProfileInput>,
}

/// Thermal expansion of a body, whose `temperature` the steps give. With F = (1 + α (T − T₀)) F_e the material sees F_e; a `linear`
/// one sees the strain less α (T − T₀).
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThermalInput {
    /// α: strain per temperature, against the undeformed body [1/Θ]
    pub expansion: f64,
    /// T₀: temperature of the undeformed body, which it has until a step gives another [Θ]
    #[serde(default)]
    pub reference: f64,
}

/// How warm a body is.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum TemperatureInput {
    /// Temperature at the end of the step, reached linearly from the one at its start
    Constant(f64),
    /// Expression in the reference position x, y and the run time t
    Expression(String),
    /// Variation in time, or by a coordinate
    Varying(TemperatureVariation),
}

impl<'de> Deserialize<'de> for TemperatureInput {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "a number, an expression in x, y, t such as \"20 + 5*x*t\", {\"rate\": v}, {\"table\": [[t, v], …]}, or \
                         {\"x\": [[x, v], …]}";
        Choice { expecting, number: Some(Self::Constant), text: Self::Expression, object: Self::Varying }
            .read(deserializer)
    }
}

/// A temperature that varies. A table by x or y, of the reference position, is reached at the end of the step, linearly from the
/// temperature at its start: linear between, constant outside, the same coordinate twice is a jump.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TemperatureVariation {
    /// Value at the start of the step plus rate × time since [1/T]
    Rate(f64),
    /// Pairs of run time and value, times ascending; linear between, constant outside
    Table(Vec<[f64; 2]>),
    /// Pairs of x and value, x ascending
    X(Vec<[f64; 2]>),
    /// Pairs of y and value, y ascending
    Y(Vec<[f64; 2]>),
}
