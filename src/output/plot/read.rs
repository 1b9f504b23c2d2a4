//! Columns of a CSV file that may still be growing.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use super::error::PlotError;

/// Columns by name, in the file's order.
#[derive(Clone, Debug)]
pub struct Columns {
    path: PathBuf,
    /// all names of the header
    names: Vec<String>,
    values: BTreeMap<String, Vec<f64>>,
    /// of the columns of words
    words: BTreeMap<String, Vec<String>>,
}

/// Columns of words; their values are the numbers of the words.
const WORDS: [&str; 4] = ["step", "contact", "verdict", "reason"];

impl Columns {
    /// Read the columns whose names are `wanted`, line by line. A last line without its end is left out: it is being
    /// written, or its writer was killed.
    ///
    /// # Errors
    /// [`PlotError::Unreadable`] with the line.
    pub fn read(path: &Path, wanted: impl Fn(&str) -> bool) -> Result<Self, PlotError> {
        let (columns, fault) = Self::read_to_fault(path, wanted)?;
        fault.map_or(Ok(columns), Err)
    }

    /// As [`read`](Self::read), up to a line that cannot be understood, if there is one.
    ///
    /// # Errors
    /// [`PlotError::Unreadable`] when there is not even a header.
    pub fn read_to_fault(path: &Path, wanted: impl Fn(&str) -> bool) -> Result<(Self, Option<PlotError>), PlotError> {
        let unreadable = |cause: String| PlotError::Unreadable { path: path.to_owned(), cause };
        let file = File::open(path).map_err(|cause| unreadable(format!("cannot be read: {cause}")))?;
        let mut lines = BufReader::with_capacity(1 << 16, file);
        let mut line = String::new();
        let mut next = |line: &mut String| -> Result<bool, PlotError> {
            line.clear();
            lines.read_line(line).map_err(|cause| unreadable(format!("cannot be read: {cause}")))?;
            Ok(line.ends_with('\n'))
        };
        if !next(&mut line)? {
            return Err(unreadable("has no header line: nothing was written yet".into()));
        }
        let names: Vec<String> = line.trim_end().split(',').map(Into::into).collect();
        let mut readers: Vec<Reader> = names.iter().map(|name| Reader::new(name, wanted(name))).collect();
        let mut number = 1;
        let fault = loop {
            match next(&mut line) {
                Ok(true) => number += 1,
                Ok(false) => break None,
                Err(fault) => break Some(fault),
            }
            if let Err(cause) = row(line.trim_end(), &names, &mut readers) {
                break Some(unreadable(format!("line {number}{cause}")));
            }
        };
        let whole = readers.iter().filter_map(|reader| Some(reader.values.as_ref()?.len())).min().unwrap_or(0);
        let (mut values, mut words) = (BTreeMap::new(), BTreeMap::new());
        for (name, mut reader) in names.iter().cloned().zip(readers) {
            let Some(mut column) = reader.values.take() else { continue };
            column.truncate(whole);
            reader.words.map(|of| words.insert(name.clone(), of));
            values.insert(name, column);
        }
        Ok((Self { path: path.to_owned(), names, values, words }, fault))
    }

    /// The same, if there are rows.
    ///
    /// # Errors
    /// [`PlotError::Unreadable`] when there are none.
    pub fn with_rows(self) -> Result<Self, PlotError> {
        match self.is_empty() {
            true => Err(PlotError::Unreadable { path: self.path, cause: "has no rows yet".into() }),
            false => Ok(self),
        }
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.values.values().all(Vec::is_empty)
    }

    /// A column.
    ///
    /// # Errors
    /// [`PlotError::Unreadable`] when the file does not have it.
    pub fn get(&self, name: &str) -> Result<&[f64], PlotError> {
        self.values.get(name).map(Vec::as_slice).ok_or_else(|| PlotError::Unreadable {
            path: self.path.clone(),
            cause: format!("has no column `{name}`: was it written by another version?"),
        })
    }

    /// The points (x, y) of two columns.
    ///
    /// # Errors
    /// [`PlotError::Unreadable`] when the file does not have them.
    pub fn points(&self, x: &str, y: &str) -> Result<Vec<[f64; 2]>, PlotError> {
        Ok(self.get(x)?.iter().zip(self.get(y)?).map(|(x, y)| [*x, *y]).collect())
    }

    /// Names of the columns that were read, in the file's order.
    pub fn names(&self) -> impl Iterator<Item = &String> {
        self.names.iter().filter(|name| self.has(name))
    }

    /// What the values of a column of words stand for; nothing for a column of numbers.
    pub fn words(&self, name: &str) -> Option<&[String]> {
        self.words.get(name).map(Vec::as_slice)
    }

    /// Whether a column was read.
    pub fn has(&self, name: &str) -> bool {
        self.values.contains_key(name)
    }

    /// What stands before a dot and `column`, in order: the contacts or sets that have this column.
    pub fn owners(&self, column: &str) -> Vec<String> {
        let owner = |name: &String| name.strip_suffix(column)?.strip_suffix('.').map(Into::into);
        self.names.iter().filter_map(owner).collect()
    }
}

/// What of a column was read so far.
struct Reader {
    /// `None` if it is not wanted
    values: Option<Vec<f64>>,
    /// `None` if it is one of numbers
    words: Option<Vec<String>>,
}

impl Reader {
    fn new(name: &str, wanted: bool) -> Self {
        Self { values: wanted.then(Vec::new), words: WORDS.contains(&name).then(Vec::new) }
    }

    /// Read a cell; `None` if it is no number.
    fn read(&mut self, cell: &str) -> Option<()> {
        let Self { values: Some(values), words } = self else { return Some(()) };
        values.push(match words {
            None => cell.parse().ok()?,
            Some(words) => {
                // The same word as in the row before, mostly.
                let before = values.last().map(|&number| number as usize).filter(|&number| words[number] == cell);
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

/// Read a row; the error goes on behind the number of its line.
fn row(line: &str, names: &[String], readers: &mut [Reader]) -> Result<(), String> {
    let mut cells = line.split(',');
    for (name, reader) in names.iter().zip(readers) {
        let cell = cells.next().ok_or_else(|| format!(" ends before {name}"))?;
        reader.read(cell).ok_or_else(|| format!(": {name} is no number: {cell}"))?;
    }
    Ok(())
}
