//! Arrays of a store of zarr, and the files they consist of.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::codec::{Number, THOROUGH};
use crate::output::csv::failed;
use crate::run::error::Error;

/// The store's own files.
pub const GROUP: &str = ".zgroup";
/// See [`GROUP`].
pub const ARRAY: &str = ".zarray";
/// See [`GROUP`].
pub const ATTRIBUTES: &str = ".zattrs";
/// See [`GROUP`].
pub const METADATA: &str = ".zmetadata";

/// What an array is, besides its numbers.
#[derive(Clone, Debug)]
pub struct Description {
    /// its name
    pub name: String,
    /// what its numbers are
    pub number: Number,
    /// its dimensions; the first is that of the records, if it grows
    pub dimensions: Vec<String>,
    /// units, meaning and the like
    pub attributes: Map<String, Value>,
}

/// An array that grows.
#[derive(Debug)]
pub struct Series {
    /// what it is
    pub is: Description,
    /// numbers of a record, in each dimension behind that of the records
    pub width: Option<usize>,
    /// checksum of the files of its complete chunks, one after the other
    pub complete: crc32fast::Hasher,
    /// bytes of the records since the last complete chunk
    pub chunk: Vec<u8>,
}

impl Series {
    /// One without records.
    pub fn new(is: Description, width: Option<usize>) -> Self {
        Self { is, width, complete: crc32fast::Hasher::new(), chunk: Vec::new() }
    }

    /// Whether the first chunks still are what was written.
    ///
    /// # Errors
    /// [`Error::Output`] with the first one that is gone, or the array if its chunks were changed.
    pub fn check(&self, store: &Path, chunks: usize, crc: u32) -> Result<(), Error> {
        let mut found = crc32fast::Hasher::new();
        for path in (0..chunks).map(|number| store.join(self.file(number))) {
            if !path.is_file() {
                return Err(failed(&path, &"was there when the checkpoint was written, and is gone"));
            }
            found.update(&fs::read(&path).map_err(|cause| failed(&path, &cause))?);
        }
        let changed = "was changed since the checkpoint was written: its chunks have another checksum; put it back as it was, \
                       or begin anew in another folder";
        if found.finalize() == crc { Ok(()) } else { Err(failed(&store.join(&self.is.name), &changed)) }
    }

    /// Bytes of a record.
    pub fn record(&self) -> usize {
        self.width.unwrap_or(1) * self.is.number.size()
    }

    /// File of a chunk below the store.
    pub fn file(&self, number: usize) -> PathBuf {
        let name = if self.width.is_some() { format!("{number}.0") } else { number.to_string() };
        Path::new(&self.is.name).join(name)
    }
}

/// `.zgroup`.
pub fn group() -> Value {
    json!({"zarr_format": 2})
}

/// `.zattrs` of an array.
pub fn all_attributes(is: &Description) -> Value {
    let mut attributes = is.attributes.clone();
    attributes.insert("_ARRAY_DIMENSIONS".into(), json!(is.dimensions));
    Value::Object(attributes)
}

/// `.zarray`.
pub fn shape(is: &Description, shape: &[usize], chunks: &[usize]) -> Value {
    json!({
        "zarr_format": 2,
        "shape": shape,
        "chunks": chunks,
        "dtype": is.number.name(),
        "fill_value": if is.number == Number::Whole { Value::Null } else { json!("NaN") },
        "order": "C",
        "filters": [{"id": "shuffle", "elementsize": is.number.size()}],
        "compressor": {"id": "zlib", "level": THOROUGH},
    })
}

/// Records of growing arrays of the store in a folder, as its files say; the largest number where they differ, and 0 where there
/// are none.
pub fn counted<'n>(store: &Path, names: impl Iterator<Item = &'n str>) -> u64 {
    let read = |path: PathBuf| {
        let bytes = fs::read(path).unwrap_or_default();
        serde_json::from_slice::<Value>(&bytes).unwrap_or_default()
    };
    let all = read(store.join(METADATA));
    let of_one = |name: &str| {
        let own = read(store.join(name).join(ARRAY))["shape"][0].as_u64();
        own.max(all["metadata"][format!("{name}/{ARRAY}")]["shape"][0].as_u64())
    };
    names.filter_map(of_one).max().unwrap_or(0)
}

/// The files of a store that lies in a folder, those first by which readers go: removed in this order, they never count what is
/// gone; others than its own are none of them, nor is anything behind a link.
///
/// # Errors
/// What the system says.
pub fn files_of(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let is_folder = |path: &Path| path.symlink_metadata().is_ok_and(|known| known.is_dir());
    let entries = |folder: &Path| -> io::Result<Vec<PathBuf>> {
        fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path())).collect()
    };
    let mut found = Vec::new();
    if is_folder(folder) {
        for path in entries(folder)? {
            match is_folder(&path) {
                true => found.extend(entries(&path)?),
                false => found.push(path),
            }
        }
    }
    found.retain(|path| is_own(path));
    let turn = |path: &PathBuf| match path.file_name().and_then(|name| name.to_str()) {
        Some(METADATA) => 0,
        Some(name) if name.starts_with('.') => 1,
        _ => 2,
    };
    found.sort_by_key(turn);
    Ok(found)
}

/// Whether a file has the name of one of a store: a chunk, or what describes the chunks.
pub fn is_own(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let name = name.strip_suffix(".new").unwrap_or(name);
    let is_number = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    [GROUP, ARRAY, ATTRIBUTES, METADATA].contains(&name) || name.split('.').all(is_number)
}

/// Take away the folders of arrays that are empty.
pub fn forget(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        // One that is not empty, or no folder, stays.
        let _ = fs::remove_dir(entry.path());
    }
}
