//! Temporary folders that no end of the program leaves behind, save `SIGKILL`.
//!
//! New files wait in a hidden folder `.qless-XXXXXX`, removed when dropped. All of them are known in one place, so that
//! [`abandon`] can remove them when a signal ends the program. Who creates something, or puts it in place, has the [`WriteLock`]:
//! [`abandon`] waits for it and never gives it back, so that no commit is torn and nothing is created afterwards.
//!
//! A stage is locked as long as its program lives; one without lock is of a program that was killed, and is removed by the next
//! that writes to the same folder.

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

/// The right, until it is dropped.
pub(super) struct WriteLock(#[expect(dead_code, reason = "it is held")] MutexGuard<'static, ()>);

impl WriteLock {
    /// Waits for it; forever, once the program is ending.
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

/// Whether this thread is creating files, putting them in place or removing them for the last time.
///
/// A program whose allocator has a reserve may hand it out then: what is cut off at that moment stays behind. Allocates nothing.
///
/// ```
/// assert!(!qless_io::write::is_at_work());
/// ```
pub fn is_at_work() -> bool {
    AT_WORK.get()
}

/// How the names of all stages begin.
const PREFIX: &str = ".qless-";
/// Where new files wait in a stage.
pub(super) const NEW: &str = "new";
/// In the stage of a switch, the folder that is not to be seen, and a note about it.
pub(super) const SECOND: &str = "folder";
pub(super) const NOTE: &str = "README";
/// Younger stages may not have got their lock yet.
const SETTLED: Duration = Duration::from_secs(60);
/// Removing meets files that another thread is removing, too.
const TRIES: usize = 100;

/// The folders that [`abandon`] removes. Locked after the turn is taken where both are.
static STAGES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes all files that wait for their place, and stops every thread that wants to write another.
///
/// For a program that is about to end by a signal, from a thread of its own: a set of files that is being put in place is finished
/// first. A thread that calls anything of [`write`](super) afterwards waits until the program ends.
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

/// [`abandon`], unless this thread [is at work](super::is_at_work) itself, and what it does cannot be finished.
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
    /// Held as long as the program lives; none where the file system has no locks.
    _lock: Option<File>,
}

impl Stage {
    pub fn new(folder: &Path, _lock: &WriteLock) -> io::Result<Self> {
        let mut known = known();
        // Room first: a folder that nobody knows could stay behind.
        known.reserve(1);
        let path = tempfile::Builder::new().prefix(PREFIX).tempdir_in(folder)?.keep();
        known.push(path.clone());
        let lock = File::open(&path).ok().filter(|folder| folder.try_lock().is_ok());
        Ok(Self { path, _lock: lock })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Leaves it where it is.
    pub fn leave(self) {
        forget(&self.path);
        std::mem::forget(self);
    }
}

impl Drop for Stage {
    /// It is known until it is gone.
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

/// Removes what killed programs left in `folder`.
pub(super) fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if is_stage(&entry.file_name()) && entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            let path = entry.path();
            if is_left(&path).unwrap_or(false) {
                let _ = fs::remove_dir_all(path);
            }
        }
    }
}

/// Whether a stage is nobody's any more and holds nothing but copies and new files: old files of a folder are left to the user.
fn is_left(stage: &Path) -> io::Result<bool> {
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

/// In a switch, the folder that was there before holds a stage; the one that is made for it holds no folder.
fn has_no_folder(second: &Path) -> io::Result<bool> {
    fs::read_dir(second)?.try_fold(true, |none, entry| Ok(none && !entry?.file_type()?.is_dir()))
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    #[test]
    fn what_a_killed_program_left_is_removed_and_nothing_else() {
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
