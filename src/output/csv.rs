//! A table on disk: comma, dot, header row, full double precision. Every row reaches the file within a blink.

use std::fs::File;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::run::error::Error;

/// Rows written within this time of each other go to the system together: the call would cost as much as the row.
const BLINK: Duration = Duration::from_millis(50);

/// A CSV file being written, row by row and cell by cell.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    file: BufWriter<File>,
    /// the row so far, a comma behind every cell
    row: Vec<u8>,
    flushed: Instant,
}

impl Table {
    /// Create the file and write its header.
    pub fn create(path: &Path, header: &[impl AsRef<str>]) -> Result<Self, Error> {
        let file = File::create(path).map_err(|cause| failed(path, &cause))?;
        let mut table =
            Self { path: path.to_owned(), file: BufWriter::new(file), row: Vec::new(), flushed: Instant::now() };
        header.iter().for_each(|name| table.text(name.as_ref()));
        table.end_row()?;
        table.flush()?;
        Ok(table)
    }

    /// Add a cell.
    pub fn text(&mut self, text: &str) {
        self.row.extend_from_slice(text.as_bytes());
        self.row.push(b',');
    }

    /// Add a cell with a number that reads back as the same double.
    pub fn number(&mut self, value: f64) {
        self.text(zmij::Buffer::new().format(value));
    }

    /// Add a cell with a whole number.
    pub fn count(&mut self, value: usize) {
        // Writing to a Vec cannot fail.
        let _ = write!(self.row, "{value},");
    }

    /// Write the row.
    pub fn end_row(&mut self) -> Result<(), Error> {
        if let Some(comma) = self.row.last_mut() {
            *comma = b'\n';
        }
        self.file.write_all(&self.row).map_err(|cause| failed(&self.path, &cause))?;
        self.row.clear();
        Ok(())
    }

    /// Hand the rows so far to the system, so that a killed run loses nothing, unless that was done a blink ago.
    pub fn share(&mut self) -> Result<(), Error> {
        if self.flushed.elapsed() < BLINK { Ok(()) } else { self.flush() }
    }

    /// How long the file is [bytes].
    pub fn length(&mut self) -> Result<u64, Error> {
        self.flush()?;
        let length = self.file.get_ref().metadata().map(|file| file.len());
        length.map_err(|cause| failed(&self.path, &cause))
    }

    /// Take back what was written after the file was this long.
    pub fn cut(&mut self, length: u64) -> Result<(), Error> {
        self.flush()?;
        let file = self.file.get_mut();
        let cut = file.set_len(length).and_then(|()| file.seek(SeekFrom::End(0)));
        cut.map(drop).map_err(|cause| failed(&self.path, &cause))
    }

    /// Hand the rows so far to the system.
    pub fn flush(&mut self) -> Result<(), Error> {
        self.flushed = Instant::now();
        self.file.flush().map_err(|cause| failed(&self.path, &cause))
    }
}

/// An output error of a path.
pub fn failed(path: &Path, cause: &dyn std::fmt::Display) -> Error {
    Error::Output { path: path.to_owned(), cause: cause.to_string() }
}
