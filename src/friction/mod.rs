//! The friction-law contract: what an interface point remembers, and how a law answers one increment.
//!
//! A law is a pure function of (committed state, increment). It sees scalars in the frame that turns with the
//! interface, never nodes or meshes, so the same law serves a finite-element interface, a point mass or a test.
//!
//! Signs: `q` resists positive slip of the slave along +s; pressure is positive in compression.

use std::fmt::Debug;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What friction remembers at one contact point between increments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrictionState {
    /// q: traction that resists the slip of the slave along +s [F/L²]
    pub traction: f64,
    /// p: contact pressure, positive in compression [F/L²]
    pub pressure: f64,
    /// μ: peak coefficient available now, μ_k ≤ μ ≤ μ_s for the super/subloading law [-]
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

/// The answer of a law to one increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionResponse {
    /// State at the end of the increment.
    pub state: FrictionState,
    /// ∂q/∂Δu_t [F/L³]
    pub dtraction_dslip: f64,
    /// ∂q/∂p [-]
    pub dtraction_dpressure: f64,
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
}

/// A friction law, integrated over one increment. Pure: the same `old` and `sliding` give the same answer.
pub trait FrictionLaw: Debug + Send + Sync {
    /// State of a point that has just come into contact.
    fn initial_state(&self) -> FrictionState;

    /// q and the state variables at the end of the increment, with the consistent tangent ∂q/∂Δu_t, ∂q/∂p.
    ///
    /// # Errors
    /// [`LawFailure`] when the increment is not finite.
    fn respond(&self, old: &FrictionState, sliding: Sliding) -> Result<FrictionResponse, LawFailure>;
}
