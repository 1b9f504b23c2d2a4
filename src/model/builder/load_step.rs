//! A load step and its loads as they are given: what is not given is as in the step before.

use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::groups::Place;
use crate::model::Damping;
use crate::model::boundary::{BodyTemperature, Drive};
use crate::model::scheme::{Scheme, nine_tenths};
use crate::model::step::ForceComponent;

/// Share of a force within which it is met unless told otherwise.
#[doc(hidden)]
pub const MET: f64 = 1e-6;

/// A step: a time span with its scheme and increments, supports and loads.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Step")]
#[non_exhaustive]
#[must_use]
pub struct LoadStep {
    /// Name in messages and results
    pub name: String,
    /// Length of the step [T]
    pub duration: f64,
    /// Time scheme; inherited from the step before unless given, static in the first step
    pub scheme: Option<Scheme>,
    /// Increments; inherited from the step before unless given, a tenth of the first step
    pub dt: Option<IncrementSettings>,
    /// Static steps only, where bodies are held by nothing until contact holds them: dashpots at all nodes of every body
    /// resist motion, at the start of the step as if this share of the body's stiffness lambda + 2G moved it in the
    /// time of the step; they fade linearly and are gone at its end, which takes at least two increments. 1e-3 is a good
    /// start. Not inherited
    pub stabilize: Option<f64>,
    /// Static and implicit steps: the step goes on explicitly while a contact slips fast. Not inherited
    pub rupture: Option<RuptureSettings>,
    /// Velocity [x, y] that whole bodies or point masses take when this step begins, a dynamic or explicit one: settle under gravity,
    /// then launch. What it changes of the kinetic energy counts as work from outside. Supported nodes keep to their supports [L/T]
    #[serde(default)]
    pub velocity: BTreeMap<String, [f64; 2]>,
    /// Damping of bodies from this step on, in place of what the body or a step before has; inherited. Statics know none
    #[serde(default)]
    pub damping: BTreeMap<String, Damping>,
    /// Static and implicit steps: the step ends before its time when a reaction comes to a value, and those after it begin then.
    /// A step that comes to its own end without stops the run. Not inherited
    pub until: Option<UntilSettings>,
    /// Temperature of bodies that have `thermal` [Θ]; inherited, and replaced where the same body is named again. A number is reached
    /// linearly at the end of the step, from the temperature at its start; expressions may have the reference position x, y
    /// and the run time t
    #[serde(default)]
    pub temperature: BTreeMap<String, BodyTemperature>,
    /// Supports; inherited, and replaced where the same group and direction is named again. One that null frees is gone at
    /// once in dynamic and explicit steps; in a static step, also while `rupture` makes it explicit, its reaction stays as a
    /// force that fades linearly over the step
    #[serde(default)]
    pub supports: Vec<Support>,
    /// Loads; inherited, and replaced where the same group and kind is named again. In any scheme null takes a pressure,
    /// traction, force or gravity linearly to zero over the step, as the value 0 would, and ends springs, dashpots and
    /// absorbing sides at once. A table or expression makes an end as sudden as it is to be
    #[serde(default)]
    pub loads: Vec<Load>,
}

/// Increments of a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Increments")]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct IncrementSettings {
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

impl From<f64> for IncrementSettings {
    fn from(initial: f64) -> Self {
        Self { initial, min: None, max: None, error: None }
    }
}

impl IncrementSettings {
    /// Never cut below this [T].
    pub fn min(self, min: f64) -> Self {
        Self { min: Some(min), ..self }
    }

    /// Never growing beyond this [T].
    pub fn max(self, max: f64) -> Self {
        Self { max: Some(max), ..self }
    }

    /// As long as their estimated error stays below this [L].
    pub fn error(self, error: f64) -> Self {
        Self { error: Some(error), ..self }
    }
}

/// When a step goes on explicitly, and returns to its own scheme. An increment in which a contact point slips faster than
/// `slip_rate`, or that cannot be solved, is halved down to `dt.min` and, if that does not help, made explicitly. The step
/// returns when no point has slipped that fast, on the mean of the time that a shear wave takes across the model. What slides
/// without friction does not count. To be noticed, an event must slip more than `slip_rate` times `dt.max`. Waves that are
/// left die in a static step, and their energy counts as damped
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Rupture")]
#[non_exhaustive]
#[must_use]
pub struct RuptureSettings {
    /// Slip rate above which increments are explicit [L/T]
    pub slip_rate: f64,
    /// Explicit increments as a share of the longest that is stable, above 0 and at most 1; 0.9 unless given [-]
    #[serde(default = "nine_tenths")]
    pub safety: f64,
}

impl From<f64> for RuptureSettings {
    fn from(slip_rate: f64) -> Self {
        Self { slip_rate, safety: nine_tenths() }
    }
}

impl RuptureSettings {
    /// Explicit increments as another share of the longest that is stable [-].
    pub fn safety(self, safety: f64) -> Self {
        Self { safety, ..self }
    }
}

/// A reaction that ends a step: displacement control up to a force. The increment in which the force passes its value is made
/// shorter until it has it. Supports that were to come to a value stay where the step has ended; tables and expressions go on by
/// the time of the run. Exactly one of `fx`, `fy` and `force` is given
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Until")]
#[non_exhaustive]
pub struct UntilSettings {
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

impl UntilSettings {
    /// Part of the reaction and its value, if exactly one is given.
    #[doc(hidden)]
    pub fn part(&self) -> Option<(ForceComponent, f64)> {
        let parts =
            [(ForceComponent::X, self.fx), (ForceComponent::Y, self.fy), (ForceComponent::Magnitude, self.force)];
        let mut given = parts.into_iter().filter_map(|(part, value)| Some((part, value?)));
        given.next().filter(|_| given.next().is_none())
    }
}

/// A support on a group or a node.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct Support {
    /// Where
    pub on: Place,
    /// Displacement in x [L]; null frees it, see `supports`
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub ux: Option<Change<Drive>>,
    /// Displacement in y [L]; null frees it, see `supports`
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub uy: Option<Change<Drive>>,
    /// Direction [x, y] of the displacement u; it need not be of unit length
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub along: Option<[f64; 2]>,
    /// Displacement along the direction `along`; what is across is free, unless another support of the node holds that as well:
    /// two directions at a node hold both of its components. null frees it, see `supports` [L]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub u: Option<Change<Drive>>,
    /// Displacement along the normal of a side, positive out of the body; the side slides. The normal is that of the undeformed
    /// body, averaged over the edges at a node; where edges of the group meet at 45 degrees or more, both normals hold. null
    /// frees it, see `supports` [L]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub un: Option<Change<Drive>>,
    /// Rigid rotation about a point, instead of all others; null frees it, see `supports`
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub rotation: Option<Change<Rotation>>,
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

impl Support {
    /// Supports at a place, which prescribe nothing yet.
    pub fn on(place: impl Into<Place>) -> Self {
        Self { on: place.into(), ux: None, uy: None, along: None, u: None, un: None, rotation: None }
    }

    /// Its displacements, with their keys.
    #[doc(hidden)]
    pub fn displacements(&self) -> impl Iterator<Item = (&'static str, &Change<Drive>)> {
        let all = [("ux", &self.ux), ("uy", &self.uy), ("u", &self.u), ("un", &self.un)];
        all.into_iter().filter_map(|(key, change)| Some((key, change.as_ref()?)))
    }

    /// With a displacement in x: a value is reached at the end of the step, [`Change::End`] frees it [L].
    pub fn ux(self, ux: impl Into<Change<Drive>>) -> Self {
        Self { ux: Some(ux.into()), ..self }
    }

    /// With a displacement in y [L].
    pub fn uy(self, uy: impl Into<Change<Drive>>) -> Self {
        Self { uy: Some(uy.into()), ..self }
    }

    /// With a displacement along a direction, which need not be of unit length [L].
    pub fn along(self, direction: [f64; 2], u: impl Into<Change<Drive>>) -> Self {
        Self { along: Some(direction), u: Some(u.into()), ..self }
    }

    /// With a displacement along the normal of a side, positive out of the body [L].
    pub fn un(self, un: impl Into<Change<Drive>>) -> Self {
        Self { un: Some(un.into()), ..self }
    }

    /// With a rotation about a point, counter-clockwise [rad].
    pub fn rotation(self, about: [f64; 2], angle: impl Into<Drive>) -> Self {
        Self { rotation: Some(Change::To(Rotation { about, angle: angle.into() })), ..self }
    }
}

impl LoadStep {
    /// A step that changes nothing yet.
    pub fn new(name: impl Into<String>, duration: f64) -> Self {
        Self {
            name: name.into(),
            duration,
            scheme: None,
            dt: None,
            stabilize: None,
            rupture: None,
            velocity: BTreeMap::new(),
            damping: BTreeMap::new(),
            until: None,
            temperature: BTreeMap::new(),
            supports: Vec::new(),
            loads: Vec::new(),
        }
    }

    /// With another time scheme.
    pub fn scheme(self, scheme: Scheme) -> Self {
        Self { scheme: Some(scheme), ..self }
    }

    /// With other increments: a first Δt, or all settings [T].
    pub fn dt(self, increments: impl Into<IncrementSettings>) -> Self {
        Self { dt: Some(increments.into()), ..self }
    }

    /// Held until contact holds: by dashpots that fade over this static step, at its start as if this share of the bodies'
    /// stiffness moved them in the time of the step; 1e-3 is a good start [-].
    pub fn stabilize(self, share: f64) -> Self {
        Self { stabilize: Some(share), ..self }
    }

    /// Going on explicitly while a contact slips faster than this: a slip rate [L/T], or all settings.
    pub fn rupture(self, rupture: impl Into<RuptureSettings>) -> Self {
        Self { rupture: Some(rupture.into()), ..self }
    }

    /// With another damping of a body from this step on.
    pub fn damping(mut self, body: impl Into<String>, damping: Damping) -> Self {
        self.damping.insert(body.into(), damping);
        self
    }

    /// Ending before its time when the reaction of a place comes to a value, met to a millionth of it [F].
    pub fn until(self, on: impl Into<Place>, part: ForceComponent, value: f64) -> Self {
        let [fx, fy, force] =
            [ForceComponent::X, ForceComponent::Y, ForceComponent::Magnitude].map(|one| (one == part).then_some(value));
        Self { until: Some(UntilSettings { on: on.into(), fx, fy, force, tolerance: MET }), ..self }
    }

    /// With a body, or point masses, that take a velocity when the step begins: a launch after settling [L/T].
    pub fn launch(mut self, name: impl Into<String>, velocity: [f64; 2]) -> Self {
        self.velocity.insert(name.into(), velocity);
        self
    }

    /// With a body whose temperature changes: a value is reached at the end of the step [Θ].
    pub fn temperature(mut self, body: impl Into<String>, temperature: impl Into<BodyTemperature>) -> Self {
        self.temperature.insert(body.into(), temperature.into());
        self
    }

    /// With a support.
    pub fn support(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }

    /// With a place that does not move.
    pub fn fix(self, place: impl Into<Place>) -> Self {
        self.support(Support::on(place).ux(0.0).uy(0.0))
    }

    /// With a load.
    pub fn load(mut self, load: Load) -> Self {
        self.loads.push(load);
        self
    }
}

/// A load: exactly one kind an entry. It replaces the load of its kind that an earlier step gave there.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct Load {
    /// Where
    pub on: Place,
    /// Pressure on edges that follows the surface, positive toward the body [F/L²]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub pressure: Option<Change<Drive>>,
    /// Pressure on edges that keeps the force and direction it has on the undeformed edges, positive toward the body [F/L²]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub dead_pressure: Option<Change<Drive>>,
    /// Traction on reference edges that keeps its direction [F/L²]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub traction: Option<Change<Components>>,
    /// Acceleration of gravity on a body or on point masses [L/T²]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub gravity: Option<Change<Components>>,
    /// Force on every node of the group [F]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub force: Option<Change<Components>>,
    /// Force on edges as a whole, spread over them as an even traction: a unit of depth in plane strain, the thickness of a
    /// plate, the full turn of a ring. Its expressions depend on t alone [F]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub total_force: Option<Change<Components>>,
    /// Moment on a plate that moves as a rigid body, counter-clockwise; it turns with the plate [F L]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub moment: Option<Change<Drive>>,
    /// Spring at every node of the group, to the ground or to a moving driver; what it does to the node counts as work
    /// from outside
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub spring: Option<Change<SpringLoad>>,
    /// Dashpot at every node of the group, to the ground or to a moving driver
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub dashpot: Option<Change<DashpotLoad>>,
    /// true: a side of a body absorbs waves, as if the body went on (Lysmer-Kuhlemeyer: dashpots rho c_p along the normal
    /// and rho c_s along the side, of the undeformed body); false or null ends it
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub absorbing: Option<Change<bool>>,
}

/// The one thing that a load does.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub enum Action<'l> {
    /// `pressure`
    Pressure(Option<&'l Drive>),
    /// `dead_pressure`
    DeadPressure(Option<&'l Drive>),
    /// `traction`
    Traction(Option<&'l Components>),
    /// `gravity`
    Gravity(Option<&'l Components>),
    /// `force`
    Force(Option<&'l Components>),
    /// `total_force`
    TotalForce(Option<&'l Components>),
    /// `moment`
    Moment(Option<&'l Drive>),
    /// `spring`
    Spring(Option<&'l SpringLoad>),
    /// `dashpot`
    Dashpot(Option<&'l DashpotLoad>),
    /// `absorbing`, and whether it does
    Absorbing(bool),
}

/// Components of a vector; zero unless given.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
pub struct Components {
    /// x component
    pub x: Option<Drive>,
    /// y component
    pub y: Option<Drive>,
}

impl Components {
    /// The component along x (0) or y (1).
    pub fn along(&self, component: usize) -> Option<&Drive> {
        if component == 0 { self.x.as_ref() } else { self.y.as_ref() }
    }
}

impl<D: Into<Drive>> From<[D; 2]> for Components {
    fn from([x, y]: [D; 2]) -> Self {
        Self { x: Some(x.into()), y: Some(y.into()) }
    }
}

impl<D: Into<Drive>> From<[D; 2]> for Change<Components> {
    fn from(components: [D; 2]) -> Self {
        Self::To(components.into())
    }
}

/// A spring.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Spring")]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct SpringLoad {
    /// Stiffness in x [F/L]
    #[serde(default)]
    pub kx: f64,
    /// Stiffness in y [F/L]
    #[serde(default)]
    pub ky: f64,
    /// Displacement of the far end; the ground unless given [L]
    pub driver: Option<Components>,
}

impl SpringLoad {
    /// Of the stiffness along x and along y, to the ground [F/L].
    pub fn new(kx: f64, ky: f64) -> Self {
        Self { kx, ky, driver: None }
    }

    /// To a far end that moves: its displacement [L].
    pub fn driver(self, driver: impl Into<Components>) -> Self {
        Self { driver: Some(driver.into()), ..self }
    }
}

/// A dashpot: force c (v_driver − v). In statics v is the mean velocity of the increment.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Dashpot")]
#[cfg_attr(not(feature = "internals"), non_exhaustive)]
#[must_use]
pub struct DashpotLoad {
    /// Coefficient in x [F T/L]
    #[serde(default)]
    pub cx: f64,
    /// Coefficient in y [F T/L]
    #[serde(default)]
    pub cy: f64,
    /// Velocity of the far end; the ground unless given [L/T]
    pub driver: Option<Components>,
}

impl DashpotLoad {
    /// Of the coefficient along x and along y, to the ground [F T/L].
    pub fn new(cx: f64, cy: f64) -> Self {
        Self { cx, cy, driver: None }
    }

    /// To a far end that moves: its velocity [L/T].
    pub fn driver(self, driver: impl Into<Components>) -> Self {
        Self { driver: Some(driver.into()), ..self }
    }
}

impl From<SpringLoad> for Change<SpringLoad> {
    fn from(spring: SpringLoad) -> Self {
        Self::To(spring)
    }
}

impl From<DashpotLoad> for Change<DashpotLoad> {
    fn from(dashpot: DashpotLoad) -> Self {
        Self::To(dashpot)
    }
}

/// To the ground.
impl From<[f64; 2]> for Change<SpringLoad> {
    fn from([kx, ky]: [f64; 2]) -> Self {
        Self::To(SpringLoad::new(kx, ky))
    }
}

/// To the ground.
impl From<[f64; 2]> for Change<DashpotLoad> {
    fn from([cx, cy]: [f64; 2]) -> Self {
        Self::To(DashpotLoad::new(cx, cy))
    }
}

impl Load {
    /// Nothing yet at a place.
    fn on(place: impl Into<Place>) -> Self {
        Self {
            on: place.into(),
            pressure: None,
            dead_pressure: None,
            traction: None,
            gravity: None,
            force: None,
            total_force: None,
            moment: None,
            spring: None,
            dashpot: None,
            absorbing: None,
        }
    }

    /// What it does, where exactly one thing is given; without a value where that ends.
    #[doc(hidden)]
    pub fn action(&self) -> Option<Action<'_>> {
        let given = [
            self.pressure.as_ref().map(|change| Action::Pressure(change.given())),
            self.dead_pressure.as_ref().map(|change| Action::DeadPressure(change.given())),
            self.traction.as_ref().map(|change| Action::Traction(change.given())),
            self.gravity.as_ref().map(|change| Action::Gravity(change.given())),
            self.force.as_ref().map(|change| Action::Force(change.given())),
            self.total_force.as_ref().map(|change| Action::TotalForce(change.given())),
            self.moment.as_ref().map(|change| Action::Moment(change.given())),
            self.spring.as_ref().map(|change| Action::Spring(change.given())),
            self.dashpot.as_ref().map(|change| Action::Dashpot(change.given())),
            self.absorbing.as_ref().map(|change| Action::Absorbing(change.given() == Some(&true))),
        ];
        let mut given = given.into_iter().flatten();
        given.next().filter(|_| given.next().is_none())
    }

    /// Pressure on edges that follows the surface, positive toward the body [F/L²]; [`Change::End`] fades it over the step.
    pub fn pressure(on: impl Into<Place>, pressure: impl Into<Change<Drive>>) -> Self {
        Self { pressure: Some(pressure.into()), ..Self::on(on) }
    }

    /// Pressure on reference edges that keeps its force and direction, positive toward the body [F/L²].
    pub fn dead_pressure(on: impl Into<Place>, pressure: impl Into<Change<Drive>>) -> Self {
        Self { dead_pressure: Some(pressure.into()), ..Self::on(on) }
    }

    /// Traction on reference edges that keeps its direction [F/L²].
    pub fn traction(on: impl Into<Place>, traction: impl Into<Change<Components>>) -> Self {
        Self { traction: Some(traction.into()), ..Self::on(on) }
    }

    /// Gravity on a body or on point masses [L/T²].
    pub fn gravity(on: impl Into<Place>, acceleration: impl Into<Change<Components>>) -> Self {
        Self { gravity: Some(acceleration.into()), ..Self::on(on) }
    }

    /// Force on every node [F].
    pub fn force(on: impl Into<Place>, force: impl Into<Change<Components>>) -> Self {
        Self { force: Some(force.into()), ..Self::on(on) }
    }

    /// Force on edges as a whole, spread over them as an even traction: a unit of depth in plane strain, the thickness of a
    /// plate, the full turn of a ring [F].
    pub fn total_force(on: impl Into<Place>, force: impl Into<Change<Components>>) -> Self {
        Self { total_force: Some(force.into()), ..Self::on(on) }
    }

    /// A moment on a plate that turns, counter-clockwise [F L].
    pub fn moment(on: impl Into<Place>, moment: impl Into<Change<Drive>>) -> Self {
        Self { moment: Some(moment.into()), ..Self::on(on) }
    }

    /// Springs of the stiffnesses k_x, k_y at every node [F/L]; [`Change::End`] takes them away at once.
    pub fn spring(on: impl Into<Place>, stiffness: impl Into<Change<SpringLoad>>) -> Self {
        Self { spring: Some(stiffness.into()), ..Self::on(on) }
    }

    /// Dashpots of the coefficients c_x, c_y at every node [F T/L].
    pub fn dashpot(on: impl Into<Place>, coefficients: impl Into<Change<DashpotLoad>>) -> Self {
        Self { dashpot: Some(coefficients.into()), ..Self::on(on) }
    }

    /// A side that absorbs waves.
    pub fn absorbing(on: impl Into<Place>) -> Self {
        Self { absorbing: Some(Change::To(true)), ..Self::on(on) }
    }
}

/// What a step does to a support or a load: give it anew, or end it.
#[derive(Clone, Debug, PartialEq)]
pub enum Change<T> {
    /// From now on it is this
    To(T),
    /// It ends
    End,
}

impl<T> Change<T> {
    /// What is given, if it does not end.
    pub fn given(&self) -> Option<&T> {
        match self {
            Self::To(given) => Some(given),
            Self::End => None,
        }
    }
}

impl<T: Serialize> Serialize for Change<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.given().serialize(serializer)
    }
}

impl<T: JsonSchema> JsonSchema for Change<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        Option::<T>::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Option::<T>::json_schema(generator)
    }
}

/// Tell a key that is `null`, which ends what an earlier step gave, from one that is absent and changes nothing.
fn present<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Change<T>>, D::Error> {
    let given = Option::deserialize(deserializer)?;
    Ok(Some(given.map_or(Change::End, Change::To)))
}

impl From<f64> for Change<Drive> {
    fn from(value: f64) -> Self {
        Self::To(value.into())
    }
}

impl From<Drive> for Change<Drive> {
    fn from(drive: Drive) -> Self {
        Self::To(drive)
    }
}
