//! The increment in which a contact is evaluated, and what a linear solve presumes about a point of it.

use crate::laws::friction::FrictionState;

/// When a pair is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactIncrement {
    /// t at its end [T]
    pub time: f64,
    /// Δt [T]
    pub dt: f64,
    /// Whether slip radiates, where the contact has a radiation damping: in motions without inertia
    pub radiates: bool,
    /// Share of an initial overlap that does not count yet
    pub fading: f64,
    /// α_n under the augmented Lagrangian is this many times the one given
    pub stiffening: f64,
    /// Whether the bodies give way under the pressures that come up within the increment
    pub settles: bool,
}

impl ContactIncrement {
    /// From when to when.
    pub fn span(&self) -> [f64; 2] {
        [self.time - self.dt, self.time]
    }
}

/// Increment of a contact point, and what the iteration presumes about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointIncrement {
    /// Length of the increment, and what it changes about every point
    pub during: ContactIncrement,
    /// What the linear solve presumes about the point
    pub presumption: Presumption,
}

/// What one linear solve takes over for a point from those before; an accepted state presumes nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Presumption {
    /// Presumption about its state
    pub presume: Presume,
    /// Tractions that the tangent turns and stretches with the surface; those of the trial state unless given
    pub promised: Option<Tractions>,
    /// Pressure of a point that is closed whatever its gap, and under which friction answers unless its own is positive;
    /// none if it is 0
    pub kept: f64,
    /// Pressure under which friction answers, and from where its answer goes on in a straight line, at a point that has just
    /// closed: a stiff penalty presses a point far too hard that goes too deep in one iterate, and would make it stick
    /// where it is to slip.
    pub carried: Option<f64>,
    /// Two segments between which its foot goes to and fro
    pub astride: Option<[usize; 2]>,
}

/// What the next linear solve presumes about a point, for the sake of convergence; an accepted state presumes nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Presume {
    /// The laws answer as they are
    #[default]
    Nothing,
    /// A zero gap is closed and sticks: it would open and close for ever at p = 0
    Touch,
    /// The point sticks, q = q₀ + α_t Δu_t whatever its size. From one iterate to the next it slipped one way and then
    /// the other, past the narrow and stiff range of sticking that lies between: the tangents on both sides are soft,
    /// and Newton's method would jump to and fro for ever. It is presumed again where the point then slips although the
    /// tractions that were promised would have held it.
    Stick,
}

/// Pressure and traction of a point, as one linear solve promised them to the next.
///
/// A stiff penalty turns every error of a displacement into a pressure far too high, and that into a geometric stiffness
/// p δn ℓ that leads the next iterate astray, or opens a point that should be closed. The promise p + δp of the linear
/// solve is off by the square of the correction only: it makes the geometric stiffness, and says which points stay closed.
/// The residual that a solution must meet knows no promises.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tractions {
    /// p [F/L²]
    pub pressure: f64,
    /// q [F/L²]
    pub traction: f64,
}

impl Tractions {
    /// Those of a state.
    pub fn of(friction: &FrictionState) -> Self {
        Self { pressure: friction.pressure, traction: friction.traction }
    }

    /// Both in proportion, so that the pressure is not above a limit.
    pub fn limited(self, most: f64) -> Self {
        let share = if self.pressure > most { most / self.pressure } else { 1.0 };
        Self { pressure: share * self.pressure, traction: share * self.traction }
    }
}
