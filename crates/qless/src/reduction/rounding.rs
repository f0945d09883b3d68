//! Rounding in the relation of a block: which entries of T, G and g are zero.

use crate::Csr;
use crate::factor::block::Block;
use crate::factor::solver::NOISE;
use crate::input::scale::ldexp;

/// A row of T is zero, and its slave fixed, if all its entries are below this many units in the last place times the condition ...
const ZERO_UNITS: f64 = 8.0;
/// ... and below this limit, for any condition.
const ZERO_LIMIT: f64 = 1e-8;

/// The bound of the entries of a row that is zero; `sigma` is the smallest singular value of the kept rows.
pub(super) fn zero(sigma: f64) -> f64 {
    (ZERO_UNITS * f64::EPSILON / sigma).clamp(NOISE, ZERO_LIMIT)
}

/// Exponents of the DOFs of a block and powers of its rows in one choice of units: those of `matrix`, or balanced ones.
struct Units<'a> {
    block: &'a Block,
    is_balanced: bool,
}

impl<'a> Units<'a> {
    /// The two choices of units; only one if they are equal.
    fn all(block: &'a Block) -> impl Iterator<Item = Self> {
        let both = block.balanced.iter().any(|&unit| unit != 0);
        [false, true].into_iter().take(1 + usize::from(both)).map(move |is_balanced| Self { block, is_balanced })
    }

    fn dof(&self, j: u32) -> i32 {
        if self.is_balanced { self.block.balanced[j as usize] } else { 0 }
    }

    fn row(&self, i: usize) -> i32 {
        if self.is_balanced { self.block.balanced_row(i) } else { 0 }
    }

    /// The size of 1 in each column of the relation: of masters, and of prescribed DOFs by their largest coefficients.
    fn sizes(&self, masters: &[u32]) -> Vec<f64> {
        let mut prescribed = vec![0.0_f64; self.block.prescribed.len()];
        for i in 0..self.block.fixed.rows() {
            let power = self.row(i);
            self.block.fixed.row(i).for_each(|(c, v)| prescribed[c] = prescribed[c].max(ldexp(v.abs(), power)));
        }
        masters.iter().map(|&j| ldexp(1.0, self.dof(j))).chain(prescribed.into_iter().map(|size| 1.0 / size)).collect()
    }
}

/// Drops entries of the relation `u_s = X [u_q; u_p; 1]` that are rounding, where the equations hold without them.
///
/// Entries are small in any units, beside the others of their row; those of masters, of prescribed DOFs and constants apart. The units of a
/// row do not decide alone: a column of X is rounded only if every equation holds without its small entries, so that the sum of the terms of
/// an equation in the column stays rounding of them.
pub(super) struct Cleaning<'a> {
    pub block: &'a Block,
    /// Kept rows of the block.
    pub kept: &'a [usize],
    /// DOFs of the block.
    pub slaves: &'a [u32],
    pub masters: &'a [u32],
    /// As [`zero`] gives it.
    pub zero: f64,
}

impl Cleaning<'_> {
    /// Rows of X by slave, each with its column numbers in ascending order; the constant is the last column.
    pub fn run(&self, rows: &[Vec<(usize, f64)>]) -> (Csr, Vec<f64>) {
        let width = self.masters.len() + self.block.prescribed.len();
        let mut is_large = self.large_in_rows(rows);
        let is_needed = self.columns_that_need_all(rows, &is_large);
        is_large.iter_mut().zip(rows).for_each(|(is_large, row)| {
            is_large.iter_mut().zip(row).for_each(|(is_large, (c, v))| *is_large |= is_needed[*c] && *v != 0.0);
        });
        let mut relation = Csr::empty(width);
        let mut constant = vec![0.0; rows.len()];
        for ((row, is_large), constant) in rows.iter().zip(&is_large).zip(&mut constant) {
            let kept = || row.iter().zip(is_large).filter(|(_, is_large)| **is_large).map(|(entry, _)| *entry);
            relation.append(kept().filter(|&(c, _)| c < width));
            *constant = kept().find(|&(c, _)| c == width).map_or(0.0, |(_, v)| v);
        }
        (relation, constant)
    }

    /// Entries that are more than rounding beside the others of their row, in some units.
    fn large_in_rows(&self, rows: &[Vec<(usize, f64)>]) -> Vec<Vec<bool>> {
        let (q, p) = (self.masters.len(), self.block.prescribed.len());
        let side = |c: usize| usize::from(c >= q);
        let mut is_large: Vec<Vec<bool>> = rows.iter().map(|row| vec![false; row.len()]).collect();
        for units in Units::all(self.block) {
            let sizes = units.sizes(self.masters);
            let sides = self.kept.iter().map(|&i| ldexp(self.block.rhs[i].abs(), units.row(i))).filter(|&b| b > 0.0);
            let least_side = NOISE * sides.reduce(f64::min).unwrap_or(0.0);
            for ((row, &slave), is_large) in rows.iter().zip(self.slaves).zip(&mut is_large) {
                let unit = -units.dof(slave);
                let size = |&(c, v): &(usize, f64)| ldexp(v.abs() * sizes.get(c).unwrap_or(&1.0), unit);
                let mut largest = [0.0_f64; 2];
                let entries = row.iter().filter(|(c, _)| *c < q + p);
                entries.for_each(|entry| largest[side(entry.0)] = largest[side(entry.0)].max(size(entry)));
                let least = largest.map(|largest| if largest <= self.zero { self.zero } else { NOISE * largest });
                is_large.iter_mut().zip(row).for_each(|(is_large, entry)| {
                    let least = if entry.0 < q + p { least[side(entry.0)] } else { least_side };
                    *is_large |= size(entry) > least;
                });
            }
        }
        is_large
    }

    /// The columns in which some equation does not hold without the small entries.
    fn columns_that_need_all(&self, rows: &[Vec<(usize, f64)>], is_large: &[Vec<bool>]) -> Vec<bool> {
        let (q, p) = (self.masters.len(), self.block.prescribed.len());
        let mut is_rounded = vec![false; q + p + 1];
        rows.iter().zip(is_large).for_each(|(row, is_large)| {
            row.iter().zip(is_large).for_each(|((c, v), is_large)| is_rounded[*c] |= !is_large && *v != 0.0);
        });
        let mut is_needed = vec![false; q + p + 1];
        if !is_rounded.contains(&true) {
            return is_needed;
        }
        let mut place = vec![Err(0); self.block.dofs.len()];
        self.masters.iter().zip(0..).for_each(|(&j, c)| place[j as usize] = Err(c));
        self.slaves.iter().zip(0..).for_each(|(&j, s)| place[j as usize] = Ok(s));
        let mut sums = vec![(0.0_f64, 0.0_f64); q + p + 1];
        for &i in self.kept {
            let mut add = |c: usize, term: f64| {
                if is_rounded[c] {
                    sums[c] = (sums[c].0 + term, sums[c].1 + term.abs());
                }
            };
            for (j, v) in self.block.matrix.row(i) {
                match place[j] {
                    Err(c) => add(c, v),
                    Ok(s) => {
                        let large = rows[s].iter().zip(&is_large[s]).filter(|(_, is_large)| **is_large);
                        large.for_each(|(&(c, x), _)| add(c, v * x));
                    }
                }
            }
            self.block.fixed.row(i).for_each(|(c, v)| add(q + c, v));
            add(q + p, -self.block.rhs[i]);
            for (sum, is_needed) in sums.iter_mut().zip(&mut is_needed) {
                let (sum, size) = std::mem::take(sum);
                *is_needed |= sum.abs() > NOISE * size;
            }
        }
        is_needed
    }
}
