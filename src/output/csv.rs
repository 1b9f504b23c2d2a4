//! A table on disk: comma, dot, header row, full double precision. Every row reaches the file within a blink, and whole: a
//! table never ends within a row, whether its run is killed or its disk full.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::files;
use super::rows::Row;
use crate::run::error::Error;

/// Rows written within this time of each other go to the system together: the call would cost as much as the row.
const BLINK: Duration = Duration::from_millis(50);

/// Rows of so many bytes do so at once.
const MANY: usize = 1 << 16;

/// A CSV file being written, row by row and cell by cell.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    file: File,
    header: Vec<String>,
    /// whole rows that are not yet in the file
    rows: Vec<u8>,
    /// the row so far, a comma behind every cell
    row: Vec<u8>,
    /// a whole row that is written if an event follows
    held: Vec<u8>,
    flushed: Instant,
}

/// How a table comes to its file: [`Table::create`] or [`Table::reopen`].
pub type Opening = fn(&Path, &[String]) -> Result<Table, Error>;

impl Table {
    /// Create the file and write its header.
    pub fn create(path: &Path, header: &[String]) -> Result<Self, Error> {
        let file = files::create(path).map_err(|cause| failed(path, &cause))?;
        let mut table = Self::of(path, file, header);
        header.iter().for_each(|name| table.text(name));
        table.end_row()?;
        table.flush()?;
        Ok(table)
    }

    /// Open the file of an earlier run, to be [`cut`](Self::cut) and gone on with.
    pub fn reopen(path: &Path, header: &[String]) -> Result<Self, Error> {
        let file = files::open(path).map_err(|cause| failed(path, &cause))?;
        Ok(Self::of(path, file, header))
    }

    fn of(path: &Path, file: File, header: &[String]) -> Self {
        let (path, header) = (path.to_owned(), header.to_vec());
        Self { path, file, header, rows: Vec::new(), row: Vec::new(), held: Vec::new(), flushed: Instant::now() }
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

    /// Add cells with numbers.
    pub fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        numbers.into_iter().for_each(|number| self.number(number));
    }

    /// Add a cell with a whole number.
    pub fn count(&mut self, value: usize) {
        // Writing to a Vec cannot fail.
        let _ = write!(self.row, "{value},");
    }

    /// Write the row.
    pub fn end_row(&mut self) -> Result<(), Error> {
        self.end_row_as(Row::Written)
    }

    /// Write the row, with the one that was held or without, or hold it.
    pub fn end_row_as(&mut self, row: Row) -> Result<(), Error> {
        if let Some(comma) = self.row.last_mut() {
            *comma = b'\n';
        }
        if row == Row::AfterTheHeld {
            self.rows.append(&mut self.held);
        }
        self.held.clear();
        match row {
            Row::Held => self.held.append(&mut self.row),
            Row::Written | Row::AfterTheHeld => self.rows.append(&mut self.row),
        }
        if self.rows.len() < MANY { Ok(()) } else { self.flush() }
    }

    /// The row that is held.
    pub fn held(&self) -> &[u8] {
        &self.held
    }

    /// Hold a row of an earlier run.
    pub fn hold(&mut self, row: Vec<u8>) {
        self.held = row;
    }

    /// Hand the rows so far to the system, so that a killed run loses nothing, unless that was done a blink ago.
    pub fn share(&mut self) -> Result<(), Error> {
        if self.flushed.elapsed() < BLINK { Ok(()) } else { self.flush() }
    }

    /// How long the file is [bytes]; so much of it is on the disk.
    pub fn length(&mut self) -> Result<u64, Error> {
        self.flush()?;
        let length = self.file.sync_data().and_then(|()| self.file.metadata()).map(|file| file.len());
        length.map_err(|cause| failed(&self.path, &cause))
    }

    /// Take back what was written after the file was this long. Where it had other columns then, the new ones are not a number
    /// in the rows so far.
    pub fn cut(&mut self, length: u64) -> Result<(), Error> {
        self.rows.clear();
        self.row.clear();
        self.held.clear();
        let path = self.path.clone();
        self.cut_to(length).map_err(|cause| failed(&path, &cause))
    }

    fn cut_to(&mut self, length: u64) -> io::Result<()> {
        let is = self.file.metadata()?.len();
        if is < length {
            let message =
                format!("has {is} bytes, but had {length} when the checkpoint was written: it was changed since");
            return Err(io::Error::other(message));
        }
        self.file.seek(SeekFrom::Start(0))?;
        let mut line = String::new();
        io::BufRead::read_line(&mut io::BufReader::new((&self.file).take(length)), &mut line)?;
        let had: Vec<&str> = line.trim_end_matches('\n').split(',').collect();
        if had != self.header {
            let rewritten = self.with_columns_of_now(&had, length)?;
            files::replace(&self.path, rewritten.as_bytes())?;
            self.file = files::open(&self.path)?;
        } else {
            self.file.set_len(length)?;
        }
        self.file.seek(SeekFrom::End(0)).map(drop)
    }

    /// The rows so far under the header of now.
    fn with_columns_of_now(&self, had: &[&str], length: u64) -> io::Result<String> {
        if let Some(gone) = had.iter().find(|name| !self.header.iter().any(|column| column == *name)) {
            let message = format!("has the column `{gone}`, which would be lost: ask for it in the case as before");
            return Err(io::Error::other(message));
        }
        let places: Vec<Option<usize>> =
            self.header.iter().map(|name| had.iter().position(|column| column == name)).collect();
        let mut file = &self.file;
        file.seek(SeekFrom::Start(0))?;
        let mut text = String::new();
        file.take(length).read_to_string(&mut text)?;
        let mut rewritten = self.header.join(",") + "\n";
        for row in text.lines().skip(1) {
            let cells: Vec<&str> = row.split(',').collect();
            let of = |place: &Option<usize>| place.and_then(|place| cells.get(place).copied()).unwrap_or("NaN");
            rewritten += &(places.iter().map(of).collect::<Vec<_>>().join(",") + "\n");
        }
        Ok(rewritten)
    }

    /// Hand the rows so far to the system.
    pub fn flush(&mut self) -> Result<(), Error> {
        self.flushed = Instant::now();
        let rows = std::mem::take(&mut self.rows);
        let mut written = 0;
        while written < rows.len() {
            match self.file.write(&rows[written..]) {
                Err(cause) if cause.kind() == io::ErrorKind::Interrupted => {}
                Ok(0) => return Err(self.ended_in_a_row(&rows[..written], io::ErrorKind::WriteZero.into())),
                Ok(more) => written += more,
                Err(cause) => return Err(self.ended_in_a_row(&rows[..written], cause)),
            }
        }
        self.rows = rows;
        self.rows.clear();
        Ok(())
    }

    /// A file that cannot take more keeps whole rows.
    fn ended_in_a_row(&mut self, written: &[u8], cause: io::Error) -> Error {
        let half = written.iter().rev().take_while(|byte| **byte != b'\n').count() as u64;
        let length = self.file.metadata().map_or(0, |file| file.len());
        if half > 0 && length >= half {
            // It is told that the file is not complete anyway.
            let _ = self.file.set_len(length - half);
        }
        failed(&self.path, &cause)
    }
}

impl Drop for Table {
    fn drop(&mut self) {
        // Whoever wants to hear of a failure flushes before.
        let _ = self.flush();
    }
}

/// An output error of a path.
pub fn failed(path: &Path, cause: &dyn std::fmt::Display) -> Error {
    Error::Output { path: path.to_owned(), cause: cause.to_string() }
}
