//! Errors that stop a run.

use thiserror::Error;

use crate::laws::friction::LawFailure;
use crate::model::scheme::time_text;

pub use crate::equations::sums::TrialFailure;
pub use crate::linear::LinearFailure;
pub use crate::solve::failure::IncrementFailure;
pub use crate::solve::newton::NewtonFailure;

/// Error that stops a run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// An increment cannot be made small enough.
    #[error("step `{step}` stopped at time {}: {limit}{cause} (increment {dt:.3e}, smallest allowed {min:.3e}){suspicion}", time_text(*time))]
    IncrementTooSmall {
        /// step
        step: String,
        /// time reached
        time: f64,
        /// increment that failed
        dt: f64,
        /// smallest allowed increment
        min: f64,
        /// that it may be a limit point, with the loads reached, before a semicolon; empty unless there is a sign of one
        limit: String,
        /// cause of the failure
        cause: Box<IncrementFailure>,
        /// suspected reason, preceded by a semicolon; empty if there is none
        suspicion: String,
    },
    /// No smaller increment can help.
    #[error("step `{step}` stopped at time {}: {cause}", time_text(*time))]
    Unsolvable {
        /// step
        step: String,
        /// time reached
        time: f64,
        /// why
        cause: Box<IncrementFailure>,
    },
    /// The reaction that ends a step did not reach its target value.
    #[error(
        "step `{step}` ended at time {} before {part} of `{on}` reached {value}: it is {reached:.6e}; make the step \
         longer, or move farther (until)",
        time_text(*time)
    )]
    NotReached {
        /// step
        step: String,
        /// time reached
        time: f64,
        /// component of the reaction
        part: &'static str,
        /// group of the reaction
        on: String,
        /// target value [F]
        value: f64,
        /// value at the end of the step [F]
        reached: f64,
    },
    /// A motion gained more energy than was supplied; its results are kept, but are those of an instability.
    #[error("the results are not usable: {0}")]
    Unstable(String),
    /// A friction law failed in a law test.
    #[error("the law stopped after time {}: {cause}", time_text(*time))]
    Law {
        /// time reached
        time: f64,
        /// failure reported by the law
        cause: LawFailure,
    },
    /// The slider of a law test takes more steps than anybody waits for.
    #[error(
        "the slider takes too many steps at the time {}: check mass and stiffness, or raise the tolerance",
        time_text(*time)
    )]
    TooManySteps {
        /// time reached
        time: f64,
    },
    /// A run whose step was changed by its caller does not follow from its model alone and cannot be saved in a file.
    #[error("step `{step}` was changed by its caller: such a run can be saved in this process, but not in a file")]
    StepChanged {
        /// step
        step: String,
    },
    /// A run could not be saved.
    #[error("the run could not be saved: {0}")]
    NotSaved(String),
    /// The user or the system requested the end of the run.
    #[error("interrupted")]
    Interrupted,
    /// An observer ended the run.
    #[error("{0}")]
    Ended(String),
    /// A result file could not be written.
    #[error("{path}: {cause}")]
    Output {
        /// the file
        path: std::path::PathBuf,
        /// message of the system
        cause: String,
    },
}

impl Error {
    /// Cause of the failure of the last increment, if it stopped the run.
    pub fn cause(&self) -> Option<&IncrementFailure> {
        match self {
            Self::IncrementTooSmall { cause, .. } | Self::Unsolvable { cause, .. } => Some(cause),
            _ => None,
        }
    }
}
