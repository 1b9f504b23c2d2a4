//! Tables of results for the page: read up to the first defect, with fewer rows where there are too many, and packed by
//! column.
//!
//! Numbers are packed into text: rounded, shuffled by byte significance, compressed, in base64.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use serde_json::{Value, json};

use super::source::ReportError;
use crate::output::store::codec::{rounded, shuffled};

/// Columns of words; their values are indices of the words.
const WORDS: [&str; 5] = ["step", "contact", "verdict", "reason", "negative_pivots"];

/// Columns in which single precision would not distinguish rows.
const EXACT: [&str; 6] = ["time", "onset", "arrival", "place", "position", "increment"];

/// A column of numbers, or of words.
#[derive(Clone, Debug)]
pub struct Column {
    /// name
    pub name: String,
    /// values by row; for words, their indices
    pub values: Vec<f64>,
    /// words by index; `None` for a column of numbers
    pub words: Option<Vec<String>>,
}

impl Column {
    /// Creates a column of numbers.
    pub fn numbers(name: &str, values: Vec<f64>) -> Self {
        Self { name: name.into(), values, words: None }
    }

    /// Reads a cell; `None` if it is not a number.
    fn read(&mut self, cell: &str) -> Option<()> {
        self.values.push(match &mut self.words {
            None => cell.parse().ok()?,
            Some(words) => {
                // Usually the same word as in the row before.
                let before = self.values.last().map(|&number| number as usize).filter(|&number| words[number] == cell);
                let known = before.or_else(|| words.iter().rposition(|word| word == cell));
                known.unwrap_or_else(|| {
                    words.push(cell.into());
                    words.len() - 1
                }) as f64
            }
        });
        Some(())
    }
}

/// Columns of a CSV file, in their order.
#[derive(Clone, Debug)]
pub struct Columns {
    path: PathBuf,
    columns: Vec<Column>,
}

impl Columns {
    /// Reads a file line by line, up to the first defective line, if any. An incomplete last line is skipped: it is being
    /// written, or its writer was killed.
    ///
    /// # Errors
    /// Returns [`ReportError::Unreadable`] if there is no header.
    pub fn read(path: &Path) -> Result<(Self, Option<ReportError>), ReportError> {
        let unreadable = |cause: String| ReportError::Unreadable { path: path.to_owned(), cause };
        let file = File::open(path).map_err(|cause| unreadable(format!("cannot be read: {cause}")))?;
        let mut lines = BufReader::with_capacity(1 << 16, file);
        let mut line = String::new();
        let mut next = |line: &mut String| -> Result<bool, ReportError> {
            line.clear();
            lines.read_line(line).map_err(|cause| unreadable(format!("cannot be read: {cause}")))?;
            Ok(line.ends_with('\n'))
        };
        if !next(&mut line)? {
            return Err(unreadable("has no header line: nothing was written yet".into()));
        }
        let column =
            |name: &str| Column { words: WORDS.contains(&name).then(Vec::new), ..Column::numbers(name, Vec::new()) };
        let mut columns: Vec<Column> = line.trim_end().split(',').map(column).collect();
        let mut number = 1;
        let fault = loop {
            match next(&mut line) {
                Ok(true) => number += 1,
                Ok(false) => break None,
                Err(fault) => break Some(fault),
            }
            if let Err(cause) = row(line.trim_end(), &mut columns) {
                break Some(unreadable(format!("line {number}{cause}")));
            }
        };
        let whole = columns.iter().map(|column| column.values.len()).min().unwrap_or(0);
        columns.iter_mut().for_each(|column| column.values.truncate(whole));
        Ok((Self { path: path.to_owned(), columns }, fault))
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Number of columns.
    pub fn count(&self) -> usize {
        self.columns.len()
    }

    fn find(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// Returns a column by its name.
    ///
    /// # Errors
    /// Returns [`ReportError::Unreadable`] if the file does not have it.
    pub fn get(&self, name: &str) -> Result<&[f64], ReportError> {
        self.find(name).map(|column| &column.values[..]).ok_or_else(|| ReportError::Unreadable {
            path: self.path.clone(),
            cause: format!("has no column `{name}`: was it written by another version?"),
        })
    }

    /// Words behind the values of a column of words; `None` for a column of numbers.
    pub fn words(&self, name: &str) -> Option<&[String]> {
        self.find(name)?.words.as_deref()
    }

    /// Number of non-finite values, by column.
    pub fn not_numbers(&self) -> impl Iterator<Item = (&str, usize)> {
        let bad = |column: &Column| column.values.iter().filter(|value| !value.is_finite()).count();
        self.columns.iter().map(move |column| (column.name.as_str(), bad(column))).filter(|(_, count)| *count > 0)
    }

    /// Rows to be shown: all, or the first, last, minimum and maximum of every column in each of as many groups of rows as fit.
    pub fn spread(&self, most: usize) -> Vec<usize> {
        let count = self.rows();
        if count <= most {
            return (0..count).collect();
        }
        // Constant and monotonic columns have their extremes at the ends of the groups.
        let swinging = |column: &&Column| column.words.is_none() && !column.values.is_sorted();
        let swinging: Vec<&Column> = self.columns.iter().filter(swinging).collect();
        let group = (count * (2 + 2 * swinging.len())).div_ceil(most).max(1);
        let mut kept = Vec::with_capacity(most);
        for start in (0..count).step_by(group) {
            let rows = start..(start + group).min(count);
            let mut some = vec![rows.start, rows.end - 1];
            for Column { values, .. } in &swinging {
                let by_value = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
                some.extend(rows.clone().min_by(by_value));
                some.extend(rows.clone().max_by(by_value));
            }
            some.sort_unstable();
            some.dedup();
            kept.extend(some);
        }
        kept
    }

    /// Page data of some rows.
    pub fn sheet(&self, rows: &[usize], pack: &mut Pack) -> Value {
        let some = |column: &Column| Column {
            values: rows.iter().map(|&row| column.values[row]).collect(),
            name: column.name.clone(),
            words: column.words.clone(),
        };
        sheet(self.columns.iter().map(some), pack)
    }
}

/// Reads a row; the error text follows the line number.
fn row(line: &str, columns: &mut [Column]) -> Result<(), String> {
    let mut cells = line.split(',');
    for column in columns {
        let cell = cells.next().ok_or_else(|| format!(" ends before {}", column.name))?;
        column.read(cell).ok_or_else(|| format!(": {} is not a number: {cell}", column.name))?;
    }
    Ok(())
}

/// Reads a table up to the first defect, which is noted; `None` if there is no such table.
pub fn read(folder: &Path, file: &str, notes: &mut Vec<String>) -> Option<Columns> {
    let path = folder.join(file);
    if !path.is_file() {
        return None;
    }
    match Columns::read(&path) {
        Ok((columns, fault)) => {
            notes.extend(fault.map(|fault| format!("{fault}; only the rows before it are shown")));
            Some(columns)
        }
        Err(fault) => {
            notes.push(format!("{fault}; it is not shown"));
            None
        }
    }
}

/// Page data of the columns of a table.
pub fn sheet(columns: impl IntoIterator<Item = Column>, pack: &mut Pack) -> Value {
    let mut rows = 0;
    let mut column = |Column { name, values, words }: Column| {
        rows = values.len();
        let exact = EXACT.contains(&name.as_str());
        let packed = if exact { Packed::exact(&values) } else { Packed::single(&values) };
        json!({ "name": name, "words": words, "type": if exact { "f64" } else { "f32" }, "chunk": pack.add(&packed) })
    };
    let packed: Vec<Value> = columns.into_iter().map(&mut column).collect();
    json!({ "rows": rows, "columns": packed })
}

/// Mantissa bits of the maps of interfaces: their relative error is at most 2⁻¹².
const BITS: u32 = 11;

/// Code of non-finite values among integers.
const NO_NUMBER: i32 = i32::MIN;

/// Packed array of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Packed {
    text: String,
    /// for values in integer steps: the step, and the number of components per point
    steps: Option<(f64, usize)>,
}

impl Packed {
    /// Size of the packed numbers [bytes].
    pub fn size(&self) -> usize {
        self.text.len()
    }

    /// Packs doubles unchanged.
    pub fn exact(values: &[f64]) -> Self {
        Self::of(values.iter().map(|value| value.to_le_bytes()), values.len())
    }

    /// Packs values in single precision.
    pub fn single(values: &[f64]) -> Self {
        Self::of(values.iter().map(|value| (*value as f32).to_le_bytes()), values.len())
    }

    /// Packs values in single precision with fewer mantissa bits.
    pub fn rounded(values: impl ExactSizeIterator<Item = f64>) -> Self {
        let count = values.len();
        Self::of(values.map(|value| rounded(value, BITS).to_le_bytes()), count)
    }

    /// Packs values with several components per point and magnitude up to `size`, to an error of `error` times `size`: in
    /// integer steps, of which the difference from the previous point is stored, since consecutive points of a mesh are mostly
    /// neighbours.
    pub fn stepped(values: &[f64], components: usize, size: f64, error: f64) -> Self {
        let step = if size > 0.0 && size.is_finite() { 2.0 * error * size } else { 1.0 };
        let mut last = vec![0; components];
        let difference = |(k, value): (usize, &f64)| {
            let last = &mut last[k % components];
            let steps = (value / step).round();
            let difference = if value.is_finite() { steps as i32 - *last } else { NO_NUMBER };
            *last = if value.is_finite() { steps as i32 } else { *last };
            difference.to_le_bytes()
        };
        let packed = Self::of(values.iter().enumerate().map(difference), values.len());
        Self { steps: Some((step, components)), ..packed }
    }

    /// Packs non-negative integers.
    pub fn counts(values: &[u32]) -> Self {
        Self::of(values.iter().map(|value| value.to_le_bytes()), values.len())
    }

    /// Packs values of one byte each.
    pub fn bytes(values: &[u8]) -> Self {
        Self::of(values.iter().map(|value| [*value]), values.len())
    }

    /// Packs all first bytes, then all second ones, and so on, which groups similar bytes.
    fn of<const N: usize>(values: impl Iterator<Item = [u8; N]>, count: usize) -> Self {
        let mut bytes = Vec::with_capacity(N * count);
        values.for_each(|value| bytes.extend_from_slice(&value));
        let mut encoder = DeflateEncoder::new(Vec::with_capacity(bytes.len() / 2), Compression::new(4));
        // Writing to a Vec cannot fail.
        let _ = encoder.write_all(&shuffled(&bytes, N));
        Self { text: STANDARD.encode(encoder.finish().unwrap_or_default()), steps: None }
    }
}

/// All packed numbers of a page.
#[derive(Debug, Default)]
pub struct Pack {
    /// packed arrays in sequence
    pub text: String,
}

impl Pack {
    /// Adds a packed array and returns its range in the text: start, length; for integer steps also the step and the number of
    /// components per point.
    pub fn add(&mut self, packed: &Packed) -> Value {
        let start = self.text.len();
        self.text += &packed.text;
        match packed.steps {
            None => json!([start, packed.size()]),
            Some((step, components)) => json!([start, packed.size(), step, components]),
        }
    }
}
