//! Moves new files over old ones in a folder, or, on any failure, puts the old ones back.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::WriteError;

/// Where the new files wait.
pub(super) fn new_files(stage: &Path) -> PathBuf {
    stage.join("new")
}

/// Moves `names` from `staged` to `folder` and removes `absent` there.
pub(super) fn replace(
    folder: &Path,
    stage: &Path,
    staged: &Path,
    names: &[String],
    absent: &[String],
) -> Result<(), WriteError> {
    for name in names.iter().chain(absent) {
        check_place(&folder.join(name))?;
    }
    let kept = stage.join("old");
    fs::create_dir(&kept).map_err(WriteError::io(folder))?;
    let mut done = Vec::new();
    let moves = names.iter().map(|name| (name, Some(staged.join(name))));
    for (name, new) in moves.chain(absent.iter().map(|name| (name, None))) {
        let (place, kept) = (folder.join(name), kept.join(name));
        if let Err(error) = put(&place, &kept, new.as_deref()) {
            undo(&done);
            return Err(WriteError::io(&place)(error));
        }
        done.push((place, kept));
    }
    Ok(())
}

/// A folder or a device is never replaced by a file.
fn check_place(place: &Path) -> Result<(), WriteError> {
    match fs::metadata(place) {
        Ok(kind) if !kind.is_file() => Err(WriteError::NotAFile { path: place.to_path_buf() }),
        _ => Ok(()),
    }
}

/// Keeps what stands at `place`, then moves `new` over it, or removes it if there is no `new`.
fn put(place: &Path, kept: &Path, new: Option<&Path>) -> io::Result<()> {
    let stands = place.symlink_metadata().is_ok();
    if stands {
        fs::hard_link(place, kept).or_else(|_| fs::copy(place, kept).map(drop))?;
    }
    match new {
        Some(new) => fs::rename(new, place),
        None if stands => fs::remove_file(place),
        None => Ok(()),
    }
}

/// Last first; what cannot be put back is left, since there is nothing more to be done.
fn undo(done: &[(PathBuf, PathBuf)]) {
    for (place, kept) in done.iter().rev() {
        let _ = if kept.symlink_metadata().is_ok() { fs::rename(kept, place) } else { fs::remove_file(place) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_move_that_fails_puts_back_what_stood_there() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let (folder, stage) = (place.path().join("folder"), place.path().join("stage"));
        let staged = new_files(&stage);
        for path in [&folder, &staged] {
            fs::create_dir_all(path).expect("created");
        }
        fs::write(folder.join("old"), "old").expect("written");
        for name in ["old", "fresh"] {
            fs::write(staged.join(name), "new").expect("written");
        }
        // The third file was never staged, so its move fails after two went well.
        let names = ["old", "fresh", "lost"].map(String::from);
        let error = replace(&folder, &stage, &staged, &names, &[]).expect_err("one is lost");
        assert!(error.to_string().contains("lost: cannot be written"), "{error}");
        assert_eq!(fs::read_to_string(folder.join("old")).expect("put back"), "old");
        assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 1);
    }
}
