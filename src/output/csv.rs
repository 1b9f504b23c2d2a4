//! A table on disk: comma, dot, header row, full double precision, flushed after every row.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::error::Error;

/// A CSV file being written.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Table {
    /// Create the file and write its header.
    pub fn create(path: &Path, header: &[String]) -> Result<Self, Error> {
        let file = File::create(path).map_err(|cause| failed(path, &cause))?;
        let mut table = Self { path: path.to_owned(), file: BufWriter::new(file) };
        table.line(&header.join(","))?;
        table.flush()?;
        Ok(table)
    }

    /// Write one line.
    pub fn line(&mut self, line: &str) -> Result<(), Error> {
        writeln!(self.file, "{line}").map_err(|cause| failed(&self.path, &cause))
    }

    /// Hand everything to the system, so that a killed run loses nothing.
    pub fn flush(&mut self) -> Result<(), Error> {
        self.file.flush().map_err(|cause| failed(&self.path, &cause))
    }
}

/// An output error of a path.
pub fn failed(path: &Path, cause: &dyn std::fmt::Display) -> Error {
    Error::Output { path: path.to_owned(), cause: cause.to_string() }
}
