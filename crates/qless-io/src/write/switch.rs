//! Replaces several files of a folder at once: readers of its path see the old ones, then the new ones.
//!
//! 1. A second, hidden folder is made beside it: hard links to the new files and to all unchanged files, symbolic
//!    links to folders.
//! 2. The two folders are exchanged, by one system call. This is the switch.
//! 3. The first folder, now hidden, is changed file by file.
//! 4. The two are exchanged again, so that the path leads to the original folder, with its owner, its rights, and
//!    every process whose working directory it is.
//!
//! If the program is killed between 2 and 4, the second folder stays in place. It is complete; its links to folders
//! lead to the first one, and a note beside that folder says so.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::io;
use std::os::unix::fs::{MetadataExt, symlink};
use std::path::Path;

use rustix::fs::{CWD, RenameFlags, renameat_with};

use super::metadata;
use super::moves::{self, FolderChange};
use super::stage::{self, NEW, NOTE, SECOND, Stage, WriteLock};
use crate::WriteError;

const NOTE_TEXT: &str = "qless was killed while it replaced files. `folder` is the original output folder. The folder that is now in its \
                         place has all files, and links to the folders in here: move these back before you remove this one.\n";

/// Changes `folder`, which holds `stage`. Returns `None`, without a change, if folders cannot be exchanged.
pub(super) fn replace(
    folder: &Path,
    stage: &Stage,
    change: &FolderChange,
    lock: &WriteLock,
) -> Option<Result<(), WriteError>> {
    let folder = &folder.canonicalize().ok()?;
    let aside = Stage::new(folder.parent()?, lock).ok()?;
    let second = &aside.path().join(SECOND);
    fs::write(aside.path().join(NOTE), NOTE_TEXT).ok()?;
    make(second, folder, stage, change).ok()?;
    exchange(folder, second).ok()?;
    let hidden = second.join(stage.path().file_name().unwrap_or_default());
    let done = moves::replace(second, &hidden, change);
    if let Err(error) = exchange(folder, second) {
        aside.keep();
        return Some(Err(WriteError::io(folder)(error)));
    }
    take_late(second, folder, change);
    stage::sweep(folder.parent()?);
    Some(done)
}

/// Fills `second` with the future content of `folder`.
fn make(second: &Path, folder: &Path, stage: &Stage, change: &FolderChange) -> io::Result<()> {
    fs::create_dir(second)?;
    let changed = changed(change);
    for entry in fs::read_dir(folder)? {
        let (entry, name) = entry.map(|entry| (entry.path(), entry.file_name()))?;
        let is_folder = entry.symlink_metadata()?.is_dir();
        if is_folder && !stage::is_stage(&name) {
            // The path of this subfolder after the exchange.
            symlink(second.join(&name), second.join(&name))?;
        } else if !is_folder && !changed.contains(&*name) {
            fs::hard_link(&entry, second.join(&name))?;
        }
    }
    for name in &change.names {
        fs::hard_link(stage.path().join(NEW).join(name), second.join(name))?;
    }
    metadata::keep(folder, second)
}

fn changed(change: &FolderChange) -> BTreeSet<&OsStr> {
    change.names.iter().chain(&change.absent).map(|name| OsStr::new(name.as_str())).collect()
}

/// Moves files that others added to `second` during the switch into `folder`.
fn take_late(second: &Path, folder: &Path, change: &FolderChange) {
    let changed = changed(change);
    for entry in fs::read_dir(second).into_iter().flatten().flatten() {
        let (place, name) = (folder.join(entry.file_name()), entry.file_name());
        let is_ours = changed.contains(&*name) || is_same(&entry.path(), &place);
        if !is_ours {
            let _ = fs::rename(entry.path(), place);
        }
    }
}

/// Whether both paths name one file, or one is a link and the other a folder.
fn is_same(one: &Path, other: &Path) -> bool {
    let number = |path: &Path| fs::symlink_metadata(path).map(|file| (file.dev(), file.ino())).ok();
    number(one) == number(other) || (one.is_symlink() && other.is_dir())
}

fn exchange(one: &Path, other: &Path) -> io::Result<()> {
    Ok(renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// State after a kill between the two exchanges.
    #[test]
    fn between_the_exchanges_the_folder_has_the_new_files_and_all_others() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let folder = place.path().canonicalize().expect("a path").join("out");
        fs::create_dir_all(folder.join("deep/er")).expect("created");
        for (name, text) in [("a", "old"), ("b", "old"), ("gone", "old"), ("notes", "mine"), ("deep/er/notes", "mine")]
        {
            fs::write(folder.join(name), text).expect("written");
        }
        let lock = WriteLock::take();
        let (stage, aside) = (Stage::new(&folder, &lock).expect("one"), Stage::new(place.path(), &lock).expect("one"));
        fs::create_dir(stage.path().join(NEW)).expect("created");
        for name in ["a", "b"] {
            fs::write(stage.path().join(NEW).join(name), "new").expect("written");
        }
        let change = FolderChange { names: vec!["a".into(), "b".into()], absent: vec!["gone".into()] };
        let second = fs::canonicalize(aside.path()).expect("a path").join(SECOND);
        let expected = [Some("new"), Some("new"), None, Some("mine"), Some("mine")].map(|text| text.map(str::to_owned));
        let all = |folder: &Path| {
            ["a", "b", "gone", "notes", "deep/er/notes"].map(|name| fs::read_to_string(folder.join(name)).ok())
        };
        make(&second, &folder, &stage, &change).expect("made");
        if exchange(&folder, &second).is_err() {
            // Fallback on a file system without exchange of folders.
            assert!(replace(&folder, &stage, &change, &lock).is_none(), "no change, and no success reported");
            moves::replace(&folder, stage.path(), &change).expect("moved");
            assert_eq!(all(&folder), expected);
            return;
        }
        assert_eq!(all(&folder), expected);
        // Files written by others during the switch are kept.
        fs::write(folder.join("late"), "theirs").expect("written");
        exchange(&folder, &second).expect("as before");
        take_late(&second, &folder, &change);
        let all = ["a", "b", "gone", "late"].map(|name| fs::read_to_string(folder.join(name)).expect("there"));
        assert_eq!(all, ["old", "old", "old", "theirs"]);
        assert!(folder.join("deep").symlink_metadata().expect("there").is_dir());
    }
}
