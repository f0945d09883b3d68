//! `G du = -c`: the set linearised at u, as linear equations for `qless`.
//!
//! A row of G that is nothing but rounding is written without terms: scaled to one, its noise would be taken for a rank. Which rows
//! these are belongs to the configuration and not to the model: [`ConstraintSet::vanishing`] says it of one.

use std::fmt;

use qless::{ArgumentError, ConstraintSystem, SystemBuilder};

use crate::set::ConstraintSet;
use crate::set::error::LineariseError;
use crate::set::evaluation::Quantities;
use crate::set::rounding::Rounding;

/// An equation whose row of G is nothing but rounding at this configuration.
///
/// To first order no motion changes it: at `|theta| = 2 pi` no rotation vector reaches a turn about an axis across it, and a rod
/// whose ends meet has no direction. At other configurations it may well be needed.
#[derive(Clone, Debug, PartialEq)]
pub struct Vanishing {
    /// The equation.
    pub row: usize,
    /// Its label.
    pub label: String,
    /// The largest entry of its row that was computed.
    pub entry: f64,
    /// What the rounding of its terms can make of a zero there: not less than the entry.
    pub rounding: f64,
    /// c, which no step to first order changes.
    pub value: f64,
    /// Whether the equation is linear: then it has no terms at any configuration.
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
            "\"{label}\" says nothing at this configuration: the largest entry of its row of G, {entry:e}, is rounding"
        )?;
        write!(f, " (up to {rounding:e}); its value is {value:e}; elsewhere it may be needed")
    }
}

impl ConstraintSet {
    /// The linearised equations `G du = -c` with the labels of the set; `prescribed` are increments `(DOF, du)`.
    ///
    /// Entries that are no more than their rounding at this configuration are left out; rows of nothing else have no terms, and a right-hand side of zero where c is rounding too;
    /// [`ConstraintSet::vanishing`] says which. The configuration is that of the last evaluation.
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
    /// let mut quantities = set.allocate();
    /// set.evaluate(&[0.0; 3], &mut quantities)?;
    /// let system = set.linearised(&quantities, &[])?;
    /// assert_eq!(system.equation_label(2), "ca");
    /// assert_eq!(analyse(&system, &Options::default())?.rank(), 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`LineariseError`] for quantities of another set, if an entry of G or c is not finite at this u, or a prescribed DOF is not valid.
    pub fn linearised(
        &self,
        quantities: &Quantities,
        prescribed: &[(usize, f64)],
    ) -> Result<ConstraintSystem, LineariseError> {
        self.linearised_in(&vec![1.0; self.dofs], quantities, prescribed)
    }

    /// The same with columns in the given units, `G_rj s_j`: `du_j = s_j y_j`.
    pub(crate) fn linearised_in(
        &self,
        units: &[f64],
        quantities: &Quantities,
        prescribed: &[(usize, f64)],
    ) -> Result<ConstraintSystem, LineariseError> {
        self.current(quantities)?;
        let rounding = self.rounding_of_nonlinear(quantities)?;
        let mut builder = SystemBuilder::new(self.dofs);
        for row in 0..self.equations() {
            let not_finite = |value| Err(LineariseError::NotFinite { row, label: self.label(row)?, value });
            if let Some(value) = quantities.not_finite(row) {
                return not_finite(value);
            }
            let (terms, rhs) = quantities.linear_equation(row, rounding.as_ref());
            let terms = terms.map(|(j, v)| (j, v * units[j]));
            if let Some(value) = terms.clone().map(|(_, v)| v).find(|v| !v.is_finite()) {
                return not_finite(value);
            }
            builder.labelled_equation(self.label(row)?, terms, rhs);
        }
        prescribed.iter().for_each(|&(dof, increment)| builder.prescribe(dof, increment));
        Ok(builder.build()?)
    }

    /// The equations whose rows of G are nothing but rounding at the configuration of the quantities, ascending.
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
    /// let mut quantities = set.allocate();
    /// // After one turn, a rotation vector reaches no turn but the one along itself.
    /// set.evaluate(&[0.0, 0.0, 0.0, 0.0, 0.0, std::f64::consts::TAU], &mut quantities)?;
    /// let vanishing = set.vanishing(&quantities)?;
    /// assert_eq!((vanishing.len(), vanishing[0].label.as_str()), (2, "door, tilt 1"));
    /// assert_eq!(analyse(&set.linearised(&quantities, &[])?, &Options::default())?.rank(), 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] for quantities of another set, or of the set before it changed.
    pub fn vanishing(&self, quantities: &Quantities) -> Result<Vec<Vanishing>, ArgumentError> {
        self.current(quantities)?;
        let rounding = self.rounding(&quantities.u)?;
        let rows = (0..self.equations()).filter(|&row| quantities.vanishes(row, &rounding));
        rows.map(|row| self.report(row, quantities, &rounding)).collect()
    }

    /// The bounds, where a row may vanish that is not zero: that of a linear equation does not.
    pub(super) fn rounding_of_nonlinear(&self, quantities: &Quantities) -> Result<Option<Rounding>, ArgumentError> {
        if self.linear.rows() == self.equations() { Ok(None) } else { self.rounding(&quantities.u).map(Some) }
    }

    fn report(&self, row: usize, quantities: &Quantities, rounding: &Rounding) -> Result<Vanishing, ArgumentError> {
        let entry = quantities.g.row(row).map(|(_, v)| v.abs()).fold(0.0, f64::max);
        let value = quantities.c[row];
        let rounding = rounding.of_row(row).iter().copied().fold(0.0, f64::max);
        Ok(Vanishing { row, label: self.label(row)?, entry, rounding, value, everywhere: self.is_linear(row) })
    }
}

/// Whether a number is no more than its rounding; what is not finite is no rounding.
fn is_rounding(value: f64, bound: f64) -> bool {
    value.is_finite() && value.abs() <= bound
}

impl Quantities {
    /// A number of c or of the row of G that is not finite, before bounds on rounding, which are then infinite, hide it.
    pub(super) fn not_finite(&self, row: usize) -> Option<f64> {
        let numbers = std::iter::once(self.c[row]).chain(self.g.row(row).map(|(_, v)| v));
        numbers.into_iter().find(|value| !value.is_finite())
    }

    /// The entries of a row of G that are more than rounding, and -c, zero if all of these are: an entry of 1e-159 would make a column look as if
    /// it were in another unit.
    pub(super) fn linear_equation<'a>(
        &'a self,
        row: usize,
        rounding: Option<&'a Rounding>,
    ) -> (impl Iterator<Item = (usize, f64)> + Clone + 'a, f64) {
        let bounds = rounding.map_or(&[][..], |rounding| rounding.of_row(row)).iter().copied();
        let terms = self.g.row(row).zip(bounds.chain(std::iter::repeat(-1.0)));
        let vanishing = rounding.filter(|rounding| self.vanishes(row, rounding));
        // An infinite bound knows nothing: it takes no entry out of a row in which others stand.
        let real = move |&((_, v), bound): &((_, f64), f64)| {
            vanishing.is_none() && !(is_rounding(v, bound) && bound.is_finite())
        };
        let c = self.c[row];
        let is_nothing = vanishing.is_some_and(|rounding| is_rounding(c, rounding.c()[row]));
        (terms.filter(real).map(|(term, _)| term), if is_nothing { 0.0 } else { -c })
    }

    /// Whether no entry of a row of G is more than rounding.
    fn vanishes(&self, row: usize, rounding: &Rounding) -> bool {
        self.g.row(row).zip(rounding.of_row(row)).all(|((_, v), &bound)| is_rounding(v, bound))
    }
}
