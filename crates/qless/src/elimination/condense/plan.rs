//! The plan of a condensation: for each line (row or column) of K_q, the entries of K that contribute. It is computed once per pattern.

use super::lines::{Lines, Union};
use super::{CondensedPattern, NONE};
use crate::SystemError;
use crate::elimination::EliminationError;
use crate::elimination::view::{Index, Storage, View};

/// The sources of the values of K_q.
#[derive(Clone, Debug, Default)]
pub(super) struct CondensePlan {
    /// Number of stored entries of K.
    pub entries: usize,
    /// For each unknown, the source of its line (row or column) of K_q.
    pub source: Vec<LineSource>,
    /// The entries of K in the lines (rows or columns) that are not copied.
    pub mixed: Entries,
    /// The entries of K in the lines (rows or columns) of the slaves.
    pub of_slaves: Entries,
    /// Each eliminated prescribed DOF with the entries of its line (row or column) of K, if `K u_0` is summed by columns.
    pub of_prescribed: Vec<(u32, Entries)>,
    /// True if K is stored by columns with all entries, so that it need not be symmetric.
    pub by_columns: bool,
    /// Pattern of `W = K_S L`. K_S holds the lines (rows or columns) of the slaves in K, and L holds T and the identity.
    pub w: Lines,
}

/// The source of a line (row or column) of K_q.
#[derive(Clone, Copy, Debug)]
pub(super) enum LineSource {
    /// A copy of consecutive entries of K, starting at this one.
    Copied(u32),
    /// A sum: this line (row or column) of [`CondensePlan::mixed`] times L, which holds T and the identity, plus the lines of W
    /// ([`CondensePlan::w`]) of the slaves that depend on the unknown.
    Mixed(u32),
}

/// Entries of K by lines. Each entry is given by its index in the values of K and by its column (its row, if lines are columns).
#[derive(Clone, Debug)]
pub(super) struct Entries {
    starts: Vec<usize>,
    places: Vec<(u32, u32)>,
}

impl Default for Entries {
    fn default() -> Self {
        Self { starts: vec![0], places: Vec::new() }
    }
}

impl Entries {
    pub fn line(&self, i: usize) -> &[(u32, u32)] {
        &self.places[self.starts[i]..self.starts[i + 1]]
    }

    fn push(&mut self, entries: impl Iterator<Item = (u32, u32)>) {
        self.places.extend(entries);
        self.starts.push(self.places.len());
    }
}

impl CondensedPattern {
    /// Computes the pattern of K_q and the plan for its values.
    pub(super) fn plan<P: Index, I: Index>(&mut self, slaves: &[usize], k: View<P, I>) -> Result<(), EliminationError> {
        let many = |found| EliminationError::Matrix(SystemError::TooLarge { what: "the number of entries", found });
        if u32::try_from(k.nnz()).is_err() {
            return Err(many(k.nnz()));
        }
        let mirrored = self.mirrored(&k);
        let entries = |dof: usize| {
            let stored = k.range(dof).map(|e| (e as u32, k.index(e) as u32));
            stored.chain(mirrored.line(dof).iter().copied())
        };
        let mut plan = CondensePlan {
            entries: k.nnz(),
            by_columns: k.by_columns && k.storage == Storage::Full,
            ..CondensePlan::default()
        };
        let mut union = Union::new(self.unknowns());
        for (i, &dof) in slaves.iter().enumerate() {
            // A slave of a factored part is an unknown, so it has a number and is not eliminated.
            let is_eliminated = self.number[dof] == NONE;
            plan.of_slaves.push(entries(dof).filter(|_| is_eliminated));
            plan.of_slaves.line(i).iter().for_each(|&(_, j)| self.reached(j, &mut union, |_| true));
            union.take(&mut plan.w.index);
            if !plan.w.close() {
                return Err(many(plan.w.index.len()));
            }
        }
        if plan.by_columns {
            for dof in (0..self.number.len()).filter(|&j| self.number[j] == NONE && self.slave[j] == NONE) {
                let mut own = Entries::default();
                own.push(entries(dof));
                plan.of_prescribed.push((dof as u32, own));
            }
        }
        let mut lines = Lines::default();
        for (q, &dof) in self.dofs.iter().enumerate() {
            let stored = k.range(dof);
            let ascends = || stored.clone().skip(1).all(|e| k.index(e - 1) < k.index(e));
            let plain = stored.clone().all(|e| self.number[k.index(e)] != NONE) && mirrored.line(dof).is_empty();
            if plain && self.slaves_of.row(q).len() == 0 && ascends() {
                plan.source.push(LineSource::Copied(stored.start as u32));
                lines.index.extend(stored.map(|e| self.number[k.index(e)]));
            } else {
                plan.source.push(LineSource::Mixed(plan.mixed.starts.len() as u32 - 1));
                plan.mixed.push(entries(dof));
                let own = plan.mixed.line(plan.mixed.starts.len() - 2);
                let stored = |r: u32| self.is_stored(q, r);
                own.iter().for_each(|&(_, j)| self.reached(j, &mut union, stored));
                for (a, _) in self.slaves_of.row(q) {
                    plan.w.line(a).iter().filter(|&&r| stored(r)).for_each(|&r| union.add(r));
                }
                union.take(&mut lines.index);
            }
            if !lines.close() {
                return Err(many(lines.index.len()));
            }
        }
        (self.lines, self.plan) = (lines, plan);
        Ok(())
    }

    /// Adds the unknowns in row j of L, which expresses DOF j, to `union`, except those for which `stored` is false.
    fn reached(&self, j: u32, union: &mut Union, stored: impl Fn(u32) -> bool) {
        self.row_of_l(j as usize).map(|(r, _)| r).filter(|&r| stored(r)).for_each(|r| union.add(r));
    }

    /// Returns true if entry r of line q (a row or a column) is in the half of K_q that is stored.
    #[inline]
    pub(super) fn is_stored(&self, q: usize, r: u32) -> bool {
        self.half.holds(q, r as usize)
    }

    /// The entries of a symmetric K in the half that is not stored, if their row or column is not an unknown. For each line (row or
    /// column): the index of the stored mirror image of an entry, and the index of the entry in the line.
    fn mirrored<P: Index, I: Index>(&self, k: &View<P, I>) -> Entries {
        let n = self.number.len();
        let mut found = Vec::new();
        if k.storage != Storage::Full {
            for i in 0..n {
                let is_special = |j: usize| j != i && (self.number[i] == NONE || self.number[j] == NONE);
                let special = k.range(i).filter(|&e| is_special(k.index(e)));
                found.extend(special.map(|e| (k.index(e) as u32, e as u32, i as u32)));
            }
            found.sort_unstable();
        }
        let mut mirrored = Entries::default();
        let mut rest = found.iter().peekable();
        for line in 0..n as u32 {
            let own = std::iter::from_fn(|| rest.next_if(|entry| entry.0 == line));
            mirrored.push(own.map(|&(_, e, j)| (e, j)));
        }
        mirrored
    }
}
