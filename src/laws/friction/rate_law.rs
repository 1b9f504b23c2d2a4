//! Laws whose slip rate follows from traction and state.

use std::fmt::Debug;

use super::{FrictionState, Regime};

/// What acts on a point of an interface that radiates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loading {
    /// τ = q + η V: what friction and radiation damping carry together [F/L²]
    pub traction: f64,
    /// p [F/L²]
    pub pressure: f64,
    /// η [F T/L³]
    pub damping: f64,
}

/// A law whose slip rate follows from traction and state, so that an interface can be integrated by itself.
///
/// ```text
/// τ = q(V, x, p) + η V          solved for V, which has the sign of τ; x: the state, a number without dimension
/// ẋ = ẋ(V, x)
/// ```
pub trait RateLaw: Debug + Send + Sync {
    /// V; not a number where the law has no answer [L/T].
    fn slip_rate(&self, x: f64, loading: Loading) -> f64;

    /// ẋ at a slip rate [1/T].
    fn evolution(&self, _x: f64, _slip_rate: f64) -> f64 {
        0.0
    }

    /// x of what a point remembers.
    fn evolving(&self, _state: &FrictionState) -> f64 {
        0.0
    }

    /// The state with x in its variables.
    fn remember(&self, _x: f64, state: FrictionState) -> FrictionState {
        state
    }

    /// |∂(q/p)/∂x|: what an error of x does to the coefficient of friction [-].
    fn weight(&self) -> f64 {
        0.0
    }

    /// Stick or slip.
    fn regime(&self, x: f64, slip_rate: f64) -> Regime;
}
