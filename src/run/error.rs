//! Why a run stopped.

use thiserror::Error;

use crate::laws::friction::LawFailure;
use crate::model::scheme::time_text;

pub use crate::equations::sums::TrialFailure;
pub use crate::linear::LinearFailure;
pub use crate::solve::failure::IncrementFailure;
pub use crate::solve::newton::NewtonFailure;

/// Why a run stopped.
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
        /// why it failed
        cause: Box<IncrementFailure>,
        /// what may be to blame, behind a semicolon; empty if nothing is suspected
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
    /// The reaction that ends a step did not reach its value.
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
        /// which part of the reaction
        part: &'static str,
        /// its group
        on: String,
        /// what it was to reach [F]
        value: f64,
        /// what it is [F]
        reached: f64,
    },
    /// A friction law failed in a law test.
    #[error("the law stopped after time {}: {cause}", time_text(*time))]
    Law {
        /// time reached
        time: f64,
        /// what the law said
        cause: LawFailure,
    },
    /// A run whose step was changed by its caller does not follow from its model alone, and cannot be saved in a file.
    #[error("step `{step}` was changed by its caller: such a run can be saved in this process, but not in a file")]
    StepChanged {
        /// step
        step: String,
    },
    /// A run could not be saved.
    #[error("the run could not be saved: {0}")]
    NotSaved(String),
    /// The user, or the system, asked for the end.
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
        /// what the system said
        cause: String,
    },
}

impl Error {
    /// Why the last increment failed, if the run stopped for that.
    pub fn cause(&self) -> Option<&IncrementFailure> {
        match self {
            Self::IncrementTooSmall { cause, .. } | Self::Unsolvable { cause, .. } => Some(cause),
            _ => None,
        }
    }
}
