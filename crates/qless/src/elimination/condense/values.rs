//! Computes the values `K_q(q, :) = K(q, :) L + sum over slaves a of L_aq W(a, :)`, each line (row or column) by one thread. L holds T and
//! the identity, `W = K_S L`, and K_S holds the lines of the slaves in K.

use std::ops::Range;

use rayon::prelude::*;

use super::plan::LineSource;
use super::{CondensedPattern, NONE};
use crate::ArgumentError;
use crate::common::argument::{long, numbers};
use crate::elimination::Elimination;
use crate::elimination::apply::{fill, first_not_finite};

/// Minimum number of entries of K_q for one thread.
const ENTRIES_PER_THREAD: usize = 1 << 15;

impl CondensedPattern {
    /// Computes `K_q = L^T K L` and `f_q = L^T (f - K u_0)`, where `u = L u_q + u_0`, from values of K in the order of its pattern and
    /// forces f on all DOFs.
    ///
    /// # Errors
    /// [`ArgumentError`] for a wrong length, a number that is not finite, or an elimination that did not make this pattern.
    pub fn condense_into(
        &self,
        elimination: &Elimination,
        k: &[f64],
        f: &[f64],
        k_q: &mut [f64],
        f_q: &mut [f64],
    ) -> Result<(), ArgumentError> {
        self.condense_matrix_into(elimination, k, k_q)?;
        self.load_into(elimination, k, f, f_q)
    }

    /// Computes `L^T K L` alone, where L holds T and the identity: for mass, damping and other matrices with the pattern of K.
    ///
    /// # Errors
    /// As [`CondensedPattern::condense_into`].
    pub fn condense_matrix_into(
        &self,
        elimination: &Elimination,
        k: &[f64],
        k_q: &mut [f64],
    ) -> Result<(), ArgumentError> {
        self.check(elimination, k_q.len())?;
        long("the list of values of K", k.len(), self.plan.entries)?;
        let finite = self.work.with(self.plan.w.index.len(), |w| {
            self.of_slaves(k, w);
            let w = &*w;
            each(&self.lines.starts, k_q, &|range, out: &mut [f64]| self.fill(range, out, k, w))
        });
        if finite {
            return Ok(());
        }
        match k.iter().position(|v| !v.is_finite()) {
            Some(place) => Err(ArgumentError::NotFinite { what: "the list of values of K", place, value: k[place] }),
            None => Err(ArgumentError::Overflow { what: "K_q", place: first_not_finite(k_q) }),
        }
    }

    /// Computes a range of lines (rows or columns) of K_q; false if a value is not finite.
    fn fill(&self, range: Range<usize>, out: &mut [f64], k: &[f64], w: &[f64]) -> bool {
        let mixed = |source: &LineSource| matches!(source, LineSource::Mixed(_));
        let sums = if self.plan.source[range.clone()].iter().any(mixed) { self.unknowns() } else { 0 };
        self.work.with(sums, |sums| self.fill_with(sums, range, out, k, w))
    }

    fn fill_with(&self, sums: &mut [f64], range: Range<usize>, mut out: &mut [f64], k: &[f64], w: &[f64]) -> bool {
        let mut finite = true;
        for q in range {
            let line = self.lines.line(q);
            let (own, rest) = out.split_at_mut(line.len());
            out = rest;
            match self.plan.source[q] {
                LineSource::Copied(first) => own.copy_from_slice(&k[first as usize..first as usize + own.len()]),
                LineSource::Mixed(m) => {
                    line.iter().for_each(|&r| sums[r as usize] = 0.0);
                    self.add_line(self.plan.mixed.line(m as usize), k, sums, |r| self.is_stored(q, r));
                    for (a, v) in self.slaves_of.row(q) {
                        let of_slave = self.plan.w.line(a).iter().zip(&w[self.plan.w.range(a)]);
                        of_slave.filter(|(r, _)| self.is_stored(q, **r)).for_each(|(&r, w)| sums[r as usize] += v * w);
                    }
                    own.iter_mut().zip(line).for_each(|(own, &r)| *own = sums[r as usize]);
                }
            }
            finite &= own.iter().fold(true, |all, v| all & v.is_finite());
        }
        finite
    }

    /// Adds a line (row or column) of K, given by its entries, times L to `sums`, at the indices for which `stored` is true. L holds T and
    /// the identity.
    fn add_line(&self, entries: &[(u32, u32)], k: &[f64], sums: &mut [f64], stored: impl Fn(u32) -> bool) {
        for &(e, j) in entries {
            let row = self.row_of_l(j as usize).filter(|&(r, _)| stored(r));
            row.for_each(|(r, l)| sums[r as usize] += k[e as usize] * l);
        }
    }

    /// Computes `W = K_S L`. K_S holds the lines (rows or columns) of the slaves in K, and L holds T and the identity.
    fn of_slaves(&self, k: &[f64], values: &mut [f64]) {
        let w = &self.plan.w;
        let lines = |range: Range<usize>, mut out: &mut [f64], sums: &mut [f64]| {
            for a in range {
                let (own, rest) = out.split_at_mut(w.line(a).len());
                out = rest;
                w.line(a).iter().for_each(|&r| sums[r as usize] = 0.0);
                self.add_line(self.plan.of_slaves.line(a), k, sums, |_| true);
                own.iter_mut().zip(w.line(a)).for_each(|(own, &r)| *own = sums[r as usize]);
            }
        };
        each(&w.starts, values, &|range, out: &mut [f64]| {
            self.work.with(self.unknowns(), |sums| lines(range, out, sums));
            true
        });
    }
}

/// Calls `work` for ranges of lines with about the same number of entries, on all threads; returns true if every call returned true. With
/// one thread there is a single range, and no list of ranges is allocated.
fn each(starts: &[u32], values: &mut [f64], work: &(impl Fn(Range<usize>, &mut [f64]) -> bool + Sync)) -> bool {
    match rayon::current_num_threads() {
        threads if threads == 1 || values.len() < 2 * ENTRIES_PER_THREAD => work(0..starts.len() - 1, values),
        threads => {
            let ranges = line_ranges(starts, values, 4 * threads).into_par_iter();
            ranges.map(|(lines, values)| work(lines, values)).reduce(|| true, |a, b| a & b)
        }
    }
}

/// Splits the lines (rows or columns) into at most `most` ranges with about the same number of entries, each with its values.
pub(super) fn line_ranges<'a>(
    starts: &[u32],
    mut values: &'a mut [f64],
    most: usize,
) -> Vec<(Range<usize>, &'a mut [f64])> {
    let count = most.min(values.len() / ENTRIES_PER_THREAD).max(1);
    let (total, lines) = (values.len(), starts.len() - 1);
    let mut all = Vec::new();
    let mut first = 0;
    for part in 1..=count {
        let end = if part == count { lines } else { starts.partition_point(|&s| (s as usize) < total * part / count) };
        let end = end.clamp(first, lines);
        let (own, rest) = values.split_at_mut((starts[end] - starts[first]) as usize);
        all.push((first..end, own));
        (values, first) = (rest, end);
    }
    all
}

/// Minimum number of slaves for one thread.
const SLAVES_PER_THREAD: usize = 1 << 9;

impl CondensedPattern {
    /// Computes `f_q = L^T (f - K u_0)` alone, where `u = L u_q + u_0`: for other forces, or after a [`crate::Elimination::update`].
    ///
    /// # Errors
    /// As [`CondensedPattern::condense_into`].
    pub fn load_into(
        &self,
        elimination: &Elimination,
        k: &[f64],
        f: &[f64],
        f_q: &mut [f64],
    ) -> Result<(), ArgumentError> {
        self.check(elimination, self.nnz())?;
        long("the list of values of K", k.len(), self.plan.entries)?;
        numbers("the list of forces", f, elimination.dofs())?;
        long("the list of forces on unknowns", f_q.len(), self.unknowns())?;
        let (plan, slaves) = (&self.plan, elimination.slaves());
        let columns = if plan.by_columns { elimination.dofs() } else { 0 };
        self.work.with(columns, |by_columns| {
            self.stress_by_columns(elimination, k, by_columns);
            self.work.with(slaves.len(), |of_slaves| self.load_of(elimination, (k, f), by_columns, of_slaves, f_q))
        })
    }

    fn load_of(
        &self,
        elimination: &Elimination,
        (k, f): (&[f64], &[f64]),
        by_columns: &[f64],
        of_slaves: &mut [f64],
        f_q: &mut [f64],
    ) -> Result<(), ArgumentError> {
        let (plan, slaves) = (&self.plan, elimination.slaves());
        // `(K u_0)_dof` from the line of K. u_0 is zero for unknowns, so `line` may be empty if all DOFs of the line are unknowns.
        let stress = |dof: usize, line: &[(u32, u32)]| {
            if plan.by_columns {
                return by_columns[dof];
            }
            let moved = line.iter().filter(|&&(_, j)| self.number[j as usize] == NONE);
            moved.map(|&(e, j)| k[e as usize] * self.shift(elimination, j as usize)).sum()
        };
        let of_slave = |(a, out): (usize, &mut f64)| *out = f[slaves[a]] - stress(slaves[a], plan.of_slaves.line(a));
        if slaves.len() < 2 * SLAVES_PER_THREAD || rayon::current_num_threads() == 1 {
            of_slaves.iter_mut().enumerate().for_each(of_slave);
        } else {
            of_slaves.par_iter_mut().with_min_len(SLAVES_PER_THREAD).enumerate().for_each(of_slave);
        }
        let of_slaves = &*of_slaves;
        fill(f_q, "f_q", |q| {
            let line = if let LineSource::Mixed(m) = plan.source[q] { plan.mixed.line(m as usize) } else { &[] };
            let own = f[self.dofs[q]] - stress(self.dofs[q], line);
            own + self.slaves_of.row(q).map(|(a, v)| v * of_slaves[a]).sum::<f64>()
        })
    }

    /// Computes `K u_0` at all DOFs, if K is stored by columns with all entries.
    fn stress_by_columns(&self, elimination: &Elimination, k: &[f64], stress: &mut [f64]) {
        if !self.plan.by_columns {
            return;
        }
        stress.fill(0.0);
        let of_slaves = elimination.slaves().iter().enumerate().map(|(a, &dof)| (dof, self.plan.of_slaves.line(a)));
        let of_prescribed = self.plan.of_prescribed.iter().map(|(dof, entries)| (*dof as usize, entries.line(0)));
        for (dof, line) in of_slaves.chain(of_prescribed) {
            let u = self.shift(elimination, dof);
            line.iter().for_each(|&(e, i)| stress[i as usize] += k[e as usize] * u);
        }
    }
}
