//! One process at a time writes into a folder. A lock names it: its number, the computer it runs on, and since when.
//!
//! The system holds the lock as long as the process lives, whatever ends it, so that what a killed one leaves is no lock any
//! more. Where the system has no locks, or another computer wrote the file, what stands in it decides.

use std::fs::{File, TryLockError};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use super::files;

/// Name of the lock in the folder.
pub const LOCK: &str = "fecontact.lock";

/// Room that the lock keeps: given back when a disk is full, so that the end of a run can still be told [bytes].
const RESERVE: usize = 64 << 10;

/// A folder is locked by this process until it is dropped.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    file: File,
}

/// Who holds a lock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Holder {
    process: u32,
    computer: String,
    /// Seconds since 1970
    since: u64,
}

impl Lock {
    /// Lock a folder.
    ///
    /// # Errors
    /// Who is at work in it, or why the lock cannot be written.
    pub fn take(folder: &Path) -> Result<Self, String> {
        let path = folder.join(LOCK);
        let told = |cause: io::Error| format!("results cannot be written here: {LOCK}: {cause}");
        let mut file = open(&path).map_err(told)?;
        let me = Holder::this();
        let holder = Holder::read(&mut file);
        match (file.try_lock(), &holder) {
            (Err(TryLockError::WouldBlock), holder) => return Err(busy(holder.as_ref())),
            (Err(TryLockError::Error(_)), Some(holder)) if holder.lives(&me) => return Err(busy(Some(holder))),
            (_, Some(holder)) if holder.computer != me.computer => return Err(elsewhere(holder)),
            _ => {}
        }
        let mut text = serde_json::to_string(&me).unwrap_or_default();
        text.extend(std::iter::repeat_n(' ', RESERVE.saturating_sub(text.len() + 1)));
        text.push('\n');
        let write = |file: &mut File| {
            file.set_len(0)?;
            file.seek(SeekFrom::Start(0))?;
            file.write_all(text.as_bytes())
        };
        let written = write(&mut file);
        let lock = Self { path, file };
        written.map_err(told)?;
        match lock.is_there() {
            true => Ok(lock),
            // Whoever held it has just ended and taken it away.
            false => Err(busy(None)),
        }
    }

    /// Whether the lock, and so its folder, is still there.
    pub fn is_there(&self) -> bool {
        same(&self.path, &self.file)
    }

    /// Give back the room that was kept for the end.
    pub fn give_room(&mut self) {
        // Without it there is just less room.
        let _ = self.file.set_len(512);
    }
}

/// Whether a process of this computer writes into a folder, as far as can be seen without disturbing it.
pub fn at_work(folder: &Path) -> bool {
    let holder = File::open(folder.join(LOCK)).ok().and_then(|mut file| Holder::read(&mut file));
    holder.is_some_and(|holder| holder.lives(&Holder::this()))
}

impl Drop for Lock {
    fn drop(&mut self) {
        if self.is_there() {
            // One that stays is found to be nobody's.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

fn open(path: &Path) -> io::Result<File> {
    match files::open(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            match File::options().read(true).write(true).create_new(true).open(path) {
                // Somebody was faster.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => files::open(path),
                created => created,
            }
        }
        opened => opened,
    }
}

#[cfg(unix)]
fn same(path: &Path, file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    let number = |known: io::Result<std::fs::Metadata>| known.ok().map(|known| (known.dev(), known.ino()));
    let own = number(file.metadata());
    own.is_some() && own == number(std::fs::symlink_metadata(path))
}

#[cfg(not(unix))]
fn same(path: &Path, _: &File) -> bool {
    path.exists()
}

impl Holder {
    fn this() -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs());
        Self { process: std::process::id(), computer: computer(), since }
    }

    fn read(file: &mut File) -> Option<Self> {
        let mut text = String::new();
        file.take(RESERVE as u64).read_to_string(&mut text).ok()?;
        serde_json::from_str(&text).ok()
    }

    /// Whether its process is at work, as far as this computer can know.
    fn lives(&self, me: &Self) -> bool {
        self.computer == me.computer
            && self.process != me.process
            && Path::new(&format!("/proc/{}", self.process)).exists()
    }
}

fn busy(holder: Option<&Holder>) -> String {
    let who = match holder {
        Some(Holder { process, computer, since }) => {
            let minutes = Holder::this().since.saturating_sub(*since) / 60;
            format!("process {process} on {computer} has been writing into this folder for {minutes} min")
        }
        None => "another process writes into this folder".into(),
    };
    format!("{who}: wait for its end, or choose another --out")
}

fn elsewhere(Holder { process, computer, .. }: &Holder) -> String {
    format!(
        "process {process} on {computer}, another computer, wrote into this folder and has not ended, or was killed: if it is \
         gone, remove {LOCK}"
    )
}

/// Name of this computer.
fn computer() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let name = name.or_else(|| std::env::var("HOSTNAME").ok()).or_else(|| std::env::var("COMPUTERNAME").ok());
    name.map_or_else(|| "this computer".into(), |name| name.trim().into())
}
