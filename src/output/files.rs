//! Safe writing of files and folders: nothing of a user's is overwritten, links are not followed, and files that may be read
//! while they are written are replaced as a whole.
//!
//! One process at a time writes into a folder. The lock file names it: process id, host, and start time.
//!
//! The system holds the lock until the process ends for whatever reason, so a killed process leaves no lock. Where the
//! system has no locks, the content of the file decides. Locks of a network file system are not always visible to
//! other hosts: the lock of another host counts as abandoned once the system's lock is free and its heartbeat, the time of
//! the file, is over ten minutes old.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Log of a run in its results folder: what it printed.
pub const LOG: &str = "run.log";

/// Creates a new file in place of an earlier one.
///
/// # Errors
/// Returns the error of the system; a link or a folder of that name is not touched.
pub fn create(path: &Path) -> io::Result<File> {
    remove(path)?;
    File::options().read(true).write(true).create_new(true).open(path)
}

/// Opens an existing file, to be continued.
///
/// # Errors
/// The same as for [`create`].
pub fn open(path: &Path) -> io::Result<File> {
    plain(path)?;
    File::options().read(true).write(true).open(path)
}

/// Removes a file if it exists.
///
/// # Errors
/// The same as for [`create`].
pub fn remove(path: &Path) -> io::Result<()> {
    match plain(path) {
        Ok(()) => fs::remove_file(path),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
    }
}

/// Whether a file, not a link, contains these words near its start; they distinguish files of the program from a user's file
/// of that name.
pub fn bears(path: &Path, words: &str) -> bool {
    let mut start = Vec::new();
    let read = |file: File| file.take(1024).read_to_end(&mut start);
    plain(path).and_then(|()| File::open(path)).and_then(read).is_ok()
        && String::from_utf8_lossy(&start).contains(words)
}

/// Checks that a path is a regular file, not a link.
fn plain(path: &Path) -> io::Result<()> {
    let kind = fs::symlink_metadata(path)?.file_type();
    match (kind.is_file(), kind.is_symlink()) {
        (true, _) => Ok(()),
        (_, true) => Err(io::Error::other("is a link, which is neither written nor removed")),
        _ => Err(io::Error::other("is not a plain file")),
    }
}

/// Creates a subfolder of the results, which must not be a link.
///
/// # Errors
/// The same as for [`create`].
pub fn folder(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(known) if known.is_dir() => Ok(()),
        Ok(_) => Err(io::Error::other("is not a folder of its own")),
        Err(_) => fs::create_dir(path),
    }
}

/// Replaces the content of a file; at any moment it is the old or the new one as a whole.
///
/// # Errors
/// Returns the error of the system; the old file is then kept.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let aside = aside(path);
    let written = create(&aside).and_then(|mut file| file.write_all(bytes)).and_then(|()| into_place(&aside, path));
    if written.is_err() {
        // The incomplete file is of no use.
        let _ = remove(&aside);
    }
    written
}

/// Replaces a file as [`replace`] and synchronizes it to the disk.
///
/// # Errors
/// The same as for [`replace`].
pub fn replace_for_good(path: &Path, bytes: &[u8]) -> io::Result<()> {
    replace_for_good_after(path, bytes, || Ok(()))
}

/// Replaces a file as [`replace_for_good`] and calls `then` once the new file is complete, before it is renamed.
///
/// # Errors
/// The same as for [`replace`], and those of `then`.
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

/// Renames a file to the path of another.
///
/// # Errors
/// The same as for [`create`].
pub fn into_place(aside: &Path, path: &Path) -> io::Result<()> {
    match plain(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
        _ => fs::rename(aside, path)?,
    }
    // Renaming one of two hard links of a file to the other has no effect (POSIX).
    remove(aside)
}

/// Synchronizes the folder, without which a renamed file may revert to its old name.
fn sync_folder(path: &Path) -> io::Result<()> {
    match path.parent() {
        // Where folders cannot be opened, nothing can be done.
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

/// Name of the lock file in the folder.
pub const LOCK: &str = "fecontact.lock";

/// Disk space reserved by the lock, released on a full disk so that the end of a run can still be recorded [bytes].
const RESERVE: usize = 64 << 10;

/// Time between two heartbeats of a lock.
const BEAT: Duration = Duration::from_secs(30);

/// Time without a heartbeat after which a lock of another host counts as abandoned.
const LEFT_BEHIND: Duration = Duration::from_secs(600);

/// Lock of a folder, held by this process until it is dropped.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    file: File,
    _heart: Heart,
}

/// Thread that updates the time of a lock while it is held.
#[derive(Debug)]
struct Heart {
    /// `None` once the thread is to stop
    beating: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

/// Process that holds a lock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Holder {
    process: u32,
    computer: String,
    /// start time, in seconds since 1970
    since: u64,
}

/// A folder, or a file in it, because of which results cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}: --out: {cause}", path.display())]
pub struct FolderError {
    /// the folder or file
    pub path: PathBuf,
    /// reason and remedy
    pub cause: String,
}

impl FolderError {
    /// Creates an error about a folder or file.
    pub fn new(path: &Path, cause: impl ToString) -> Self {
        Self { path: path.to_owned(), cause: cause.to_string() }
    }

    /// Creates the error of a folder or file that cannot be written.
    pub fn unwritable(path: &Path, cause: impl std::fmt::Display) -> Self {
        Self::new(path, format_args!("results cannot be written here: {cause}"))
    }
}

impl Lock {
    /// Locks a folder.
    ///
    /// # Errors
    /// Returns [`FolderError`] that names the holder of the lock, or the reason why it cannot be written.
    pub fn take(folder: &Path) -> Result<Self, FolderError> {
        Self::beating(folder, BEAT)
    }

    /// Locks a folder as [`take`](Self::take), with a given time between two heartbeats.
    ///
    /// # Errors
    /// The same as for [`take`](Self::take).
    pub fn beating(folder: &Path, beat: Duration) -> Result<Self, FolderError> {
        let path = folder.join(LOCK);
        let cannot = |cause: io::Error| FolderError::unwritable(folder, format_args!("{LOCK}: {cause}"));
        let busy = |holder: Option<&Holder>| FolderError::new(folder, busy(holder));
        let mut file = open_lock(&path).map_err(cannot)?;
        let me = Holder::this();
        let holder = Holder::read(&mut file);
        match (file.try_lock(), &holder) {
            (Err(TryLockError::WouldBlock), holder) => return Err(busy(holder.as_ref())),
            (Err(TryLockError::Error(_)), Some(holder)) if holder.lives(&me) => return Err(busy(Some(holder))),
            (_, Some(holder)) if holder.computer != me.computer => {
                let silent = silent_for(&file);
                if silent <= LEFT_BEHIND {
                    return Err(FolderError::new(folder, elsewhere(holder, silent)));
                }
                // A previous holder that is still active detects the replaced file and stops.
                if same(&path, &file) {
                    fs::remove_file(&path).map_err(cannot)?;
                }
                file = open_lock(&path).map_err(cannot)?;
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
        written.map_err(cannot)?;
        match lock.is_there() {
            true => Ok(lock),
            // The previous holder has just ended and removed it.
            false => Err(busy(None)),
        }
    }

    /// Whether the lock file, and therefore the folder, still exists.
    pub fn is_there(&self) -> bool {
        same(&self.path, &self.file)
    }

    /// Releases the reserved disk space.
    pub fn give_room(&mut self) {
        // On failure there is only less space.
        let _ = self.file.set_len(512);
    }
}

impl Heart {
    fn of(lock: &File, beat: Duration) -> Self {
        let (beating, ends) = channel::<()>();
        // Without a heartbeat the lock would count as abandoned too early, and only on another host.
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
            // The result of the thread is not needed.
            let _ = thread.join();
        }
    }
}

/// Time since the last heartbeat of a lock; zero if the clock is ahead or the file has no time.
fn silent_for(lock: &File) -> Duration {
    let beat = lock.metadata().and_then(|known| known.modified());
    beat.ok().and_then(|beat| SystemTime::now().duration_since(beat).ok()).unwrap_or_default()
}

/// Whether a process of this host writes into a folder, as far as can be detected without interfering.
pub fn at_work(folder: &Path) -> bool {
    let holder = File::open(folder.join(LOCK)).ok().and_then(|mut file| Holder::read(&mut file));
    holder.is_some_and(|holder| holder.lives(&Holder::this()))
}

impl Drop for Lock {
    fn drop(&mut self) {
        if self.is_there() {
            // A remaining file is found to be abandoned.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

fn open_lock(path: &Path) -> io::Result<File> {
    match open(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            match File::options().read(true).write(true).create_new(true).open(path) {
                // Another process was faster.
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

    /// Whether its process is active, as far as this host can determine.
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

/// Name of this host.
fn computer() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let name = name.or_else(|| std::env::var("HOSTNAME").ok()).or_else(|| std::env::var("COMPUTERNAME").ok());
    name.map_or_else(|| "this computer".into(), |name| name.trim().into())
}
