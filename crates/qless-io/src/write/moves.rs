//! Moves new files over old ones in a folder, one by one; after an error, restores the old ones.
//!
//! The first file is removed first and added last. While the set is incomplete, even after a kill, there is no first
//! file rather than one that does not match the others.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::stage::NEW;
use crate::WriteError;

/// A change of a folder.
pub(super) struct FolderChange {
    /// Names of new files.
    pub names: Vec<String>,
    /// Names of files to remove.
    pub absent: Vec<String>,
}

/// Changes `folder`; `stage` holds the new files.
pub(super) fn replace(folder: &Path, stage: &Path, change: &FolderChange) -> Result<(), WriteError> {
    let (staged, old) = (stage.join(NEW), stage.join("old"));
    fs::create_dir(&old).map_err(WriteError::io(folder))?;
    let mut done = UndoLog(Vec::new());
    let each = |name: &String| (folder.join(name), old.join(name), staged.join(name));
    let mut names = change.names.iter();
    let first = names.next().map(each);
    let result = (|| {
        if let Some((place, old, _)) = &first {
            done.step(place, old, remove)?;
        }
        for (place, old, new) in names.map(each) {
            done.step(&place, &old, |place| fs::rename(&new, place))?;
        }
        for (place, old, _) in change.absent.iter().map(each) {
            done.step(&place, &old, remove)?;
        }
        first.iter().try_for_each(|(place, _, new)| fs::rename(new, place).map_err(WriteError::io(place)))
    })();
    if result.is_err() {
        done.undo();
    }
    result
}

/// Changes made so far: the place of each file, and the copy of the old file, if there was one.
struct UndoLog(Vec<(PathBuf, PathBuf)>);

impl UndoLog {
    /// Keeps the old file at `place`, then changes it.
    fn step(
        &mut self,
        place: &Path,
        old: &Path,
        change: impl FnOnce(&Path) -> io::Result<()>,
    ) -> Result<(), WriteError> {
        if place.symlink_metadata().is_ok() {
            let kept = fs::hard_link(place, old).or_else(|_| fs::copy(place, old).map(drop));
            kept.map_err(WriteError::io(place))?;
        }
        self.0.push((place.to_path_buf(), old.to_path_buf()));
        change(place).map_err(WriteError::io(place))
    }

    /// Restores old files, last change first. Errors are ignored: nothing more can be done.
    fn undo(&self) {
        for (place, old) in self.0.iter().rev() {
            let _ = if old.symlink_metadata().is_ok() { fs::rename(old, place) } else { fs::remove_file(place) };
        }
    }
}

fn remove(place: &Path) -> io::Result<()> {
    match fs::remove_file(place) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_move_restores_the_old_files() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let (folder, stage) = (place.path().join("folder"), place.path().join("stage"));
        for path in [&folder, &stage.join(NEW)] {
            fs::create_dir_all(path).expect("created");
        }
        fs::write(folder.join("old"), "old").expect("written");
        for name in ["old", "fresh"] {
            fs::write(stage.join(NEW).join(name), "new").expect("written");
        }
        // The third file was never staged, so that its move fails after the others succeeded.
        let names = ["old", "fresh", "lost"].map(String::from).to_vec();
        let change = FolderChange { names, absent: Vec::new() };
        let error = replace(&folder, &stage, &change).expect_err("one is lost");
        assert!(error.to_string().contains("lost: cannot be written"), "{error}");
        assert_eq!(fs::read_to_string(folder.join("old")).expect("put back"), "old");
        assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 1);
    }
}
