//! Warnings that are told as they come, each once.

use super::company::Warn;
use crate::model::Model;
use crate::output::warnings::Warnings;
use crate::run::error::Error;
use crate::run::observer::{Attempt, Observer};

/// The warnings of a run, and who tells them.
pub(super) struct Aloud {
    pub warnings: Warnings,
    warn: Warn,
    /// how many have been told
    told: usize,
}

impl Aloud {
    /// With the warnings that have been told already.
    pub fn new(list: Vec<String>, warn: Warn) -> Self {
        let told = list.len();
        let mut warnings = Warnings::default();
        warnings.list = list;
        Self { warnings, warn, told }
    }

    fn tell(&mut self) {
        self.warnings.list[self.told..].iter().for_each(|warning| (self.warn)(warning));
        self.told = self.warnings.list.len();
    }
}

impl Observer for Aloud {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        let recorded = self.warnings.record(model, attempt);
        self.tell();
        recorded
    }

    fn name(&self) -> &'static str {
        self.warnings.name()
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        self.warnings.save()
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        self.warnings.restore(memory)?;
        // Those were told when they came.
        self.told = self.warnings.list.len();
        Ok(())
    }

    fn finish(&mut self) -> Result<(), Error> {
        let finished = self.warnings.finish();
        self.tell();
        finished
    }
}
