//! A store of arrays that grow record by record: zarr version 2, as xarray opens it.
//!
//! ```text
//! .zgroup .zattrs          description of the store
//! NAME/.zarray .zattrs     shape, chunks and codecs of an array; its dimensions, units and meaning
//! NAME/k  NAME/k.0 …       chunk k: records k R … (k + 1) R − 1 of all places, NaN where there is none yet
//! .zmetadata               all of the above but the chunks, once more in one file
//! ```
//!
//! Every file is the old one or the new one at any moment. A flush writes chunks first, then the shapes, and last
//! `.zmetadata`, which readers use: if the process is killed, a reader finds all records up to the last flush in all arrays.
//! Records are removed in the reverse order.
//!
//! Source: Zarr storage specification version 2, <https://zarr-specs.readthedocs.io/en/latest/v2/v2.0.html>.
//!
//! Arrays of a zarr store and their files.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use std::{fs, io};

use serde_json::{Map, Value, json};

use super::codec::{Number, QUICK, THOROUGH, packed};
use crate::output::csv::failed;
use crate::output::files;
use crate::run::error::Error;

/// Number of values per chunk: enough to compress well, few enough to be rewritten with every flush.
const CHUNK: usize = 1 << 15;

/// Upper bound of the records per chunk.
const MOST_RECORDS: usize = 1 << 12;

/// Minimum time between two flushes.
const BLINK: Duration = Duration::from_millis(50);
/// Minimum time between two flushes, as a multiple of the duration of the last one.
const REST: u32 = 40;

/// Number of records, and for each array the checksum of the complete chunks and the bytes of the records since.
pub type Saved = (u64, Vec<(u32, Vec<u8>)>);

/// A store being written.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    attributes: Value,
    /// arrays that do not grow, with their values
    fixed: Vec<(Description, Vec<f64>)>,
    series: Vec<Series>,
    /// R: number of records per chunk
    chunk: usize,
    /// records so far
    records: usize,
    /// whether all records are in the files
    settled: bool,
    flushed: Instant,
    /// duration of the last flush
    took: Duration,
    /// complete chunks that may not be on the disk yet
    young: Vec<PathBuf>,
}

impl Store {
    /// Creates the description of a store in `folder`, to be created or restored: fixed arrays with their values, and growing
    /// arrays with the number of values per record in each further dimension.
    pub fn new(
        folder: PathBuf,
        attributes: Map<String, Value>,
        fixed: Vec<(Description, Vec<f64>)>,
        growing: Vec<(Description, Vec<usize>)>,
    ) -> Self {
        let widest = growing.iter().map(|(_, shape)| shape.iter().product()).max().unwrap_or(1);
        let series = growing.into_iter().map(|(is, shape)| Series::new(is, shape)).collect();
        Self {
            folder,
            attributes: Value::Object(attributes),
            fixed,
            series,
            chunk: (CHUNK / widest.max(1)).clamp(1, MOST_RECORDS),
            records: 0,
            settled: false,
            flushed: Instant::now(),
            took: Duration::ZERO,
            young: Vec::new(),
        }
    }

    /// Creates the files of the store, without records.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if they cannot be written.
    pub fn create(&mut self) -> Result<(), Error> {
        self.describe()?;
        self.flush()
    }

    /// Writes everything that does not grow.
    fn describe(&self) -> Result<(), Error> {
        let made = |folder: &Path| files::folder(folder).map_err(|cause| failed(folder, &cause));
        made(&self.folder)?;
        put(&self.folder.join(GROUP), &json_bytes(&group()))?;
        put(&self.folder.join(ATTRIBUTES), &json_bytes(&self.attributes))?;
        for is in self.descriptions() {
            let folder = self.folder.join(&is.name);
            made(&folder)?;
            put(&folder.join(ATTRIBUTES), &json_bytes(&all_attributes(is)))?;
        }
        for (is, values) in &self.fixed {
            let mut bytes = Vec::new();
            values.iter().for_each(|value| is.number.write(*value, &mut bytes));
            put(&self.folder.join(&is.name).join("0"), &packed(&bytes, is.number.size(), THOROUGH))?;
        }
        Ok(())
    }

    /// Adds a record: the numbers of each growing array.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if a complete chunk cannot be written.
    pub fn push(&mut self, record: &[Vec<f64>]) -> Result<(), Error> {
        for (series, values) in self.series.iter_mut().zip(record) {
            debug_assert_eq!(values.len(), series.shape.iter().product::<usize>(), "{}", series.is.name);
            values.iter().for_each(|value| series.is.number.write(*value, &mut series.chunk));
        }
        self.records += 1;
        self.settled = false;
        if self.records.is_multiple_of(self.chunk) {
            self.write_chunks(self.records / self.chunk - 1, THOROUGH)?;
            self.series.iter_mut().for_each(|series| series.chunk.clear());
        }
        Ok(())
    }

    /// Writes pending records to the system, unless that was done recently.
    ///
    /// # Errors
    /// The same as for [`flush`](Self::flush).
    pub fn share(&mut self) -> Result<(), Error> {
        if self.flushed.elapsed() < BLINK.max(REST * self.took) { Ok(()) } else { self.flush() }
    }

    /// Writes pending records to the system.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if they cannot be written.
    pub fn flush(&mut self) -> Result<(), Error> {
        let started = Instant::now();
        self.settle(QUICK)?;
        (self.flushed, self.took) = (Instant::now(), started.elapsed());
        Ok(())
    }

    /// Flushes the last records.
    ///
    /// # Errors
    /// The same as for [`flush`](Self::flush).
    pub fn finish(&mut self) -> Result<(), Error> {
        self.settle(THOROUGH)
    }

    /// Returns the number of records and those since the last complete chunk, after synchronizing complete chunks to the disk.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if that fails.
    pub fn save(&mut self) -> Result<Saved, Error> {
        for path in std::mem::take(&mut self.young) {
            File::open(&path).and_then(|file| file.sync_all()).map_err(|cause| failed(&path, &cause))?;
        }
        let saved = |series: &Series| (series.complete.clone().finalize(), series.chunk.clone());
        Ok((self.records as u64, self.series.iter().map(saved).collect()))
    }

    /// Checks that the saved records are unchanged.
    ///
    /// # Errors
    /// Returns [`Error::Output`] with what is missing or was changed.
    pub fn check(&self, (records, saved): &Saved) -> Result<(), Error> {
        let records = usize::try_from(*records).unwrap_or(usize::MAX);
        let (chunks, length) = (records / self.chunk, records % self.chunk);
        for (series, (crc, chunk)) in self.series.iter().zip(saved) {
            if chunk.len() != length * series.record() {
                return Err(failed(&self.folder, &"its checkpoint is one of another store"));
            }
            series.check(&self.folder, chunks, *crc)?;
        }
        Ok(())
    }

    /// Resumes from the saved records and removes later ones.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if later records cannot be removed.
    pub fn restore(&mut self, (records, saved): Saved) -> Result<(), Error> {
        self.records = usize::try_from(records).unwrap_or(usize::MAX);
        let complete = self.records / self.chunk;
        let length = self.records % self.chunk;
        for (series, (crc, chunk)) in self.series.iter_mut().zip(saved) {
            (series.complete, series.chunk) = (crc32fast::Hasher::new_with_initial(crc), chunk);
        }
        self.describe()?;
        self.settled = false;
        // The number of records is reduced before they are removed.
        if counted(&self.folder, self.series.iter().map(|series| &*series.is.name)) > records {
            self.write_shapes()?;
        }
        self.flush()?;
        let first = complete + usize::from(length > 0);
        for series in &self.series {
            for path in (first..).map(|number| self.folder.join(series.file(number))) {
                if path.symlink_metadata().is_err() {
                    break;
                }
                files::remove(&path).map_err(|cause| failed(&path, &cause))?;
            }
        }
        Ok(())
    }

    /// Writes pending data: chunks, then shapes.
    fn settle(&mut self, level: u8) -> Result<(), Error> {
        if self.settled && level == QUICK {
            return Ok(());
        }
        if !self.records.is_multiple_of(self.chunk) {
            self.write_chunks(self.records / self.chunk, level)?;
        }
        self.write_shapes()?;
        self.settled = true;
        Ok(())
    }

    /// Writes the number of records.
    fn write_shapes(&self) -> Result<(), Error> {
        for (name, shape) in self.shapes() {
            put(&self.folder.join(name).join(ARRAY), &json_bytes(&shape))?;
        }
        let metadata = self.metadata();
        put(&self.folder.join(METADATA), &json_bytes(&metadata))
    }

    fn write_chunks(&mut self, number: usize, level: u8) -> Result<(), Error> {
        for k in 0..self.series.len() {
            let series = &mut self.series[k];
            let (mut bytes, whole) = (series.chunk.clone(), series.record() * self.chunk);
            let is_complete = bytes.len() == whole;
            while bytes.len() < whole {
                series.is.number.write(f64::NAN, &mut bytes);
            }
            let bytes = packed(&bytes, series.is.number.size(), level);
            let path = self.folder.join(series.file(number));
            put(&path, &bytes)?;
            if is_complete {
                series.complete.update(&bytes);
            }
            if level == THOROUGH {
                self.young.push(path);
            }
        }
        Ok(())
    }

    fn descriptions(&self) -> impl Iterator<Item = &Description> {
        self.fixed.iter().map(|(is, _)| is).chain(self.series.iter().map(|series| &series.is))
    }

    /// The `.zarray` of every array.
    fn shapes(&self) -> impl Iterator<Item = (String, Value)> {
        let fixed =
            self.fixed.iter().map(|(is, values)| (is.name.clone(), shape(is, &[values.len()], &[values.len()])));
        let growing = self.series.iter().map(|Series { is, shape: further, .. }| {
            let with = |records: usize| std::iter::once(records).chain(further.iter().copied()).collect::<Vec<_>>();
            (is.name.clone(), shape(is, &with(self.records), &with(self.chunk)))
        });
        fixed.chain(growing)
    }

    fn metadata(&self) -> Value {
        let mut all = Map::new();
        all.insert(GROUP.into(), group());
        all.insert(ATTRIBUTES.into(), self.attributes.clone());
        all.extend(self.shapes().map(|(name, shape)| (format!("{name}/{ARRAY}"), shape)));
        all.extend(self.descriptions().map(|is| (format!("{}/{ATTRIBUTES}", is.name), all_attributes(is))));
        json!({"metadata": all, "zarr_consolidated_format": 1})
    }
}

fn put(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    files::replace(path, bytes).map_err(|cause| failed(path, &cause))
}

fn json_bytes(value: &Value) -> Vec<u8> {
    format!("{value:#}\n").into_bytes()
}

/// File of a group.
pub const GROUP: &str = ".zgroup";
/// File of the shape and type of an array.
pub const ARRAY: &str = ".zarray";
/// File of the attributes of an array.
pub const ATTRIBUTES: &str = ".zattrs";
/// File with all metadata of the store.
pub const METADATA: &str = ".zmetadata";

/// Description of an array without its values.
#[derive(Clone, Debug)]
pub struct Description {
    /// name
    pub name: String,
    /// number type
    pub number: Number,
    /// dimensions; the first is that of the records, if it grows
    pub dimensions: Vec<String>,
    /// units, meaning and other attributes
    pub attributes: Map<String, Value>,
}

/// A growing array.
#[derive(Debug)]
pub struct Series {
    /// description
    pub is: Description,
    /// number of values per record in each dimension after that of the records
    pub shape: Vec<usize>,
    /// checksum of the files of its complete chunks, one after the other
    pub complete: crc32fast::Hasher,
    /// bytes of the records since the last complete chunk
    pub chunk: Vec<u8>,
}

impl Series {
    /// Creates an array without records.
    pub fn new(is: Description, shape: Vec<usize>) -> Self {
        Self { is, shape, complete: crc32fast::Hasher::new(), chunk: Vec::new() }
    }

    /// Checks that the first chunks are unchanged.
    ///
    /// # Errors
    /// Returns [`Error::Output`] with the first missing chunk, or the array if its chunks were changed.
    pub fn check(&self, store: &Path, chunks: usize, crc: u32) -> Result<(), Error> {
        let mut found = crc32fast::Hasher::new();
        for path in (0..chunks).map(|number| store.join(self.file(number))) {
            if !path.is_file() {
                return Err(failed(&path, &"existed when the checkpoint was written, and is missing"));
            }
            found.update(&fs::read(&path).map_err(|cause| failed(&path, &cause))?);
        }
        let changed = "was changed since the checkpoint was written: its chunks have another checksum; restore it, or \
                       start a new run in another folder";
        if found.finalize() == crc { Ok(()) } else { Err(failed(&store.join(&self.is.name), &changed)) }
    }

    /// Size of a record in bytes.
    pub fn record(&self) -> usize {
        self.shape.iter().product::<usize>() * self.is.number.size()
    }

    /// File of a chunk, relative to the store.
    pub fn file(&self, number: usize) -> PathBuf {
        let name = format!("{number}{}", ".0".repeat(self.shape.len()));
        Path::new(&self.is.name).join(name)
    }
}

/// Content of `.zgroup`.
pub fn group() -> Value {
    json!({"zarr_format": 2})
}

/// Content of `.zattrs` of an array.
pub fn all_attributes(is: &Description) -> Value {
    let mut attributes = is.attributes.clone();
    attributes.insert("_ARRAY_DIMENSIONS".into(), json!(is.dimensions));
    Value::Object(attributes)
}

/// Content of `.zarray`.
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

/// Number of records of growing arrays of the store in a folder, according to its files: the largest where they differ, 0 where
/// there are none.
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

/// Files of a store in a folder, those used by readers first: removed in this order, they never list missing data. Other files
/// and files behind links are excluded.
///
/// # Errors
/// Returns the error of the system.
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

/// Whether a file has the name of a file of a store: a chunk or metadata.
pub fn is_own(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let name = name.strip_suffix(".new").unwrap_or(name);
    let is_number = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    [GROUP, ARRAY, ATTRIBUTES, METADATA].contains(&name) || name.split('.').all(is_number)
}

/// Removes empty folders of arrays.
pub fn forget(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        // Non-empty folders and other files are kept.
        let _ = fs::remove_dir(entry.path());
    }
}
