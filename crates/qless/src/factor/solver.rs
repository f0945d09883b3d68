//! Solves `C_S x = c` for many sparse c, by the factors `C_S = U^T L11^T` of [`super::lu`] and a step of refinement (Skeel 1980). C_S has
//! the columns of the slaves.
//!
//! Bit sets list the nonzeros in order, so the cost is about that of the operations on nonzeros.

use rayon::prelude::*;

use super::lu::SparseLu;
use crate::Csr;

/// In a row of T, entries below this fraction of the largest one are rounding. The entries of a column belong to slaves with different
/// units, so they cannot be compared.
pub(crate) const NOISE: f64 = 1e-14;

/// During the solve for one column, numbers below this fraction of the largest one are skipped. Otherwise they would decay from step to
/// step without becoming zero, and each would cost operations.
const FADED: f64 = 1e-19;

/// The factors of C_S (the columns of the slaves), and C_S itself for the refinement.
#[derive(Clone, Debug)]
pub(crate) struct SlaveSolver {
    lu: SparseLu,
    /// C_S, the columns of the slaves: row k lists the entries of the slave of step k; equations are numbered by their steps.
    columns: Csr,
    /// For each equation, the step that eliminates it.
    step: Vec<u32>,
}

/// Number of right-hand sides that are solved together: one cache line of numbers for each step.
const LANES: usize = 8;

/// Numbers of N right-hand sides by step, most of them zero; a bit set marks the steps with nonzeros.
struct SparseFactors<const N: usize> {
    values: Vec<[f64; N]>,
    bits: Vec<u64>,
}

impl<const N: usize> SparseFactors<N> {
    fn new(length: usize) -> Self {
        Self { values: vec![[0.0; N]; length], bits: vec![0; length.div_ceil(64)] }
    }

    #[inline]
    fn add(&mut self, k: usize, values: [f64; N]) {
        self.values[k].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        self.bits[k / 64] |= 1 << (k % 64);
    }

    /// Subtracts `factor` times the values.
    #[inline]
    fn subtract(&mut self, k: usize, factor: f64, values: [f64; N]) {
        self.add(k, values.map(|value| -factor * value));
    }

    /// The largest number of each right-hand side.
    fn largest(&self) -> [f64; N] {
        let mut largest = [0.0_f64; N];
        self.visit(|_, values| largest.iter_mut().zip(values).for_each(|(most, value)| *most = most.max(value.abs())));
        largest
    }

    fn visit(&self, mut visit: impl FnMut(usize, [f64; N])) {
        for (word, &bits) in self.bits.iter().enumerate() {
            let mut bits = bits;
            while bits != 0 {
                let k = 64 * word + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                visit(k, self.values[k]);
            }
        }
    }

    /// Removes the numbers in ascending order of their steps and passes each to `next`, which may add numbers at later steps.
    fn drain_up(&mut self, mut next: impl FnMut(&mut Self, usize, [f64; N])) {
        for word in 0..self.bits.len() {
            while self.bits[word] != 0 {
                let k = 64 * word + self.bits[word].trailing_zeros() as usize;
                self.bits[word] &= self.bits[word] - 1;
                let values = std::mem::replace(&mut self.values[k], [0.0; N]);
                next(self, k, values);
            }
        }
    }

    /// Removes the numbers in descending order of their steps and passes each to `next`, which may add numbers at earlier steps.
    fn drain_down(&mut self, mut next: impl FnMut(&mut Self, usize, [f64; N])) {
        for word in (0..self.bits.len()).rev() {
            while self.bits[word] != 0 {
                let k = 64 * word + 63 - self.bits[word].leading_zeros() as usize;
                self.bits[word] ^= 1 << (k % 64);
                let values = std::mem::replace(&mut self.values[k], [0.0; N]);
                next(self, k, values);
            }
        }
    }
}

/// Work arrays for N right-hand sides; empty between solves.
struct SolverWork<const N: usize> {
    right: SparseFactors<N>,
    y: SparseFactors<N>,
    x: SparseFactors<N>,
}

impl<const N: usize> SolverWork<N> {
    fn new(length: usize) -> Self {
        let empty = || SparseFactors::new(length);
        Self { right: empty(), y: empty(), x: empty() }
    }
}

/// A column of T: steps and numbers.
type SolvedColumn = Vec<(usize, f64)>;

/// What a thread needs to solve for groups of [`LANES`] right-hand sides, one after the other or together.
struct GroupWork {
    one: SolverWork<1>,
    together: Option<SolverWork<LANES>>,
    /// Whether the next group is solved together, which gives the same bits.
    share: bool,
}

impl SlaveSolver {
    /// A solver for these factors; `equations` must be those that were factored.
    pub fn new(equations: &Csr, lu: SparseLu) -> Self {
        let r = lu.order.len();
        let mut step = vec![0; r];
        lu.order.iter().zip(0..).for_each(|(&i, k)| step[i as usize] = k);
        let mut place = vec![u32::MAX; equations.cols];
        lu.slaves.iter().zip(0..).for_each(|(&j, k)| place[j as usize] = k);
        let mut rows = Csr::empty(r);
        for &i in &lu.order {
            let of_slaves = equations.row(i as usize).filter(|&(j, _)| place[j] != u32::MAX);
            rows.append(of_slaves.map(|(j, v)| (place[j] as usize, v)));
        }
        Self { columns: rows.transposed(), step, lu }
    }

    /// The slaves, in the order of the columns of the result of [`SlaveSolver::solve`].
    pub fn slaves(&self) -> &[u32] {
        &self.lu.slaves
    }

    /// Row k of the result is the solution for the right-hand side in row k of `right`. The columns of `right` are the equations.
    pub fn solve(&self, right: &Csr) -> Csr {
        let r = self.lu.order.len();
        let work = || GroupWork { one: SolverWork::new(r), together: None, share: false };
        let groups = (0..right.rows().div_ceil(LANES)).into_par_iter();
        let solved: Vec<Vec<SolvedColumn>> = groups.map_init(work, |work, k| self.group(work, right, k)).collect();
        let mut all = Csr::empty(r);
        solved.into_iter().flatten().for_each(|column| all.append(column));
        all
    }

    /// Solves for the k-th group of right-hand sides.
    fn group(&self, work: &mut GroupWork, right: &Csr, k: usize) -> Vec<SolvedColumn> {
        let rows: Vec<usize> = (k * LANES..right.rows().min((k + 1) * LANES)).collect();
        let GroupWork { one, together, share } = work;
        let solved: Vec<SolvedColumn> = if *share {
            self.solved(together.get_or_insert_with(|| SolverWork::new(self.lu.order.len())), right, &rows)
        } else {
            rows.iter().flat_map(|&row| self.solved(one, right, &[row])).collect()
        };
        *share = share_steps(&solved, &mut one.x);
        solved
    }

    /// Solves `C_S x = b` for one dense b (by equation), with a step of refinement; C_S has the columns of the slaves, and x is in their
    /// order.
    pub fn solve_dense(&self, b: &[f64]) -> Vec<f64> {
        let mut rest = vec![0.0; b.len()];
        self.step.iter().zip(b).for_each(|(&step, &b)| rest[step as usize] = b);
        let mut x = self.once(rest.clone());
        for (column, &x) in x.iter().enumerate() {
            self.columns.row(column).for_each(|(equation, v)| rest[equation] -= v * x);
        }
        let correction = self.once(rest);
        x.iter_mut().zip(correction).for_each(|(x, c)| *x += c);
        x
    }

    /// Solves `C_S^T y = f` for one dense f, with a step of refinement. C_S has the columns of the slaves, f is in their order, and y is by
    /// equation.
    pub fn solve_transposed(&self, f: &[f64]) -> Vec<f64> {
        let mut y = self.once_transposed(f.to_vec());
        let left = |k: usize| f[k] - self.columns.row(k).map(|(equation, v)| v * y[equation]).sum::<f64>();
        let correction = self.once_transposed((0..f.len()).map(left).collect());
        y.iter_mut().zip(correction).for_each(|(y, c)| *y += c);
        self.step.iter().map(|&step| y[step as usize]).collect()
    }

    /// Solves with `C_S = U^T L11^T`, the columns of the slaves, once and without refinement: `L11^-T U^-T x`.
    fn once(&self, mut x: Vec<f64>) -> Vec<f64> {
        for k in 0..x.len() {
            x[k] /= self.lu.diagonal[k];
            let value = x[k];
            self.lu.u.row(k).for_each(|(later, v)| x[later] -= v * value);
        }
        for k in (0..x.len()).rev() {
            let value = x[k];
            self.lu.l.row(k).for_each(|(earlier, v)| x[earlier] -= v * value);
        }
        x
    }

    /// Solves with the transpose of `C_S = U^T L11^T`, the columns of the slaves, once and without refinement: `U^-1 L11^-1 y`.
    fn once_transposed(&self, mut y: Vec<f64>) -> Vec<f64> {
        for k in 0..y.len() {
            y[k] -= self.lu.l.row(k).map(|(earlier, v)| v * y[earlier]).sum::<f64>();
        }
        for k in (0..y.len()).rev() {
            let sum: f64 = self.lu.u.row(k).map(|(later, v)| v * y[later]).sum();
            y[k] = (y[k] - sum) / self.lu.diagonal[k];
        }
        y
    }

    /// Number of nonzeros of the factors.
    pub fn nnz(&self) -> usize {
        self.lu.l.nnz() + self.lu.u.nnz() + self.lu.diagonal.len()
    }

    /// The factors of `C_S = U^T L11^T`, the columns of the slaves.
    pub fn lu(&self) -> &SparseLu {
        &self.lu
    }

    /// Solves `C_S x = right` twice for up to N rows of `right`, where C_S has the columns of the slaves: the second solve is for the
    /// residual of the first and corrects x.
    fn solved<const N: usize>(&self, work: &mut SolverWork<N>, right: &Csr, rows: &[usize]) -> Vec<SolvedColumn> {
        for (lane, &row) in rows.iter().enumerate() {
            let of_lane = |v: f64| std::array::from_fn(|k| if k == lane { v } else { 0.0 });
            right.row(row).for_each(|(i, v)| work.right.add(self.step[i] as usize, of_lane(v)));
        }
        self.add_solution(work);
        self.subtract_product(work);
        self.add_solution(work);
        work.right.drain_up(|_, _, _| {});
        // Exact lengths: lists that grow side by side would leave gaps between them.
        let mut lengths = [0; N];
        work.x.visit(|_, values| lengths.iter_mut().zip(values).for_each(|(n, value)| *n += usize::from(value != 0.0)));
        let mut out: Vec<SolvedColumn> = lengths[..rows.len()].iter().map(|&n| Vec::with_capacity(n)).collect();
        work.x.drain_up(|_, k, values| {
            out.iter_mut().zip(values).filter(|(_, value)| *value != 0.0).for_each(|(out, value)| out.push((k, value)));
        });
        out
    }

    /// `x <- x + L11^-T U^-T right` with the factors L11 and U; `right` is not changed.
    fn add_solution<const N: usize>(&self, SolverWork { right, y, x }: &mut SolverWork<N>) {
        let (of_right, of_x) = (right.largest(), x.largest());
        let faded: [f64; N] = std::array::from_fn(|lane| FADED * of_right[lane].max(of_x[lane]));
        let above = |values: [f64; N]| -> Option<[f64; N]> {
            let kept: [f64; N] =
                std::array::from_fn(|lane| if values[lane].abs() > faded[lane] { values[lane] } else { 0.0 });
            kept.iter().any(|value| *value != 0.0).then_some(kept)
        };
        let mut upper = SparseFactors { values: std::mem::take(&mut y.values), bits: std::mem::take(&mut y.bits) };
        let mut lower: Vec<(usize, [f64; N])> = Vec::new();
        right.visit(|k, values| upper.add(k, values));
        upper.drain_up(|upper, k, values| {
            if let Some(values) = above(values) {
                let values = values.map(|value| value / self.lu.diagonal[k]);
                self.lu.u.row(k).for_each(|(later, v)| upper.subtract(later, v, values));
                lower.push((k, values));
            }
        });
        lower.iter().for_each(|&(k, values)| upper.add(k, values));
        upper.drain_down(|rest, k, values| {
            if let Some(values) = above(values) {
                self.lu.l.row(k).for_each(|(earlier, v)| rest.subtract(earlier, v, values));
                x.add(k, values);
            }
        });
        (y.values, y.bits) = (upper.values, upper.bits);
    }

    /// Subtracts `C_S x` from `right`; C_S has the columns of the slaves.
    fn subtract_product<const N: usize>(&self, SolverWork { right, x, .. }: &mut SolverWork<N>) {
        x.visit(|k, values| self.columns.row(k).for_each(|(equation, v)| right.subtract(equation, v, values)));
    }
}

/// Whether columns have so many steps in common that it pays to solve for them together. Alone, each costs its own steps; together, a step
/// of any of them costs about two.
fn share_steps(columns: &[SolvedColumn], empty: &mut SparseFactors<1>) -> bool {
    columns.iter().flatten().for_each(|&(k, _)| empty.add(k, [0.0]));
    let mut union = 0;
    empty.drain_up(|_, _, _| union += 1);
    2 * union < columns.iter().map(Vec::len).sum::<usize>()
}

#[cfg(test)]
mod tests;
