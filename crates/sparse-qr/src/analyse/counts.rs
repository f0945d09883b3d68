//! `c_j = |{k >= j: r_jk != 0}|` without forming R, in almost linear time (Gilbert, Ng, Peyton 1994).
//!
//! Row i of S with first column f_i fills like the edges `f_i - k`, k in row i. So column k of R is the union of the tree
//! paths from those f_i to k, and c_j counts the k whose union holds j: +1 at each leaf of it, -1 where two paths meet,
//! -1 above k, summed up the tree. Nodes are numbered in postorder.

use crate::pattern::{Lists, NONE};

/// `rows` in the order of their first column, each ascending; empty rows may stand anywhere.
pub(super) fn of_rows(parent: &[u32], rows: &Lists) -> Vec<u32> {
    let n = parent.len();
    let first = first_descendants(parent);
    let mut delta: Vec<i64> = (0..n).map(|j| i64::from(first[j] == j as u32)).collect();
    let mut leaf = vec![NONE; n];
    let mut set: Vec<u32> = (0..n as u32).collect();
    let mut row = 0;
    for j in 0..n as u32 {
        if parent[j as usize] != NONE {
            delta[parent[j as usize] as usize] -= 1;
        }
        while row < rows.len() && rows.list(row).first().is_none_or(|&f| f == j) {
            for &k in rows.list(row).iter().skip(1) {
                let before = leaf[k as usize];
                if before != NONE && before >= first[j as usize] {
                    continue;
                }
                delta[j as usize] += 1;
                leaf[k as usize] = j;
                if before != NONE {
                    delta[find(&mut set, before) as usize] -= 1;
                }
            }
            row += 1;
        }
        if parent[j as usize] != NONE {
            set[j as usize] = parent[j as usize];
        }
    }
    for j in 0..n {
        if parent[j] != NONE {
            delta[parent[j] as usize] += delta[j];
        }
    }
    delta.into_iter().map(|count| count as u32).collect()
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
