//! Replaces old files by new ones.
//!
//! | change | method | left behind by a kill |
//! | --- | --- | --- |
//! | a new folder | rename the folder | nothing, or the whole folder |
//! | one file | rename the file | the old file or the new one |
//! | several files in a folder | exchange the folder for a complete one ([`switch`]) | the old files or the new ones |
//! | the same, if folders cannot be exchanged | move files one by one ([`moves`]) | the old files or the new ones, or no first file |
//!
//! Folders cannot be exchanged if the file system cannot exchange them or has no hard links (Linux and macOS mostly
//! have both), if the parent folder is not writable, or if the folder is a mount point. After an error, all old files
//! are back in place.

use std::fs;
use std::path::Path;

use super::moves::{self, FolderChange};
use super::stage::{self, NEW, Stage, WriteLock};
use super::{metadata, switch};
use crate::WriteError;

/// Changes an existing folder; `stage` lies in it and holds the new files.
pub(super) fn commit(folder: &Path, stage: &Stage, mut change: FolderChange) -> Result<(), WriteError> {
    let lock = WriteLock::take();
    for name in change.names.iter().chain(&change.absent) {
        check_place(&folder.join(name))?;
    }
    change.absent.retain(|name| folder.join(name).symlink_metadata().is_ok());
    let staged = stage.path().join(NEW);
    for name in &change.names {
        let place = folder.join(name);
        metadata::keep(&place, &staged.join(name)).map_err(WriteError::io(&place))?;
    }
    put(folder, stage, &change, &lock)?;
    stage::sweep(folder);
    Ok(())
}

fn put(folder: &Path, stage: &Stage, change: &FolderChange, lock: &WriteLock) -> Result<(), WriteError> {
    if let ([name], []) = (&change.names[..], &change.absent[..]) {
        let place = folder.join(name);
        return fs::rename(stage.path().join(NEW).join(name), &place).map_err(WriteError::io(&place));
    }
    switch::replace(folder, stage, change, lock).unwrap_or_else(|| moves::replace(folder, stage.path(), change))
}

/// A folder or a device is never replaced by a file.
fn check_place(place: &Path) -> Result<(), WriteError> {
    match fs::metadata(place) {
        Ok(kind) if !kind.is_file() => Err(WriteError::NotAFile { path: place.to_path_buf() }),
        _ => Ok(()),
    }
}
