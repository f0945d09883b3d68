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

/// Drops entries of the relation `u_s = X [u_q; u_p; 1]` that are rounding.
///
/// Entries are small in any units, beside the others of their row; those of masters, of prescribed DOFs and constants apart. A row whose
/// entries are all small is zero, unless an equation needs them: the terms that are left of it in a column must cancel, relative to the
/// largest motions of its DOFs.
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

/// By slave, whether each entry of its row is more than rounding.
type Large = Vec<Vec<bool>>;

impl Cleaning<'_> {
    /// Rows of X by slave, each with its column numbers in ascending order; the constant is the last column.
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

    /// Marks entries that are more than rounding beside the others of their row.
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

    /// Marks the entries of the slaves of an equation in the columns in which it does not hold with what is marked so far. What the first
    /// rule drops changes an equation by at most [`NOISE`] of the largest motions of its DOFs.
    fn needed_by_equations(&self, rows: &[Vec<(usize, f64)>], sizes: &ColumnSizes, is_large: &mut Large) {
        let (q, constant) = (self.masters.len(), self.masters.len() + self.block.prescribed.len());
        let motion = |row: &Vec<(usize, f64)>| {
            let entries = row.iter().filter(|(c, _)| *c < constant);
            entries.map(|&(c, v)| v.abs() * sizes.of_column[c]).fold(0.0, f64::max)
        };
        let motions: Vec<f64> = rows.iter().map(motion).collect();
        let mut place = vec![Err(0); self.block.dofs.len()];
        self.masters.iter().zip(0..).for_each(|(&j, c)| place[j as usize] = Err(c));
        self.slaves.iter().zip(0..).for_each(|(&j, s)| place[j as usize] = Ok(s));
        let mut sums = vec![0.0; constant + 1];
        let mut is_touched = vec![false; constant + 1];
        let mut touched: Vec<usize> = Vec::new();
        for &i in self.kept {
            let (mut size, mut of_b) = (0.0_f64, self.block.rhs[i].abs());
            let mut add = |c: usize, term: f64| {
                sums[c] += term;
                if !std::mem::replace(&mut is_touched[c], true) {
                    touched.push(c);
                }
            };
            for (j, v) in self.block.matrix.row(i) {
                match place[j] {
                    Err(c) => {
                        add(c, v);
                        size += v.abs() * sizes.of_column[c];
                    }
                    Ok(s) => {
                        let large = rows[s].iter().zip(&is_large[s]).filter(|(_, is_large)| **is_large);
                        large.for_each(|(&(c, x), _)| add(c, v * x));
                        size += v.abs() * motions[s];
                        of_b = of_b
                            .max(rows[s].last().map_or(0.0, |&(c, x)| if c == constant { (v * x).abs() } else { 0.0 }));
                    }
                }
            }
            self.block.fixed.row(i).for_each(|(c, v)| {
                add(q + c, v);
                size += v.abs() * sizes.of_column[q + c];
            });
            add(constant, -self.block.rhs[i]);
            for c in touched.drain(..) {
                is_touched[c] = false;
                let left = std::mem::take(&mut sums[c]).abs() * sizes.of_column[c];
                if left <= 2.0 * NOISE * if c < constant { size } else { of_b } {
                    continue;
                }
                for s in self.block.matrix.row(i).filter_map(|(j, _)| place[j].ok()) {
                    if let Ok(at) = rows[s].binary_search_by_key(&c, |entry| entry.0) {
                        is_large[s][at] = rows[s][at].1 != 0.0;
                    }
                }
            }
        }
    }
}

/// Units, and the size of 1 in each column of the relation.
struct ColumnSizes<'a> {
    units: Units<'a>,
    of_column: Vec<f64>,
}

impl ColumnSizes<'_> {
    /// The size of an entry in the row of a slave.
    fn of(&self, slave: u32, &(c, v): &(usize, f64)) -> f64 {
        ldexp(v.abs() * self.of_column[c], -self.units.dof(slave))
    }
}
