//! Steps as they are written.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::damping::DampingInput;
use super::drive::DriveInput;
use super::imposed::TemperatureInput;
use super::load::LoadInput;
use super::place::{Place, present};
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
