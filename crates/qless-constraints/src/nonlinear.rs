//! NONLINEAR

use crate::scalar::{Dual, HyperDual, Scalar};

/// The stored parameters of nonlinear equations that share n DOFs: `c(u) = 0`, one row per part.
///
/// `u` are the values of the constraint's own DOFs, in the order of its list. Only [`Nonlinear::value`] is required:
/// without more, derivatives are taken by dual numbers, exact to rounding.
pub trait Nonlinear: Send + Sync + Sized + 'static {
    /// How many DOFs each constraint of the type has, or 0 if that varies. A fixed number makes faster loops.
    const DOFS: usize = 0;
    /// Whether c is a polynomial of degree two: then [`Nonlinear::hessian`] does not depend on u, and is given none.
    /// With one equation and [`Nonlinear::NUMBERS`] it is called once, for a weight of 1, and its multiples are taken from then on.
    const QUADRATIC: bool = false;
    /// Which number of [`Nonlinear::hessian`] each pair takes, repeated over all pairs; empty if each pair has its own.
    ///
    /// Where few numbers make many entries, `[0, 1, 0]` for `v, -v, v, v, -v, v`, only these are written.
    const NUMBERS: &'static [usize] = &[];
    /// Whether [`Nonlinear::pairs`] depends on the number of DOFs alone: then one constraint is asked for all that have as many.
    const SAME_PAIRS: bool = false;
    /// Whether parameters are functions of time: then [`Nonlinear::at_time`] is called, else it is not.
    const DRIVEN: bool = false;
    /// A name for each equation, such as "x"; a single equation has an empty one.
    const PARTS: &'static [&'static str];

    /// `c`, length of `PARTS`.
    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]);

    /// Takes the parameters of this time; the DOFs and [`Nonlinear::pairs`] stay what they are.
    ///
    /// Called when the constraint is added or activated, with the time of the set (0 at first), and by
    /// [`crate::ConstraintSet::set_time`].
    ///
    /// # Errors
    /// What a function of time gives where that is not finite. The set then stays where it was, and takes the parameters of that time again.
    fn at_time(&mut self, _time: f64) -> Result<(), f64> {
        Ok(())
    }

    /// The angle, in radians, that the parameters prescribe and that c knows only up to whole turns.
    ///
    /// From one time to the next c can be followed over less than half a turn of it; [`crate::equilibrium::drive`] takes shorter steps.
    fn angle(&self) -> Option<f64> {
        None
    }

    /// Calls `found(k)` for each rotation vector in the local DOFs k, k + 1, k + 2 of which c uses the rotation and nothing else: it may be replaced by
    /// another vector of the same rotation ([`crate::ConstraintSet::shorten_rotations`]).
    fn rotation_vectors(&self, _found: &mut dyn FnMut(usize)) {}

    /// Calls `pair(j, k)`, `j >= k`, once for each pair of local DOFs for which some `d^2 c / du_j du_k` is not zero.
    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        (0..dofs).for_each(|j| (0..=j).for_each(|k| pair(j, k)));
    }

    /// `c`, and `dc_r / du_j` at `g[r * n + j]`; every number is written.
    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        jacobian(self, u, c, g);
    }

    /// The same in any numbers: with bounds on their rounding, if u has them ([`crate::ConstraintSet::rounding`]).
    ///
    /// By dual numbers that costs as many evaluations of c as there are DOFs; a type whose c is a sum over many pieces adds up derivatives of
    /// the pieces instead.
    fn jacobian_in<S: Scalar>(&self, u: &[S], c: &mut [S], g: &mut [S]) {
        jacobian(self, u, c, g);
    }

    /// `sum_r w_r d^2 c_r / du_j du_k`, one number per pair, in the order of [`Nonlinear::pairs`], or as
    /// [`Nonlinear::NUMBERS`] says; every number is written.
    fn hessian(&self, u: &[f64], w: &[f64], h: &mut [f64]) {
        hessian(self, u, w, h);
    }

    /// How many constraints [`Nonlinear::values_and_jacobians`] and [`Nonlinear::second_derivatives`] take at once, at most.
    ///
    /// A type that costs much arithmetic can do the same operations for several constraints in the same instructions; it then has
    /// both functions of its own, as those given here take one constraint.
    const AT_ONCE: usize = 1;

    /// [`Nonlinear::value_and_jacobian`] of several constraints, `u`, `c` and `g` one after the other.
    #[inline]
    fn values_and_jacobians(items: &[Self], u: &[f64], c: &mut [f64], g: &mut [f64]) {
        debug_assert_eq!(items.len(), 1);
        items[0].value_and_jacobian(u, c, g);
    }

    /// [`Nonlinear::hessian`] of several constraints, `u`, `w` and `h` one after the other.
    fn second_derivatives(items: &[Self], u: &[f64], w: &[f64], h: &mut [f64]) {
        debug_assert_eq!(items.len(), 1);
        items[0].hessian(u, w, h);
    }

    /// Which number the pair takes that [`Nonlinear::pairs`] names at this place.
    #[doc(hidden)]
    fn number(pair: usize) -> usize {
        if Self::NUMBERS.is_empty() { pair } else { Self::NUMBERS[pair % Self::NUMBERS.len()] }
    }
}

/// Directions per evaluation: enough to use the width of the machine, few enough to stay in registers.
const WIDTH: usize = 8;
/// Equations, and DOFs, that fit on the stack.
const ROWS: usize = 8;
const DOFS: usize = 32;

/// `c`, and `dc_r / du_j` at `g[r * n + j]`, in any numbers: with bounds, if u has them.
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

/// `sum_r w_r d^2 c_r / du_j du_k` for each pair.
pub fn hessian<Q: Nonlinear>(q: &Q, u: &[f64], w: &[f64], h: &mut [f64]) {
    with_scratch(HyperDual::from(0.0), u.len(), w.len(), |x, value| {
        (0..u.len()).for_each(|j| x[j] = HyperDual::from(u[j]));
        let mut slot = h.iter_mut();
        q.pairs(u.len(), &mut |j, k| {
            (x[j].first, x[k].second) = (1.0, 1.0);
            q.value(x, value);
            (x[j].first, x[k].second) = (0.0, 0.0);
            if let Some(slot) = slot.next() {
                *slot = value.iter().zip(w).map(|(c, w)| w * c.mixed).sum();
            }
        });
    });
}

/// Room for the DOFs and the equations, on the stack where they are few.
fn with_scratch<S: Copy>(zero: S, dofs: usize, rows: usize, work: impl FnOnce(&mut [S], &mut [S])) {
    if dofs <= DOFS && rows <= ROWS {
        work(&mut [zero; DOFS][..dofs], &mut [zero; ROWS][..rows]);
    } else {
        work(&mut vec![zero; dofs], &mut vec![zero; rows]);
    }
}
