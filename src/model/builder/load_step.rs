//! Input of a load step, which inherits from the previous step. Its loads are in [`super::load`].

use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::groups::Place;
use super::load::{Change, Load, present};
use super::pore_flow::DrainageInput;
use crate::laws::parameter::ratio;
use crate::model::boundary::{BodyTemperature, Drive};
use crate::model::scheme::Scheme;
use crate::model::step::ForceComponent;
use crate::model::text::vector;
use crate::model::{Damping, Increments};

/// Default relative tolerance of the force that ends a step.
#[doc(hidden)]
pub const UNTIL_TOLERANCE: f64 = 1e-6;

/// Allowed error of slip per increment in D_c, by default: the times of stick-slip events, over ten decades of the slip
/// rate, are then right to a few thousandths.
pub const OF_CRITICAL_SLIP: f64 = 1e-4;

/// A step: a time span with its scheme and increments, supports and loads.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Step")]
#[non_exhaustive]
pub struct LoadStep {
    /// Name in messages and results
    pub name: String,
    /// Length of the step [T]
    pub duration: f64,
    /// Time scheme; by default inherited from the previous step, static in the first step
    pub scheme: Option<Scheme>,
    /// Increments; by default inherited from the previous step, a tenth of the first step
    pub dt: Option<IncrementSettings>,
    /// Static steps only, for bodies that are unconstrained until contact closes: dashpots at all nodes of every body
    /// resist motion, at the start of the step with this fraction of the body's stiffness lambda + 2G for a motion over
    /// the duration of the step; they fade linearly to zero at its end, which takes at least two increments. 1e-3 is a
    /// good start. Not inherited
    pub stabilize: Option<f64>,
    /// Static and implicit steps: automatic switch to explicit integration while a contact slips fast. Not inherited
    pub rupture: Option<RuptureSettings>,
    /// Velocity [x, y] given to whole bodies or point masses at the start of this step, which is dynamic or explicit:
    /// settle under gravity, then launch. The change of kinetic energy counts as external work. Supported nodes follow
    /// their supports [L/T]
    #[serde(default)]
    pub velocity: BTreeMap<String, [f64; 2]>,
    /// Damping of bodies from this step on, replacing that of the body or of an earlier step; inherited. No effect in
    /// static steps
    #[serde(default)]
    pub damping: BTreeMap<String, Damping>,
    /// Static and implicit steps: the step ends early when a reaction reaches a value, and later steps begin then. If
    /// the step ends before the reaction reaches it, the run stops. Not inherited
    pub until: Option<UntilSettings>,
    /// Temperature of bodies that have `thermal` [Θ]; inherited, and replaced where the same body is named again. A
    /// number is reached linearly at the end of the step, from the temperature at its start; expressions may depend on
    /// the reference position x, y and the run time t
    #[serde(default)]
    pub temperature: BTreeMap<String, BodyTemperature>,
    /// Bodies and bars taken away at the start of this step, as in an excavation. The forces that they exerted on the rest remain
    /// as loads that fade linearly to zero over the step
    #[serde(default)]
    pub remove: Vec<String>,
    /// Bodies and bars that come at the start of this step and are absent before, such as a wall or an anchor. Bodies come without
    /// strain in the place that their nodes have then, at rest under their `initial_stress`, if any; that and their weight
    /// grow in linearly over the step. A bar comes without force between its points as they are then
    #[serde(default)]
    pub add: Vec<String>,
    /// Bars that are stressed in this step, by name: the force N to which a jack brings the whole bar linearly over the step; with the
    /// end of the step its length is locked [F]
    #[serde(default)]
    pub prestress: BTreeMap<String, f64>,
    /// Supports; inherited, and replaced where the same group and direction is named again. A support released by null
    /// ends at once in dynamic and explicit steps; in a static step, also while `rupture` makes it explicit, its
    /// reaction remains as a force that fades linearly over the step
    #[serde(default)]
    pub supports: Vec<Support>,
    /// Where water flows out of bodies whose pore_fluid has a permeability, or into them; inherited, and replaced where the same place is named
    /// again
    #[serde(default)]
    pub drainage: Vec<DrainageInput>,
    /// Loads; inherited, and replaced where the same group and kind is named again. In any scheme null reduces a
    /// pressure, traction, force or gravity linearly to zero over the step, as the value 0 would, and ends springs,
    /// dashpots and absorbing sides at once. For a sudden end, use a table or expression
    #[serde(default)]
    pub loads: Vec<Load>,
}

/// Increments of a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Increments")]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct IncrementSettings {
    /// First increment [T]
    pub initial: f64,
    /// Shortest increment [T]; default initial/1000, with `error` initial/10⁶. With rate-and-state friction under error
    /// control and in quasi_dynamic steps it is the shortest that round-off of the time allows, since slip may take any
    /// rate
    pub min: Option<f64>,
    /// Longest increment [T]; default initial, with a given `error` and in quasi_dynamic steps a tenth of the step
    pub max: Option<f64>,
    /// Error control: the longest increments whose estimated error stays below this [L]. In dynamic steps it is the
    /// error of a displacement, and contact events (onset, arrest and reversal of slip) are located to ten times this;
    /// in static steps it is the error of the slip of a contact point, half the difference of its plastic slip from
    /// that at the last rate. With rate-and-state friction, this error of its slip is also at most 1e-4 D_c in static steps
    /// that give no `error`, and in all implicit ones. null: no control at all
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub error: Option<Change<f64>>,
    /// Error control of water that flows: the longest increments in which the pressure of no corner changes by more than twice this beside what it
    /// would at the last rate. Not controlled unless given [F/L²]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pore_pressure: Option<f64>,
    /// Allowed error of the slip of rate-and-state friction in D_c, where `error` leaves it open [-]
    #[serde(skip, default = "of_critical_slip")]
    #[doc(hidden)]
    pub slip: f64,
}

fn of_critical_slip() -> f64 {
    OF_CRITICAL_SLIP
}

conversions! {
    f64 => IncrementSettings: |initial| Self { initial, min: None, max: None, error: None, pore_pressure: None, slip: OF_CRITICAL_SLIP };
    f64 => RuptureSettings: |slip_rate| Self { slip_rate, safety: 0.9 };
}

impl From<Increments> for IncrementSettings {
    fn from(Increments { initial, min, max, error, slip, pore_pressure }: Increments) -> Self {
        let error = match (error, slip) {
            (None, Some(_)) => None,
            (error, _) => Some(error.map_or(Change::End, Change::To)),
        };
        Self { initial, min: Some(min), max: Some(max), error, pore_pressure, slip: slip.unwrap_or(OF_CRITICAL_SLIP) }
    }
}

setters! { settings: IncrementSettings;
    /// Sets the shortest increment [T].
    min(min: f64) { settings.min = Some(min); }

    /// Sets the longest increment [T].
    max(max: f64) { settings.max = Some(max); }

    /// Sets the error control: the estimated error per increment; [`Change::End`] switches it off [L].
    error(error: impl Into<Change<f64>>) { settings.error = Some(error.into()); }

    /// Sets the error control of water that flows: the estimated error of a pressure per increment [F/L²].
    pore_pressure(error: f64) { settings.pore_pressure = Some(error); }
}

/// Automatic switch of a step to explicit integration and back. An increment in which a contact point slips faster than
/// `slip_rate`, or that cannot be solved, is halved down to `dt.min` and, if that does not help, integrated explicitly.
/// The step returns to its own scheme when no point has slipped that fast, on average over the time that a shear wave
/// takes across the bodies that touch. Frictionless contacts do not count. To be detected, an event must slip more than `slip_rate`
/// times `dt.max`. Remaining waves are removed on return to a static step, and their energy counts as damping
/// dissipation
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Rupture")]
#[non_exhaustive]
pub struct RuptureSettings {
    /// Slip rate above which increments are explicit [L/T]
    pub slip_rate: f64,
    /// Explicit increments as a fraction of the longest stable one, above 0 and at most 1; default 0.9 [-]
    #[serde(default = "ratio::<9, 10>")]
    pub safety: f64,
}

setters! { settings: RuptureSettings;
    /// Sets explicit increments as a fraction of the longest stable one [-].
    safety(safety: f64) { settings.safety = safety; }
}

/// What ends a step: a reaction, for displacement control up to a force, or a degree of consolidation. The increment in which it passes its value
/// is shortened until it has the value. Supports that move to a value stay where the step has ended; tables and
/// expressions continue with the time of the run. Exactly one of `fx`, `fy`, `force` and `consolidation` is given
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Until")]
#[non_exhaustive]
pub struct UntilSettings {
    /// Place of the reaction: the forces of the supports on these nodes; of consolidation a body
    pub on: Place,
    /// Its x component [F]
    pub fx: Option<f64>,
    /// Its y component [F]
    pub fy: Option<f64>,
    /// Its magnitude [F]
    pub force: Option<f64>,
    /// Degree of consolidation of a body whose water flows, 1 less its mean excess pressure over the largest one so far, above 0 and below 1 [-]
    pub consolidation: Option<f64>,
    /// Tolerance relative to the value, or to the reaction at the start of the step if that is larger, at most 0.1;
    /// default 1e-6 [-]
    #[serde(default = "met")]
    pub tolerance: f64,
}

fn met() -> f64 {
    UNTIL_TOLERANCE
}

impl UntilSettings {
    /// Returns component of the reaction, none of consolidation, and value, if exactly one is given.
    #[doc(hidden)]
    pub fn part(&self) -> Option<(Option<ForceComponent>, f64)> {
        let parts = [
            (Some(ForceComponent::X), self.fx),
            (Some(ForceComponent::Y), self.fy),
            (Some(ForceComponent::Magnitude), self.force),
            (None, self.consolidation),
        ];
        let mut given = parts.into_iter().filter_map(|(part, value)| Some((part, value?)));
        given.next().filter(|_| given.next().is_none())
    }
}

/// A support on a group or a node.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Support {
    /// Group, or single node, that is supported
    pub on: Place,
    /// Displacement in x [L]; null releases it, see `supports`
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub ux: Option<Change<Drive>>,
    /// Displacement in y [L]; null releases it, see `supports`
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub uy: Option<Change<Drive>>,
    /// Direction [x, y] of the displacement u; it need not be of unit length
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub along: Option<[f64; 2]>,
    /// Displacement along the direction `along`; the perpendicular component is free, unless another support of the
    /// node constrains it: two directions at a node constrain both of its components. null releases it, see `supports`
    /// [L]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub u: Option<Change<Drive>>,
    /// Displacement along the normal of a side, positive out of the body; the side can slide. The normal is that of the
    /// undeformed body, averaged over the edges at a node; where edges of the group meet at 45 degrees or more, both
    /// normals are constrained. null releases it, see `supports` [L]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub un: Option<Change<Drive>>,
    /// Rigid rotation about a point, instead of all others; null releases it, see `supports`
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub rotation: Option<Change<Rotation>>,
    /// Rotation of a rigid body about its reference point, counter-clockwise; null releases it, see `supports` [rad]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub angle: Option<Change<Drive>>,
}

/// A rigid rotation.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Rotation {
    /// Centre [L]
    pub about: [f64; 2],
    /// Angle, counter-clockwise [rad]
    pub angle: Drive,
}

impl Display for Rotation {
    fn fmt(&self, f: &mut Formatter) -> std::fmt::Result {
        write!(f, "{} about {}", self.angle, vector(self.about))
    }
}

impl Support {
    /// Creates a support at a place without prescribed displacements.
    pub fn on(place: impl Into<Place>) -> Self {
        Self { on: place.into(), ux: None, uy: None, along: None, u: None, un: None, rotation: None, angle: None }
    }

    /// Returns its motions but for a rotation about a point, with their keys.
    pub(super) fn motions(&self) -> impl Iterator<Item = (&'static str, &Change<Drive>)> {
        let all = [("ux", &self.ux), ("uy", &self.uy), ("u", &self.u), ("un", &self.un), ("angle", &self.angle)];
        all.into_iter().filter_map(|(key, change)| Some((key, change.as_ref()?)))
    }
}

setters! { support: Support;
    /// Sets the displacement in x: a value is reached at the end of the step, [`Change::End`] releases it [L].
    ux(ux: impl Into<Change<Drive>>) { support.ux = Some(ux.into()); }

    /// Sets the displacement in y [L].
    uy(uy: impl Into<Change<Drive>>) { support.uy = Some(uy.into()); }

    /// Sets the displacement along a direction, which need not be of unit length [L].
    along(direction: [f64; 2], u: impl Into<Change<Drive>>) {
        support.along = Some(direction);
        support.u = Some(u.into());
    }

    /// Sets the displacement along the normal of a side, positive out of the body [L].
    un(un: impl Into<Change<Drive>>) { support.un = Some(un.into()); }

    /// Sets the rotation of a rigid body about its reference point, counter-clockwise [rad].
    angle(angle: impl Into<Change<Drive>>) { support.angle = Some(angle.into()); }

    /// Sets a rotation about a point, counter-clockwise [rad].
    rotation(about: [f64; 2], angle: impl Into<Drive>) {
        support.rotation = Some(Change::To(Rotation { about, angle: angle.into() }));
    }
}

impl LoadStep {
    /// Creates a step without changes.
    pub fn new(name: impl Into<String>, duration: f64) -> Self {
        Self { name: name.into(), duration, ..Self::default() }
    }

    /// Fixes a place.
    pub fn fix(self, place: impl Into<Place>) -> Self {
        self.support(Support::on(place).ux(0.0).uy(0.0))
    }
}

setters! { step: LoadStep;
    /// Sets the time scheme.
    scheme(scheme: Scheme) { step.scheme = Some(scheme); }

    /// Sets the increments: a first Δt, or all settings [T].
    dt(increments: impl Into<IncrementSettings>) { step.dt = Some(increments.into()); }

    /// Constrains bodies until contact closes, by dashpots that decrease to zero over this static step. Their initial
    /// coefficient equals this fraction of the bodies' stiffness for a motion over the duration of the step; 1e-3 is a good
    /// start [-].
    stabilize(share: f64) { step.stabilize = Some(share); }

    /// Switches to explicit integration while a contact slips faster than a slip rate [L/T]; or all settings.
    rupture(rupture: impl Into<RuptureSettings>) { step.rupture = Some(rupture.into()); }

    /// Sets the damping of a body from this step on.
    damping(body: impl Into<String>, damping: Damping) { step.damping.insert(body.into(), damping); }

    /// Ends the step early when the reaction at a place reaches a value, within a relative tolerance of 1e-6 [F].
    until(on: impl Into<Place>, part: ForceComponent, value: f64) {
        let [fx, fy, force] =
            [ForceComponent::X, ForceComponent::Y, ForceComponent::Magnitude].map(|one| (one == part).then_some(value));
        step.until = Some(UntilSettings { on: on.into(), fx, fy, force, consolidation: None, tolerance: UNTIL_TOLERANCE });
    }

    /// Ends the step early when a body is consolidated to a degree, within a relative tolerance of 1e-6 [-].
    until_consolidated(body: impl Into<Place>, degree: f64) {
        let (on, consolidation) = (body.into(), Some(degree));
        step.until = Some(UntilSettings { on, fx: None, fy: None, force: None, consolidation, tolerance: UNTIL_TOLERANCE });
    }

    /// Assigns a velocity to a body, or to point masses, at the start of the step: a launch after settling [L/T].
    launch(name: impl Into<String>, velocity: [f64; 2]) { step.velocity.insert(name.into(), velocity); }

    /// Sets the temperature of a body: a value is reached at the end of the step [Θ].
    temperature(body: impl Into<String>, temperature: impl Into<BodyTemperature>) {
        step.temperature.insert(body.into(), temperature.into());
    }

    /// Takes a body away at the start of this step.
    remove(body: impl Into<String>) { step.remove.push(body.into()); }

    /// Lets a body come at the start of this step, which is absent before.
    add_body(body: impl Into<String>) { step.add.push(body.into()); }

    /// Adds a support.
    support(support: Support) { step.supports.push(support); }

    /// Adds a place where water flows out of bodies, or into them.
    drain(drainage: DrainageInput) { step.drainage.push(drainage); }

    /// Adds a load.
    load(load: Load) { step.loads.push(load); }
}
