//! Connected components across ranks. Each rank finds the parts of its own equations that share free DOFs; the owners of DOFs that
//! several ranks use join those parts to components.

use qless::common::DisjointSets;

use super::labels::{number_of, rank_of, roots, vertex};
use super::{KnownDofs, Layout, TouchedDofs};
use crate::ranks::{Outbox, Ranks};
use crate::share::ShareRows;

/// The components of a rank's equations.
pub(crate) struct ConnectedComponents {
    /// The local part of each row; [`NONE`] for rows that were left out.
    pub of_row: Vec<u32>,
    /// The local part of each free DOF of the included rows, by place; [`NONE`] for other DOFs.
    pub of_dof: Vec<u32>,
    /// The root of each part: parts of ranks with the same root are one component.
    root: Vec<u64>,
}

/// No part.
pub(crate) const NONE: u32 = u32::MAX;

/// A component, on the rank that holds its root.
pub(crate) struct ConnectedComponent<const K: usize> {
    /// The number of its root on this rank.
    pub root: usize,
    /// Its parts on other ranks, or beside the root on this one.
    others: Vec<u64>,
    /// What all parts add up to.
    pub total: [u64; K],
}

impl ConnectedComponents {
    /// Finds the components of the rows for which `included` holds. Collective.
    pub fn of(
        ranks: &dyn Ranks,
        layout: &Layout,
        (rows, touched, known): (&ShareRows, &TouchedDofs, &KnownDofs),
        included: impl Fn(usize) -> bool,
    ) -> Self {
        let (of_row, of_dof, count) = parts(rows, touched, known, included);
        let named = touched.dofs.iter().zip(&of_dof).zip(&known.said);
        let mut post = Outbox::default();
        for ((&dof, &part), _) in named.filter(|&((_, &part), said)| said.is_shared() && part != NONE) {
            post.to(layout.owner(dof)).extend([dof, u64::from(part)]);
        }
        let mut uses: Vec<(u64, u64)> = Vec::new();
        for message in post.send(ranks) {
            uses.extend(message.words.chunks_exact(2).map(|w| (w[0], vertex(message.rank, w[1] as usize))));
        }
        uses.sort_unstable();
        let mut pairs: Vec<(u64, u64)> = Vec::new();
        for of_dof in uses.chunk_by(|a, b| a.0 == b.0) {
            let hub = of_dof[0].1;
            pairs.extend(of_dof[1..].iter().flat_map(|&(_, other)| [(hub, other), (other, hub)]));
        }
        // Two parts usually share many DOFs.
        pairs.sort_unstable();
        pairs.dedup();
        let mut post = Outbox::default();
        pairs.into_iter().for_each(|(a, b)| post.to(rank_of(a)).extend([number_of(a) as u64, b]));
        let mut edges: Vec<(u32, u64)> = Vec::new();
        for message in post.send(ranks) {
            edges.extend(message.words.chunks_exact(2).map(|w| (w[0] as u32, w[1])));
        }
        edges.sort_unstable();
        edges.dedup();
        Self { of_row, of_dof, root: roots(ranks, count, edges) }
    }

    /// Number of parts on this rank.
    pub fn parts(&self) -> usize {
        self.root.len()
    }

    /// Combines the values of all parts of each component. Returns the components whose roots are on this rank, ascending by root.
    /// Collective.
    pub fn total<const K: usize>(
        &self,
        ranks: &dyn Ranks,
        own: &[[u64; K]],
        combine: impl Fn(&mut [u64; K], &[u64; K]),
    ) -> Vec<ConnectedComponent<K>> {
        let mut components = Vec::new();
        let mut index = vec![NONE; self.parts()];
        let mut post = Outbox::default();
        for (part, (&root, of_part)) in self.root.iter().zip(own).enumerate() {
            if root == vertex(ranks.rank(), part) {
                index[part] = components.len() as u32;
                components.push(ConnectedComponent { root: part, others: Vec::new(), total: *of_part });
            } else {
                let words = post.to(rank_of(root));
                words.extend([number_of(root) as u64, part as u64]);
                words.extend(of_part);
            }
        }
        for message in post.send(ranks) {
            for words in message.words.chunks_exact(2 + K) {
                let component: &mut ConnectedComponent<K> = &mut components[index[words[0] as usize] as usize];
                component.others.push(vertex(message.rank, words[1] as usize));
                let mut of_part = [0; K];
                of_part.copy_from_slice(&words[2..]);
                combine(&mut component.total, &of_part);
            }
        }
        components
    }

    /// Sends one word for each component from the rank of its root to all its parts. Returns the word of each local part. Collective.
    pub fn tell<const K: usize>(
        &self,
        ranks: &dyn Ranks,
        components: &[ConnectedComponent<K>],
        words: &[u64],
    ) -> Vec<u64> {
        let mut told = vec![0; self.parts()];
        let mut post = Outbox::default();
        for (component, &word) in components.iter().zip(words) {
            told[component.root] = word;
            component.others.iter().for_each(|&v| post.to(rank_of(v)).extend([number_of(v) as u64, word]));
        }
        for message in post.send(ranks) {
            message.words.chunks_exact(2).for_each(|words| told[words[0] as usize] = words[1]);
        }
        told
    }
}

impl<const K: usize> ConnectedComponent<K> {
    /// Whether its equations are held by more than one rank: `rank` is that of its root.
    pub fn crosses(&self, rank: usize) -> bool {
        self.others.iter().any(|&v| rank_of(v) != rank)
    }
}

/// The part of each row and of each free DOF on this rank, and how many there are.
fn parts(
    rows: &ShareRows,
    touched: &TouchedDofs,
    known: &KnownDofs,
    included: impl Fn(usize) -> bool,
) -> (Vec<u32>, Vec<u32>, usize) {
    let mut of_dof = vec![NONE; touched.dofs.len()];
    let mut sets = DisjointSets::new(rows.len());
    let free = |i: usize| touched.row(rows, i).iter().map(|&j| j as usize).filter(|&j| known.said[j].is_free());
    for i in (0..rows.len()).filter(|&i| included(i)) {
        for j in free(i) {
            match of_dof[j] {
                NONE => of_dof[j] = i as u32,
                other => sets.join(other as usize, i),
            }
        }
    }
    let mut number = vec![NONE; rows.len()];
    let mut of_row = vec![NONE; rows.len()];
    let mut count = 0;
    for i in (0..rows.len()).filter(|&i| included(i)) {
        let root = sets.root(i);
        if number[root] == NONE {
            number[root] = count;
            count += 1;
        }
        of_row[i] = number[root];
    }
    of_dof.iter_mut().filter(|row| **row != NONE).for_each(|row| *row = of_row[*row as usize]);
    (of_row, of_dof, count as usize)
}
