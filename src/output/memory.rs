//! What observers remember, as bytes.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::csv::{Table, failed};
use crate::run::error::Error;

/// The bytes of what an observer remembers.
pub fn written(memory: &impl Serialize) -> Result<Vec<u8>, Error> {
    postcard::to_allocvec(memory).map_err(|cause| failed(Path::new("memory of an observer"), &cause))
}

/// What the bytes say.
pub fn read<M: DeserializeOwned>(bytes: &[u8]) -> Result<M, Error> {
    postcard::from_bytes(bytes).map_err(|cause| failed(Path::new("memory of an observer"), &cause))
}

/// A table remembers what stands in it.
pub fn of_table(table: &mut Table) -> Result<Vec<u8>, Error> {
    written(&table.standing()?)
}

/// Whether a table can be gone on with, where the memory begins with what stood in it.
pub fn check_table(table: &Table, bytes: &[u8]) -> Result<(), Error> {
    table.check(&read(bytes)?)
}

/// Cut a table back to what stood in it; what else was remembered.
pub fn cut_table<M: DeserializeOwned>(table: &mut Table, bytes: &[u8]) -> Result<M, Error> {
    let (stood, memory) = read(bytes)?;
    table.cut(stood)?;
    Ok(memory)
}
