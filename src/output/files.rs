//! Files and folders, made so that nothing of a user's is lost: never through a link, and whole or not at all where a reader
//! might look at them half written.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

/// A new file in the place of an earlier one.
///
/// # Errors
/// What the system says; a link or a folder in its place is left alone.
pub fn create(path: &Path) -> io::Result<File> {
    remove(path)?;
    File::options().read(true).write(true).create_new(true).open(path)
}

/// A file that is there already, to be gone on with.
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

/// Whether a file of its own has these words among its first: by them what we have written is told from a user's file of that name.
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

/// Where a file is written before it takes its place.
pub fn aside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    path.with_file_name(name)
}
