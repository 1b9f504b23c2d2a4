//! The friction-law contract: what an interface point remembers, and how a law answers one increment.
//!
//! A law is a pure function of (committed state, increment). It sees scalars in the frame that turns with the
//! interface, never nodes or meshes, so the same law serves a finite-element interface, a point mass or a test.
//!
//! Signs: `q` resists positive slip of the slave along +s; pressure is positive in compression.
//!
//! Laws: [`SuperSubloading`], [`SlipWeakening`], [`RateAndState`], [`Coulomb`], [`Frictionless`]; [`FrictionParameters`]
//! reads any of them from a case.

mod approach;
mod coulomb;
mod exponential_integral;
mod frictionless;
mod parameters;
mod path;
mod peak;
mod rate_and_state;
mod root;
mod slip_equation;
mod slip_weakening;
mod super_subloading;

use std::fmt::Debug;

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use approach::Approach;
pub use coulomb::{Coulomb, CoulombParameters};
pub use frictionless::Frictionless;
pub use parameters::FrictionParameters;
pub use peak::Integration;
pub use rate_and_state::{RateAndState, RateAndStateParameters, StateEvolution};
pub use slip_weakening::{SlipWeakening, SlipWeakeningParameters};
pub use super_subloading::{SuperSubloading, SuperSubloadingParameters};

/// What friction remembers at one contact point between increments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrictionState {
    /// q: traction that resists the slip of the slave along +s [F/L²]
    pub traction: f64,
    /// p: contact pressure, positive in compression [F/L²]
    pub pressure: f64,
    /// μ: peak coefficient available now, μ_k ≤ μ ≤ μ_s for the super/subloading law; for rate-and-state friction the
    /// coefficient at the reference slip rate [-]
    pub mu: f64,
    /// Total plastic slip, signed along +s [L]
    pub plastic_slip: f64,
    /// Plastic slip of the last increment, signed along +s [L]
    pub plastic_increment: f64,
    /// Work dissipated by friction so far per contact area [F/L]
    pub dissipation: f64,
}

impl FrictionState {
    /// R = |q|/(μ p): how far the traction is from the peak surface; 0 where nothing is pressed [-]
    pub fn ratio(&self) -> f64 {
        let strength = self.mu * self.pressure;
        if strength > 0.0 { self.traction.abs() / strength } else { 0.0 }
    }

    /// The state after the surfaces have parted: the elastic energy q²/(2 α_t) of the contact spring is lost.
    fn parted(self, mu: f64, stiffness: f64) -> Self {
        let lost = self.traction * self.traction / (2.0 * stiffness);
        let dissipation = self.dissipation + lost;
        Self { traction: 0.0, pressure: 0.0, mu, plastic_increment: 0.0, dissipation, ..self }
    }

    /// The state after an increment whose slip was all elastic.
    fn stuck(self, traction: f64, pressure: f64, mu: f64) -> Self {
        Self { traction, pressure, mu, plastic_increment: 0.0, ..self }
    }

    /// The state after plastic slip along sgn q has brought the traction down from the elastic `trial` to `traction`.
    ///
    /// ```text
    /// Δλ = (|q_tr| − |q|)/α_t       plastic slip
    /// ΔW = ∫ |q| dλ = q̄ Δλ ≥ 0      work dissipated; q̄, the mean of |q| over the plastic slip, is the law's to know
    /// ```
    /// The work ∫ q du of the increment, along the path that the law takes inside it, is Δ(q²/2α_t) + ΔW.
    fn slid(self, trial: f64, traction: f64, mean: f64, (pressure, mu): (f64, f64), stiffness: f64) -> Self {
        let sign = traction.signum();
        let slip = ((trial - traction) * sign / stiffness).max(0.0);
        Self {
            traction,
            pressure,
            mu,
            plastic_slip: self.plastic_slip + sign * slip,
            plastic_increment: sign * slip,
            dissipation: self.dissipation + mean * slip,
        }
    }
}

/// |q| where plastic slip sets in, in an increment along which the elastic traction and the strength both go evenly from
/// their first value to their second, and the traction ends above. One that is above from the start slips from there.
///
/// Both lines are counted along the sign of the trial, so a traction of the other sign unloads elastically, passes zero,
/// and loads elastically up to the strength.
fn traction_at_yield(elastic: [f64; 2], strength: [f64; 2]) -> f64 {
    let (below, above) = (strength[0] - elastic[0], elastic[1] - strength[1]);
    if below <= 0.0 || above <= 0.0 {
        return elastic[0].max(0.0);
    }
    strength[0] + below / (below + above) * (strength[1] - strength[0])
}

/// Relative motion of the two surfaces during one increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sliding {
    /// Δu_t: slip increment of the slave relative to the master along +s [L]
    pub slip: f64,
    /// p: pressure at the end of the increment, ≤ 0 where the point is open [F/L²]
    pub pressure: f64,
    /// Δt: length of the increment [T]
    pub dt: f64,
}

impl Sliding {
    /// Refuses what no law can answer.
    fn checked(self) -> Result<Self, LawFailure> {
        let Self { slip, pressure, dt } = self;
        if !(slip.is_finite() && pressure.is_finite() && dt.is_finite()) {
            return Err(LawFailure::NotFinite { slip, pressure, dt });
        }
        if dt < 0.0 {
            return Err(LawFailure::NegativeTime { dt });
        }
        Ok(self)
    }
}

/// No law answers a tangent |∂q/∂Δu_t| above this many times α_t, or |∂q/∂p| above it. Where two roots of a law's equation
/// of plastic slip merge the traction snaps, and just before it the derivative grows without bound, like the inverse of the
/// root of the distance to the snap. It is exact up to here; beyond, the distance is lost in round-off.
pub const STEEPEST: f64 = 1e8;

/// Least −∂G/∂Δλ over α_t of an equation of plastic slip that a tangent is computed with.
const LEAST_SLOPE: f64 = 1.0 / STEEPEST;

/// The answer of a law to one increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionResponse {
    /// State at the end of the increment.
    pub state: FrictionState,
    /// ∂q/∂Δu_t [F/L³]
    pub dtraction_dslip: f64,
    /// ∂q/∂p [-]
    pub dtraction_dpressure: f64,
    /// Evaluations of the scalar equation of plastic slip that this answer took; 0 where it has a closed form
    pub evaluations: usize,
}

impl FrictionResponse {
    /// The answer that `state` follows without plastic slip, where q has the tangent `stiffness` by slip.
    fn elastic(state: FrictionState, stiffness: f64) -> Self {
        Self { state, dtraction_dslip: stiffness, dtraction_dpressure: 0.0, evaluations: 0 }
    }

    /// Bounds the tangent to what [`FrictionLaw::respond`] promises for the stiffness α_t, and refuses numbers that have
    /// overflowed, and those of a committed state that was not finite.
    fn checked(mut self, stiffness: f64) -> Result<Self, LawFailure> {
        self.dtraction_dslip = self.dtraction_dslip.clamp(-STEEPEST * stiffness, STEEPEST * stiffness);
        self.dtraction_dpressure = self.dtraction_dpressure.clamp(-STEEPEST, STEEPEST);
        let FrictionState { traction, pressure, mu, plastic_slip, plastic_increment, dissipation } = self.state;
        let state = traction + pressure + mu + plastic_slip + plastic_increment + dissipation;
        if (state + self.dtraction_dslip + self.dtraction_dpressure).is_finite() {
            Ok(self)
        } else {
            Err(LawFailure::Overflow { traction })
        }
    }
}

/// Why a law could not answer; the increment is tried again with a smaller step.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LawFailure {
    /// The increment itself is not a finite number.
    #[error("friction was asked for a slip {slip}, pressure {pressure} and time {dt} that are not all finite")]
    NotFinite {
        /// slip increment [L]
        slip: f64,
        /// pressure [F/L²]
        pressure: f64,
        /// increment length [T]
        dt: f64,
    },
    /// The increment goes back in time.
    #[error("friction was asked for an increment of negative time {dt}")]
    NegativeTime {
        /// increment length [T]
        dt: f64,
    },
    /// The equation of plastic slip was not solved, or the sub-steps of the increment did not come to agree.
    #[error(
        "friction did not converge within {evaluations} evaluations: {rest:.3e} of the trial traction {trial:.3e} is left"
    )]
    NotConverged {
        /// evaluations of the equation of plastic slip
        evaluations: usize,
        /// what is left out of balance, or the difference between sub-steps [F/L²]
        rest: f64,
        /// |q_tr|: traction without plastic slip [F/L²]
        trial: f64,
    },
    /// The state was not finite, or the increment is so large that it no longer is.
    #[error("the friction state is not finite: the traction is {traction}")]
    Overflow {
        /// q: traction [F/L²]
        traction: f64,
    },
}

/// A friction law, integrated over one increment. Pure: the same `old` and `sliding` give the same answer.
pub trait FrictionLaw: Debug + Send + Sync {
    /// State of a point that has just come into contact.
    fn initial_state(&self) -> FrictionState;

    /// q and the state variables at the end of the increment, with the consistent tangent ∂q/∂Δu_t, ∂q/∂p, limited to
    /// ± [`STEEPEST`] times α_t, or 1.
    ///
    /// # Errors
    /// [`LawFailure`] when the increment or the answer is not finite, time goes backwards, or the law's equations are not
    /// solved to their tolerance.
    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Result<FrictionResponse, LawFailure>;

    /// α_t: tangential contact stiffness; the contact stores q²/(2 α_t). 0 without friction [F/L³]
    fn stiffness(&self) -> f64;

    /// 1/R* = μ/μ_k: degree of structure that belongs to a peak coefficient; 1 for a law without structure [-]
    fn structure(&self, mu: f64) -> f64;

    /// Largest |q| that a point which has not slipped yet may start with under the pressure p; infinite for a law that
    /// lets an excess slip off [F/L²]
    fn starting_limit(&self, pressure: f64) -> f64;

    /// Pressure from which the rate problem may have several answers, if there is one [F/L²]
    fn uniqueness_limit(&self) -> Option<f64>;
}
