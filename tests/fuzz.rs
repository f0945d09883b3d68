//! The seeds and the kept inputs of fuzzing pass the checks of every fuzz target, and so do random calls of the library.

use std::path::{Path, PathBuf};

#[path = "fuzz/mod.rs"]
mod checks;

/// Runs every file of `fuzz/corpus/TARGET` and `fuzz/seeds/TARGET`.
fn replay(target: &str, run: impl Fn(&[u8])) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    if !root.exists() {
        eprintln!("SKIPPED: {target}: the packaged archive has no folder fuzz/; the repository has");
        return;
    }
    let inputs: Vec<PathBuf> =
        ["seeds", "corpus"].iter().flat_map(|kind| files(&root.join(kind).join(target))).collect();
    assert!(inputs.len() > 2, "{} inputs of {target}", inputs.len());
    for path in inputs {
        println!("{}", path.display());
        run(&std::fs::read(&path).expect("read"));
    }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    files.sort();
    files
}

#[test]
fn case_files() {
    replay("case", checks::case);
}

#[test]
fn case_folders() {
    replay("folder", checks::folder);
}

#[test]
fn calculix_decks() {
    replay("calculix", checks::calculix);
}

#[test]
fn nastran_decks() {
    replay("nastran", checks::nastran);
}

#[test]
fn ansys_decks() {
    replay("ansys", checks::ansys);
}

#[test]
fn lsdyna_decks() {
    replay("lsdyna", checks::lsdyna);
}

#[test]
fn radioss_decks() {
    replay("radioss", checks::radioss);
}

#[test]
fn named_relations() {
    replay("relations", checks::relations);
}

#[test]
fn calls_of_the_library() {
    replay("api", checks::api);
}

#[test]
fn random_calls_of_the_library() {
    let mut rng = qless_scenes::Rng::new(1);
    for _ in 0..3000 {
        let length = 100 + rng.below(1500);
        let byte =
            |rng: &mut qless_scenes::Rng| if rng.below(3) > 0 { rng.below(8) as u8 } else { rng.below(256) as u8 };
        checks::api(&(0..length).map(|_| byte(&mut rng)).collect::<Vec<u8>>());
    }
}
