//! There are no import circles between modules, except between a parent and its child.

use std::collections::{BTreeMap, BTreeSet};

use super::imports::{Crate, Module, crates};

#[test]
fn no_import_circles() {
    let mut found = Vec::new();
    for one in crates() {
        for circle in circles(&one) {
            let names: Vec<String> = circle.iter().map(|module| module.join("/")).collect();
            found.push(format!("{}: {}", one.name, names.join(", ")));
        }
    }
    assert!(found.is_empty(), "modules that import one another:\n{}", found.join("\n"));
}

/// Strongly connected modules, the root of the crate left out.
fn circles(one: &Crate) -> Vec<Vec<Module>> {
    let counts = |module: &Module| !module.is_empty();
    let edges: BTreeMap<&Module, BTreeSet<&Module>> = one
        .imports
        .iter()
        .filter(|(module, _)| counts(module))
        .map(|(module, targets)| (module, targets.iter().filter(|target| counts(target)).collect()))
        .collect();
    let reach: BTreeMap<&Module, BTreeSet<&Module>> =
        edges.keys().map(|&module| (module, reachable(module, &edges))).collect();
    let mut circles = BTreeSet::new();
    for (&module, reached) in &reach {
        let circle: Vec<Module> = reached
            .iter()
            .filter(|other| reach.get(*other).is_some_and(|back| back.contains(module)))
            .map(|&other| other.clone())
            .collect();
        let is_parent_and_child = circle.len() == 2 && circle[1].starts_with(&circle[0]);
        if circle.len() > 1 && !is_parent_and_child {
            circles.insert(circle);
        }
    }
    circles.into_iter().collect()
}

fn reachable<'a>(from: &'a Module, edges: &BTreeMap<&'a Module, BTreeSet<&'a Module>>) -> BTreeSet<&'a Module> {
    let (mut reached, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(module) = open.pop() {
        for &next in edges.get(module).into_iter().flatten() {
            if reached.insert(next) {
                open.push(next);
            }
        }
    }
    reached
}
