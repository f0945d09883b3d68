//! Changes several files of a folder at once, as whoever looks at its path sees it: the old ones, then the new ones.
//!
//! 1. A second folder is made beside it, out of sight: hard links to the new files and to all others that stay, symbolic links to
//!    folders.
//! 2. The two change places, by one call of the system. This is the switch.
//! 3. The first folder, now out of sight, is changed file by file.
//! 4. They change places again, so that the folder at the path is the one that was there: its owner, its rights, and everybody who
//!    stands in it.
//!
//! Killed between 2 and 4, the program leaves the second folder in place. It is complete; links to folders lead to the first, and a
//! note beside that one says so.

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

const WORDS: &str = "qless was killed while it put files in place. `folder` is the output folder that it changed; the one that stands \
                    in its place has all files, and links that lead here. Move the folders in it back before you remove it.\n";

/// Changes `folder`, which holds `stage`; `None`, and no change, where folders cannot be exchanged.
pub(super) fn replace(
    folder: &Path,
    stage: &Stage,
    change: &FolderChange,
    lock: &WriteLock,
) -> Option<Result<(), WriteError>> {
    let folder = &folder.canonicalize().ok()?;
    let aside = Stage::new(folder.parent()?, lock).ok()?;
    let second = &aside.path().join(SECOND);
    fs::write(aside.path().join(NOTE), WORDS).ok()?;
    make(second, folder, stage, change).ok()?;
    exchange(folder, second).ok()?;
    let hidden = second.join(stage.path().file_name().unwrap_or_default());
    let done = moves::replace(second, &hidden, change);
    if let Err(error) = exchange(folder, second) {
        aside.leave();
        return Some(Err(WriteError::io(folder)(error)));
    }
    take_late(second, folder, change);
    stage::sweep(folder.parent()?);
    Some(done)
}

/// Makes `second` hold what `folder` is to hold.
fn make(second: &Path, folder: &Path, stage: &Stage, change: &FolderChange) -> io::Result<()> {
    fs::create_dir(second)?;
    let changed = changed(change);
    for entry in fs::read_dir(folder)? {
        let (entry, name) = entry.map(|entry| (entry.path(), entry.file_name()))?;
        let is_folder = entry.symlink_metadata()?.is_dir();
        if is_folder && !stage::is_stage(&name) {
            // Where the folder itself will be after the exchange.
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

/// What others put into `second` while it stood in the place of `folder` is theirs.
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

/// Whether both are names of one file, or one a link to the other, a folder.
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

    /// What a kill between the two exchanges leaves.
    #[test]
    fn amid_the_switch_the_folder_has_the_new_files_and_all_others() {
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
            // This file system exchanges no folders: the files come one by one.
            assert!(replace(&folder, &stage, &change, &lock).is_none(), "nothing is done, and nobody told otherwise");
            moves::replace(&folder, stage.path(), &change).expect("moved");
            assert_eq!(all(&folder), expected);
            return;
        }
        assert_eq!(all(&folder), expected);
        // Others may write in between; what they write is theirs.
        fs::write(folder.join("late"), "theirs").expect("written");
        exchange(&folder, &second).expect("as before");
        take_late(&second, &folder, &change);
        let all = ["a", "b", "gone", "late"].map(|name| fs::read_to_string(folder.join(name)).expect("there"));
        assert_eq!(all, ["old", "old", "old", "theirs"]);
        assert!(folder.join("deep").symlink_metadata().expect("there").is_dir());
    }
}
