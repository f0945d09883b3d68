//! A folder with `C.mtx` and the other files of a case in the input.

use std::path::Path;

use qless_io::{ReadError, read_case, write_case};

use super::files::split;

const PARTS: [&str; 4] = ["b.txt", "prescribed.txt", "rows.txt", "cols.txt"];

/// Reads the case. An accepted case must be the same after writing and reading it.
pub fn case(data: &[u8]) {
    let place = tempfile::tempdir().expect("a temporary folder");
    let folder = place.path().join("case");
    put(&folder, data);
    match read_case(&folder, None, None) {
        Ok(system) => {
            // A label with a lone CR is refused with a typed error.
            let copy = place.path().join("copy");
            if write_case(&copy, &system).is_ok() {
                assert_eq!(read_case(&copy, None, None).expect("what was written is read"), system);
            }
        }
        Err(ReadError::Io { source, .. }) => panic!("the files are there: {source}"),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

fn put(folder: &Path, data: &[u8]) {
    let (matrix, parts) = split(data);
    std::fs::create_dir(folder).expect("a new folder");
    std::fs::write(folder.join("C.mtx"), matrix).expect("written");
    for (name, text) in parts.iter().filter(|(name, _)| PARTS.contains(&name.as_str())) {
        std::fs::write(folder.join(name), text).expect("written");
    }
}
