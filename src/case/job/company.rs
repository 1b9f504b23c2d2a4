//! Who watches a run.

use std::sync::Arc;

use crate::run::error::Error;
use crate::run::observer::Observer;

/// Who is told a warning.
pub type Warn = Arc<dyn Fn(&str) + Send + Sync>;

/// Why a run is to end before its time, if it is.
pub type Ends = Arc<dyn Fn() -> Option<Error> + Send + Sync>;

/// Who watches a run.
pub struct Company<'a> {
    /// is told warnings as they come, but for those of the model
    pub warn: Warn,
    /// is asked between two increments, and within explicit ones
    pub ends: Ends,
    /// shows how far it is
    pub progress: Option<Box<dyn Observer + 'a>>,
}
