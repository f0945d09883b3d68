//! Pictures of the page: the sparsity pattern of C, the sizes of the parts, and the nodes of the equations.

use std::collections::{BTreeMap, BTreeSet};

use qless::common::DisjointSets;
use qless::report::Term;
use qless::{ConstraintSystem, Kind, Report};
use serde::Serialize;

use crate::diagnose::Diagnosis;

/// Largest number of cells along each side of the picture of the pattern.
const CELLS: usize = 160;
/// Limit on the nodes that are drawn besides those of dependent equations and their explanations. The additional nodes show the shape of
/// the model.
const OTHERS: usize = 5000;

#[derive(Serialize)]
pub struct Picture {
    spy: Spy,
    /// Sizes of parts, ascending, and how many parts have each size.
    parts: Vec<(usize, usize)>,
    /// Nodes of the deck with their positions.
    nodes: Vec<(u32, f64, f64, f64)>,
    /// Nodes of each dependent equation and of each equation in its explanation, by row from 1.
    rows: Vec<(usize, Vec<u32>)>,
}

#[derive(Serialize)]
struct Spy {
    cells: usize,
    /// Cells with coefficients: row, column, and the worst kind of their equations: 0 independent, 1 redundant, 2 conflicting.
    dots: Vec<(usize, usize, u8)>,
}

impl Picture {
    pub fn new(diagnosis: &Diagnosis, report: &Report) -> Self {
        let (nodes, rows) = nodes(diagnosis, report);
        Self { spy: spy(diagnosis), parts: parts(&diagnosis.system), nodes, rows }
    }
}

fn spy(diagnosis: &Diagnosis) -> Spy {
    let (m, n) = (diagnosis.system.equations(), diagnosis.system.dofs());
    let cells = m.max(n).clamp(1, CELLS);
    let mut worst: BTreeMap<(usize, usize), u8> = BTreeMap::new();
    for i in 0..m {
        let kind = match diagnosis.analysis.kinds()[i] {
            Kind::Independent => 0,
            Kind::Redundant => 1,
            Kind::Conflicting => 2,
        };
        for (j, _) in diagnosis.system.matrix().row(i) {
            // The same scale in both directions keeps the aspect ratio.
            let at = (i * cells / m.max(n), j * cells / m.max(n));
            let entry = worst.entry(at).or_insert(0);
            *entry = kind.max(*entry);
        }
    }
    Spy { cells, dots: worst.into_iter().map(|((i, j), kind)| (i, j, kind)).collect() }
}

/// Sizes of the parts, and how many parts have each size.
fn parts(system: &ConstraintSystem) -> Vec<(usize, usize)> {
    let mut sets = DisjointSets::new(system.equations());
    let mut first = vec![None; system.dofs()];
    let is_prescribed = |j: usize| system.prescribed().binary_search_by_key(&j, |given| given.0).is_ok();
    for i in 0..system.equations() {
        for (j, _) in system.matrix().row(i).filter(|(j, _)| !is_prescribed(*j)) {
            sets.join(*first[j].get_or_insert(i), i);
        }
    }
    let mut sizes: BTreeMap<usize, usize> = BTreeMap::new();
    (0..system.equations()).for_each(|i| *sizes.entry(sets.root(i)).or_default() += 1);
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    sizes.values().for_each(|&size| *counts.entry(size).or_default() += 1);
    counts.into_iter().collect()
}

type Nodes = (Vec<(u32, f64, f64, f64)>, Vec<(usize, Vec<u32>)>);

/// Nodes of dependent equations and of their explanations, and some of the others; none if no equation is dependent.
fn nodes(diagnosis: &Diagnosis, report: &Report) -> Nodes {
    let Some(deck) = diagnosis.deck.as_ref().filter(|_| !report.dependent.is_empty()) else {
        return (Vec::new(), Vec::new());
    };
    let node = |j: usize| deck.deck.model().dofs().get(j).map(|dof| dof.node);
    let of_row =
        |row: usize| -> BTreeSet<u32> { diagnosis.system.matrix().row(row).filter_map(|(j, _)| node(j)).collect() };
    let mut rows: BTreeMap<usize, BTreeSet<u32>> = BTreeMap::new();
    for dependent in &report.dependent {
        let equations = dependent.certificate.because.iter().filter_map(|term| match term {
            Term::Equation { row, .. } => Some(*row),
            _ => None,
        });
        for row in std::iter::once(dependent.row).chain(equations) {
            rows.entry(row).or_insert_with(|| of_row(row - 1));
        }
    }
    let mut shown: BTreeSet<u32> = rows.values().flatten().copied().collect();
    let most = shown.len() + OTHERS;
    for dof in deck.deck.model().dofs() {
        if shown.len() >= most {
            break;
        }
        shown.insert(dof.node);
    }
    let positions = deck.deck.positions();
    let place = |node: u32| positions.get(&node).map(|[x, y, z]| (node, *x, *y, *z));
    let rows = rows.into_iter().map(|(row, nodes)| (row, nodes.into_iter().collect())).collect();
    (shown.into_iter().filter_map(place).collect(), rows)
}
