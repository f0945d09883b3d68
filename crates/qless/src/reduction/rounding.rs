//! Rounding in the relation of a block: which entries of T, G and g are zero.

use crate::Csr;
use crate::factor::block::Block;
use crate::factor::solver::NOISE;
use crate::input::scale::ldexp;

/// A row of T is zero, and its slave fixed, if all its entries are at most this many units in the last place times the condition of the
/// kept rows.
const ZERO_UNITS: f64 = 8.0;
/// Upper limit of the bound below which a row counts as zero, however large the condition is.
const ZERO_LIMIT: f64 = 1e-8;

/// The bound below which all entries of a row count as zero; `sigma` is the smallest singular value of the kept rows.
pub(super) fn zero(sigma: f64) -> f64 {
    (ZERO_UNITS * f64::EPSILON / sigma).clamp(NOISE, ZERO_LIMIT)
}

/// One choice of units for a block, as exponents of its DOFs and rows: the units of the block's matrix, or balanced ones.
struct Units<'a> {
    block: &'a Block,
    is_balanced: bool,
}

impl<'a> Units<'a> {
    /// The two choices of units, those of the block's matrix and balanced ones; only one if they are equal.
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

    /// For each column of the relation between slaves and other DOFs, the factor that makes entries comparable: the unit of a master, or 1
    /// over the largest coefficient of a prescribed DOF.
    fn sizes(&self, masters: &[u32]) -> Vec<f64> {
        let mut prescribed = vec![0.0_f64; self.block.prescribed.len()];
        for i in 0..self.block.fixed.rows() {
            let power = self.row(i);
            self.block.fixed.row(i).for_each(|(c, v)| prescribed[c] = prescribed[c].max(ldexp(v.abs(), power)));
        }
        masters.iter().map(|&j| ldexp(1.0, self.dof(j))).chain(prescribed.into_iter().map(|size| 1.0 / size)).collect()
    }
}

/// Drops entries of the relation `u_s = X [u_q; u_p; 1]` that are rounding.
///
/// An entry is rounding if it is small in both choices of units. In each row, entries of masters are compared with the largest of them, and
/// entries of prescribed DOFs with the largest of these. If the largest is at most `zero`, all entries of the group are dropped. Constants
/// are compared with the smallest nonzero right-hand side. A small entry is kept if an equation needs it: without the entry, the terms of
/// the equation in a column would not cancel.
pub(super) struct Cleaning<'a> {
    pub block: &'a Block,
    /// Kept rows of the block.
    pub kept: &'a [usize],
    /// The slaves, as numbers of DOFs within the block.
    pub slaves: &'a [u32],
    pub masters: &'a [u32],
    /// The bound below which all entries of a row count as zero: the result of [`zero`].
    pub zero: f64,
    /// True if the block is solved as a dense matrix.
    pub is_small: bool,
}

/// For each slave, whether each entry of its row is more than rounding.
type Large = Vec<Vec<bool>>;

impl Cleaning<'_> {
    /// Returns the cleaned relation and the constants. `rows` are the rows of X in `u_s = X [u_q; u_p; 1]`, one for each slave, with
    /// ascending column numbers; the last column is the constant.
    pub fn run(&self, rows: &[Vec<(usize, f64)>]) -> (Csr, Vec<f64>) {
        let width = self.masters.len() + self.block.prescribed.len();
        let mut is_large: Large = rows.iter().map(|row| vec![false; row.len()]).collect();
        let all: Vec<ColumnSizes> = Units::all(self.block).map(|units| self.sizes(units)).collect();
        all.iter().for_each(|sizes| self.large_in_rows(rows, sizes, &mut is_large));
        let is_dropped = |(row, is_large): (&Vec<(usize, f64)>, &Vec<bool>)| {
            row.iter().zip(is_large).any(|((_, v), is_large)| *v != 0.0 && !is_large)
        };
        if rows.iter().zip(&is_large).any(is_dropped) {
            all.iter().for_each(|sizes| self.needed_by_equations(rows, sizes, &mut is_large));
        }
        let mut relation = Csr::empty(width);
        let mut constant = vec![0.0; rows.len()];
        for ((row, is_large), constant) in rows.iter().zip(&is_large).zip(&mut constant) {
            let kept = || row.iter().zip(is_large).filter(|(_, is_large)| **is_large).map(|(entry, _)| *entry);
            relation.append(kept().filter(|&(c, _)| c < width));
            *constant = kept().find(|&(c, _)| c == width).map_or(0.0, |(_, v)| v);
        }
        (relation, constant)
    }

    fn sizes<'a>(&'a self, units: Units<'a>) -> ColumnSizes<'a> {
        let mut of_column = units.sizes(self.masters);
        of_column.push(1.0);
        ColumnSizes { units, of_column }
    }

    /// Marks entries that are more than rounding, compared with the other entries of their row.
    fn large_in_rows(&self, rows: &[Vec<(usize, f64)>], sizes: &ColumnSizes, is_large: &mut Large) {
        let (q, constant) = (self.masters.len(), self.masters.len() + self.block.prescribed.len());
        let side = |c: usize| usize::from(c >= q);
        let sides = self.kept.iter().map(|&i| ldexp(self.block.rhs[i].abs(), sizes.units.row(i)));
        let least_side = NOISE * sides.filter(|&b| b > 0.0).reduce(f64::min).unwrap_or(0.0);
        for ((row, &slave), is_large) in rows.iter().zip(self.slaves).zip(is_large) {
            let mut largest = [0.0_f64; 2];
            let entries = row.iter().filter(|(c, _)| *c < constant);
            entries.for_each(|e| largest[side(e.0)] = largest[side(e.0)].max(sizes.of(slave, e)));
            let least = largest.map(|largest| if largest <= self.zero { self.zero } else { NOISE * largest });
            is_large.iter_mut().zip(row).for_each(|(is_large, entry)| {
                let least = if entry.0 < constant { least[side(entry.0)] } else { least_side };
                *is_large |= sizes.of(slave, entry) > least;
            });
        }
    }

    /// Marks entries of X in `u_s = X [u_q; u_p; 1]` that equations need. If the terms of an equation in a column do not cancel with the
    /// entries marked so far, the entries of its slaves in this column are marked. In a large block entries decay with the distance from
    /// their master, so the residual is relative to the largest motions of the equation's DOFs. In a small block, and for the constant, it
    /// is relative to the terms in the column.
    fn needed_by_equations(&self, rows: &[Vec<(usize, f64)>], sizes: &ColumnSizes, is_large: &mut Large) {
        let motions = self.motions(rows, sizes);
        let place = self.places();
        let mut columns = ColumnSums::new(sizes.of_column.len());
        loop {
            let mut is_new = false;
            for &i in self.kept {
                self.add_terms(i, (rows, is_large), &place, &mut columns);
                let size = self.block.matrix.row(i).map(|(j, v)| v.abs() * motions[j]).sum::<f64>();
                while let Some((c, sum, own)) = columns.take() {
                    let by_own = self.is_small || c + 1 == sizes.of_column.len();
                    let bound = if by_own { own } else { own.max(size / sizes.of_column[c]) };
                    if sum.abs() > 2.0 * NOISE * bound {
                        is_new |= self.mark(i, c, (rows, is_large), &place);
                    }
                }
            }
            if !(is_new && self.is_small) {
                return;
            }
        }
    }

    /// For each DOF of the block, the largest motion that one master or prescribed DOF causes.
    fn motions(&self, rows: &[Vec<(usize, f64)>], sizes: &ColumnSizes) -> Vec<f64> {
        let constant = sizes.of_column.len() - 1;
        let mut motions = vec![0.0; self.block.dofs.len()];
        self.masters.iter().zip(&sizes.of_column).for_each(|(&j, &size)| motions[j as usize] = size);
        for (row, &slave) in rows.iter().zip(self.slaves) {
            let entries = row.iter().filter(|(c, _)| *c < constant);
            motions[slave as usize] = entries.map(|&(c, v)| v.abs() * sizes.of_column[c]).fold(0.0, f64::max);
        }
        motions
    }

    /// For each DOF of the block, the row of a slave or the column of a master.
    fn places(&self) -> Vec<RelationPlace> {
        let mut place = vec![RelationPlace::Master(0); self.block.dofs.len()];
        self.masters.iter().zip(0..).for_each(|(&j, c)| place[j as usize] = RelationPlace::Master(c));
        self.slaves.iter().zip(0..).for_each(|(&j, s)| place[j as usize] = RelationPlace::Slave(s));
        place
    }

    /// Inserts `u_s = X [u_q; u_p; 1]` into equation i and adds its terms in each column of X. Entries of X that are not marked count as
    /// zero.
    fn add_terms(&self, i: usize, (rows, is_large): Entries, place: &[RelationPlace], columns: &mut ColumnSums) {
        let q = self.masters.len();
        for (j, v) in self.block.matrix.row(i) {
            match place[j] {
                RelationPlace::Master(c) => columns.add(c, v),
                RelationPlace::Slave(s) => {
                    let large = rows[s].iter().zip(&is_large[s]).filter(|(_, is_large)| **is_large);
                    large.for_each(|(&(c, x), _)| columns.add(c, v * x));
                }
            }
        }
        self.block.fixed.row(i).for_each(|(c, v)| columns.add(q + c, v));
        columns.add(q + self.block.prescribed.len(), -self.block.rhs[i]);
    }

    /// Marks the entries in column c of the relation X for the slaves of equation i; returns true if one was not marked before.
    fn mark(
        &self,
        i: usize,
        c: usize,
        (rows, is_large): (&[Vec<(usize, f64)>], &mut Large),
        place: &[RelationPlace],
    ) -> bool {
        let mut is_new = false;
        for (j, _) in self.block.matrix.row(i) {
            if let RelationPlace::Slave(s) = place[j]
                && let Ok(at) = rows[s].binary_search_by_key(&c, |entry| entry.0)
                && rows[s][at].1 != 0.0
            {
                is_new |= !std::mem::replace(&mut is_large[s][at], true);
            }
        }
        is_new
    }
}

/// The rows of the relation X, and which of their entries are marked.
type Entries<'a> = (&'a [Vec<(usize, f64)>], &'a Large);

/// The place of a DOF in the relation.
#[derive(Clone, Copy)]
enum RelationPlace {
    /// The column of a master.
    Master(usize),
    /// The row of a slave.
    Slave(usize),
}

/// The terms of an equation in each column of the relation X: their sum, and the sum of their magnitudes.
struct ColumnSums {
    sums: Vec<(f64, f64)>,
    touched: Vec<usize>,
}

impl ColumnSums {
    fn new(count: usize) -> Self {
        Self { sums: vec![(0.0, 0.0); count], touched: Vec::new() }
    }

    fn add(&mut self, c: usize, term: f64) {
        let (sum, size) = &mut self.sums[c];
        if *size == 0.0 && term != 0.0 {
            self.touched.push(c);
        }
        *sum += term;
        *size += term.abs();
    }

    /// Removes one column and returns (column, sum, sum of magnitudes).
    fn take(&mut self) -> Option<(usize, f64, f64)> {
        let c = self.touched.pop()?;
        let (sum, size) = std::mem::take(&mut self.sums[c]);
        Some((c, sum, size))
    }
}

/// A choice of units, and for each column of the relation the factor that makes its entries comparable ([`Units::sizes`]); the factor of
/// the constant is 1.
struct ColumnSizes<'a> {
    units: Units<'a>,
    of_column: Vec<f64>,
}

impl ColumnSizes<'_> {
    /// The size of an entry in the row of a slave, in the units of this choice.
    fn of(&self, slave: u32, &(c, v): &(usize, f64)) -> f64 {
        ldexp(v.abs() * self.of_column[c], -self.units.dof(slave))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding grows with the condition, until nearly nothing would count as more than rounding.
    #[test]
    fn the_bound_of_zero_rows_grows_with_the_condition() {
        assert_eq!((zero(1.0), zero(1e-12)), (NOISE, ZERO_LIMIT));
        for sigma in [1e-2, 1e-4, 1e-5] {
            let condition = zero(sigma) / zero(0.1 * sigma);
            assert!((condition - 0.1).abs() < 1e-12, "{sigma:e}: {condition}");
        }
    }
}
