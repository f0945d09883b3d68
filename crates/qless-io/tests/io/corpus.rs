//! Reads every case of the corpora in this repository and under `QLESS_CORPUS`. Cases whose `expected.json` says
//! `invalid` must be refused.

use std::path::{Path, PathBuf};

use qless_io::read_case;
use qless_scenes::corpus::larger;

#[test]
fn every_case_is_read_or_refused_as_expected() {
    let small = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/corpus");
    let cases: Vec<_> = larger().into_iter().chain([small]).flat_map(|root| cases_below(&root)).collect();
    assert!(cases.len() >= 24, "{} folders with a C.mtx", cases.len());
    let wrong: Vec<String> = cases.iter().filter_map(|case| disagreement(case)).collect();
    assert!(wrong.is_empty(), "{} of {} cases:\n{}", wrong.len(), cases.len(), wrong.join("\n"));
    println!("{} cases agree", cases.len());
}

/// Folders with a case: `root`, its subfolders and theirs.
fn cases_below(root: &Path) -> Vec<PathBuf> {
    let mut folders = vec![root.to_path_buf()];
    for _ in 0..2 {
        let inner = folders.iter().flat_map(|folder| std::fs::read_dir(folder).into_iter().flatten().flatten());
        let mut inner: Vec<PathBuf> = inner.map(|entry| entry.path()).collect();
        folders.append(&mut inner);
    }
    folders.retain(|folder| folder.join("C.mtx").is_file());
    folders.sort();
    folders.dedup();
    folders
}

fn disagreement(case: &Path) -> Option<String> {
    let expected = std::fs::read_to_string(case.join("expected.json")).unwrap_or_default();
    let invalid = expected.contains("\"class\": \"invalid\"");
    match read_case(case, None, None) {
        Ok(_) if invalid => Some(format!("{}: was read, but is invalid", case.display())),
        Err(error) if !invalid => Some(error.to_string()),
        Err(error) if !(error.to_string().contains("row ") || error.to_string().contains("column ")) => {
            Some(format!("no row or column in: {error}"))
        }
        Ok(system) => wrong_size(&expected, "rows", system.equations())
            .or_else(|| wrong_size(&expected, "cols", system.dofs()))
            .map(|text| format!("{}: {text}", case.display())),
        Err(_) => None,
    }
}

fn wrong_size(expected: &str, key: &str, found: usize) -> Option<String> {
    let text = expected.split(&format!("\"{key}\": ")).nth(1)?.split([',', '\n', '}']).next()?.trim();
    (text != found.to_string()).then(|| format!("{key} is {found}, expected {text}"))
}
