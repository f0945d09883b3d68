//! Bounds on the rounding errors of c and G at a configuration, by running error analysis.
//!
//! [`crate::Nonlinear::value`] is evaluated in dual numbers whose components carry error bounds, so that the size of every term counts even
//! if terms cancel later. DOFs, parameters and coordinates are assumed known to one unit in the last place. Since `x = at + u`, the
//! uncertainty of the reference coordinate `at` is added to that of the DOF u. Cost: about ten evaluations.

use qless::ArgumentError;

use crate::equations::dof_uses::UncertainDofs;
use crate::equations::nonlinear::NonlinearBatch;
use crate::equations::tasks::{run_tasks, value_tasks};
use crate::scalar::Bounded;
use crate::set::{ConstraintSet, long};

/// Bounds on the rounding errors of c and G at one configuration, in the units of c and G; infinite if there is no bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounding {
    c: Vec<f64>,
    g: Vec<f64>,
    start: Vec<usize>,
}

impl Rounding {
    /// Bound on the error of each constraint value, length m.
    pub fn c(&self) -> &[f64] {
        &self.c
    }

    /// Bounds on the errors of G, in the order of `Evaluation::g().values()`.
    pub fn g(&self) -> &[f64] {
        &self.g
    }

    /// The bounds on row `r` of G, in the order of its columns; empty if there is no row `r`.
    ///
    /// A row of G is indistinguishable from zero if none of its entries exceeds its bound.
    pub fn of_row(&self, r: usize) -> &[f64] {
        if r < self.c.len() { &self.g[self.start[r]..self.start[r + 1]] } else { &[] }
    }
}

impl ConstraintSet {
    /// Bounds on the rounding errors of `c(u)` and `G(u)`, from the magnitudes of their terms.
    ///
    /// `c_r` is indistinguishable from zero if `|c_r|` is at most `rounding.c()[r]`, and a row of G if all its entries are at most
    /// `rounding.of_row(r)`.
    ///
    /// ```
    /// use qless_constraints::ConstraintSet;
    /// use qless_constraints::types::{Distance, PlanarPoint};
    /// // A rod of a millimetre, 1000 km from the origin: one unit in the last place of a coordinate is 1e-10.
    /// let a = PlanarPoint::new([0, 1], [1e6, 0.0]);
    /// let b = PlanarPoint::new([2, 3], [1e6 + 1e-3, 0.0]);
    /// let mut builder = ConstraintSet::builder(4);
    /// builder.add("rod", Distance::new(a, b))?;
    /// let rounding = builder.build()?.rounding(&[0.0; 4])?;
    /// assert!(rounding.c()[0] > 1e-10 && rounding.c()[0] < 1e-8);
    /// // Its direction is known to some six digits.
    /// assert!(rounding.of_row(0)[2] > 1e-7 && rounding.of_row(0)[2] < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] if `u` does not have length n.
    pub fn rounding(&self, u: &[f64]) -> Result<Rounding, ArgumentError> {
        long("u", u.len(), self.dofs)?;
        let (mut c, mut g) = (vec![0.0; self.equations()], self.whole_pattern());
        let constant = self.linear.col.len();
        g.values_mut()[..constant].iter_mut().for_each(|a| *a = Bounded::from(*a).error);
        let known = &UncertainDofs { u, uses: &self.dof_uses };
        let of_linear = |rows, c: &mut [f64]| self.linear.rounding(rows, u, c);
        let of_items =
            |batch: &dyn NonlinearBatch, items, c: &mut [f64], g: &mut [f64]| batch.rounding(items, known, c, g);
        run_tasks(value_tasks((&self.linear, &self.nonlinear.batches), (&mut c, &mut g), of_linear, of_items));
        Ok(Rounding { c, start: g.starts().to_vec(), g: g.values().to_vec() })
    }
}

impl ConstraintSet {
    /// `max(|u_j|, |x_j|)` for each DOF j, n numbers in the unit of that DOF. `|x_j|` is the largest magnitude of a coordinate of the node
    /// that DOF j displaces. For a DOF of a rotation, `x_j` is 1. If [`ConstraintSet::moves_node`] is false, `x_j` is 0.
    ///
    /// # Errors
    /// [`ArgumentError`] if u does not have length n.
    pub fn extents(&self, u: &[f64]) -> Result<Vec<f64>, ArgumentError> {
        long("u", u.len(), self.dofs)?;
        let size = |(j, u): (usize, &f64)| u.abs().max(self.dof_uses.sizes(j).map_or(0.0, |[_, node]| node));
        Ok(u.iter().enumerate().map(size).collect())
    }

    /// Whether an active constraint states that this DOF is added to a reference coordinate ([`crate::EquationSink::coordinate`]), or that
    /// it belongs to a rotation. The position of a body does not count as a reference coordinate. False if `dof` is not below the number
    /// of DOFs.
    pub fn moves_node(&self, dof: usize) -> bool {
        self.dof_uses.sizes(dof).is_some()
    }
}
