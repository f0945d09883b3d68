//! Connected components across ranks. A fragment is the portion of a component on one rank: equations of the rank that are connected by
//! free DOFs. The owners of DOFs that several ranks use join the fragments to components.

use qless::common::DisjointSets;

use super::labels::{number_of, rank_of, roots, vertex};
use super::{KnownDofs, Layout, TouchedDofs};
use crate::ranks::{Outbox, Ranks};
use crate::share::ShareRows;

/// The components of a rank's equations.
pub(crate) struct ConnectedComponents {
    /// The fragment of each row; [`NONE`] for rows that the search did not include.
    pub of_row: Vec<u32>,
    /// The fragment of each DOF, by its index in [`TouchedDofs`]; [`NONE`] unless the DOF is free and occurs in an included row.
    pub of_dof: Vec<u32>,
    /// The root of each fragment: the fragment, on any rank, that represents the component. Fragments with the same root are one component.
    root: Vec<u64>,
}

/// Marks a row or a DOF that belongs to no fragment.
pub(crate) const NONE: u32 = u32::MAX;

/// A component, on the rank that holds its root.
pub(crate) struct ConnectedComponent<const K: usize> {
    /// The fragment that is the root of the component.
    pub root: usize,
    /// The other fragments of the component, on any rank.
    others: Vec<u64>,
    /// The values of all fragments of the component, combined, for example added.
    pub total: [u64; K],
}

impl ConnectedComponents {
    /// Finds the components of the rows for which `included` is true. Collective.
    pub fn find(
        ranks: &dyn Ranks,
        layout: &Layout,
        (rows, touched, known): (&ShareRows, &TouchedDofs, &KnownDofs),
        included: impl Fn(usize) -> bool,
    ) -> Self {
        let (of_row, of_dof, count) = fragments(rows, touched, known, included);
        let dofs = touched.dofs.iter().zip(&of_dof).zip(&known.flags);
        let mut post = Outbox::default();
        for ((&dof, &fragment), _) in dofs.filter(|&((_, &fragment), flags)| flags.is_shared() && fragment != NONE) {
            post.to(layout.owner(dof)).extend([dof, u64::from(fragment)]);
        }
        let use_of = |(rank, [dof, fragment]): (usize, [u64; 2])| (dof, vertex(rank, fragment as usize));
        let mut uses: Vec<(u64, u64)> = post.send_records(ranks).map(use_of).collect();
        uses.sort_unstable();
        let mut pairs: Vec<(u64, u64)> = Vec::new();
        for of_dof in uses.chunk_by(|a, b| a.0 == b.0) {
            let hub = of_dof[0].1;
            pairs.extend(of_dof[1..].iter().flat_map(|&(_, other)| [(hub, other), (other, hub)]));
        }
        // Two fragments that share many DOFs give the same pair many times; only one copy is sent.
        pairs.sort_unstable();
        pairs.dedup();
        let mut post = Outbox::default();
        pairs.into_iter().for_each(|(a, b)| post.to(rank_of(a)).extend([number_of(a) as u64, b]));
        let mut edges: Vec<(u32, u64)> =
            post.send_records(ranks).map(|(_, [own, other])| (own as u32, other)).collect();
        edges.sort_unstable();
        edges.dedup();
        Self { of_row, of_dof, root: roots(ranks, count, edges) }
    }

    /// Number of fragments on this rank.
    pub fn fragments(&self) -> usize {
        self.root.len()
    }

    /// Combines the values `own` of all fragments of each component. Returns the components whose roots are on this rank, ascending by
    /// root. Collective.
    pub fn total<const K: usize>(
        &self,
        ranks: &dyn Ranks,
        own: &[[u64; K]],
        combine: impl Fn(&mut [u64; K], &[u64; K]),
    ) -> Vec<ConnectedComponent<K>> {
        let mut components = Vec::new();
        let mut index = vec![NONE; self.fragments()];
        let mut post = Outbox::default();
        for (fragment, (&root, values)) in self.root.iter().zip(own).enumerate() {
            if root == vertex(ranks.rank(), fragment) {
                index[fragment] = components.len() as u32;
                components.push(ConnectedComponent { root: fragment, others: Vec::new(), total: *values });
            } else {
                let words = post.to(rank_of(root));
                words.extend([number_of(root) as u64, fragment as u64]);
                words.extend(values);
            }
        }
        for message in post.send(ranks) {
            for words in message.words.chunks_exact(2 + K) {
                let component: &mut ConnectedComponent<K> = &mut components[index[words[0] as usize] as usize];
                component.others.push(vertex(message.rank, words[1] as usize));
                combine(&mut component.total, &std::array::from_fn(|k| words[2 + k]));
            }
        }
        components
    }

    /// Sends one word for each component from the rank of its root to all its fragments. Returns the word of each fragment. Collective.
    pub fn broadcast<const K: usize>(
        &self,
        ranks: &dyn Ranks,
        components: &[ConnectedComponent<K>],
        words: &[u64],
    ) -> Vec<u64> {
        let mut of_fragment = vec![0; self.fragments()];
        let mut post = Outbox::default();
        for (component, &word) in components.iter().zip(words) {
            of_fragment[component.root] = word;
            component.others.iter().for_each(|&v| post.to(rank_of(v)).extend([number_of(v) as u64, word]));
        }
        post.send_records(ranks).for_each(|(_, [fragment, word])| of_fragment[fragment as usize] = word);
        of_fragment
    }
}

impl<const K: usize> ConnectedComponent<K> {
    /// Whether several ranks hold equations of the component; `rank` is the rank of the root.
    pub fn crosses(&self, rank: usize) -> bool {
        self.others.iter().any(|&v| rank_of(v) != rank)
    }
}

/// The fragment of each row and of each free DOF on this rank, and the number of fragments. A fragment is a connected set of equations of
/// this rank.
fn fragments(
    rows: &ShareRows,
    touched: &TouchedDofs,
    known: &KnownDofs,
    included: impl Fn(usize) -> bool,
) -> (Vec<u32>, Vec<u32>, usize) {
    let mut of_dof = vec![NONE; touched.dofs.len()];
    let mut sets = DisjointSets::new(rows.len());
    let free = |i: usize| touched.row(rows, i).iter().map(|&j| j as usize).filter(|&j| known.flags[j].is_free());
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
