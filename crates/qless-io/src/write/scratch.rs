//! Makes temporary files beside the final places of new files, and locks that show which writers still run.
//!
//! A writer marks its folder by a file `.qless-XXXXXX`, the mark, which it keeps locked. Its new files are `.qless-XXXXXX-1`,
//! `.qless-XXXXXX-2`, and so on, until they are renamed. If the program is killed, the lock ends with it, and the next writer removes these
//! files. The writer takes no other file for a temporary one.
//!
//! | lock | held | between |
//! | --- | --- | --- |
//! | of the folder | while a mark is made, and while files are renamed | processes |
//! | of the mark | as long as the writer lives | processes |
//! | [`WriteLock`] | while files are created, renamed or removed | threads; [`abandon`] takes it and never releases it |

use std::cell::Cell;
use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::WriteError;

static WRITING: Mutex<()> = Mutex::new(());

thread_local! {
    static AT_WORK: Cell<bool> = const { Cell::new(false) };
}

/// The right to create files and to put them in place. Only one thread at a time has it.
pub(super) struct WriteLock(#[expect(dead_code, reason = "it is held")] MutexGuard<'static, ()>);

impl WriteLock {
    /// Waits until this thread has the lock. If the program is ending, it waits for ever.
    pub fn take() -> Self {
        let guard = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
        AT_WORK.set(true);
        Self(guard)
    }
}

impl Drop for WriteLock {
    fn drop(&mut self) {
        AT_WORK.set(false);
    }
}

/// Whether this thread is creating files, putting them in place, or removing them at the end.
///
/// If so, a failed allocation would leave files behind. An allocator that keeps a reserve may use it then. This function does not allocate.
///
/// ```
/// assert!(!qless_io::write::is_at_work());
/// ```
pub fn is_at_work() -> bool {
    AT_WORK.get()
}

/// Prefix of the names of all temporary files.
pub(super) const PREFIX: &str = ".qless-";
/// Number of random letters after the prefix in the name of a mark.
const LETTERS: usize = 6;
/// Content of a mark, which distinguishes it from a file of the user.
const MARK: &[u8] = b"qless writes files here. The next run removes this file and its numbered neighbours.\n";
/// Longest wait for the lock of a folder. A writer holds the lock for some renames, each of which takes milliseconds.
const PATIENCE: Duration = Duration::from_secs(60);
/// Largest number of attempts to mark a folder. The folder may vanish before it is marked: the writer that created it may fail and remove
/// it.
const TRIES: usize = 100;

/// What [`abandon`] removes: the mark of each writer with its files, and the folders that the writer created. To avoid a deadlock, take
/// [`WriteLock`] before this lock.
static TRACES: Mutex<Vec<Traces>> = Mutex::new(Vec::new());

#[derive(Debug)]
struct Traces {
    mark: PathBuf,
    created: Vec<PathBuf>,
}

/// Removes all files that are not yet in place, and blocks every thread that wants to write another one.
///
/// For a program that a signal is about to end. Call it from a separate thread. If a commit is in progress, this waits until it is
/// finished. Threads that call functions of [`write`](super) afterwards wait until the program ends.
///
/// ```no_run
/// // In the thread that waits for signals:
/// qless_io::write::abandon();
/// std::process::exit(128 + 15);
/// ```
pub fn abandon() {
    let lock = WriteLock::take();
    let traces = known();
    traces.iter().for_each(Traces::remove);
    std::mem::forget((lock, traces));
}

/// Calls [`abandon`], unless this thread itself [is at work](super::is_at_work) and thus already holds the lock.
///
/// For a program that ends on the thread in which it failed.
pub fn abandon_unless_at_work() {
    if !is_at_work() {
        abandon();
    }
}

fn known() -> MutexGuard<'static, Vec<Traces>> {
    TRACES.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Traces {
    /// Removes the temporary files of this writer, then its mark, the file `.qless-XXXXXX`, and then the folders that it created if they
    /// are empty. Errors are ignored, because nothing more can be done.
    fn remove(&self) {
        remove_marked(&self.mark);
        for folder in self.created.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Removes the numbered files that belong to a mark, and then the mark.
fn remove_marked(mark: &Path) {
    let (Some(folder), Some(name)) = (mark.parent(), mark.file_name().and_then(|name| name.to_str())) else { return };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let number = entry.file_name();
        let number = number.to_str().and_then(|other| other.strip_prefix(name)?.strip_prefix('-'));
        if number.is_some_and(|number| number.bytes().all(|byte| byte.is_ascii_digit())) {
            let _ = fs::remove_file(entry.path());
        }
    }
    let _ = fs::remove_file(mark);
}

/// Waits for the lock of a folder. `None` if the folder cannot be opened, or if its file system has no locks.
pub(super) fn lock(folder: &Path) -> Result<Option<File>, WriteError> {
    let Ok(file) = File::open(folder) else { return Ok(None) };
    let start = Instant::now();
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(Some(file)),
            Err(TryLockError::Error(_)) => return Ok(None),
            Err(TryLockError::WouldBlock) if start.elapsed() > PATIENCE => {
                return Err(WriteError::Busy { path: folder.to_path_buf() });
            }
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(2)),
        }
    }
}

/// The mark of a writer in a folder. Dropping it removes the files that are not yet in place.
#[derive(Debug)]
pub(super) struct Scratch {
    mark: PathBuf,
    /// The lock of the mark. It is held as long as the writer lives.
    _lock: File,
    files: usize,
}

impl Scratch {
    /// Marks a folder. The folders in `missing` are created first.
    pub fn new(folder: &Path, missing: &[PathBuf]) -> Result<Self, WriteError> {
        let mut tries = 0;
        loop {
            match Self::try_new(folder, missing) {
                Err(WriteError::Io { source, .. })
                    if source.kind() == ErrorKind::NotFound && !missing.is_empty() && tries < TRIES =>
                {
                    tries += 1;
                }
                other => return other,
            }
        }
    }

    fn try_new(folder: &Path, missing: &[PathBuf]) -> Result<Self, WriteError> {
        let created = Created::new(missing).map_err(WriteError::io(folder))?;
        let _folder = lock(folder)?;
        let _lock = WriteLock::take();
        sweep(folder);
        let mut known = known();
        // Reserve memory first: if adding a mark to the list failed, nothing would remove the mark.
        known.reserve(1);
        let (mut file, mark) = mark(folder).map_err(WriteError::io(folder))?;
        known.push(Traces { mark: mark.clone(), created: created.keep() });
        drop(known);
        let _ = file.try_lock();
        let written = file.write_all(MARK);
        let scratch = Self { mark, _lock: file, files: 0 };
        written.map_err(WriteError::io(folder))?;
        Ok(scratch)
    }

    /// Creates a new temporary file.
    pub fn file(&mut self) -> io::Result<(File, PathBuf)> {
        self.files += 1;
        let mut path = self.mark.clone().into_os_string();
        path.push(format!("-{}", self.files));
        let _lock = WriteLock::take();
        Ok((File::create_new(&path)?, path.into()))
    }

    /// Keeps the folders that were created, even if the writer fails from now on.
    pub fn keep_folders(&self) {
        known().iter_mut().filter(|traces| traces.mark == self.mark).for_each(|traces| traces.created.clear());
    }
}

impl Drop for Scratch {
    /// Removes the mark and its files. The mark stays in `TRACES` until then.
    fn drop(&mut self) {
        // While it has the lock, this thread counts as at work, so it may use a reserve of memory: a failed allocation would leave files
        // behind.
        let _lock = (!is_at_work()).then(WriteLock::take);
        let mut known = known();
        known.extract_if(.., |traces| traces.mark == self.mark).for_each(|traces| traces.remove());
    }
}

fn mark(folder: &Path) -> io::Result<(File, PathBuf)> {
    let file = tempfile::Builder::new().prefix(PREFIX).rand_bytes(LETTERS).tempfile_in(folder)?;
    file.keep().map_err(|error| error.error)
}

/// The folders that were created for a writer. Dropping removes those that are empty.
struct Created(Vec<PathBuf>);

impl Created {
    fn new(missing: &[PathBuf]) -> io::Result<Self> {
        let mut created = Self(Vec::new());
        for folder in missing {
            match fs::create_dir(folder) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                done => {
                    done?;
                    created.0.push(folder.clone());
                }
            }
        }
        Ok(created)
    }

    fn keep(mut self) -> Vec<PathBuf> {
        std::mem::take(&mut self.0)
    }
}

impl Drop for Created {
    fn drop(&mut self) {
        self.0.iter().rev().for_each(|folder| _ = fs::remove_dir(folder));
    }
}

/// Removes the mark and the temporary files of each writer that was killed. The caller must hold the lock of the folder. Otherwise another
/// writer might have made its mark and not locked it yet, and would be taken for a killed one.
fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let letters = name.to_str().and_then(|name| name.strip_prefix(PREFIX));
        if letters.is_some_and(|letters| letters.len() == LETTERS) && is_abandoned(&entry.path()).unwrap_or(false) {
            remove_marked(&entry.path());
        }
    }
}

/// Whether a file is the mark of a writer that no longer runs. If the writer was killed at once, its mark may be incomplete.
fn is_abandoned(path: &Path) -> io::Result<bool> {
    if !fs::symlink_metadata(path)?.is_file() {
        return Ok(false);
    }
    let mut file = File::open(path)?;
    let mut content = Vec::new();
    Read::by_ref(&mut file).take(MARK.len() as u64 + 1).read_to_end(&mut content)?;
    Ok(MARK.starts_with(&content) && file.try_lock().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_killed_writers_are_removed() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let file = |name: &str, text: &[u8]| {
            fs::write(place.path().join(name), text).expect("written");
            place.path().join(name)
        };
        let mut living = Scratch::new(place.path(), &[]).expect("a mark");
        let (_, unfinished) = living.file().expect("a file");
        let killed = [file(".qless-killed", MARK), file(".qless-killed-1", b"half"), file(".qless-young1", b"")];
        let others = [
            file(".qless-users1", b"mine"),
            file(".qless-notes", MARK),
            file(".qless-killed-old", b"mine"),
            file(".qless-other1-1", b"mine"),
        ];
        sweep(place.path());
        assert!(killed.iter().all(|path| !path.exists()), "{killed:?}");
        assert!(others.iter().all(|path| path.exists()), "{others:?}");
        assert!(unfinished.exists());
        drop(living);
        assert!(!unfinished.exists());
        assert_eq!(fs::read_dir(place.path()).expect("a folder").count(), others.len());
    }
}
