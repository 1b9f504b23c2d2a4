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
}

impl Columns {
    /// Read the columns whose names are `wanted`, line by line. A last line without its end is left out: it is being
    /// written, or its writer was killed.
    ///
    /// # Errors
    /// [`PlotError::Unreadable`] with the line.
    pub fn read(path: &Path, wanted: impl Fn(&str) -> bool) -> Result<Self, PlotError> {
        let unreadable = |cause: String| PlotError::Unreadable { path: path.to_owned(), cause };
        let file = File::open(path).map_err(|cause| unreadable(format!("cannot be read: {cause}")))?;
        let mut lines = BufReader::new(file);
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
        let mut values: Vec<Option<Vec<f64>>> = names.iter().map(|name| wanted(name).then(Vec::new)).collect();
        let mut number = 1;
        while next(&mut line)? {
            number += 1;
            let mut cells = line.trim_end().split(',');
            for (name, values) in names.iter().zip(&mut values) {
                let cell = cells.next().ok_or_else(|| unreadable(format!("line {number} ends before {name}")))?;
                if let Some(values) = values {
                    let value = cell.parse();
                    values.push(value.map_err(|_| unreadable(format!("line {number}: {name} is no number: {cell}")))?);
                }
            }
        }
        let values: BTreeMap<_, _> =
            names.iter().cloned().zip(values).filter_map(|(name, values)| Some((name, values?))).collect();
        Ok(Self { path: path.to_owned(), names, values })
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
