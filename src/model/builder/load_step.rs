//! A load step and its loads as they are given: what is not given is as in the step before.

use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::groups::Place;
use crate::model::Damping;
use crate::model::boundary::{BodyTemperature, Drive};
use crate::model::scheme::{Scheme, nine_tenths};
use crate::model::step::Part;

/// Default relative tolerance of the force that ends a step.
pub const MET: f64 = 1e-6;

/// A step: a time span with its scheme and increments, supports and loads.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Step")]
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
    /// Supports; inherited, and replaced where the same group and direction is named again. A support released by null
    /// ends at once in dynamic and explicit steps; in a static step, also while `rupture` makes it explicit, its
    /// reaction remains as a force that fades linearly over the step
    #[serde(default)]
    pub supports: Vec<Support>,
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
pub struct IncrementSettings {
    /// First increment [T]
    pub initial: f64,
    /// Shortest increment [T]; default initial/1000, with `error` initial/10⁶, in quasi_dynamic steps the shortest that
    /// round-off of the time allows
    pub min: Option<f64>,
    /// Longest increment [T]; default initial, with `error` and in quasi_dynamic steps a tenth of the step
    pub max: Option<f64>,
    /// Error control: the longest increments whose estimated error stays below this [L]. In dynamic steps it is the
    /// error of a displacement, and contact events (onset, arrest and reversal of slip) are located to ten times this;
    /// in static steps it is the error of the slip of a contact point, half the difference of its plastic slip from
    /// that at the last rate
    pub error: Option<f64>,
}

impl From<f64> for IncrementSettings {
    fn from(initial: f64) -> Self {
        Self { initial, min: None, max: None, error: None }
    }
}

/// Automatic switch of a step to explicit integration and back. An increment in which a contact point slips faster than
/// `slip_rate`, or that cannot be solved, is halved down to `dt.min` and, if that does not help, integrated explicitly.
/// The step returns to its own scheme when no point has slipped that fast, on average over the time that a shear wave
/// takes across the model. Frictionless contacts do not count. To be detected, an event must slip more than `slip_rate`
/// times `dt.max`. Remaining waves are removed on return to a static step, and their energy counts as damping
/// dissipation
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Rupture")]
pub struct RuptureSettings {
    /// Slip rate above which increments are explicit [L/T]
    pub slip_rate: f64,
    /// Explicit increments as a fraction of the longest stable one, above 0 and at most 1; default 0.9 [-]
    #[serde(default = "nine_tenths")]
    pub safety: f64,
}

/// A reaction that ends a step: displacement control up to a force. The increment in which the force passes its value
/// is shortened until it has the value. Supports that move to a value stay where the step has ended; tables and
/// expressions continue with the time of the run. Exactly one of `fx`, `fy` and `force` is given
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Until")]
pub struct UntilSettings {
    /// Place of the reaction: the forces of the supports on these nodes
    pub on: Place,
    /// Its x component [F]
    pub fx: Option<f64>,
    /// Its y component [F]
    pub fy: Option<f64>,
    /// Its magnitude [F]
    pub force: Option<f64>,
    /// Tolerance relative to the value, or to the reaction at the start of the step if that is larger, at most 0.1;
    /// default 1e-6 [-]
    #[serde(default = "met")]
    pub tolerance: f64,
}

fn met() -> f64 {
    MET
}

impl UntilSettings {
    /// Part of the reaction and its value, if exactly one is given.
    pub fn part(&self) -> Option<(Part, f64)> {
        let parts = [(Part::X, self.fx), (Part::Y, self.fy), (Part::Size, self.force)];
        let mut given = parts.into_iter().filter_map(|(part, value)| Some((part, value?)));
        given.next().filter(|_| given.next().is_none())
    }
}

/// A support on a group or a node.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Where
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
}

/// A rigid rotation.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
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

    /// Constrained until contact closes: by dashpots that fade over this static step, at its start as if this share of
    /// the bodies' stiffness moved them in the time of the step; 1e-3 is a good start [-].
    pub fn stabilize(self, share: f64) -> Self {
        Self { stabilize: Some(share), ..self }
    }

    /// Explicit integration while a contact slips faster than this [L/T].
    pub fn rupture(self, slip_rate: f64) -> Self {
        Self { rupture: Some(RuptureSettings { slip_rate, safety: nine_tenths() }), ..self }
    }

    /// With another damping of a body from this step on.
    pub fn damping(mut self, body: impl Into<String>, damping: Damping) -> Self {
        self.damping.insert(body.into(), damping);
        self
    }

    /// Ending before its time when the reaction of a place comes to a value, met to a millionth of it [F].
    pub fn until(self, on: impl Into<Place>, part: Part, value: f64) -> Self {
        let [fx, fy, force] = [Part::X, Part::Y, Part::Size].map(|one| (one == part).then_some(value));
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

/// A load: exactly one kind per entry. It replaces the load of the same kind and place of an earlier step.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
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
    /// Resultant force on edges, applied as a uniform traction: per unit of depth in plane strain, for the thickness in
    /// plane stress, per full turn in axisymmetry. Its expressions depend on t only [F]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub total_force: Option<Change<Components>>,
    /// Moment on a loading plate that moves as a rigid body, counter-clockwise; it rotates with the plate [F L]
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub moment: Option<Change<Drive>>,
    /// Spring at every node of the group, to the ground or to a moving driver; its work on the node counts as external
    /// work
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub spring: Option<Change<SpringLoad>>,
    /// Dashpot at every node of the group, to the ground or to a moving driver
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub dashpot: Option<Change<DashpotLoad>>,
    /// true: an absorbing side, as if the body were unbounded there (Lysmer-Kuhlemeyer: dashpots rho c_p along the
    /// normal and rho c_s along the side, of the undeformed body); false or null ends it
    #[serde(default, deserialize_with = "present", skip_serializing_if = "Option::is_none")]
    pub absorbing: Option<Change<bool>>,
}

/// The one thing that a load does.
#[derive(Clone, Copy, Debug)]
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
pub struct SpringLoad {
    /// Stiffness in x [F/L]
    #[serde(default)]
    pub kx: f64,
    /// Stiffness in y [F/L]
    #[serde(default)]
    pub ky: f64,
    /// Displacement of the far end; default: the ground [L]
    pub driver: Option<Components>,
}

/// A dashpot: force c (v_driver − v). In statics v is the mean velocity of the increment.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Dashpot")]
pub struct DashpotLoad {
    /// Coefficient in x [F T/L]
    #[serde(default)]
    pub cx: f64,
    /// Coefficient in y [F T/L]
    #[serde(default)]
    pub cy: f64,
    /// Velocity of the far end; default: the ground [L/T]
    pub driver: Option<Components>,
}

/// To the ground.
impl From<[f64; 2]> for Change<SpringLoad> {
    fn from([kx, ky]: [f64; 2]) -> Self {
        Self::To(SpringLoad { kx, ky, driver: None })
    }
}

/// To the ground.
impl From<[f64; 2]> for Change<DashpotLoad> {
    fn from([cx, cy]: [f64; 2]) -> Self {
        Self::To(DashpotLoad { cx, cy, driver: None })
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

    /// Resultant force on edges, applied as a uniform traction: per unit of depth in plane strain, for the thickness in
    /// plane stress, per full turn in axisymmetry [F].
    pub fn total_force(on: impl Into<Place>, force: impl Into<Change<Components>>) -> Self {
        Self { total_force: Some(force.into()), ..Self::on(on) }
    }

    /// A moment on a plate that can rotate, counter-clockwise [F L].
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
