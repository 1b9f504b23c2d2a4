//! Reader of `interface.zarr`, also of a growing one: all records up to the last flush.
//!
//! The chunks may be compressed with zlib or not, shuffled or not, of type `<f4`, `<f8` or `<i4`: all formats written here or
//! by a typical script.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;
use thiserror::Error;

use super::STORE;
use super::codec::{Number, unpacked, unshuffled};
use super::zarr::{ARRAY, ATTRIBUTES, METADATA};
use crate::output::quantities::FORMER;

/// Stored history of one contact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StoredContact {
    /// name
    pub name: String,
    /// times of the records, ascending [T]
    pub times: Vec<f64>,
    /// arc length of the points along the undeformed slave [L]
    pub positions: Vec<f64>,
    /// undeformed coordinates of the points [L]
    pub places: Vec<[f64; 2]>,
    /// number of the continuous line of each point
    pub lines: Vec<usize>,
    /// requested quantities by name, as far as available: one value per point, record after record
    pub quantities: BTreeMap<String, Vec<f32>>,
}

impl StoredContact {
    /// Values of a quantity at all points of a record.
    pub fn at(&self, quantity: &str, record: usize) -> Option<&[f32]> {
        let points = self.positions.len();
        self.quantities.get(quantity)?.get(record * points..(record + 1) * points)
    }
}

/// Reason why a store cannot be read.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}: {cause}", path.display())]
pub struct Unreadable {
    /// the file
    pub path: PathBuf,
    /// description of the defect
    pub cause: String,
}

/// Metadata of a store.
#[derive(Deserialize)]
struct Metadata {
    metadata: BTreeMap<String, Value>,
}

/// `.zarray`.
#[derive(Deserialize)]
struct Shape {
    shape: Vec<usize>,
    chunks: Vec<usize>,
    dtype: String,
    order: String,
    #[serde(default)]
    filters: Option<Vec<Codec>>,
    #[serde(default)]
    compressor: Option<Codec>,
}

#[derive(Deserialize)]
struct Codec {
    id: String,
}

/// Returns the contacts of a results folder in the order of the store, with the quantities `wanted`; empty if there is no
/// store. All have the same number of records.
///
/// # Errors
/// Returns [`Unreadable`] with the file and its defect.
pub fn contacts(folder: &Path, wanted: impl Fn(&str) -> bool) -> Result<Vec<StoredContact>, Unreadable> {
    let store = folder.join(STORE);
    if !store.join(METADATA).is_file() {
        return Ok(Vec::new());
    }
    let reader = Reader::open(store)?;
    let (names, prefixes) = (reader.names("contacts")?, reader.names("prefixes")?);
    let times = reader.values("time")?;
    names.into_iter().zip(&prefixes).map(|(name, prefix)| reader.contact(name, prefix, &times, &wanted)).collect()
}

/// Present name of a quantity of the store; earlier versions used other names for some.
fn name_of_now(quantity: &str) -> &str {
    FORMER.iter().find(|(former, _)| *former == quantity).map_or(quantity, |(_, now)| now)
}

struct Reader {
    store: PathBuf,
    metadata: BTreeMap<String, Value>,
}

impl Reader {
    fn open(store: PathBuf) -> Result<Self, Unreadable> {
        let path = store.join(METADATA);
        let unreadable = |cause: String| Unreadable { path: path.clone(), cause };
        let text = std::fs::read_to_string(&path).map_err(|cause| unreadable(format!("cannot be read: {cause}")))?;
        let Metadata { metadata } = serde_json::from_str(&text).map_err(|cause| unreadable(cause.to_string()))?;
        Ok(Self { store, metadata })
    }

    fn unreadable(&self, file: &str, cause: impl Into<String>) -> Unreadable {
        Unreadable { path: self.store.join(file), cause: cause.into() }
    }

    /// Returns a list of names among the attributes of the store.
    fn names(&self, attribute: &str) -> Result<Vec<String>, Unreadable> {
        let value = self.metadata.get(ATTRIBUTES).and_then(|all| all.get(attribute)).cloned().unwrap_or_default();
        let missing = |_| self.unreadable(METADATA, format!("the store does not name its `{attribute}`"));
        serde_json::from_value(value).map_err(missing)
    }

    fn contact(
        &self,
        name: String,
        prefix: &str,
        times: &[f64],
        wanted: impl Fn(&str) -> bool,
    ) -> Result<StoredContact, Unreadable> {
        let of = |what: &str| self.values(&format!("{prefix}.{what}"));
        let (positions, x, y, lines) = (of("position")?, of("x")?, of("y")?, of("line")?);
        let mut quantities = BTreeMap::new();
        for array in self.metadata.keys().filter_map(|key| key.strip_suffix(ARRAY)?.strip_suffix('/')) {
            let quantity = array.strip_prefix(prefix).and_then(|rest| rest.strip_prefix('.'));
            let is_series = |array: &str| self.shape(array).is_ok_and(|shape| shape.shape.len() == 2);
            let Some(quantity) = quantity.map(name_of_now).filter(|name| wanted(name) && is_series(array)) else {
                continue;
            };
            let mut values = Vec::new();
            self.read(array, |value| values.push(value as f32))?;
            if values.len() != times.len() * positions.len() {
                let (have, need) = (values.len(), times.len() * positions.len());
                return Err(self.unreadable(array, format!("has {have} values where there should be {need}")));
            }
            quantities.insert(quantity.into(), values);
        }
        if [x.len(), y.len(), lines.len()] != [positions.len(); 3] {
            return Err(self.unreadable(METADATA, format!("the places of `{name}` differ in number")));
        }
        let places = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
        let lines = lines.into_iter().map(|line| line as usize).collect();
        Ok(StoredContact { name, times: times.to_vec(), positions, places, lines, quantities })
    }

    fn shape(&self, array: &str) -> Result<Shape, Unreadable> {
        let key = format!("{array}/{ARRAY}");
        let value = self.metadata.get(&key).ok_or_else(|| self.unreadable(array, "is missing"))?;
        Shape::deserialize(value).map_err(|cause| self.unreadable(&key, cause.to_string()))
    }

    fn values(&self, array: &str) -> Result<Vec<f64>, Unreadable> {
        let mut values = Vec::new();
        self.read(array, |value| values.push(value))?;
        Ok(values)
    }

    /// Reads all values of an array, record by record. Chunks must divide the first dimension only.
    fn read(&self, array: &str, mut take: impl FnMut(f64)) -> Result<(), Unreadable> {
        let shape = self.shape(array)?;
        let strange = |what: String| Err(self.unreadable(&format!("{array}/{ARRAY}"), what));
        let Some(number) = Number::named(&shape.dtype) else {
            return strange(format!("its numbers are {}, which is not read here", shape.dtype));
        };
        let (records, width) = match (&shape.shape[..], &shape.chunks[..]) {
            ([records], [chunk]) if *chunk > 0 => (*records, 1),
            ([records, width], [chunk, whole]) if *chunk > 0 && width == whole => (*records, *width),
            _ => return strange("its chunks are not parts of its records".into()),
        };
        let filters: Vec<&str> = shape.filters.iter().flatten().map(|codec| codec.id.as_str()).collect();
        let compressor = shape.compressor.as_ref().map(|codec| codec.id.as_str());
        let shuffles = filters == ["shuffle"];
        if shape.order != "C" || !(filters.is_empty() || shuffles) || !matches!(compressor, None | Some("zlib")) {
            return strange("it is packed in a way that is not read here".into());
        }
        let chunk = shape.chunks[0];
        let Some(length) = chunk.checked_mul(width).and_then(|count| count.checked_mul(number.size())) else {
            return strange("its chunks are too large".into());
        };
        let behind = if shape.shape.len() == 2 { ".0" } else { "" };
        for first in (0..records).step_by(chunk) {
            let file = format!("{array}/{}{behind}", first / chunk);
            let packed = std::fs::read(self.store.join(&file));
            let packed = packed.map_err(|cause| self.unreadable(&file, format!("cannot be read: {cause}")))?;
            let size = if shuffles { number.size() } else { 1 };
            let bytes = match compressor {
                Some(_) => unpacked(&packed, size, length),
                None if packed.len() == length => Ok(unshuffled(&packed, size)),
                None => Err(format!("it holds {} bytes instead of {length}", packed.len())),
            };
            let bytes = bytes.map_err(|cause| self.unreadable(&file, format!("is damaged: {cause}")))?;
            number.read(&bytes).take((records - first).min(chunk) * width).for_each(&mut take);
        }
        Ok(())
    }
}
