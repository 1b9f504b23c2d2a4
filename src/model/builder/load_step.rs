//! A load step and its loads as they are given: what is not given is as in the step before.

use super::groups::Place;
use crate::model::Damping;
use crate::model::boundary::Drive;
use crate::model::scheme::{Scheme, nine_tenths};
use crate::model::step::Part;

/// Share of a force within which it is met unless told otherwise.
pub const MET: f64 = 1e-6;

/// A load step: a time span with its scheme and increments, supports and loads.
#[derive(Clone, Debug)]
pub struct LoadStep {
    /// Name in messages and results
    pub name: String,
    /// Length of the step [T]
    pub duration: f64,
    /// Time scheme; that of the step before unless given, static in the first step
    pub scheme: Option<Scheme>,
    /// Increments; those of the step before unless given, a tenth of the first step
    pub increments: Option<IncrementSettings>,
    /// Share of the bodies' stiffness with which dashpots that fade away hold them in a static step [-]
    pub stabilize: Option<f64>,
    /// When the step goes on explicitly
    pub rupture: Option<RuptureSettings>,
    /// Damping of bodies from this step on
    pub damping: Vec<(String, Damping)>,
    /// A reaction that ends the step before its time
    pub until: Option<UntilSettings>,
    /// Velocities that bodies and point masses take when the step begins [L/T]
    pub velocities: Vec<(String, [f64; 2])>,
    /// Temperatures of bodies that are new in this step or change; all others stay [Θ]
    pub temperatures: Vec<(String, Drive)>,
    /// Supports that are new in this step or change; all others stay
    pub supports: Vec<Support>,
    /// Loads that are new in this step or change; all others stay
    pub loads: Vec<Load>,
}

/// How increments are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IncrementSettings {
    /// First increment [T]
    pub initial: f64,
    /// Increments are not cut below this [T]; initial/1000 unless given, with `error` initial/10⁶
    pub min: Option<f64>,
    /// Increments do not grow beyond this [T]; initial unless given, with `error` a tenth of the step
    pub max: Option<f64>,
    /// Increments are as long as the estimated error of each stays below this [L]
    pub error: Option<f64>,
}

impl From<f64> for IncrementSettings {
    fn from(initial: f64) -> Self {
        Self { initial, min: None, max: None, error: None }
    }
}

/// When a static or implicit step goes on explicitly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RuptureSettings {
    /// Slip rate of a contact point above which increments are explicit [L/T]
    pub slip_rate: f64,
    /// Explicit increments as a share of the longest that is stable [-]
    pub safety: f64,
}

/// A reaction that ends a step.
#[derive(Clone, Debug, PartialEq)]
pub struct UntilSettings {
    /// Where
    pub on: Place,
    /// Which part of the reaction
    pub part: Part,
    /// What it comes to [F]
    pub value: f64,
    /// Share of the value, or of the reaction at the start of the step if that is larger, within which it is met [-]
    pub tolerance: f64,
}

/// Supports of the nodes at a place.
#[derive(Clone, Debug)]
pub struct Support {
    /// Where
    pub on: Place,
    /// Displacement in x [L]
    pub ux: Option<Change<Drive>>,
    /// Displacement in y [L]
    pub uy: Option<Change<Drive>>,
    /// Displacement along a direction [x, y], which need not be of unit length, toward it [L]
    pub along: Option<([f64; 2], Change<Drive>)>,
    /// Displacement along the normal of a side of the undeformed body, positive out of the body [L]
    pub un: Option<Change<Drive>>,
    /// Rigid rotation, instead of all others
    pub rotation: Option<Change<Rotation>>,
}

/// A rigid rotation about a fixed point.
#[derive(Clone, Debug)]
pub struct Rotation {
    /// Centre [L]
    pub about: [f64; 2],
    /// Angle, counter-clockwise [rad]
    pub angle: Drive,
}

impl Support {
    /// Supports at a place, which prescribe nothing yet.
    pub fn on(place: impl Into<Place>) -> Self {
        Self { on: place.into(), ux: None, uy: None, along: None, un: None, rotation: None }
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
        Self { along: Some((direction, u.into())), ..self }
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
            increments: None,
            stabilize: None,
            rupture: None,
            damping: Vec::new(),
            until: None,
            velocities: Vec::new(),
            temperatures: Vec::new(),
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
        Self { increments: Some(increments.into()), ..self }
    }

    /// Held until contact holds: by dashpots that fade over this static step, at its start as if this share of the bodies'
    /// stiffness moved them in the time of the step; 1e-3 is a good start [-].
    pub fn stabilize(self, share: f64) -> Self {
        Self { stabilize: Some(share), ..self }
    }

    /// Going on explicitly while a contact slips faster than this [L/T].
    pub fn rupture(self, slip_rate: f64) -> Self {
        Self { rupture: Some(RuptureSettings { slip_rate, safety: nine_tenths() }), ..self }
    }

    /// With another damping of a body from this step on.
    pub fn damping(mut self, body: impl Into<String>, damping: Damping) -> Self {
        self.damping.push((body.into(), damping));
        self
    }

    /// Ending before its time when the reaction of a place comes to a value, met to a millionth of it [F].
    pub fn until(self, on: impl Into<Place>, part: Part, value: f64) -> Self {
        Self { until: Some(UntilSettings { on: on.into(), part, value, tolerance: MET }), ..self }
    }

    /// With a body, or point masses, that take a velocity when the step begins: a launch after settling [L/T].
    pub fn launch(mut self, name: impl Into<String>, velocity: [f64; 2]) -> Self {
        self.velocities.push((name.into(), velocity));
        self
    }

    /// With a body whose temperature changes: a value is reached at the end of the step [Θ].
    pub fn temperature(mut self, body: impl Into<String>, temperature: impl Into<Drive>) -> Self {
        self.temperatures.push((body.into(), temperature.into()));
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

/// A load on a group of the mesh or on a node: it replaces the load of its kind that an earlier step gave there.
#[derive(Clone, Debug)]
pub struct Load {
    /// Where
    pub on: Place,
    /// What
    pub action: Action,
}

/// What a load does.
#[derive(Clone, Debug)]
pub enum Action {
    /// Pressure on edges that follows the surface, positive toward the body [F/L²]
    Pressure(Change<Drive>),
    /// Pressure on reference edges that keeps its force and direction, positive toward the body [F/L²]
    DeadPressure(Change<Drive>),
    /// Traction on reference edges that keeps its direction [F/L²]
    Traction(Change<Components>),
    /// Acceleration of gravity on a body or on point masses [L/T²]
    Gravity(Change<Components>),
    /// Force on every node [F]
    Force(Change<Components>),
    /// Force on edges as a whole, spread over them as an even traction [F]
    TotalForce(Change<Components>),
    /// Spring at every node, to the ground or to a moving driver
    Spring(Change<Link>),
    /// Dashpot at every node, to the ground or to a moving driver
    Dashpot(Change<Link>),
    /// Dashpots that let waves out of a side of a body, as if it went on
    Absorbing(Change<()>),
    /// Moment on a plate that turns, counter-clockwise [F L]
    Moment(Change<Drive>),
}

/// Components of a vector; zero unless given.
#[derive(Clone, Debug, Default)]
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

/// A spring or a dashpot.
#[derive(Clone, Debug)]
pub struct Link {
    /// Stiffness in x and y of a spring [F/L], coefficients of a dashpot [F T/L]
    pub coefficients: [f64; 2],
    /// Displacement of the far end of a spring [L], velocity of that of a dashpot [L/T]; the ground unless given
    pub driver: Option<Components>,
}

/// To the ground.
impl From<[f64; 2]> for Change<Link> {
    fn from(coefficients: [f64; 2]) -> Self {
        Self::To(Link { coefficients, driver: None })
    }
}

impl Load {
    /// Pressure on edges that follows the surface, positive toward the body [F/L²]; [`Change::End`] fades it over the step.
    pub fn pressure(on: impl Into<Place>, pressure: impl Into<Change<Drive>>) -> Self {
        Self { on: on.into(), action: Action::Pressure(pressure.into()) }
    }

    /// Pressure on reference edges that keeps its force and direction, positive toward the body [F/L²].
    pub fn dead_pressure(on: impl Into<Place>, pressure: impl Into<Change<Drive>>) -> Self {
        Self { on: on.into(), action: Action::DeadPressure(pressure.into()) }
    }

    /// Traction on reference edges that keeps its direction [F/L²].
    pub fn traction(on: impl Into<Place>, traction: impl Into<Change<Components>>) -> Self {
        Self { on: on.into(), action: Action::Traction(traction.into()) }
    }

    /// Gravity on a body or on point masses [L/T²].
    pub fn gravity(on: impl Into<Place>, acceleration: impl Into<Change<Components>>) -> Self {
        Self { on: on.into(), action: Action::Gravity(acceleration.into()) }
    }

    /// Force on every node [F].
    pub fn force(on: impl Into<Place>, force: impl Into<Change<Components>>) -> Self {
        Self { on: on.into(), action: Action::Force(force.into()) }
    }

    /// Force on edges as a whole, spread over them as an even traction: a unit of depth in plane strain, the thickness of a
    /// plate, the full turn of a ring [F].
    pub fn total_force(on: impl Into<Place>, force: impl Into<Change<Components>>) -> Self {
        Self { on: on.into(), action: Action::TotalForce(force.into()) }
    }

    /// A moment on a plate that turns, counter-clockwise [F L].
    pub fn moment(on: impl Into<Place>, moment: impl Into<Change<Drive>>) -> Self {
        Self { on: on.into(), action: Action::Moment(moment.into()) }
    }

    /// Springs of the stiffnesses k_x, k_y at every node [F/L]; [`Change::End`] takes them away at once.
    pub fn spring(on: impl Into<Place>, stiffness: impl Into<Change<Link>>) -> Self {
        Self { on: on.into(), action: Action::Spring(stiffness.into()) }
    }

    /// Dashpots of the coefficients c_x, c_y at every node [F T/L].
    pub fn dashpot(on: impl Into<Place>, coefficients: impl Into<Change<Link>>) -> Self {
        Self { on: on.into(), action: Action::Dashpot(coefficients.into()) }
    }

    /// A side that absorbs waves.
    pub fn absorbing(on: impl Into<Place>) -> Self {
        Self { on: on.into(), action: Action::Absorbing(Change::To(())) }
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
