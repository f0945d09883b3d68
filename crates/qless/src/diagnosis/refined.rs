//! Solutions of the kept equations with twice the digits of doubles, by corrections (iterative refinement).
//!
//! ```text
//! r = b - C X    in sums of two doubles, over the kept equations
//! C D = r        with the factors of the analysis, in doubles; masters and prescribed DOFs of D are zero
//! X + D          in sums of two doubles, until r is rounding of 32 digits
//! ```
//!
//! A correction divides the error by at least `d` / 2e-16, where d is the distance of the kept equations from dependence. It costs
//! O(nnz of the factors). Blocks must be in the units in which they were factored.

use super::certificate::History;
use super::distance::KeptRows;
use crate::common::two_sum;
use crate::factor::backend::many::Slab;
use crate::input::numbering::LocalSystem;
use crate::input::scale::ldexp;
use crate::presolve::basis::Basis;

/// The largest number of corrections. Right-hand sides that span 32 digits need five if d > 1e-9; the sixth pass finds that nothing is
/// left.
const CORRECTIONS: usize = 6;
/// A remainder up to this fraction of the largest term of an equation is rounding: a sum of two doubles has 106 bits, and adding a thousand
/// such numbers loses 10 of them.
const DONE: f64 = f64::EPSILON * f64::EPSILON * 256.0;

/// W solutions by DOF; each number is a sum of two doubles.
pub(crate) struct Solutions<const W: usize> {
    high: Slab<W>,
    low: Slab<W>,
    /// The last correction, zero where the solution has converged.
    pub last: Slab<W>,
}

/// Factors that solve the kept equations.
pub(crate) trait SolveKept {
    /// The equations, the basis of the kept ones, and how the elimination found it.
    fn parts(&self) -> (LocalSystem<'_>, &Basis, &History);

    /// The solution `X` of `C X = left` over the kept equations, in doubles. Masters and prescribed DOFs are zero. The slaves of peeled
    /// equations may be left at zero.
    fn correction<const W: usize>(&self, left: impl Fn(usize) -> [f64; W]) -> Slab<W>;

    /// Solves for the given right-hand sides of each equation, with all masters zero and prescribed DOFs as in `start`. Peeled equations
    /// need not hold: they are in no certificate.
    fn solve<const W: usize>(&self, start: Slab<W>, sides: impl Fn(usize) -> [f64; W]) -> Solutions<W> {
        let (system, basis, history) = self.parts();
        let mut solutions =
            Solutions { low: vec![[0.0; W]; start.len()], last: vec![[0.0; W]; start.len()], high: start };
        for _ in 0..CORRECTIONS {
            // A remainder that is only rounding counts as zero, so that corrections for one component do not change the last bits of
            // another.
            let rest = |(left, size): (f64, f64)| if left.abs() <= DONE * size { 0.0 } else { left };
            let left = |i: usize| solutions.left(system, i, sides(i)).map(rest);
            if not_peeled(basis, history).all(|i| left(i) == [0.0; W]) {
                solutions.last.fill([0.0; W]);
                break;
            }
            solutions.add(self.correction(left));
        }
        solutions
    }
}

/// The kept equations that were not peeled.
fn not_peeled<'a>(basis: &'a Basis, history: &'a History) -> impl Iterator<Item = usize> + 'a {
    let of_blocks = basis.blocks.iter().flat_map(|block| &block.rows);
    history.steps.iter().chain(of_blocks).map(|&i| history.rows[i as usize] as usize)
}

impl KeptRows<'_> {
    /// Solves the peeled equations too, and returns the solutions in doubles.
    pub fn complete<const W: usize>(&self, mut solution: Solutions<W>, sides: impl Fn(usize) -> [f64; W]) -> Slab<W> {
        for (t, &row) in self.basis.peeled.iter().enumerate().rev() {
            let (row, slave) = (row as usize, self.basis.slave(t));
            let pivot = self.system.coefficient(row, slave);
            // The first quotient is rounded to a double. The second one, of the new remainder, adds the digits that the rounding has lost.
            for _ in 0..2 {
                let quotient = solution.left(self.system, row, sides(row)).map(|(left, _)| left / pivot);
                solution.add_to(slave as usize, quotient);
            }
        }
        solution.high
    }
}

impl SolveKept for KeptRows<'_> {
    fn parts(&self) -> (LocalSystem<'_>, &Basis, &History) {
        (self.system, self.basis, self.history)
    }

    fn correction<const W: usize>(&self, left: impl Fn(usize) -> [f64; W]) -> Slab<W> {
        let Self { basis, history, blocks, triangles, .. } = *self;
        let mut steps: Slab<W> = Vec::with_capacity(history.steps.len());
        let after = |row: u32, steps: &Slab<W>| {
            let name = history.rows[row as usize] as usize;
            let mut own = left(name).map(|v| ldexp(v, self.scaling.row[name]));
            for &(step, factor) in &history.factors[row as usize] {
                own.iter_mut().zip(&steps[step as usize]).for_each(|(own, step)| *own -= factor * step);
            }
            own
        };
        for &row in &history.steps {
            steps.push(after(row, &steps));
        }
        let mut x = vec![[0.0; W]; self.system.dofs()];
        for (block, triangle) in blocks.iter().zip(triangles) {
            let side = |&k: &usize| after(block.rows[k], &steps).map(|v| ldexp(v, block.exponents[k]));
            let sides = triangle.rows.iter().map(side).collect();
            for ((&j, &unit), found) in block.dofs.iter().zip(&block.units).zip(triangle.first_shortest(block, &sides))
            {
                x[j as usize] = found.map(|v| ldexp(v, unit + self.scaling.col(j as usize)));
            }
        }
        let first = basis.peeled.len();
        for (step, side) in steps.iter().enumerate().rev() {
            let (slave, pivot) = (basis.slave(first + step) as usize, basis.pivot_of_step(step));
            let mut sum = side.map(|v| ldexp(v / pivot, self.scaling.col(slave)));
            for (j, v) in basis.row(self.system, first + step).entries() {
                sum.iter_mut().zip(&x[j as usize]).for_each(|(sum, x)| *sum += v * x);
            }
            x[slave] = sum;
        }
        x
    }
}

impl<const W: usize> Solutions<W> {
    /// The product `C_k X` of equation k and the solutions X, in doubles.
    pub fn product(&self, system: LocalSystem, k: usize) -> [f64; W] {
        product(system, k, &self.high)
    }

    /// The remainder `sides - C_i X` of equation i for the solutions X, and the largest term of each difference.
    pub fn left(&self, system: LocalSystem, i: usize, sides: [f64; W]) -> [(f64, f64); W] {
        let (mut sums, mut errors, mut sizes) = (sides, [0.0; W], sides.map(f64::abs));
        for (j, v) in system.row(i) {
            for c in 0..W {
                let part = v * self.high[j][c];
                let (sum, error) = two_sum(sums[c], -part);
                sums[c] = sum;
                errors[c] += error - v.mul_add(self.high[j][c], -part) - v * self.low[j][c];
                sizes[c] = sizes[c].max(part.abs());
            }
        }
        std::array::from_fn(|c| (sums[c] + errors[c], sizes[c]))
    }

    fn add(&mut self, step: Slab<W>) {
        step.iter().enumerate().for_each(|(j, &numbers)| self.add_to(j, numbers));
        self.last = step;
    }

    fn add_to(&mut self, j: usize, numbers: [f64; W]) {
        for (c, number) in numbers.into_iter().enumerate() {
            let (sum, error) = two_sum(self.high[j][c], number);
            (self.high[j][c], self.low[j][c]) = two_sum(sum, error + self.low[j][c]);
        }
    }
}

/// The product `C_k X` of equation k and the solutions X, in doubles.
pub(super) fn product<const W: usize>(system: LocalSystem, k: usize, x: &Slab<W>) -> [f64; W] {
    let mut sum = [0.0; W];
    system.row(k).for_each(|(j, v)| sum.iter_mut().zip(&x[j]).for_each(|(sum, x)| *sum += v * x));
    sum
}
