//! Temporary folders ("stages"), which are removed whenever the program ends, except by `SIGKILL`.
//!
//! New files are written to a hidden folder `.qless-XXXXXX`, which is removed when dropped. A global list holds all
//! stages, so that [`abandon`] can remove them when a signal ends the program. A thread that creates files or puts
//! them in place holds the [`WriteLock`]. [`abandon`] takes it and never releases it, so that no commit is interrupted
//! and nothing is created afterwards.
//!
//! A stage is locked while its program runs. A stage without a lock belongs to a killed program; the next program that
//! writes to the folder removes it.

use std::cell::Cell;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

static WRITING: Mutex<()> = Mutex::new(());

thread_local! {
    static AT_WORK: Cell<bool> = const { Cell::new(false) };
}

/// Exclusive right to create files and to put them in place, for one thread at a time.
pub(super) struct WriteLock(#[expect(dead_code, reason = "it is held")] MutexGuard<'static, ()>);

impl WriteLock {
    /// Waits for the lock; forever, if the program is ending.
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

/// Whether this thread holds the lock: it is creating files, putting them in place, or removing them at the end.
///
/// A program whose allocator has a reserve may use it then, since an interruption would leave files behind. Does not
/// allocate.
///
/// ```
/// assert!(!qless_io::write::is_at_work());
/// ```
pub fn is_at_work() -> bool {
    AT_WORK.get()
}

/// Prefix of the names of all stages.
const PREFIX: &str = ".qless-";
/// Folder for new files in a stage.
pub(super) const NEW: &str = "new";
/// In the stage of a switch: the second folder, and a note about it.
pub(super) const SECOND: &str = "folder";
pub(super) const NOTE: &str = "README";
/// Younger stages may not be locked yet.
const SETTLED: Duration = Duration::from_secs(60);
/// Another thread may be removing files of the same folder.
const TRIES: usize = 100;

/// Stages that [`abandon`] removes. Lock order: [`WriteLock`] first.
static STAGES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes all files that are not yet in place, and blocks every thread that wants to write another one.
///
/// For a program that a signal is about to end; call it from a separate thread. A commit in progress is finished
/// first. Threads that call functions of [`write`](super) afterwards wait until the program ends.
///
/// ```no_run
/// // In the thread that waits for signals:
/// qless_io::write::abandon();
/// std::process::exit(128 + 15);
/// ```
pub fn abandon() {
    let lock = WriteLock::take();
    let stages = known();
    for path in stages.iter() {
        remove(path);
    }
    std::mem::forget((lock, stages));
}

/// [`abandon`], unless this thread [holds the lock](super::is_at_work) itself: its work cannot be finished.
///
/// For a program that ends on the thread that failed.
pub fn abandon_unless_at_work() {
    if !is_at_work() {
        abandon();
    }
}

fn known() -> MutexGuard<'static, Vec<PathBuf>> {
    STAGES.lock().unwrap_or_else(PoisonError::into_inner)
}

fn remove(path: &Path) {
    for _ in 0..TRIES {
        if fs::remove_dir_all(path).is_ok() || path.symlink_metadata().is_err() {
            return;
        }
    }
}

/// A hidden folder in another, removed when dropped.
#[derive(Debug)]
pub(super) struct Stage {
    path: PathBuf,
    /// Held while the program runs; `None` if the file system has no locks.
    _lock: Option<File>,
}

impl Stage {
    pub fn new(folder: &Path, _lock: &WriteLock) -> io::Result<Self> {
        let mut known = known();
        // Reserves memory first: a folder that is not in the list would not be removed.
        known.reserve(1);
        let path = tempfile::Builder::new().prefix(PREFIX).tempdir_in(folder)?.keep();
        known.push(path.clone());
        let lock = File::open(&path).ok().filter(|folder| folder.try_lock().is_ok());
        Ok(Self { path, _lock: lock })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Keeps the folder.
    pub fn keep(self) {
        forget(&self.path);
        std::mem::forget(self);
    }
}

impl Drop for Stage {
    /// The folder stays in the list until it is removed.
    fn drop(&mut self) {
        remove(&self.path);
        forget(&self.path);
    }
}

fn forget(path: &Path) {
    known().retain(|known| known != path);
}

/// Whether a folder of this name is a stage.
pub(super) fn is_stage(name: &OsStr) -> bool {
    name.to_string_lossy().starts_with(PREFIX)
}

/// Removes stages of killed programs from `folder`.
pub(super) fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if is_stage(&entry.file_name()) && entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            let path = entry.path();
            if is_abandoned(&path).unwrap_or(false) {
                let _ = fs::remove_dir_all(path);
            }
        }
    }
}

/// Whether a stage has no owner and holds only copies and new files. Stages with old files stay for the user.
fn is_abandoned(stage: &Path) -> io::Result<bool> {
    if fs::metadata(stage)?.modified()?.elapsed().is_ok_and(|age| age > SETTLED) {
        for entry in fs::read_dir(stage)? {
            let entry = entry?;
            let name = entry.file_name();
            if name != NEW && name != NOTE && !(name == SECOND && has_no_folder(&entry.path())?) {
                return Ok(false);
            }
        }
        return Ok(File::open(stage)?.try_lock().is_ok());
    }
    Ok(false)
}

/// During a switch, the original folder contains a stage; its replacement contains no folder.
fn has_no_folder(second: &Path) -> io::Result<bool> {
    fs::read_dir(second)?.try_fold(true, |none, entry| Ok(none && !entry?.file_type()?.is_dir()))
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    #[test]
    fn only_stages_of_killed_programs_are_removed() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let living = Stage::new(place.path(), &WriteLock::take()).expect("a stage");
        let names = [".qless-killed", ".qless-before", ".qless-young", ".qless-amid", ".qless-notes"]
            .map(|name| place.path().join(name));
        let [killed, before, young, amid, notes] = &names;
        for path in [&killed.join(NEW), young, &before.join(SECOND), &amid.join(SECOND).join(".qless-new")] {
            fs::create_dir_all(path).expect("created");
        }
        fs::write(notes, "mine").expect("written");
        let old = SystemTime::now() - 2 * SETTLED;
        for path in [living.path(), killed, before, amid, notes] {
            File::open(path).and_then(|file| file.set_modified(old)).expect("aged");
        }
        sweep(place.path());
        assert_eq!(names.each_ref().map(|path| path.exists()), [false, false, true, true, true]);
        assert!(living.path().exists());
    }
}
