//! What is worst so far of each subject of a warning, which is reported once it is over.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// The worst case so far of each contact, bar or body, by its number, and its warning.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Worst(BTreeMap<usize, (f64, String)>);

impl Worst {
    /// The size above which a case is worse than those before; `least` where there was none.
    pub fn bound(&self, number: usize, least: f64) -> f64 {
        self.0.get(&number).map_or(least, |(size, _)| *size)
    }

    /// Enters a case that is worse than those before.
    pub fn enter(&mut self, number: usize, size: f64, message: String) {
        self.0.insert(number, (size, message));
    }

    /// The warnings by number, each of which is reported once.
    pub fn take(&mut self) -> impl Iterator<Item = (usize, String)> + use<> {
        std::mem::take(&mut self.0).into_iter().map(|(number, (_, message))| (number, message))
    }
}
