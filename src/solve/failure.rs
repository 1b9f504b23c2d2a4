//! Why an increment failed, and whether a smaller one may succeed.

use thiserror::Error;

use crate::equations::failure::TrialFailure;
use crate::linear::LinearFailure;
use crate::solve::newton::NewtonFailure;

/// Why one increment failed; a smaller one may succeed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum IncrementFailure {
    /// Newton's method found no equilibrium.
    #[error(transparent)]
    Newton(#[from] NewtonFailure<TrialFailure>),
    /// The mass matrix of the initial acceleration is singular.
    #[error("initial acceleration: {0}{hint}", hint = density_hint(.0))]
    Mass(LinearFailure),
    /// The state at the start of a dynamic step, or in an explicit increment, cannot be evaluated.
    #[error(transparent)]
    Start(TrialFailure),
    /// The augmented Lagrangian did not bring the surfaces together.
    #[error(
        "the penetration is still too large after {passes} passes of the augmented Lagrangian: raise alpha_n, or allow more"
    )]
    Penetration {
        /// solutions with better and better multipliers
        passes: usize,
    },
    /// The velocities of an explicit run are not finite any more.
    #[error(
        "the motion grows beyond all bounds: lower the safety of the explicit scheme, or look at loads and supports"
    )]
    Unbounded,
    /// An element collapsed in explicit increments of any length.
    #[error(
        "{0}, in shorter increments as well: the mesh is crushed there; let it be struck or driven more slowly, make it \
         finer or stiffer there, give the body viscosity (damping.stiffness), or a law that resists crushing (neo_hookean, \
         hencky)"
    )]
    Collapsed(TrialFailure),
    /// The bodies could not be condensed on an interface.
    #[error("the bodies cannot be condensed on the contacts: {0}; hold every body by a support or a spring")]
    Interface(LinearFailure),
    /// The differential equations of an interface could not be integrated.
    #[error("contact `{contact}` at ({x:.6}, {y:.6}): {why}")]
    Slip {
        /// contact pair
        contact: String,
        /// place of the point
        x: f64,
        /// place of the point
        y: f64,
        /// what is wrong there
        why: String,
    },
    /// A body is held by nothing.
    #[error(
        "{0}; give it a support, a spring, or contact that is closed at the start, or `stabilize` the step (a stabilized one: by more)"
    )]
    Floating(String),
    /// A trial state lost the contact that held a body.
    #[error("the iterations lost contact: {0}")]
    ContactLost(String),
}

fn density_hint(cause: &LinearFailure) -> &'static str {
    if matches!(cause, LinearFailure::Singular(_)) { " (does every body have a density?)" } else { "" }
}

impl IncrementFailure {
    /// Whether shorter explicit increments have a chance: an element collapsed, or the motion grew without bounds.
    pub fn is_collapse(&self) -> bool {
        use TrialFailure::{Crushed, Inverted};
        matches!(self, Self::Unbounded | Self::Start(Inverted { .. } | Crushed { .. }))
    }

    /// The same, after shorter increments have not helped.
    pub fn after_all(self) -> Self {
        match self {
            Self::Start(failure @ (TrialFailure::Inverted { .. } | TrialFailure::Crushed { .. })) => {
                Self::Collapsed(failure)
            }
            other => other,
        }
    }

    /// What failed, in so few words that failures can be counted.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Newton(NewtonFailure::Evaluation(failure)) | Self::Start(failure) | Self::Collapsed(failure) => {
                kind_of_trial(failure)
            }
            Self::Newton(NewtonFailure::Linear(_)) | Self::Mass(_) | Self::Interface(_) => "singular equations",
            Self::Newton(NewtonFailure::Overflow) => "forces beyond double precision",
            Self::Newton(NewtonFailure::Diverged { .. }) => "divergence",
            Self::Newton(NewtonFailure::TooManyIterations { .. }) => "too many iterations",
            Self::Penetration { .. } => "penetration",
            Self::Unbounded => "unbounded motion",
            Self::Slip { .. } => "slip equations",
            Self::Floating(_) => "floating body",
            Self::ContactLost(_) => "contact lost",
        }
    }

    /// Whether a smaller increment has a chance.
    pub fn is_retryable(&self) -> bool {
        match self {
            Self::Newton(NewtonFailure::Linear(LinearFailure::TooLarge { .. })) => false,
            _ => matches!(self, Self::Newton(_) | Self::Penetration { .. } | Self::ContactLost(_)),
        }
    }
}

fn kind_of_trial(failure: &TrialFailure) -> &'static str {
    match failure {
        TrialFailure::Inverted { .. } => "element inside out",
        TrialFailure::Crushed { .. } => "element crushed",
        TrialFailure::Friction { .. } => "friction law",
        TrialFailure::FluidPressure { .. } => "fluid pressure",
        TrialFailure::Undefined { .. } => "expression without a value",
    }
}
