//! The column elimination tree of S and the number of entries in each row of R, without forming `S^T S` or R.
//!
//! `parent(j) = min {i > j: r_ji != 0}`. Each row of S links its columns to a path, in the order of elimination; path
//! compression finds the current root of a column's tree (Liu 1990; Gilbert, Li, Ng, Peyton 2001).
//!
//! The numbers of entries, `c_j = |{k >= j: r_jk != 0}|`, take almost linear time (Gilbert, Ng, Peyton 1994). A row i of S with first
//! column f_i causes the same fill as the edges `(f_i, k)` for all k in row i. So column k of R is the union of the tree paths from those
//! f_i to k, and c_j counts the columns k whose union contains j. To count them, add 1 at each leaf of a union, subtract 1 where two paths
//! meet and 1 at the parent of k, and sum up the tree. Nodes are numbered in postorder.

use crate::lists::{Lists, NONE};

/// Parent of each position in the column elimination tree, for columns eliminated in `order`.
pub(super) fn parents(columns: &Lists, row_count: usize, order: &[u32]) -> Vec<u32> {
    let mut parent = vec![NONE; order.len()];
    let mut shortcut = vec![NONE; order.len()];
    let mut last = vec![NONE; row_count];
    for (position, &column) in order.iter().enumerate() {
        let position = position as u32;
        for &row in columns.list(column as usize) {
            let mut at = last[row as usize];
            while at != NONE && at != position {
                let next = std::mem::replace(&mut shortcut[at as usize], position);
                if next == NONE {
                    parent[at as usize] = position;
                }
                at = next;
            }
            last[row as usize] = position;
        }
    }
    parent
}

/// The nodes in postorder, children ascending.
pub(super) fn postorder(parent: &[u32]) -> Vec<u32> {
    let (first, next) = children(parent);
    let mut first = first;
    let mut post = Vec::with_capacity(parent.len());
    let mut stack = Vec::new();
    for root in (0..parent.len() as u32).filter(|&node| parent[node as usize] == NONE) {
        stack.push(root);
        while let Some(&node) = stack.last() {
            let child = first[node as usize];
            if child == NONE {
                post.push(node);
                stack.pop();
            } else {
                first[node as usize] = next[child as usize];
                stack.push(child);
            }
        }
    }
    post
}

/// First child and next sibling of every node, ascending.
fn children(parent: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let (mut first, mut next) = (vec![NONE; parent.len()], vec![NONE; parent.len()]);
    for node in (0..parent.len()).rev().filter(|&node| parent[node] != NONE) {
        next[node] = first[parent[node] as usize];
        first[parent[node] as usize] = node as u32;
    }
    (first, next)
}

/// Parents after renumbering: node `post[k]` gets number k.
pub(super) fn renumbered(parent: &[u32], post: &[u32]) -> Vec<u32> {
    let mut new = vec![0; parent.len()];
    post.iter().enumerate().for_each(|(k, &node)| new[node as usize] = k as u32);
    post.iter().map(|&node| parent[node as usize]).map(|p| if p == NONE { NONE } else { new[p as usize] }).collect()
}

/// The number of entries in each row of R. `rows` must be sorted by first column, each row ascending; empty rows may be anywhere.
pub(super) fn row_counts(parent: &[u32], rows: &Lists) -> Vec<u32> {
    let mut counter = ColumnCounter::new(parent);
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

struct ColumnCounter<'a> {
    parent: &'a [u32],
    first: Vec<u32>,
    delta: Vec<i64>,
    /// For each column k, the last leaf that was added to the union of the tree paths to k.
    leaf: Vec<u32>,
    /// Union-find by path compression: processed nodes point to their first unprocessed ancestor.
    set: Vec<u32>,
}

impl<'a> ColumnCounter<'a> {
    fn new(parent: &'a [u32]) -> Self {
        let first = first_descendants(parent);
        let delta = first.iter().zip(0..).map(|(&first, j)| i64::from(first == j)).collect();
        Self { parent, first, delta, leaf: vec![NONE; parent.len()], set: (0..parent.len() as u32).collect() }
    }

    /// Ends all tree paths to j: they do not count above j.
    fn end_path(&mut self, j: u32) {
        if self.parent[j as usize] != NONE {
            self.delta[self.parent[j as usize] as usize] -= 1;
        }
    }

    /// Adds the tree path from j to k, unless a path from a descendant of j contains it.
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

/// The root of the set of `node`; links all nodes on the path to it.
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
