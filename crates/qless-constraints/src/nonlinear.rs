//! Nonlinear constraint equations, `c(u) = 0`, and their derivatives by dual numbers.

use crate::scalar::{Dual, Scalar};

/// The parameters of nonlinear equations `c(u) = 0` that share n DOFs, one row per name in [`Nonlinear::EQUATION_NAMES`].
///
/// `u` holds the values of the constraint's own DOFs, in the order of its list. Only [`Nonlinear::value`] is required: by default,
/// derivatives are computed with dual numbers, exact to rounding.
pub trait Nonlinear: Send + Sync + Sized + 'static {
    /// Number of DOFs of each constraint of the type, or 0 if it varies. A fixed number makes loops faster.
    const DOFS: usize = 0;
    /// For each pair of DOFs, in the order of [`Nonlinear::pairs`], the index of its value in the output of [`Nonlinear::hessian`]. A list
    /// that is shorter than the list of pairs is repeated. If it is empty, each pair has a value of its own.
    ///
    /// This saves work if many pairs share few values. With the output `v, -v`, the list `[0, 1, 0]` gives six pairs the values
    /// `v, -v, v, v, -v, v`.
    const NUMBERS: &'static [usize] = &[];
    /// Whether parameters are functions of time. [`Nonlinear::at_time`] is called only then.
    const DRIVEN: bool = false;
    /// A name for each equation, such as "x"; a single equation has an empty name.
    const EQUATION_NAMES: &'static [&'static str];

    /// Writes `c`, which has the length of `EQUATION_NAMES`.
    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]);

    /// Evaluates the parameters at this time. The DOFs and [`Nonlinear::pairs`] must not change.
    ///
    /// It is called when the constraint is added or activated, with the time of the set (0 at first), and by
    /// [`crate::ConstraintSet::set_time`].
    ///
    /// # Errors
    /// A value of a function of time, if it is not finite. If the constraint is active, the set then keeps its old time, and calls
    /// `at_time` again with that time.
    fn at_time(&mut self, _time: f64) -> Result<(), f64> {
        Ok(())
    }

    /// The prescribed angle in radians, if c determines it only up to multiples of 2 pi.
    ///
    /// One time step must change this angle by less than pi, since c does not count whole turns; `qless_solve::equilibrium::drive` limits
    /// its steps for this.
    fn angle(&self) -> Option<f64> {
        None
    }

    /// Calls `pair(j, k)`, `j >= k`, once for each pair of local DOFs for which some `d^2 c / du_j du_k` is not zero. The default calls it
    /// for all pairs.
    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        (0..dofs).for_each(|j| (0..=j).for_each(|k| pair(j, k)));
    }

    /// Writes all of `c`, and `dc_r / du_j` at `g[r * n + j]`, where n is the number of DOFs.
    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        jacobian(self, u, c, g);
    }

    /// Like [`Nonlinear::value_and_jacobian`], for any scalar type. If u has error bounds, c and g have them too
    /// ([`crate::ConstraintSet::rounding`]).
    ///
    /// The default uses dual numbers, and evaluates c once for every few DOFs. For speed, a type whose c is a sum of many terms should
    /// override it, and sum the derivatives of its terms.
    fn jacobian_in<S: Scalar>(&self, u: &[S], c: &mut [S], g: &mut [S]) {
        jacobian(self, u, c, g);
    }

    /// Writes `sum_r w_r d^2 c_r / du_j du_k` for each pair of DOFs, in the order of [`Nonlinear::pairs`], or at the index that
    /// [`Nonlinear::NUMBERS`] gives.
    fn hessian(&self, u: &[f64], w: &[f64], h: &mut [f64]) {
        hessian(self, u, w, h);
    }

    /// Index of a pair's value in the output of [`Nonlinear::hessian`]; `pair` is the pair's place in the order of [`Nonlinear::pairs`].
    #[doc(hidden)]
    fn number(pair: usize) -> usize {
        if Self::NUMBERS.is_empty() { pair } else { Self::NUMBERS[pair % Self::NUMBERS.len()] }
    }
}

/// Number of DOFs in which one evaluation with dual numbers differentiates: enough to fill vector instructions, few enough to stay in
/// registers.
const WIDTH: usize = 8;
/// Largest numbers of equations and of DOFs for which scratch memory is on the stack.
const ROWS: usize = 8;
const DOFS: usize = 32;

/// Writes `c`, and `dc_r / du_j` at `g[r * n + j]` for n DOFs, by dual numbers over any scalar type.
pub fn jacobian<Q: Nonlinear, S: Scalar>(q: &Q, u: &[S], c: &mut [S], g: &mut [S]) {
    let zero = Dual::<WIDTH, S>::from(0.0);
    with_scratch(zero, u.len(), c.len(), |x, value| {
        for first in (0..u.len()).step_by(WIDTH) {
            (0..u.len()).for_each(|j| x[j] = Dual::variable(u[j], j.wrapping_sub(first)));
            q.value(x, value);
            for j in first..u.len().min(first + WIDTH) {
                (0..c.len()).for_each(|r| g[r * u.len() + j] = value[r].slope[j - first]);
            }
        }
        (0..c.len()).for_each(|r| c[r] = value[r].real);
    });
}

/// Writes `sum_r w_r d^2 c_r / du_j du_k` for each pair of DOFs, with dual numbers whose components are dual numbers.
pub fn hessian<Q: Nonlinear>(q: &Q, u: &[f64], w: &[f64], h: &mut [f64]) {
    with_scratch(Dual::<1, Dual<1>>::from(0.0), u.len(), w.len(), |x, value| {
        (0..u.len()).for_each(|j| x[j] = Dual::from(u[j]));
        let mut slot = h.iter_mut();
        q.pairs(u.len(), &mut |j, k| {
            (x[j].real.slope[0], x[k].slope[0].real) = (1.0, 1.0);
            q.value(x, value);
            (x[j].real.slope[0], x[k].slope[0].real) = (0.0, 0.0);
            if let Some(slot) = slot.next() {
                *slot = value.iter().zip(w).map(|(c, w)| w * c.slope[0].slope[0]).sum();
            }
        });
    });
}

/// Calls `work` with scratch memory for the DOFs and the equations.
fn with_scratch<S: Copy>(zero: S, dofs: usize, rows: usize, work: impl FnOnce(&mut [S], &mut [S])) {
    if dofs <= DOFS && rows <= ROWS {
        work(&mut [zero; DOFS][..dofs], &mut [zero; ROWS][..rows]);
    } else {
        work(&mut vec![zero; dofs], &mut vec![zero; rows]);
    }
}
