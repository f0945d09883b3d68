//! `D` and `M` by rows, summed up from the slave facets; entries that are only rounding are left out.

use std::collections::BTreeMap;

use faer::Mat;

use super::Multipliers;
use super::cover::Segments;
use super::multipliers::Functions;
use crate::geometry::surface::Face;

/// Sums below this part of the sizes of their terms are rounding: of the rule, and of the inverse in dual functions.
const ROUNDING: f64 = 256.0 * f64::EPSILON;

/// A sum and the sizes of what went into it.
#[derive(Clone, Copy, Default)]
struct Sum {
    value: f64,
    terms: f64,
}

/// A row of D and of -M, by nodes of either side.
#[derive(Default)]
pub(super) struct Row {
    slaves: BTreeMap<usize, Sum>,
    masters: BTreeMap<usize, Sum>,
}

impl Row {
    pub fn slaves(&self) -> impl Iterator<Item = (usize, f64)> + Clone {
        entries(&self.slaves)
    }

    pub fn masters(&self) -> impl Iterator<Item = (usize, f64)> + Clone {
        entries(&self.masters)
    }
}

fn entries(sums: &BTreeMap<usize, Sum>) -> impl Iterator<Item = (usize, f64)> + Clone {
    sums.iter().filter(|(_, sum)| sum.value.abs() > ROUNDING * sum.terms).map(|(&node, sum)| (node, sum.value))
}

fn add(sums: &mut BTreeMap<usize, Sum>, node: usize, value: f64, terms: f64) {
    let sum = sums.entry(node).or_default();
    sum.value += value;
    sum.terms += terms;
}

/// `int N_i N_j` over all segments.
fn mass(nodes: usize, segments: &Segments) -> Mat<f64> {
    Mat::from_fn(nodes, nodes, |i, j| segments.iter().map(|(_, segment)| segment.own[i * nodes + j]).sum())
}

/// Adds a slave facet to the rows of its nodes; nothing if it has no multipliers.
pub(super) fn add_facet(
    rows: &mut BTreeMap<usize, Row>,
    kind: Multipliers,
    slave: &Face,
    masters: &[Face],
    segments: &Segments,
) -> Option<()> {
    let Functions { b, d } = Functions::new(kind, slave.shape, mass(slave.nodes.len(), segments))?;
    for (i, &node) in slave.nodes.iter().enumerate() {
        let row = rows.entry(node).or_default();
        for (j, &other) in slave.nodes.iter().enumerate().filter(|&(j, _)| d[(i, j)] != 0.0) {
            add(&mut row.slaves, other, d[(i, j)], d[(i, j)].abs());
        }
        for (facet, segment) in segments {
            let nodes = &masters[*facet].nodes;
            for (k, &other) in nodes.iter().enumerate() {
                let of = |sums: &[f64], weight: &dyn Fn(f64) -> f64| -> f64 {
                    (0..slave.nodes.len()).map(|l| weight(b[(i, l)]) * sums[l * nodes.len() + k]).sum()
                };
                add(&mut row.masters, other, -of(&segment.other, &|b| b), of(&segment.terms, &f64::abs));
            }
        }
    }
    Some(())
}
