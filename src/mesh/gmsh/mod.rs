//! Reads gmsh meshes, format MSH 4.1, ASCII or binary.
//!
//! The `mshio` crate parses the sections. Around it `bytes` checks what `mshio` takes on trust (the format line, the
//! presence of the sections, the counts in their headers) and reads the names of the physical groups, which it skips.

mod bytes;
mod groups;

use std::fs;
use std::path::Path;

use self::bytes::{checked_count, encoding, explain, keep_node_tags, physical_names};
use self::groups::assemble;
use super::check;
use super::raw::RawMesh;
use super::{Mesh, MeshError};

/// The mesh in a gmsh file: bodies are its physical surfaces, edge groups its physical curves, node groups its physical
/// points. A physical group without a name is called `physical_<tag>`.
///
/// # Errors
/// [`MeshError::InFile`] says what is wrong with which file and how to mend it.
pub fn read(path: &Path) -> Result<Mesh, MeshError> {
    load(path).and_then(from_bytes).map_err(|cause| MeshError::InFile { file: path.into(), cause: Box::new(cause) })
}

/// The mesh in the content of a gmsh file, as [`read`] gives it.
///
/// # Errors
/// [`MeshError`] says what is wrong.
pub fn from_bytes(bytes: Vec<u8>) -> Result<Mesh, MeshError> {
    parse(bytes).and_then(check::finish)
}

fn load(path: &Path) -> Result<Vec<u8>, MeshError> {
    let kind = fs::metadata(path).map_err(refusal)?;
    if kind.is_dir() {
        return Err(MeshError::NotAFile("folder"));
    }
    if !kind.is_file() {
        return Err(MeshError::NotAFile("device"));
    }
    fs::read(path).map_err(refusal)
}

fn refusal(error: std::io::Error) -> MeshError {
    match error.kind() {
        std::io::ErrorKind::NotFound => MeshError::NoFile,
        _ => MeshError::Unreadable(error),
    }
}

fn parse(mut bytes: Vec<u8>) -> Result<RawMesh, MeshError> {
    let encoding = encoding(&bytes)?;
    checked_count(&bytes, encoding, "Entities")?;
    let node_count = checked_count(&bytes, encoding, "Nodes")?;
    let element_count = checked_count(&bytes, encoding, "Elements")?;
    if node_count == 0 || element_count == 0 {
        return Err(MeshError::NoElements);
    }
    let names = physical_names(&bytes)?;
    keep_node_tags(&mut bytes, encoding)?;
    let file = mshio::parse_msh_bytes(&bytes).map_err(|error| explain(&bytes, encoding, &error))?;
    assemble(file, &names, node_count, element_count)
}
