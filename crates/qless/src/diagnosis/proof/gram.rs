//! Proves that the equations A of a core are independent, by a Cholesky factorization of `fl(A A^T) - s diag(A A^T)` and bounds of its
//! rounding.
//!
//! ```text
//! fl(A A^T) = A A^T + E     |E| <= gamma_(p+3) |A| |A|^T         p terms in a row; three more for the digits of typed decimals
//! L L^T     = ... + F       |F| <= gamma_(q+2) |L| |L|^T         q terms in a row of L, in any order (Higham 2002, theorem 10.3)
//! x^T A A^T x >= sum_i (s_i - sum_j (|E| + |F|)_ij) x_i^2    because |x_i x_j| <= (x_i^2 + x_j^2) / 2
//! ```
//!
//! Here `s_i = s (A A^T)_ii` and `gamma_n = n u / (1 - n u)` with u = 2^-53. The sums over j are two products with |A| and |L|. They are
//! known only after the factorization, so s is small at first; a second attempt uses twice the s that was needed. Powers of two scale rows
//! and DOFs, which does not change the rank. Each row then has a coefficient between 1 and 2, beside which underflow is negligible.

use qless_qr::Symbolic;

use crate::diagnosis::core::Core;
use crate::input::scale::{Component, RANGE, exponent, ldexp};

/// The fraction s of the first attempt: eight roundings. It suffices only for cores whose smallest singular value, in the scaled units,
/// exceeds about the square root of s.
const SHIFT: f64 = f64::EPSILON * 4.0;
/// A core with fewer equations keeps their order; for others a fill-reducing order is computed.
const FEW: usize = 16;
/// A computed sum of positive numbers is a bound after multiplication by this factor, which exceeds the effect of its roundings.
const SLACK: f64 = 1.0 + 1e-6;
/// Bytes of an entry of the Cholesky factor L.
const BYTES: usize = 16;

/// Returns false if independence could not be proved, also because of a lack of `memory` (in bytes).
pub(super) fn is_independent(core: &Core, memory: usize) -> bool {
    // Balanced units are tried last: most cores do not need them, and they cost more than the factorization of a small core.
    [false, true]
        .into_iter()
        .any(|is_balanced| ScaledCore::new(core, is_balanced).is_some_and(|a| a.is_independent(memory)))
}

fn gamma(n: usize) -> f64 {
    let nu = n as f64 * f64::EPSILON / 2.0;
    nu / (1.0 - nu)
}

/// The equations of a core in a fill-reducing order, rows and DOFs scaled by powers of two.
struct ScaledCore {
    dofs: usize,
    rows: Vec<Vec<(u32, f64)>>,
}

/// The Cholesky factor L: its diagonal, and its other entries by columns.
struct GramFactor {
    diagonal: Vec<f64>,
    columns: Vec<Vec<(u32, f64)>>,
}

impl ScaledCore {
    /// Scales and orders the equations of a core. None if coefficients are so small, or of such different size, that they lose digits.
    fn new(core: &Core, is_balanced: bool) -> Option<Self> {
        let mut dofs: Vec<u32> = core.entries.iter().flatten().map(|&(j, _)| j).collect();
        dofs.sort_unstable();
        dofs.dedup();
        let place = |j: u32| dofs.partition_point(|&other| other < j) as u32;
        let row = |entries: &Vec<(u32, f64)>| {
            let mut row: Vec<_> = entries.iter().map(|&(j, v)| (place(j), v)).collect();
            row.sort_unstable_by_key(|&(j, _)| j);
            row
        };
        let mut scaled = Self { dofs: dofs.len(), rows: core.entries.iter().map(row).collect() };
        scaled.scale(is_balanced)?;
        scaled.reorder();
        Some(scaled)
    }

    /// Scales rows to a largest coefficient between 1 and 2, after scaling DOFs to balanced units if that is requested.
    fn scale(&mut self, is_balanced: bool) -> Option<()> {
        if self.rows.iter().flatten().any(|&(_, v)| !v.is_normal()) {
            return None;
        }
        let units = if is_balanced { self.units()? } else { vec![0; self.dofs] };
        for row in &mut self.rows {
            let power = |&(j, v): &(u32, f64)| exponent(v) + units[j as usize];
            let most = row.iter().map(power).max()?;
            row.iter_mut().for_each(|(j, v)| *v = ldexp(*v, units[*j as usize] - most));
        }
        Some(())
    }

    /// Exponents of the DOFs that lead to balanced units; None if these are the user's units or an exponent is out of range.
    fn units(&self) -> Option<Vec<i32>> {
        let terms = |i: u32| self.rows[i as usize].iter().map(|&(j, v)| (j as usize, v));
        let mut place = vec![0; self.dofs];
        let component = Component::gather((0..self.rows.len() as u32).collect(), terms, &mut place);
        let found = component.units_beyond(0.0).filter(|units| units.iter().all(|unit| unit.abs() < RANGE))?;
        let mut units = vec![0; self.dofs];
        component.dofs.iter().zip(found).for_each(|(&j, unit)| units[j as usize] = unit);
        Some(units)
    }

    fn is_independent(&self, memory: usize) -> bool {
        let mut shift = SHIFT;
        for _ in 0..2 {
            let Some(factor) = self.cholesky(shift, memory) else { return false };
            let needed = self.rounding(&factor);
            if needed < shift {
                return true;
            }
            shift = 2.0 * needed;
        }
        false
    }

    /// Sorts the rows A of the core in the column order of a QR factorization of `A^T`.
    fn reorder(&mut self) {
        if self.rows.len() < FEW {
            return;
        }
        let mut start = vec![0];
        start.extend(self.rows.iter().scan(0, |sum, row| {
            *sum += row.len();
            Some(*sum)
        }));
        let index: Vec<u32> = self.rows.iter().flatten().map(|&(j, _)| j).collect();
        if let Ok(symbolic) = Symbolic::analyse(self.dofs, self.rows.len(), &start, &index) {
            let order = symbolic.order().iter();
            self.rows = order.map(|&i| std::mem::take(&mut self.rows[i as usize])).collect();
        }
    }

    /// The Cholesky factor L of `A A^T - shift diag(A A^T)`, row by row, where A are the equations of the core. None if this matrix is not
    /// positive definite, or if L needs more than `memory`.
    fn cholesky(&self, shift: f64, memory: usize) -> Option<GramFactor> {
        let count = self.rows.len();
        let mut factor = GramFactor { diagonal: Vec::with_capacity(count), columns: vec![Vec::new(); count] };
        let mut holders: Vec<Vec<(u32, f64)>> = vec![Vec::new(); self.dofs];
        let mut tree = EliminationTree { parent: vec![NONE; count], seen: vec![NONE; count] };
        let (mut sums, mut entries, mut pattern) = (vec![0.0; count], 0, Vec::new());
        for (k, row) in (0..).zip(&self.rows) {
            tree.begin(k);
            pattern.clear();
            let mut diagonal = 0.0;
            for &(j, v) in row {
                diagonal += v * v;
                for &(i, w) in &holders[j as usize] {
                    sums[i as usize] += v * w;
                    tree.climb(i, k, &mut pattern);
                }
                holders[j as usize].push((k, v));
            }
            diagonal -= shift * diagonal;
            pattern.sort_unstable();
            for &i in &pattern {
                let column = &mut factor.columns[i as usize];
                let value = std::mem::take(&mut sums[i as usize]) / factor.diagonal[i as usize];
                column.iter().for_each(|&(j, l)| sums[j as usize] -= l * value);
                diagonal -= value * value;
                column.push((k, value));
            }
            entries += pattern.len();
            // A NaN is not positive.
            let is_positive = diagonal > 0.0;
            if !is_positive || entries > memory / BYTES {
                return None;
            }
            factor.diagonal.push(diagonal.sqrt());
        }
        Some(factor)
    }

    /// The largest sum of rounding errors of a row, relative to its diagonal entry.
    fn rounding(&self, factor: &GramFactor) -> f64 {
        let of_product = gamma(self.rows.iter().map(Vec::len).max().unwrap_or(0) + 3);
        let mut of_dofs = vec![0.0; self.dofs];
        for &(j, v) in self.rows.iter().flatten() {
            of_dofs[j as usize] += v.abs();
        }
        let (lengths, of_factor) = factor.row_sums();
        let of_factorization = gamma(lengths.into_iter().max().unwrap_or(0) + 2);
        let of_row = |(row, sum): (&Vec<(u32, f64)>, f64)| {
            let diagonal: f64 = row.iter().map(|(_, v)| v * v).sum();
            let product: f64 = row.iter().map(|&(j, v)| v.abs() * of_dofs[j as usize]).sum();
            SLACK * ((of_product * product + of_factorization * sum) / diagonal + 2.0 * f64::EPSILON)
        };
        self.rows.iter().zip(of_factor).map(of_row).fold(0.0, f64::max)
    }
}

impl GramFactor {
    /// The number of entries in each row of the Cholesky factor L, and `|L| |L|^T e`, where e is the vector of ones.
    fn row_sums(&self) -> (Vec<usize>, Vec<f64>) {
        let sum = |(d, column): (&f64, &Vec<(u32, f64)>)| d + column.iter().map(|(_, l)| l.abs()).sum::<f64>();
        let of_columns: Vec<f64> = self.diagonal.iter().zip(&self.columns).map(sum).collect();
        let mut lengths = vec![1; self.diagonal.len()];
        let mut of_rows: Vec<f64> = self.diagonal.iter().zip(&of_columns).map(|(d, sum)| d * sum).collect();
        for (column, sum) in self.columns.iter().zip(of_columns) {
            for &(k, l) in column {
                lengths[k as usize] += 1;
                of_rows[k as usize] += l.abs() * sum;
            }
        }
        (lengths, of_rows)
    }
}

const NONE: u32 = u32::MAX;

/// The elimination tree, which grows row by row (Liu 1990). The columns of row k of L are the nodes on the paths from the entries of row k
/// of the matrix up to k.
struct EliminationTree {
    parent: Vec<u32>,
    /// For each node, the last row whose path contained it.
    seen: Vec<u32>,
}

impl EliminationTree {
    fn begin(&mut self, k: u32) {
        self.seen[k as usize] = k;
    }

    fn climb(&mut self, mut i: u32, k: u32, pattern: &mut Vec<u32>) {
        while self.seen[i as usize] != k {
            self.seen[i as usize] = k;
            pattern.push(i);
            if self.parent[i as usize] == NONE {
                self.parent[i as usize] = k;
            }
            i = self.parent[i as usize];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::random::randoms;

    fn core(rows: &[&[f64]]) -> Core {
        let entries = |row: &&[f64]| (0..).zip(row.iter().copied()).filter(|&(_, v)| v != 0.0).collect();
        Core { rows: (0..rows.len() as u32).collect(), entries: rows.iter().map(entries).collect() }
    }

    #[test]
    fn independent_rows_are_proved_in_any_units_and_dependent_ones_never() {
        let mut random = randoms(4);
        let mut next = move || random.next().expect("endless");
        for size in 2..40 {
            let unit: Vec<f64> = (0..size + 3).map(|_| 2_f64.powi((next() * 400.0) as i32 - 400)).collect();
            let mut row =
                || unit.iter().map(|u| if next() < 1.0 { u * (next() - 0.9) } else { 0.0 }).collect::<Vec<_>>();
            let mut rows: Vec<Vec<f64>> = (0..size).map(|_| row()).collect();
            rows.iter_mut().enumerate().for_each(|(i, row)| row[i] = unit[i] * 9.0);
            let proved = |rows: &[Vec<f64>]| {
                is_independent(&core(&rows.iter().map(Vec::as_slice).collect::<Vec<_>>()), usize::MAX)
            };
            assert!(proved(&rows), "{size}");
            // Appends the rounded sum of two rows, and then changes it by a difference that is too small for the bound.
            rows.push(rows[0].iter().zip(&rows[1]).map(|(a, b)| a + b).collect());
            assert!(!proved(&rows), "{size}");
            rows[size][0] *= 1.0 + 1e-12;
            assert!(!proved(&rows), "{size}");
        }
    }

    /// L is the factor of `A A^T - s diag(A A^T)`, and the bound is that of the formula at the head of this file, with dense products.
    #[test]
    fn the_bound_of_rounding_is_that_of_the_formula() {
        let mut random = randoms(5);
        let mut next = move || random.next().expect("endless");
        for size in 2..25 {
            let mut row = |i: usize| -> Vec<f64> {
                let entry = |j: usize| {
                    if i == j {
                        9.0
                    } else if next() < 1.0 {
                        next() - 0.9
                    } else {
                        0.0
                    }
                };
                (0..size + 3).map(entry).collect()
            };
            let rows: Vec<Vec<f64>> = (0..size).map(&mut row).collect();
            let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
            let scaled = ScaledCore::new(&core(&rows), false).expect("numbers of one size");
            let factor = scaled.cholesky(SHIFT, usize::MAX).expect("positive definite");
            let mut a = vec![vec![0.0; size + 3]; size];
            scaled.rows.iter().zip(&mut a).for_each(|(row, a)| row.iter().for_each(|&(j, v)| a[j as usize] = v));
            let mut l = vec![vec![0.0; size]; size];
            for (i, (&diagonal, column)) in factor.diagonal.iter().zip(&factor.columns).enumerate() {
                l[i][i] = diagonal;
                column.iter().for_each(|&(k, v)| l[k as usize][i] = v);
            }
            let times = |x: &[Vec<f64>], i: usize, j: usize, of: fn(f64) -> f64| -> f64 {
                x[i].iter().zip(&x[j]).map(|(x, y)| of(*x) * of(*y)).sum()
            };
            let longest = |x: &[Vec<f64>]| x.iter().map(|row| row.iter().filter(|v| **v != 0.0).count()).max();
            let [p, q] = [&a, &l].map(|x| longest(x).expect("not empty"));
            let mut bound = 0.0_f64;
            for i in 0..size {
                let whole = times(&a, i, i, |x| x);
                for j in 0..size {
                    let off = times(&a, i, j, |x| x) - times(&l, i, j, |x| x);
                    assert!(
                        off.abs() < 1e-14 * whole.max(times(&a, j, j, |x| x)),
                        "{size}: entry {i}, {j} is off by {off:e}"
                    );
                }
                let sum = |x: &[Vec<f64>]| (0..size).map(|j| times(x, i, j, f64::abs)).sum::<f64>();
                bound = bound.max((gamma(p + 3) * sum(&a) + gamma(q + 2) * sum(&l)) / whole + 2.0 * f64::EPSILON);
            }
            let found = scaled.rounding(&factor);
            assert!((bound..1.00001 * bound).contains(&found), "{size}: {found:e} for {bound:e}");
        }
    }

    #[test]
    fn a_long_ring_with_one_other_weight_is_proved_and_one_with_equal_weights_is_not() {
        let ring = |last: f64| {
            let n = 500_u32;
            let row = |i: u32| vec![(i, 1.0), ((i + 1) % n, if i + 1 == n { last } else { -1.0 })];
            Core { rows: (0..n).collect(), entries: (0..n).map(row).collect() }
        };
        assert!(is_independent(&ring(-2.0), usize::MAX) && is_independent(&ring(1.0), usize::MAX));
        assert!(!is_independent(&ring(-1.0), usize::MAX));
        assert!(!is_independent(&ring(-2.0), 100), "more memory than allowed");
    }
}
