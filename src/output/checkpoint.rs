//! `checkpoint.bin`: state from which a run resumes with bitwise identical results.
//!
//! ```text
//! "fecontact checkpoint\n"   version u32   length u64   crc32 u32   postcard of a Checkpoint       little-endian
//! ```
//!
//! A checkpoint is written to a new file, synchronized to the disk and moved into place; the previous one is kept as
//! `checkpoint_prev.bin` and read if the newest is damaged.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::csv::failed;
use super::files;
use crate::mesh::{Group, Mesh};
use crate::run::{Error, RunBytes};

/// File of the last checkpoint.
pub const NEWEST: &str = "checkpoint.bin";
/// File of the checkpoint before it.
pub const PREVIOUS: &str = "checkpoint_prev.bin";

const MAGIC: &[u8] = b"fecontact checkpoint\n";
/// Version of the file content; every change of the layout requires a new number.
pub const VERSION: u32 = 38;
const HEAD: usize = MAGIC.len() + 16;

/// Saved run, and the program, case and mesh that it belongs to.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Checkpoint {
    /// version of the program
    pub program: String,
    /// case (JSON), including the steps of the cases that it continues
    pub case: String,
    /// number of steps taken over from those cases
    pub taken_over: usize,
    /// number of steps that had begun
    pub begun: usize,
    /// whether all steps had ended
    pub complete: bool,
    /// the mesh
    pub mesh: MeshPrint,
    /// the run
    pub run: RunBytes,
}

/// Identification of a mesh: numbers of its parts, and their checksums.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeshPrint {
    nodes: (usize, u32),
    elements: (usize, u32),
    groups: (usize, u32),
}

impl MeshPrint {
    /// Checksums of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let [mut nodes, mut elements, mut groups] = [(); 3].map(|()| crc32fast::Hasher::new());
        mesh.nodes.iter().flat_map(|x| [x.x, x.y]).for_each(|x| nodes.update(&x.to_bits().to_le_bytes()));
        let list = |print: &mut crc32fast::Hasher, list: &[usize]| {
            let counted = std::iter::once(list.len()).chain(list.iter().copied());
            counted.for_each(|number| print.update(&(number as u64).to_le_bytes()));
        };
        mesh.elements.iter().for_each(|element| list(&mut elements, &element.nodes));
        for (name, group) in &mesh.groups {
            groups.update(name.as_bytes());
            match group {
                Group::Elements(numbers) | Group::Nodes(numbers) => list(&mut groups, numbers),
                Group::Edges(edges) => edges.iter().for_each(|edge| list(&mut groups, &edge.nodes)),
                Group::Lines(lines) => {
                    let places = lines.iter().flatten().flat_map(|(_, at)| [at.x, at.y]);
                    places.for_each(|x| groups.update(&x.to_bits().to_le_bytes()));
                }
            }
        }
        Self {
            nodes: (mesh.nodes.len(), nodes.finalize()),
            elements: (mesh.elements.len(), elements.finalize()),
            groups: (mesh.groups.len(), groups.finalize()),
        }
    }

    /// First difference from another mesh, if there is one.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let parts = [
            ("nodes", self.nodes, other.nodes, "are at other positions"),
            ("elements", self.elements, other.elements, "have other nodes"),
            ("groups", self.groups, other.groups, "have other names or members"),
        ];
        parts.into_iter().find(|(_, was, is, _)| was != is).map(|(name, was, is, else_)| match was.0 == is.0 {
            true => format!("mesh: its {name} {else_}"),
            false => format!("mesh: it has {} {name}, and had {}", is.0, was.0),
        })
    }
}

/// Reason why a checkpoint cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Unusable {
    /// There is no checkpoint.
    #[error("there is none")]
    Missing,
    /// The file cannot be read.
    #[error("it cannot be read: {0}")]
    Unreadable(String),
    /// The content does not match its checksum.
    #[error("it is damaged: {0}")]
    Damaged(String),
    /// The file was written by another version of the program.
    #[error("it has the format {0}, and this program reads {VERSION}: take the version of the program that wrote it")]
    Foreign(u32),
}

/// Writes a checkpoint into a folder; the newest one becomes the previous one.
///
/// # Errors
/// Returns [`Error::Output`] if it cannot be written; existing checkpoints are then kept.
pub fn write(folder: &Path, checkpoint: &Checkpoint) -> Result<(), Error> {
    let newest = folder.join(NEWEST);
    let bytes = to_bytes(checkpoint).map_err(|cause| failed(&newest, &cause))?;
    let keep = || match newest.symlink_metadata() {
        Ok(known) if known.is_file() => kept(&newest, &folder.join(PREVIOUS)),
        _ => Ok(()),
    };
    files::replace_for_good_after(&newest, &bytes, keep).map_err(|cause| failed(&newest, &cause))
}

/// The content of the file, built in place: that of a large model is tens of megabytes (25 at 300 000 dofs), and not to be there twice.
fn to_bytes(checkpoint: &Checkpoint) -> postcard::Result<Vec<u8>> {
    let length = postcard::experimental::serialized_size(checkpoint)?;
    let mut bytes = Vec::with_capacity(HEAD + length);
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(&(length as u64).to_le_bytes());
    let checksum = bytes.len();
    bytes.resize(HEAD, 0);
    let mut bytes = postcard::to_extend(checkpoint, bytes)?;
    let crc = crc32fast::hash(&bytes[HEAD..]);
    bytes[checksum..HEAD].copy_from_slice(&crc.to_le_bytes());
    Ok(bytes)
}

/// Links the newest checkpoint as the previous one in one operation, so that a previous one always exists. Without hard
/// links, the file is moved.
fn kept(newest: &Path, previous: &Path) -> std::io::Result<()> {
    let second = files::aside(previous);
    files::remove(&second)?;
    match fs::hard_link(newest, &second) {
        Ok(()) => files::into_place(&second, previous),
        Err(_) => files::into_place(newest, previous),
    }
}

/// Reads a checkpoint.
///
/// # Errors
/// Returns [`Unusable`] if it is missing, unreadable, damaged or of another version.
pub fn read(path: &Path) -> Result<Checkpoint, Unusable> {
    let bytes = fs::read(path).map_err(|cause| match cause.kind() {
        ErrorKind::NotFound => Unusable::Missing,
        _ => Unusable::Unreadable(cause.to_string()),
    })?;
    from_bytes(&bytes)
}

/// Decodes a checkpoint from its bytes.
///
/// # Errors
/// Returns [`Unusable`] if the bytes are damaged or of another version.
pub fn from_bytes(bytes: &[u8]) -> Result<Checkpoint, Unusable> {
    let damaged = |what: &str| Unusable::Damaged(what.into());
    let (magic, rest) = bytes.split_at_checked(MAGIC.len()).ok_or_else(|| damaged("it is too short"))?;
    if magic != MAGIC {
        return Err(damaged("it does not begin as a checkpoint does"));
    }
    let Some((version, rest)) = rest.split_first_chunk() else { return Err(damaged("it is too short")) };
    let version = u32::from_le_bytes(*version);
    if version != VERSION {
        return Err(Unusable::Foreign(version));
    }
    let head = rest.split_first_chunk().and_then(|(length, rest)| Some((length, rest.split_first_chunk()?)));
    let Some((length, (crc, body))) = head else { return Err(damaged("it is too short")) };
    let length = u64::from_le_bytes(*length);
    if length != body.len() as u64 {
        return Err(Unusable::Damaged(format!(
            "it should have {length} bytes behind its head, and has {}",
            body.len()
        )));
    }
    if u32::from_le_bytes(*crc) != crc32fast::hash(body) {
        return Err(damaged("its checksum is wrong"));
    }
    postcard::from_bytes(body).map_err(|cause| Unusable::Damaged(cause.to_string()))
}

/// Returns the newest usable checkpoint of a folder, and the defect of a newer one.
///
/// # Errors
/// Returns the file and defect of the newest checkpoint if none is usable.
pub fn newest(folder: &Path) -> Result<(Checkpoint, Option<String>), (PathBuf, Unusable)> {
    let [newest, previous] = [NEWEST, PREVIOUS].map(|name| folder.join(name));
    match read(&newest) {
        Ok(checkpoint) => Ok((checkpoint, None)),
        Err(foreign @ Unusable::Foreign(_)) => Err((newest, foreign)),
        Err(why) => match read(&previous) {
            Ok(checkpoint) => Ok((checkpoint, Some(format!("{}: {why}", newest.display())))),
            Err(_) => Err((newest, why)),
        },
    }
}
