//! Files and folders, made so that nothing of a user's is lost: never through a link, and whole or not at all where a reader
//! might look at them half written.
//!
//! # Lock
//!
//! One process at a time writes into a folder. A lock names it: its number, the computer it runs on, and since when.
//!
//! The system holds the lock as long as the process lives, whatever ends it, so that what a killed one leaves is no lock any
//! more. Where the system has no locks, what stands in it decides. Locks of a network file system are not always seen from
//! another computer: one that another computer wrote counts as left behind once the system's lock is free and its heartbeat,
//! the time of the file, is over ten minutes old.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

/// A new file in the place of an earlier one.
///
/// # Errors
/// What the system says; a link or a folder in its place is left alone.
pub fn create(path: &Path) -> io::Result<File> {
    remove(path)?;
    File::options().read(true).write(true).create_new(true).open(path)
}

/// A file that is there already, to be continued.
///
/// # Errors
/// As [`create`].
pub fn open(path: &Path) -> io::Result<File> {
    plain(path)?;
    File::options().read(true).write(true).open(path)
}

/// Remove a file, if it is there.
///
/// # Errors
/// As [`create`].
pub fn remove(path: &Path) -> io::Result<()> {
    match plain(path) {
        Ok(()) => fs::remove_file(path),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
    }
}

/// Whether a file of its own has these words among its first: they distinguish our files from a user's file of that
/// name.
pub fn bears(path: &Path, words: &str) -> bool {
    let mut start = Vec::new();
    let read = |file: File| file.take(1024).read_to_end(&mut start);
    plain(path).and_then(|()| File::open(path)).and_then(read).is_ok()
        && String::from_utf8_lossy(&start).contains(words)
}

/// Whether it is a file of its own.
fn plain(path: &Path) -> io::Result<()> {
    let kind = fs::symlink_metadata(path)?.file_type();
    match (kind.is_file(), kind.is_symlink()) {
        (true, _) => Ok(()),
        (_, true) => Err(io::Error::other("is a link, which is neither written nor removed")),
        _ => Err(io::Error::other("is no plain file")),
    }
}

/// A folder below that of the results, which must be one of its own.
///
/// # Errors
/// As [`create`].
pub fn folder(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(known) if known.is_dir() => Ok(()),
        Ok(_) => Err(io::Error::other("is not a folder of its own")),
        Err(_) => fs::create_dir(path),
    }
}

/// Put a text into the place of a file, which is the old one or the new one at any moment, and never a part of it.
///
/// # Errors
/// What the system says; the old file is still there then.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let aside = aside(path);
    let written = create(&aside).and_then(|mut file| file.write_all(bytes)).and_then(|()| into_place(&aside, path));
    if written.is_err() {
        // What is left of it would only be in the way.
        let _ = remove(&aside);
    }
    written
}

/// As [`replace`], and on the disk when it returns.
///
/// # Errors
/// As [`replace`].
pub fn replace_for_good(path: &Path, bytes: &[u8]) -> io::Result<()> {
    replace_for_good_after(path, bytes, || Ok(()))
}

/// As [`replace_for_good`]; something is done once the new file is complete, before it takes its
/// place.
///
/// # Errors
/// As [`replace`], and those of what is done.
pub fn replace_for_good_after(path: &Path, bytes: &[u8], then: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
    let aside = aside(path);
    let filled = create(&aside).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    let written = filled.and_then(|()| then()).and_then(|()| into_place(&aside, path)).and_then(|()| sync_folder(path));
    if written.is_err() {
        let _ = remove(&aside);
    }
    written
}

/// Move a file into the place of another.
///
/// # Errors
/// As [`create`].
pub fn into_place(aside: &Path, path: &Path) -> io::Result<()> {
    match plain(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
        _ => fs::rename(aside, path)?,
    }
    // Two names of one file stay as they are (POSIX).
    remove(aside)
}

/// A renamed file has its new name for good only once its folder is on the disk.
fn sync_folder(path: &Path) -> io::Result<()> {
    match path.parent() {
        // Where folders cannot be opened there is nothing to be done.
        Some(folder) => File::open(folder).map_or(Ok(()), |folder| folder.sync_all()),
        None => Ok(()),
    }
}

/// Temporary path of a file before it is renamed.
pub fn aside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    path.with_file_name(name)
}

/// Name of the lock in the folder.
pub const LOCK: &str = "fecontact.lock";

/// Room that the lock keeps: given back when a disk is full, so that the end of a run can still be recorded [bytes].
const RESERVE: usize = 64 << 10;

/// Between two beats of a lock.
const BEAT: Duration = Duration::from_secs(30);

/// A lock of another computer without a beat for so long was left behind.
const LEFT_BEHIND: Duration = Duration::from_secs(600);

/// A folder is locked by this process until it is dropped.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    file: File,
    _heart: Heart,
}

/// A thread that sets the time of a lock as long as the lock is held.
#[derive(Debug)]
struct Heart {
    /// `None` once it is to stop
    beating: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

/// Process that holds a lock.
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
        Self::beating(folder, BEAT)
    }

    /// As [`take`](Self::take), with so long between two beats.
    ///
    /// # Errors
    /// As [`take`](Self::take).
    pub fn beating(folder: &Path, beat: Duration) -> Result<Self, String> {
        let path = folder.join(LOCK);
        let message = |cause: io::Error| format!("results cannot be written here: {LOCK}: {cause}");
        let mut file = open_lock(&path).map_err(message)?;
        let me = Holder::this();
        let holder = Holder::read(&mut file);
        match (file.try_lock(), &holder) {
            (Err(TryLockError::WouldBlock), holder) => return Err(busy(holder.as_ref())),
            (Err(TryLockError::Error(_)), Some(holder)) if holder.lives(&me) => return Err(busy(Some(holder))),
            (_, Some(holder)) if holder.computer != me.computer => {
                let silent = silent_for(&file);
                if silent <= LEFT_BEHIND {
                    return Err(elsewhere(holder, silent));
                }
                // Its holder, if it is at work after all, notices that another file stands in its place, and ends.
                if same(&path, &file) {
                    fs::remove_file(&path).map_err(message)?;
                }
                file = open_lock(&path).map_err(message)?;
                if let Err(TryLockError::WouldBlock) = file.try_lock() {
                    return Err(busy(Holder::read(&mut file).as_ref()));
                }
            }
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
        let heart = Heart::of(&file, beat);
        let lock = Self { path, file, _heart: heart };
        written.map_err(message)?;
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

impl Heart {
    fn of(lock: &File, beat: Duration) -> Self {
        let (beating, ends) = channel::<()>();
        // Without it, the lock would only count as left behind too early, and only on another computer.
        let beats = |lock: File| {
            std::thread::Builder::new().name("lock".into()).spawn(move || {
                while ends.recv_timeout(beat) == Err(RecvTimeoutError::Timeout) {
                    let _ = lock.set_modified(SystemTime::now());
                }
            })
        };
        let thread = lock.try_clone().and_then(beats).ok();
        Self { beating: Some(beating), thread }
    }
}

impl Drop for Heart {
    fn drop(&mut self) {
        self.beating = None;
        if let Some(thread) = self.thread.take() {
            // It only sets times, and nobody needs what it returns.
            let _ = thread.join();
        }
    }
}

/// Time since the last beat of a lock; none for one from a clock that is ahead, or without a time.
fn silent_for(lock: &File) -> Duration {
    let beat = lock.metadata().and_then(|known| known.modified());
    beat.ok().and_then(|beat| SystemTime::now().duration_since(beat).ok()).unwrap_or_default()
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

fn open_lock(path: &Path) -> io::Result<File> {
    match open(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            match File::options().read(true).write(true).create_new(true).open(path) {
                // Somebody was faster.
                Err(error) if error.kind() == ErrorKind::AlreadyExists => open(path),
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

fn elsewhere(Holder { process, computer, .. }: &Holder, silent: Duration) -> String {
    format!(
        "process {process} on {computer}, another computer, was at work in this folder {} s ago: wait for its end, or choose \
         another --out; if it was killed, remove {LOCK}, which counts as left behind {} min after its last sign of life",
        silent.as_secs(),
        LEFT_BEHIND.as_secs() / 60
    )
}

/// Name of this computer.
fn computer() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let name = name.or_else(|| std::env::var("HOSTNAME").ok()).or_else(|| std::env::var("COMPUTERNAME").ok());
    name.map_or_else(|| "this computer".into(), |name| name.trim().into())
}
