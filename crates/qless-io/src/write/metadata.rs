//! Lets a new file take over metadata of the file that it replaces: mode, owner and group.
//!
//! Access lists and extended attributes are not kept.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::WriteError;

/// Largest number of links in a chain, as in the Linux kernel.
const LINKS: usize = 40;

/// Follows the links at the end of `path`. The file to which they lead may be missing.
pub(super) fn follow(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_path_buf();
    for _ in 0..LINKS {
        match fs::read_link(&path) {
            Ok(next) => path = path.parent().unwrap_or(Path::new("")).join(next),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("too many links to links"))
}

/// Refuses a file with several names (hard links): under all other names, the old content would remain.
#[cfg(unix)]
pub(super) fn check_names(path: &Path) -> Result<(), WriteError> {
    use std::os::unix::fs::MetadataExt;
    match fs::symlink_metadata(path) {
        Ok(file) if file.is_file() && file.nlink() > 1 => {
            Err(WriteError::Linked { path: path.to_path_buf(), names: file.nlink() })
        }
        _ => Ok(()),
    }
}

#[cfg(not(unix))]
pub(super) fn check_names(_: &Path) -> Result<(), WriteError> {
    Ok(())
}

/// Gives `new` the mode, owner and group of `old`, as far as this is permitted. If `new` gets another group, this group has only rights
/// that all other users have too.
#[cfg(unix)]
pub(super) fn keep(old: &Path, new: &Path) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};
    let Ok(old) = fs::symlink_metadata(old) else { return Ok(()) };
    if old.is_symlink() {
        return Ok(());
    }
    let is_group = chown(new, Some(old.uid()), Some(old.gid())).or_else(|_| chown(new, None, Some(old.gid()))).is_ok();
    let mode = old.mode() & if old.is_dir() { 0o7777 } else { 0o777 };
    let group = if is_group { mode & 0o070 } else { mode & 0o070 & (mode << 3) };
    fs::set_permissions(new, fs::Permissions::from_mode(mode & !0o070 | group))
}

#[cfg(not(unix))]
pub(super) fn keep(_: &Path, _: &Path) -> io::Result<()> {
    Ok(())
}
