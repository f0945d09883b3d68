//! Connected components of a graph whose vertices are spread over ranks, by label propagation with pointer jumping.
//!
//! ```text
//! repeat   each root hooks on to its first neighbouring root in this round's random order, if that comes before the root itself
//!          the parent of each vertex becomes the parent's parent, until it is a root      (pointer jumping)
//! until    no edge joins two roots
//! ```
//!
//! In each round at least half of the roots that have neighbours are expected to hook, whatever the graph, so that there are
//! O(log V) rounds. The random order is a hash of root and round, the same on all ranks.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;

use crate::ranks::{Message, Outbox, Ranks};

/// Encodes a vertex as one number: the rank that holds it, and its number on that rank.
pub(crate) fn vertex(rank: usize, number: usize) -> u64 {
    (rank as u64) << 32 | number as u64
}

pub(crate) fn rank_of(vertex: u64) -> usize {
    (vertex >> 32) as usize
}

pub(crate) fn number_of(vertex: u64) -> usize {
    (vertex & 0xffff_ffff) as usize
}

/// Sort key of a root in the random order of a round.
fn chance(root: u64, round: u64) -> (u64, u64) {
    let mut x = root ^ round.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x ^ (x >> 31), root)
}

struct LabelsForest<'a> {
    ranks: &'a dyn Ranks,
    /// The parent of each vertex of this rank.
    parent: Vec<u64>,
}

/// The root of each of the `count` vertices of this rank; `edges` lead from vertices of this rank to vertices of any rank. Collective.
pub(crate) fn roots(ranks: &dyn Ranks, count: usize, mut edges: Vec<(u32, u64)>) -> Vec<u64> {
    let own = ranks.rank();
    let mut forest = LabelsForest { ranks, parent: (0..count).map(|k| vertex(own, k)).collect() };
    for round in 0.. {
        let ends = forest.parents_of(edges.iter().map(|&(_, other)| other));
        let ends_of = |&(k, other): &(u32, u64)| (forest.parent[k as usize], forest.look(&ends, other));
        let joins: Vec<(u64, u64)> = edges.iter().map(ends_of).collect();
        let mut joined = joins.iter().map(|(a, b)| a == b);
        edges.retain(|_| joined.next() == Some(false));
        let mut remaining = [edges.len() as u64];
        ranks.sum(&mut remaining);
        if remaining[0] == 0 {
            break;
        }
        forest.hook(joins.into_iter().filter(|(a, b)| a != b), round);
        forest.shorten();
    }
    forest.parent
}

impl LabelsForest<'_> {
    /// Asks other ranks for the parents of their vertices.
    fn parents_of(&self, vertices: impl Iterator<Item = u64>) -> FxHashMap<u64, u64> {
        let own = self.ranks.rank();
        let mut asked: Vec<u64> = vertices.filter(|&v| rank_of(v) != own).collect();
        asked.sort_unstable();
        asked.dedup();
        let mut post = Outbox::default();
        asked.iter().for_each(|&v| post.to(rank_of(v)).push(v));
        let answer = |Message { rank, words }: Message| {
            let words = words.iter().map(|&v| self.parent[number_of(v)]).collect();
            Message { rank, words }
        };
        let answers = self.ranks.exchange(post.send(self.ranks).into_iter().map(answer).collect());
        // Vertices ascend by rank, and answers come in the order of the ranks. So the k-th answer is that for the k-th vertex.
        asked.into_iter().zip(answers.into_iter().flat_map(|message| message.words)).collect()
    }

    /// Looks up the parent of vertex `v`. `others` has the parents of vertices of other ranks.
    fn look(&self, others: &FxHashMap<u64, u64>, v: u64) -> u64 {
        if rank_of(v) == self.ranks.rank() { self.parent[number_of(v)] } else { others[&v] }
    }

    /// Each root takes its first neighbouring root in the order of the round as its parent, if that neighbour precedes it.
    fn hook(&mut self, joins: impl Iterator<Item = (u64, u64)>, round: u64) {
        let mut first: BTreeMap<u64, u64> = BTreeMap::new();
        for (root, other) in joins.filter(|&(a, b)| chance(b, round) < chance(a, round)) {
            let best = first.entry(root).or_insert(other);
            if chance(other, round) < chance(*best, round) {
                *best = other;
            }
        }
        let mut post = Outbox::default();
        first.into_iter().for_each(|(root, other)| post.to(rank_of(root)).extend([root, other]));
        for (_, [root, other]) in post.send_records(self.ranks) {
            let parent = &mut self.parent[number_of(root)];
            if chance(other, round) < chance(*parent, round) {
                *parent = other;
            }
        }
    }

    /// Makes the root of every vertex its parent.
    fn shorten(&mut self) {
        loop {
            let parents = self.parents_of(self.parent.iter().copied());
            let grandparents: Vec<u64> = self.parent.iter().map(|&parent| self.look(&parents, parent)).collect();
            let pairs = self.parent.iter().zip(&grandparents);
            let mut changed = [pairs.filter(|(parent, grandparent)| parent != grandparent).count() as u64];
            self.parent = grandparents;
            self.ranks.sum(&mut changed);
            if changed[0] == 0 {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ranks::{Counted, on_threads};

    /// A ring of ten thousand vertices with shuffled numbers: the worst case for labels that move from neighbour to neighbour.
    #[test]
    fn a_ring_is_one_component_in_few_rounds() {
        let (size, each) = (5, 2000);
        let all = (size * each) as u64;
        let place = |k: u64| (k * 7919) % all;
        let of = |p: u64| vertex((p % size as u64) as usize, (p / size as u64) as usize);
        let found = on_threads(size, |ranks| {
            let ranks = Counted::new(ranks);
            let edges = (0..all).flat_map(|k| {
                let (a, b) = (of(place(k)), of(place((k + 1) % all)));
                [(a, b), (b, a)]
            });
            let own = edges.filter(|&(a, _)| rank_of(a) == ranks.rank());
            let roots = roots(&ranks, each, own.map(|(a, b)| (number_of(a) as u32, b)).collect());
            (roots, ranks.sent().rounds)
        });
        let root = found[0].0[0];
        assert!(found.iter().all(|(roots, _)| roots.iter().all(|&r| r == root)));
        // log2 of 10,000 is 14; each round asks, hooks, and shortens a few times.
        assert!(found[0].1 < 14 * 15, "{} rounds", found[0].1);
    }

    #[test]
    fn components_of_random_graphs_are_those_of_one_rank() {
        for seed in 0..60_u64 {
            let mut rng = qless_scenes::Rng::new(seed);
            let (size, each) = (1 + rng.below(5), 40);
            let count = size * each;
            let pairs: Vec<(usize, usize)> =
                (0..rng.below(2 * count)).map(|_| (rng.below(count), rng.below(count))).collect();
            let of = |k: usize| vertex(k / each, k % each);
            let both = |&(a, b): &(usize, usize)| [(a, b), (b, a)];
            let found = on_threads(size, |ranks| {
                let own = pairs.iter().flat_map(both).filter(|&(a, _)| a / each == ranks.rank());
                roots(ranks, each, own.map(|(a, b)| ((a % each) as u32, of(b))).collect())
            })
            .concat();
            let mut plain: Vec<usize> = (0..count).collect();
            for _ in 0..count {
                for &(a, b) in &pairs {
                    let least = plain[a].min(plain[b]);
                    (plain[a], plain[b]) = (least, least);
                }
            }
            for a in 0..count {
                for b in 0..count {
                    assert_eq!(found[a] == found[b], plain[a] == plain[b], "seed {seed}: {a} and {b}");
                }
            }
        }
    }
}
