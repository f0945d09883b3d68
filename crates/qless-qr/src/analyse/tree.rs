//! `parent(j) = min {i > j: r_ji != 0}`: the elimination tree of `S^T S` without forming it, and its postorder.
//!
//! Row by row of S all columns are linked to a path, in the order of elimination; path compression finds the present
//! root of a column's tree (Liu 1990; Gilbert, Li, Ng, Peyton 2001).

use crate::pattern::{Lists, NONE};

/// Parents by position, for columns eliminated in `order`.
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

/// Nodes in postorder, children ascending; every parent is larger than its children.
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

/// Parents after renumbering: node `post[k]` becomes k.
pub(super) fn renumbered(parent: &[u32], post: &[u32]) -> Vec<u32> {
    let mut new = vec![0; parent.len()];
    post.iter().enumerate().for_each(|(k, &node)| new[node as usize] = k as u32);
    post.iter().map(|&node| parent[node as usize]).map(|p| if p == NONE { NONE } else { new[p as usize] }).collect()
}
