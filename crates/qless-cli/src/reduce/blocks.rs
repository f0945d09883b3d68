//! Files of parts in factor form, such as `block1_L.mtx`.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::Path;

use qless::reduction::{FactoredBlock, Parts};
use qless_io::WriteError;
use qless_io::write::Output;

/// Names of the files of a block, after its number.
const FILES: [&str; 9] =
    ["L.mtx", "U.mtx", "C_M.mtx", "C_p.mtx", "b.txt", "equations.txt", "slaves.txt", "masters.txt", "prescribed.txt"];

/// Adds the files of block `number`.
pub fn write(output: &mut Output, number: usize, block: &FactoredBlock, parts: &Parts) -> Result<(), WriteError> {
    let name = |file: &str| format!("block{number}_{file}");
    output.matrix(&name("L.mtx"), &parts.lower)?;
    output.matrix(&name("U.mtx"), &parts.upper)?;
    output.matrix(&name("C_M.mtx"), &parts.of_masters)?;
    output.matrix(&name("C_p.mtx"), &parts.of_prescribed)?;
    output.numbers(&name("b.txt"), &parts.rhs)?;
    output.indices(&name("equations.txt"), &parts.equations)?;
    output.indices(&name("slaves.txt"), block.slaves())?;
    output.indices(&name("masters.txt"), block.masters())?;
    output.indices(&name("prescribed.txt"), block.prescribed())
}

/// Files in a folder that are named after blocks beyond the first `count`: an earlier run wrote them.
pub fn stale(folder: &Path, count: usize) -> io::Result<BTreeSet<String>> {
    let mut names = BTreeSet::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        if let Some(name) = name.to_str().filter(|name| number(name).is_some_and(|k| k > count)) {
            names.extend((!entry.path().is_dir()).then(|| name.to_owned()));
        }
    }
    Ok(names)
}

/// Number of the block in a file name.
pub fn number(name: &str) -> Option<usize> {
    let (number, file) = name.strip_prefix("block")?.split_once('_')?;
    let is_plain = number.bytes().all(|digit| digit.is_ascii_digit()) && !number.starts_with('0');
    number.parse().ok().filter(|_| is_plain && FILES.contains(&file))
}

#[cfg(test)]
mod tests {
    use super::{FILES, number};

    #[test]
    fn files_of_blocks_are_known_by_their_names() {
        assert!(FILES.iter().all(|file| number(&format!("block12_{file}")) == Some(12)));
        for other in
            ["L.mtx", "block_L.mtx", "block0_L.mtx", "block01_L.mtx", "block+1_L.mtx", "block1_T.mtx", "block1L.mtx"]
        {
            assert_eq!(number(other), None, "{other}");
        }
    }
}
