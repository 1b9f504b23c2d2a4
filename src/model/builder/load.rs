//! A load as it is given.

use super::change::Change;
use super::groups::Place;
use crate::model::boundary::Drive;

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
