//! A connected part of K and C together, by itself: its free DOFs and its equations, and nothing of any other part.
//!
//! ```text
//! K' = K / 4^k    C_r' = C_r / 2^r    u' = u / 2^t    lambda_r' = lambda_r 2^r / (4^k 2^t)
//! ```
//!
//! Prescribed DOFs are on the right-hand side, `f - K u_p` and `b - C u_p`. The powers put the numbers of the part around one, so that
//! no product of them leaves the range of doubles where K, C and u do not; they change no digit.
//! Cost: one copy of K and C.

mod powers;
mod split;

use qless::ConstraintSystem;

use super::matrix::Matrix;
use super::method::Method;
use super::problem::Solution;

use powers::times_power;
pub use split::Split;

/// One part, in numbers of its own.
pub struct Part<'a> {
    /// What it is part of.
    whole: &'a ConstraintSystem,
    /// Its free DOFs and its equations as the caller counts them, ascending.
    pub dofs: Vec<usize>,
    pub rows: Vec<usize>,
    pub k: Matrix,
    pub symmetric: bool,
    /// C; its right-hand sides are elsewhere.
    pub system: ConstraintSystem,
    /// `f - K u_p`, then `b - C u_p`, and the sizes of their terms.
    pub rhs: (Vec<f64>, Vec<f64>),
    /// How each equation is enforced.
    pub methods: Vec<Method>,
    /// The powers of two that were divided out: of K, of each equation, of u.
    stiffness: i32,
    equations: Vec<i32>,
    size: i32,
}

impl Part<'_> {
    /// What a row is to the caller.
    pub fn name(&self, row: usize) -> String {
        match row.checked_sub(self.dofs.len()) {
            None => format!("the forces on DOF {}", self.dofs[row]),
            Some(row) => self.whole.equation_label(self.rows[row]),
        }
    }

    /// u, lambda and `-C^T lambda` of the part in the numbers of the caller. Forces are made here: lambda alone may leave the range of doubles.
    pub fn place(&self, x: &[f64], solution: &mut Solution) {
        let (of_dofs, of_rows) = x.split_at(self.dofs.len());
        self.dofs.iter().zip(of_dofs).for_each(|(&j, x)| solution.u[j] = times_power(*x, self.size));
        let force = self.stiffness + self.size;
        for ((&row, x), power) in self.rows.iter().zip(of_rows).zip(&self.equations) {
            solution.multipliers[row] = times_power(*x, force - power);
            let terms = self.whole.matrix().row(row).map(|(j, v)| (j, times_power(v, -power) * x));
            terms.for_each(|(j, v)| solution.forces[j] -= times_power(v, force));
        }
    }
}
