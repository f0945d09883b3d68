//! Lists the user's files and the temporary files of a folder.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::os::unix::fs::DirEntryExt;
use std::path::Path;

/// The files of a folder except temporary ones.
pub type Content = BTreeMap<String, Vec<u8>>;

fn is_hidden(name: &str) -> bool {
    name.starts_with(".qless-")
}

pub fn content(folder: &Path) -> Content {
    let mut all = Content::new();
    collect(folder, "", &mut all);
    all
}

fn collect(folder: &Path, prefix: &str, all: &mut Content) {
    for entry in fs::read_dir(folder).expect("a folder").flatten() {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if path.is_dir() && !is_hidden(&name) {
            collect(&path, &format!("{prefix}{name}/"), all);
        } else if !is_hidden(&name) {
            all.insert(format!("{prefix}{name}"), fs::read(path).expect("readable"));
        }
    }
}

/// The inode numbers of the files except temporary ones, which distinguish files of equal content.
pub fn numbers(folder: &Path) -> BTreeMap<String, u64> {
    let entries = fs::read_dir(folder).expect("a folder").flatten().filter(|entry| !entry.path().is_dir());
    let numbered = entries.map(|entry| (entry.file_name().to_string_lossy().into_owned(), entry.ino()));
    numbered.filter(|(name, _)| !is_hidden(name)).collect()
}

/// The names of the temporary files.
pub fn hidden(folder: &Path) -> BTreeSet<String> {
    let names = fs::read_dir(folder).expect("a folder").flatten().map(|e| e.file_name().to_string_lossy().into_owned());
    names.filter(|name| is_hidden(name)).collect()
}
