//! Failures while solving: those a smaller increment may cure, and those that end the run.

use thiserror::Error;

use crate::friction::LawFailure;
use crate::linear::LinearFailure;
use crate::newton::NewtonFailure;
use crate::time::told;

/// Why the equations could not be evaluated at a trial state.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TrialFailure {
    /// An element has no volume left.
    #[error("element {element} of body `{body}` is turned inside out (J = {jacobian:.3e})")]
    Inverted {
        /// its tag in the mesh file
        element: u64,
        /// its body
        body: String,
        /// det F
        jacobian: f64,
    },
    /// An element has hardly any volume left.
    #[error("element {element} of body `{body}` is crushed to {share:.1e} of its size")]
    Crushed {
        /// its tag in the mesh file
        element: u64,
        /// its body
        body: String,
        /// what is left of its size
        share: f64,
    },
    /// A friction law could not answer.
    #[error("contact `{contact}`, point {point}: {cause}")]
    Friction {
        /// contact pair
        contact: String,
        /// slave point
        point: usize,
        /// what the law said
        cause: LawFailure,
    },
    /// A support or load expression has no finite value.
    #[error("a support or load at node {node} is not a finite number at time {}: check its expression", told(*time))]
    Undefined {
        /// its tag in the mesh file
        node: u64,
        /// run time
        time: f64,
    },
}

/// Why one increment failed; a smaller one may succeed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum StepFailure {
    /// Newton's method found no equilibrium.
    #[error(transparent)]
    Newton(#[from] NewtonFailure<TrialFailure>),
    /// The mass matrix of the initial acceleration is singular.
    #[error("initial acceleration: {0} (does every body have a density?)")]
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
    /// A body is held by nothing.
    #[error(
        "{0}; give it a support, a spring, or contact that is closed at the start, or `stabilize` the step (a stabilized one: by more)"
    )]
    Floating(String),
    /// A trial state lost the contact that held a body.
    #[error("the iterations lost contact: {0}")]
    ContactLost(String),
}

impl StepFailure {
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

    /// Whether a smaller increment has a chance.
    pub fn is_retryable(&self) -> bool {
        match self {
            Self::Newton(NewtonFailure::Linear(LinearFailure::TooLarge { .. })) => false,
            _ => matches!(self, Self::Newton(_) | Self::Penetration { .. } | Self::ContactLost(_)),
        }
    }
}

/// Why a run stopped.
#[derive(Debug, Error)]
pub enum Error {
    /// An increment cannot be made small enough.
    #[error("step `{step}` stopped at time {}: {cause} (increment {dt:.3e}, smallest allowed {min:.3e})", told(*time))]
    StepTooSmall {
        /// step
        step: String,
        /// time reached
        time: f64,
        /// increment that failed
        dt: f64,
        /// smallest allowed increment
        min: f64,
        /// why it failed
        cause: StepFailure,
    },
    /// No smaller increment can help.
    #[error("step `{step}` stopped at time {}: {cause}", told(*time))]
    Unsolvable {
        /// step
        step: String,
        /// time reached
        time: f64,
        /// why
        cause: StepFailure,
    },
    /// A friction law driven alone could not answer.
    #[error("the law stopped after time {}: {cause}", told(*time))]
    Law {
        /// time reached
        time: f64,
        /// what the law said
        cause: LawFailure,
    },
    /// A result file could not be written.
    #[error("{path}: {cause}")]
    Output {
        /// the file
        path: std::path::PathBuf,
        /// what the system said
        cause: String,
    },
}
