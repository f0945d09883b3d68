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

/// Numbers by step, most of them zero; a bit set marks the nonzeros.
struct SparseFactors {
    values: Vec<f64>,
    bits: Vec<u64>,
}

impl SparseFactors {
    fn new(length: usize) -> Self {
        Self { values: vec![0.0; length], bits: vec![0; length.div_ceil(64)] }
    }

    #[inline]
    fn add(&mut self, k: usize, value: f64) {
        self.values[k] += value;
        self.bits[k / 64] |= 1 << (k % 64);
    }

    fn largest(&self) -> f64 {
        let mut largest = 0.0_f64;
        self.visit(|_, value| largest = largest.max(value.abs()));
        largest
    }

    fn visit(&self, mut visit: impl FnMut(usize, f64)) {
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
    fn drain_up(&mut self, mut next: impl FnMut(&mut Self, usize, f64)) {
        for word in 0..self.bits.len() {
            while self.bits[word] != 0 {
                let k = 64 * word + self.bits[word].trailing_zeros() as usize;
                self.bits[word] &= self.bits[word] - 1;
                let value = std::mem::take(&mut self.values[k]);
                next(self, k, value);
            }
        }
    }

    /// Removes the numbers in descending order of their steps and passes each to `next`, which may add numbers at earlier steps.
    fn drain_down(&mut self, mut next: impl FnMut(&mut Self, usize, f64)) {
        for word in (0..self.bits.len()).rev() {
            while self.bits[word] != 0 {
                let k = 64 * word + 63 - self.bits[word].leading_zeros() as usize;
                self.bits[word] ^= 1 << (k % 64);
                let value = std::mem::take(&mut self.values[k]);
                next(self, k, value);
            }
        }
    }
}

/// Work arrays of one thread; empty between columns.
struct SolverWork {
    right: SparseFactors,
    y: SparseFactors,
    x: SparseFactors,
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
        let empty = || SparseFactors::new(r);
        let work = || SolverWork { right: empty(), y: empty(), x: empty() };
        let column = |work: &mut SolverWork, k: usize| {
            right.row(k).for_each(|(i, v)| work.right.add(self.step[i] as usize, v));
            self.column(work)
        };
        let solved: Vec<Vec<(usize, f64)>> = (0..right.rows()).into_par_iter().map_init(work, column).collect();
        let mut all = Csr::empty(r);
        solved.into_iter().for_each(|column| all.append(column));
        all
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

    /// Solves `C_S x = right` twice, where C_S has the columns of the slaves: the second solve is for the residual of the first and
    /// corrects x.
    fn column(&self, work: &mut SolverWork) -> Vec<(usize, f64)> {
        self.add_solution(work);
        self.subtract_product(work);
        self.add_solution(work);
        work.right.drain_up(|_, _, _| {});
        let mut out = Vec::new();
        work.x.drain_up(|_, k, value| out.extend((value != 0.0).then_some((k, value))));
        out
    }

    /// `x <- x + L11^-T U^-T right` with the factors L11 and U; `right` is not changed.
    fn add_solution(&self, SolverWork { right, y, x }: &mut SolverWork) {
        let faded = FADED * right.largest().max(x.largest());
        let mut upper = SparseFactors { values: std::mem::take(&mut y.values), bits: std::mem::take(&mut y.bits) };
        let mut lower: Vec<(usize, f64)> = Vec::new();
        right.visit(|k, value| upper.add(k, value));
        upper.drain_up(|upper, k, value| {
            if value.abs() > faded {
                let value = value / self.lu.diagonal[k];
                self.lu.u.row(k).for_each(|(later, v)| upper.add(later, -v * value));
                lower.push((k, value));
            }
        });
        lower.iter().for_each(|&(k, value)| upper.add(k, value));
        upper.drain_down(|rest, k, value| {
            if value.abs() > faded {
                self.lu.l.row(k).for_each(|(earlier, v)| rest.add(earlier, -v * value));
                x.add(k, value);
            }
        });
        (y.values, y.bits) = (upper.values, upper.bits);
    }

    /// Subtracts `C_S x` from `right`; C_S has the columns of the slaves.
    fn subtract_product(&self, SolverWork { right, x, .. }: &mut SolverWork) {
        x.visit(|k, value| self.columns.row(k).for_each(|(equation, v)| right.add(equation, -v * value)));
    }
}
