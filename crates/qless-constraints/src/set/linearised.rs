//! `G du = -c`: the set linearised at u, as linear equations for `qless`.
//!
//! A row of G is written without terms if all of its entries are within their rounding errors. Otherwise the analysis would scale this
//! noise to one, and count the row as independent. Which rows these are depends on the configuration, so [`ConstraintSet::vanishing`]
//! reports them for one configuration.

use std::fmt;

use qless::{ArgumentError, ConstraintSystem, SystemBuilder};

use crate::set::error::LineariseError;
use crate::set::evaluation::Evaluation;
use crate::set::rounding::Rounding;
use crate::set::{ConstraintSet, long};

/// An equation whose row of G is indistinguishable from zero at this configuration.
///
/// To first order, no motion changes its value. Examples: a rotation vector with `|theta| = 2 pi` cannot reach rotations about axes
/// perpendicular to it, and a rod whose ends coincide has no direction. The equation may be needed at other configurations.
#[derive(Clone, Debug, PartialEq)]
pub struct Vanishing {
    /// Row of the equation.
    pub row: usize,
    /// Label of the equation.
    pub label: String,
    /// The largest magnitude of a computed entry of the equation's row of G.
    pub entry: f64,
    /// The largest bound on the rounding error of an entry of this row; at least `entry`.
    pub rounding: f64,
    /// The value of c, which no step changes to first order.
    pub value: f64,
    /// Whether the equation is linear, so that it has no terms at any configuration.
    pub everywhere: bool,
}

impl fmt::Display for Vanishing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { label, entry, rounding, value, .. } = self;
        if self.everywhere {
            return write!(f, "\"{label}\" has no terms: they cancel; its value is {value:e}");
        }
        write!(
            f,
            "\"{label}\" has no effect at this configuration: the largest entry of its row of G, {entry:e}, is rounding"
        )?;
        write!(f, " (up to {rounding:e}); its value is {value:e}; at other configurations it may be needed")
    }
}

impl ConstraintSet {
    /// The linearised equations `G du = -c` with the labels of the set; `prescribed` are increments `(DOF, du)`.
    ///
    /// Entries within their rounding errors are left out. A row without other entries has no terms, and its right-hand side is zero if c is
    /// within its rounding error too; [`ConstraintSet::vanishing`] reports such rows. The configuration is that of the last evaluation.
    ///
    /// ```
    /// use qless::{Options, analyse};
    /// use qless_constraints::ConstraintSet;
    /// use qless_constraints::types::Equal;
    /// let mut builder = ConstraintSet::builder(3);
    /// for (label, dofs) in [("ab", [0, 1]), ("bc", [1, 2]), ("ca", [2, 0])] {
    ///     builder.add(label, Equal::new(dofs))?;
    /// }
    /// let set = builder.build()?;
    /// let system = set.linearised_at(&[0.0; 3], &[])?;
    /// assert_eq!(system.equation_label(2), "ca");
    /// assert_eq!(analyse(&system, &Options::default())?.rank(), 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`LineariseError`]: the evaluation belongs to another set, a number of c or G is not finite, or a prescribed DOF is not valid.
    pub fn linearised(
        &self,
        evaluation: &Evaluation,
        prescribed: &[(usize, f64)],
    ) -> Result<ConstraintSystem, LineariseError> {
        self.current(evaluation)?;
        let rounding = self.rounding_of_nonlinear(evaluation)?;
        self.system(&vec![1.0; self.dofs], evaluation, rounding.as_ref(), prescribed)
    }

    /// Evaluates at u, and linearises there: for a single configuration.
    ///
    /// # Errors
    /// As [`ConstraintSet::linearised`], and if `u` does not have length n.
    pub fn linearised_at(&self, u: &[f64], prescribed: &[(usize, f64)]) -> Result<ConstraintSystem, LineariseError> {
        let mut evaluation = self.allocate();
        self.evaluate(u, &mut evaluation)?;
        self.linearised(&evaluation, prescribed)
    }

    /// `sum_j G_rj s_j y_j = -c_r` for `du_j = s_j y_j`: [`ConstraintSet::linearised`] with the columns scaled by `units`, at least n
    /// numbers `s_j`. Prescribed increments are those of y. `rounding` must be [`ConstraintSet::rounding`] at the u of the evaluation;
    /// bounds of another u are not detected.
    ///
    /// # Errors
    /// As [`ConstraintSet::linearised`], and if `units` is shorter than n, or `rounding` belongs to another set.
    pub fn linearised_in(
        &self,
        units: &[f64],
        evaluation: &Evaluation,
        rounding: &Rounding,
        prescribed: &[(usize, f64)],
    ) -> Result<ConstraintSystem, LineariseError> {
        self.current(evaluation)?;
        long("the list of units", units.len().min(self.dofs), self.dofs)?;
        long("the bounds on rounding of c", rounding.c().len(), self.equations())?;
        long("the bounds on rounding of G", rounding.g().len(), evaluation.g.values().len())?;
        self.system(units, evaluation, Some(rounding), prescribed)
    }

    fn system(
        &self,
        units: &[f64],
        evaluation: &Evaluation,
        rounding: Option<&Rounding>,
        prescribed: &[(usize, f64)],
    ) -> Result<ConstraintSystem, LineariseError> {
        let mut builder = SystemBuilder::new(self.dofs);
        for row in 0..self.equations() {
            let not_finite = |value| Err(LineariseError::NotFinite { row, label: self.label(row)?, value });
            if let Some(value) = evaluation.not_finite(row) {
                return not_finite(value);
            }
            let (terms, rhs) = evaluation.linear_equation(row, rounding);
            let terms = terms.map(|(j, v)| (j, v * units[j]));
            if let Some(value) = terms.clone().map(|(_, v)| v).find(|v| !v.is_finite()) {
                return not_finite(value);
            }
            builder.labelled_equation(self.label(row)?, terms, rhs);
        }
        prescribed.iter().for_each(|&(dof, increment)| builder.prescribe(dof, increment));
        Ok(builder.build()?)
    }

    /// The equations whose rows of G are indistinguishable from zero at the configuration of the evaluation, ascending.
    ///
    /// These are the rows that [`ConstraintSet::linearised`] writes without terms.
    ///
    /// ```
    /// use qless::{Options, analyse};
    /// use qless_constraints::{ConstraintSet, types::{Body, Revolute}};
    /// let arm = Body::with_vector([0, 1, 2], [0.0; 3], [3, 4, 5]);
    /// let mut builder = ConstraintSet::builder(6);
    /// builder.add("door", Revolute { a: Body::ground(), b: arm, at: [0.0; 3], axis: [0.0, 0.0, 1.0] })?;
    /// let set = builder.build()?;
    /// let mut evaluation = set.allocate();
    /// // After a full turn, a rotation vector reaches rotations about its own axis only.
    /// set.evaluate(&[0.0, 0.0, 0.0, 0.0, 0.0, std::f64::consts::TAU], &mut evaluation)?;
    /// let vanishing = set.vanishing(&evaluation)?;
    /// assert_eq!((vanishing.len(), vanishing[0].label.as_str()), (2, "door, tilt 1"));
    /// assert_eq!(analyse(&set.linearised(&evaluation, &[])?, &Options::default())?.rank(), 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] if the evaluation belongs to another set, or is out of date.
    pub fn vanishing(&self, evaluation: &Evaluation) -> Result<Vec<Vanishing>, ArgumentError> {
        self.current(evaluation)?;
        let rounding = self.rounding(&evaluation.u)?;
        let rows = (0..self.equations()).filter(|&row| evaluation.vanishes(row, &rounding));
        rows.map(|row| self.report(row, evaluation, &rounding)).collect()
    }

    /// Bounds on rounding errors; `None` if all equations are linear. Bounds are not needed then: the coefficients of linear equations are
    /// inputs, so that a nonzero row cannot vanish.
    pub(super) fn rounding_of_nonlinear(&self, evaluation: &Evaluation) -> Result<Option<Rounding>, ArgumentError> {
        if self.linear.rows() == self.equations() { Ok(None) } else { self.rounding(&evaluation.u).map(Some) }
    }

    fn report(&self, row: usize, evaluation: &Evaluation, rounding: &Rounding) -> Result<Vanishing, ArgumentError> {
        let entry = evaluation.g.row(row).map(|(_, v)| v.abs()).fold(0.0, f64::max);
        let value = evaluation.c[row];
        let rounding = rounding.of_row(row).iter().copied().fold(0.0, f64::max);
        Ok(Vanishing { row, label: self.label(row)?, entry, rounding, value, everywhere: self.is_linear(row) })
    }
}

/// Whether a finite number is within its rounding error.
fn is_rounding(value: f64, bound: f64) -> bool {
    value.is_finite() && value.abs() <= bound
}

impl Evaluation {
    /// A number that is not finite in this row of c or G. Call this before the rounding bounds are used: they may be infinite for such a
    /// row, so that the row would seem to be rounding.
    pub(super) fn not_finite(&self, row: usize) -> Option<f64> {
        let numbers = std::iter::once(self.c[row]).chain(self.g.row(row).map(|(_, v)| v));
        numbers.into_iter().find(|value| !value.is_finite())
    }

    /// The terms of a row of G that exceed their rounding errors, and the right-hand side -c, or 0 if the row vanishes and c is rounding.
    ///
    /// If all terms were kept, an entry of 1e-159 would make a column look as if it were in another unit.
    pub(super) fn linear_equation<'a>(
        &'a self,
        row: usize,
        rounding: Option<&'a Rounding>,
    ) -> (impl Iterator<Item = (usize, f64)> + Clone + 'a, f64) {
        let bounds = rounding.map_or(&[][..], |rounding| rounding.of_row(row)).iter().copied();
        let terms = self.g.row(row).zip(bounds.chain(std::iter::repeat(-1.0)));
        let vanishing = rounding.filter(|rounding| self.vanishes(row, rounding));
        // An infinite bound says nothing, so it removes no entry from a row with significant entries.
        let real = move |&((_, v), bound): &((_, f64), f64)| {
            vanishing.is_none() && !(is_rounding(v, bound) && bound.is_finite())
        };
        let c = self.c[row];
        let is_nothing = vanishing.is_some_and(|rounding| is_rounding(c, rounding.c()[row]));
        (terms.filter(real).map(|(term, _)| term), if is_nothing { 0.0 } else { -c })
    }

    /// Whether all entries of a row of G are within their rounding errors.
    fn vanishes(&self, row: usize, rounding: &Rounding) -> bool {
        self.g.row(row).zip(rounding.of_row(row)).all(|((_, v), &bound)| is_rounding(v, bound))
    }
}
