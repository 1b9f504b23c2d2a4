//! Failures of commands, and their messages.

use crate::case::CaseError;
use crate::case::job::{Failed, Refused, internal_error};
use crate::model::text::readable;
use crate::output::report::ReportError;
use crate::run::error::Error;

/// Reason why a command failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The run stopped; results so far are kept.
    Stopped(String),
    /// The input is invalid; nothing was written.
    BadInput(String),
    /// An internal error of the program.
    Internal(String),
}

impl Failure {
    /// Returns the exit code, and the text for stderr.
    pub fn code_and_message(&self) -> (u8, String) {
        match self {
            Self::Stopped(message) => (1, readable(&format!("stopped: {message}"))),
            Self::BadInput(message) => (2, readable(&format!("error: {message}"))),
            Self::Internal(message) => (70, internal_error::message(message)),
        }
    }
}

conversions! {
    CaseError => Failure: |error| Self::BadInput(error.to_string());
    Refused => Failure: |refused| Self::BadInput(refused.to_string());
    Error => Failure: |error| Self::Stopped(error.to_string());
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        match error {
            ReportError::Output(error) => error.into(),
            ReportError::Unreadable { .. } => Self::BadInput(error.to_string()),
        }
    }
}

impl From<Failed> for Failure {
    fn from(failed: Failed) -> Self {
        match failed {
            Failed::Stopped(error) => error.into(),
            Failed::Internal(error) => Self::Internal(error),
        }
    }
}
