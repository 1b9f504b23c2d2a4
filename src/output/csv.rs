//! CSV tables on disk: comma, decimal point, header row, full double precision. Every row reaches the file within 50 ms and as
//! a whole: a table never ends within a row, even if the run is killed or the disk is full.
//!
//! Observers store their memory as bytes.

use std::fs::File;
use std::io::{self, BufRead, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::files;
use crate::model::Model;
use crate::run::{Attempt, Error, Observer, Row};

/// Time within which rows are written to the system together: a call costs as much as a row.
const BLINK: Duration = Duration::from_millis(50);

/// Number of bytes at which rows are written at once.
const MANY: usize = 1 << 16;

/// Extent of a written table: number of bytes, their checksum, and the row held back.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Standing {
    length: u64,
    crc: u32,
    held: Vec<u8>,
}

/// A CSV file being written, row by row and cell by cell.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    file: File,
    header: Vec<String>,
    /// complete rows that are not yet in the file
    rows: Vec<u8>,
    /// current row, with a comma behind every cell
    row: Vec<u8>,
    /// complete row that is written only if an event follows
    held: Vec<u8>,
    /// bytes in the file, and their checksum so far
    length: u64,
    crc: crc32fast::Hasher,
    flushed: Instant,
}

impl Table {
    /// Creates the file and writes its header.
    pub fn create(path: &Path, header: Vec<String>) -> Result<Self, Error> {
        let file = files::create(path).map_err(|cause| failed(path, &cause))?;
        let line = header.join(",");
        let mut table = Self::of(path, file, header);
        table.text(&line);
        table.end_row()?;
        table.flush()?;
        Ok(table)
    }

    /// Opens the file of an earlier run, to be [`cut`](Self::cut) and continued.
    pub fn reopen(path: &Path, header: Vec<String>) -> Result<Self, Error> {
        let file = files::open(path).map_err(|cause| failed(path, &cause))?;
        Ok(Self::of(path, file, header))
    }

    fn of(path: &Path, file: File, header: Vec<String>) -> Self {
        Self {
            path: path.to_owned(),
            file,
            header,
            rows: Vec::new(),
            row: Vec::new(),
            held: Vec::new(),
            length: 0,
            crc: crc32fast::Hasher::new(),
            flushed: Instant::now(),
        }
    }

    /// Adds a cell with a text.
    pub fn text(&mut self, text: &str) {
        self.row.extend_from_slice(text.as_bytes());
        self.row.push(b',');
    }

    /// Adds a cell with a number that reads back as the same double.
    pub fn number(&mut self, value: f64) {
        self.text(zmij::Buffer::new().format(value));
    }

    /// Adds cells with numbers.
    pub fn numbers(&mut self, numbers: impl IntoIterator<Item = f64>) {
        numbers.into_iter().for_each(|number| self.number(number));
    }

    /// Adds a cell with an integer.
    pub fn count(&mut self, value: usize) {
        // Writing to a Vec cannot fail.
        let _ = write!(self.row, "{value},");
    }

    /// Ends and writes the row.
    pub fn end_row(&mut self) -> Result<(), Error> {
        self.end_row_as(Row::Written)
    }

    /// Writes the row, with or without the one held back, or holds it back.
    pub fn end_row_as(&mut self, row: Row) -> Result<(), Error> {
        if let Some(comma) = self.row.last_mut() {
            *comma = b'\n';
        }
        if row == Row::AfterTheHeld {
            self.rows.append(&mut self.held);
        }
        self.held.clear();
        match row {
            Row::Pending => self.held.append(&mut self.row),
            Row::Written | Row::AfterTheHeld => self.rows.append(&mut self.row),
        }
        if self.rows.len() < MANY { Ok(()) } else { self.flush() }
    }

    /// Writes pending rows to the system, so that a killed run loses nothing, unless that was done within the last 50 ms.
    pub fn share(&mut self) -> Result<(), Error> {
        if self.flushed.elapsed() < BLINK { Ok(()) } else { self.flush() }
    }

    /// Returns the extent of the file, after flushing it to the disk.
    pub fn standing(&mut self) -> Result<Standing, Error> {
        self.flush()?;
        self.file.sync_data().map_err(|cause| failed(&self.path, &cause))?;
        Ok(Standing { length: self.length, crc: self.crc.clone().finalize(), held: self.held.clone() })
    }

    /// Checks, without changes, whether the file can be continued: its content is unchanged, and no column would be lost.
    pub fn check(&self, stood: &Standing) -> Result<(), Error> {
        self.can_go_on_from(stood).map_err(|cause| failed(&self.path, &cause))
    }

    fn can_go_on_from(&self, &Standing { length, crc, .. }: &Standing) -> io::Result<()> {
        let changed = |what: String| {
            Err(io::Error::other(format!(
                "was changed since the checkpoint was written: {what}; restore it, or start a new run in another folder"
            )))
        };
        let is = self.file.metadata()?.len();
        if is < length {
            return changed(format!("it had {length} bytes, and has {is}"));
        }
        if self.checksum(length)?.finalize() != crc {
            return changed(format!("its first {length} bytes have another checksum"));
        }
        let had = self.columns_there(length)?;
        match had.iter().find(|name| !self.header.contains(name)) {
            None => Ok(()),
            Some(gone) => Err(io::Error::other(format!(
                "has the column `{gone}`, which would be lost: request it in the case as before"
            ))),
        }
    }

    /// Checksum of the first bytes of the file.
    fn checksum(&self, length: u64) -> io::Result<crc32fast::Hasher> {
        let (mut crc, mut part) = (crc32fast::Hasher::new(), vec![0; MANY]);
        let mut rest = self.first(length)?;
        loop {
            match rest.read(&mut part)? {
                0 => return Ok(crc),
                read => crc.update(&part[..read]),
            }
        }
    }

    /// Columns in the header of the file.
    fn columns_there(&self, length: u64) -> io::Result<Vec<String>> {
        let mut line = String::new();
        io::BufReader::new(self.first(length)?).read_line(&mut line)?;
        Ok(line.trim_end_matches('\n').split(',').map(String::from).collect())
    }

    /// The first bytes of the file.
    fn first(&self, length: u64) -> io::Result<io::Take<&File>> {
        let mut file = &self.file;
        file.seek(SeekFrom::Start(0))?;
        Ok(file.take(length))
    }

    /// Removes what was written after the given extent. Columns that the file did not have then become NaN in its earlier rows.
    pub fn cut(&mut self, stood: Standing) -> Result<(), Error> {
        self.rows.clear();
        self.row.clear();
        self.cut_to(&stood).map_err(|cause| failed(&self.path, &cause))?;
        self.held = stood.held;
        Ok(())
    }

    fn cut_to(&mut self, &Standing { length, crc, .. }: &Standing) -> io::Result<()> {
        let had = self.columns_there(length)?;
        if had == self.header {
            self.file.set_len(length)?;
            (self.length, self.crc) = (length, crc32fast::Hasher::new_with_initial(crc));
        } else {
            let rewritten = self.with_columns_of_now(&had, length)?;
            files::replace(&self.path, rewritten.as_bytes())?;
            self.file = files::open(&self.path)?;
            (self.length, self.crc) = (rewritten.len() as u64, crc32fast::Hasher::new());
            self.crc.update(rewritten.as_bytes());
        }
        self.file.seek(SeekFrom::End(0)).map(drop)
    }

    /// Returns the earlier rows under the current header.
    fn with_columns_of_now(&self, had: &[String], length: u64) -> io::Result<String> {
        let places: Vec<Option<usize>> =
            self.header.iter().map(|name| had.iter().position(|column| column == name)).collect();
        let mut text = String::new();
        self.first(length)?.read_to_string(&mut text)?;
        let mut rewritten = self.header.join(",") + "\n";
        for row in text.lines().skip(1) {
            let cells: Vec<&str> = row.split(',').collect();
            let of = |place: &Option<usize>| place.and_then(|place| cells.get(place).copied()).unwrap_or("NaN");
            rewritten += &(places.iter().map(of).collect::<Vec<_>>().join(",") + "\n");
        }
        Ok(rewritten)
    }

    /// Writes pending rows to the system.
    pub fn flush(&mut self) -> Result<(), Error> {
        self.flushed = Instant::now();
        let rows = std::mem::take(&mut self.rows);
        let mut written = 0;
        while written < rows.len() {
            match self.file.write(&rows[written..]) {
                Err(cause) if cause.kind() == io::ErrorKind::Interrupted => {}
                Ok(0) => return Err(self.ended_in_a_row(&rows[..written], io::ErrorKind::WriteZero.into())),
                Ok(more) => {
                    self.crc.update(&rows[written..written + more]);
                    self.length += more as u64;
                    written += more;
                }
                Err(cause) => return Err(self.ended_in_a_row(&rows[..written], cause)),
            }
        }
        self.rows = rows;
        self.rows.clear();
        Ok(())
    }

    /// Truncates a file that cannot grow to complete rows.
    fn ended_in_a_row(&mut self, written: &[u8], cause: io::Error) -> Error {
        let half = written.iter().rev().take_while(|byte| **byte != b'\n').count() as u64;
        let length = self.file.metadata().map_or(0, |file| file.len());
        if half > 0 && length >= half {
            // The incomplete file is reported in any case.
            let _ = self.file.set_len(length - half);
        }
        failed(&self.path, &cause)
    }
}

impl Drop for Table {
    fn drop(&mut self) {
        // Callers that handle failures flush before.
        let _ = self.flush();
    }
}

/// Returns the output error of a path.
pub fn failed(path: &Path, cause: &dyn std::fmt::Display) -> Error {
    Error::Output { path: path.to_owned(), cause: cause.to_string() }
}

/// Encodes the memory of an observer.
pub fn remembered(memory: &impl Serialize) -> Result<Vec<u8>, Error> {
    postcard::to_allocvec(memory).map_err(|cause| failed(Path::new("memory of an observer"), &cause))
}

/// Decodes the memory of an observer.
pub fn recalled<M: DeserializeOwned>(bytes: &[u8]) -> Result<M, Error> {
    postcard::from_bytes(bytes).map_err(|cause| failed(Path::new("memory of an observer"), &cause))
}

/// Rows of a table written by a run, with their memory from row to row.
pub trait Rows: Sized {
    /// name of the table without extension, under which its memory is saved
    const NAME: &'static str;

    /// Creates the rows of a model, and their header.
    fn new(model: &Model) -> (Self, Vec<String>);

    /// Writes the rows of an attempt, if it has any.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if the file cannot be written.
    fn write(&mut self, table: &mut Table, model: &Model, attempt: &Attempt) -> Result<(), Error>;

    /// Returns the memory in bytes; empty by default.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if it cannot be encoded.
    fn save(&self) -> Result<Vec<u8>, Error> {
        Ok(Vec::new())
    }

    /// Resumes from the saved memory.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if the bytes cannot be decoded.
    fn restore(&mut self, _memory: &[u8]) -> Result<(), Error> {
        Ok(())
    }
}

/// Observer that writes a table during a run.
#[derive(Debug)]
pub struct Sheet<R> {
    table: Table,
    pub(super) rows: R,
}

impl<R: Rows> Sheet<R> {
    /// Creates the table in `folder`.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if it cannot be written.
    pub fn create(folder: &Path, model: &Model) -> Result<Self, Error> {
        let (rows, header) = R::new(model);
        Ok(Self { table: Table::create(&file::<R>(folder), header)?, rows })
    }

    /// Opens the existing table, to be restored.
    ///
    /// # Errors
    /// Returns [`Error::Output`] if it cannot be opened.
    pub fn reopen(folder: &Path, model: &Model) -> Result<Self, Error> {
        let (rows, header) = R::new(model);
        Ok(Self { table: Table::reopen(&file::<R>(folder), header)?, rows })
    }
}

fn file<R: Rows>(folder: &Path) -> PathBuf {
    folder.join(format!("{}.csv", R::NAME))
}

impl<R: Rows> Observer for Sheet<R> {
    fn record(&mut self, model: &Model, attempt: &Attempt) -> Result<(), Error> {
        self.rows.write(&mut self.table, model, attempt)?;
        self.table.share()
    }

    fn name(&self) -> &'static str {
        R::NAME
    }

    fn save(&mut self) -> Result<Vec<u8>, Error> {
        remembered(&(self.table.standing()?, self.rows.save()?))
    }

    fn check(&self, memory: &[u8]) -> Result<(), Error> {
        self.table.check(&recalled::<(Standing, Vec<u8>)>(memory)?.0)
    }

    fn restore(&mut self, memory: &[u8]) -> Result<(), Error> {
        let (stood, memory) = recalled::<(Standing, Vec<u8>)>(memory)?;
        self.table.cut(stood)?;
        self.rows.restore(&memory)
    }

    fn finish(&mut self) -> Result<(), Error> {
        self.table.flush()
    }
}
