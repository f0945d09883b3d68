//! `c_j = |{k >= j: r_jk != 0}|` without forming R, in almost linear time (Gilbert, Ng, Peyton 1994).
//!
//! Row i of S with first column f_i fills like the edges `f_i - k`, k in row i. So column k of R is the union of the tree
//! paths from those f_i to k, and c_j counts the k whose union holds j: +1 at each leaf of it, -1 where two paths meet,
//! -1 above k, summed up the tree. Nodes are numbered in postorder.

use crate::pattern::{Lists, NONE};

/// `rows` in the order of their first column, each ascending; empty rows may stand anywhere.
pub(super) fn of_rows(parent: &[u32], rows: &Lists) -> Vec<u32> {
    let mut counter = Counter::new(parent);
    let mut row = 0;
    for j in 0..parent.len() as u32 {
        counter.end_path(j);
        while row < rows.len() && rows.list(row).first().is_none_or(|&f| f == j) {
            rows.list(row).iter().skip(1).for_each(|&k| counter.path(j, k));
            row += 1;
        }
        if parent[j as usize] != NONE {
            counter.set[j as usize] = parent[j as usize];
        }
    }
    counter.summed()
}

struct Counter<'a> {
    parent: &'a [u32],
    first: Vec<u32>,
    delta: Vec<i64>,
    /// The last leaf of each column's union.
    leaf: Vec<u32>,
    /// Nodes done point up to the first ancestor that is not.
    set: Vec<u32>,
}

impl<'a> Counter<'a> {
    fn new(parent: &'a [u32]) -> Self {
        let first = first_descendants(parent);
        let delta = first.iter().zip(0..).map(|(&first, j)| i64::from(first == j)).collect();
        Self { parent, first, delta, leaf: vec![NONE; parent.len()], set: (0..parent.len() as u32).collect() }
    }

    /// All paths to j end at it.
    fn end_path(&mut self, j: u32) {
        if self.parent[j as usize] != NONE {
            self.delta[self.parent[j as usize] as usize] -= 1;
        }
    }

    /// Adds the path from j to k, unless one from below j holds it.
    fn path(&mut self, j: u32, k: u32) {
        let before = self.leaf[k as usize];
        if before != NONE && before >= self.first[j as usize] {
            return;
        }
        self.delta[j as usize] += 1;
        self.leaf[k as usize] = j;
        if before != NONE {
            self.delta[find(&mut self.set, before) as usize] -= 1;
        }
    }

    fn summed(mut self) -> Vec<u32> {
        for j in 0..self.parent.len() {
            if self.parent[j] != NONE {
                self.delta[self.parent[j] as usize] += self.delta[j];
            }
        }
        self.delta.into_iter().map(|count| count as u32).collect()
    }
}

/// The root of a node's set, after linking the path to it.
fn find(set: &mut [u32], node: u32) -> u32 {
    let mut root = node;
    while set[root as usize] != root {
        root = set[root as usize];
    }
    let mut at = node;
    while at != root {
        at = std::mem::replace(&mut set[at as usize], root);
    }
    root
}

/// The smallest node of each subtree.
pub(super) fn first_descendants(parent: &[u32]) -> Vec<u32> {
    let mut first: Vec<u32> = (0..parent.len() as u32).collect();
    for j in 0..parent.len() {
        if parent[j] != NONE {
            let above = parent[j] as usize;
            first[above] = first[above].min(first[j]);
        }
    }
    first
}
