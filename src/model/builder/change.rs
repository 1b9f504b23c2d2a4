//! What a step does to what an earlier one gave.

use crate::model::boundary::Drive;

/// What a step does to a support or a load: give it anew, or end it.
#[derive(Clone, Debug, PartialEq)]
pub enum Change<T> {
    /// From now on it is this
    To(T),
    /// It ends
    End,
}

impl<T> Change<T> {
    /// What is given, if it does not end.
    pub fn given(&self) -> Option<&T> {
        match self {
            Self::To(given) => Some(given),
            Self::End => None,
        }
    }
}

impl From<f64> for Change<Drive> {
    fn from(value: f64) -> Self {
        Self::To(value.into())
    }
}

impl From<Drive> for Change<Drive> {
    fn from(drive: Drive) -> Self {
        Self::To(drive)
    }
}
