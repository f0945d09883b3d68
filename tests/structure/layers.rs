//! The folders of each crate import in the direction that ARCHITECTURE.md states.
//!
//! A fenced block `layers` there has a line for each crate: `qless: common < input < presolve < ...`. A folder (or file of the root) imports
//! from itself and from those to its left; `a | b` do not import from each other.

use std::collections::BTreeMap;
use std::path::Path;

use super::imports::{Crate, crates};

/// The place of each folder of a crate, ascending from the lowest.
type Layers = BTreeMap<String, (usize, usize)>;

fn stated() -> BTreeMap<String, Layers> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("ARCHITECTURE.md");
    let text = std::fs::read_to_string(&path).expect("ARCHITECTURE.md");
    let block = text.split("```layers").nth(1).expect("a block `layers`").split("```").next().unwrap_or_default();
    let line = |line: &str| {
        let (name, layers) = line.split_once(':')?;
        let layers = layers.split('<').enumerate();
        let places = layers.flat_map(|(layer, folders)| {
            folders.split('|').enumerate().map(move |(k, folder)| (folder.trim().to_owned(), (layer, k)))
        });
        Some((name.trim().to_owned(), places.collect()))
    };
    block.lines().filter_map(line).collect()
}

/// Imports against the direction, and folders that the page does not name.
fn faults(one: &Crate, layers: &Layers) -> Vec<String> {
    let mut faults = Vec::new();
    for (module, targets) in one.imports.iter().filter(|(module, _)| !module.is_empty()) {
        let Some(&(layer, place)) = layers.get(&module[0]) else {
            faults.push(format!("{}: {} is not in ARCHITECTURE.md", one.name, module[0]));
            continue;
        };
        for target in targets.iter().filter(|target| !target.is_empty() && target[0] != module[0]) {
            let allowed =
                layers.get(&target[0]).is_some_and(|&(lower, other)| lower < layer || (lower, other) == (layer, place));
            if !allowed {
                faults.push(format!("{}: {} imports {}", one.name, module.join("/"), target.join("/")));
            }
        }
    }
    faults.sort();
    faults.dedup();
    faults
}

#[test]
fn folders_import_as_architecture_states() {
    let stated = stated();
    let faults: Vec<String> = crates()
        .iter()
        .flat_map(|one| {
            stated
                .get(&one.name)
                .map_or_else(|| vec![format!("{} is not in ARCHITECTURE.md", one.name)], |layers| faults(one, layers))
        })
        .collect();
    assert!(faults.is_empty(), "against ARCHITECTURE.md:\n{}", faults.join("\n"));
}
