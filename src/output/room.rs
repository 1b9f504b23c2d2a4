//! Whether there is memory for a frame, before it is made.

use std::path::{Path, PathBuf};

use super::csv::failed;
use crate::linear::memory::room_for;
use crate::model::Model;
use crate::run::error::Error;

/// Bytes a node or contact point takes in a frame: its state once more, fourteen numbers, and their text.
const PER_NODE: usize = 600;

/// The room that a frame takes while it is made.
#[derive(Debug)]
pub struct Room {
    folder: PathBuf,
    bytes: usize,
}

impl Room {
    /// Of a model's frames in a folder.
    pub fn of(folder: &Path, model: &Model) -> Self {
        let points: usize = model.contacts.iter().map(|pair| pair.points.len()).sum();
        Self { folder: folder.join("solid"), bytes: PER_NODE * (model.mesh.nodes.len() + points) }
    }

    /// Refuse a frame that does not fit.
    ///
    /// # Errors
    /// [`Error::Output`] with what it takes and what is free.
    pub fn check(&self) -> Result<(), Error> {
        let told = |cause| failed(&self.folder, &format!("a frame takes {cause}; leave them out (\"fields\": false)"));
        room_for(self.bytes, 0).map_err(told)
    }
}
