//! `sum_j a_j u_j = b` (Eq. 2): the equation that a user writes.

use crate::{Constraint, Store};

/// A linear equation `sum_j a_j u_j = b`; terms on the same DOF are summed.
///
#[doc = include_str!("../../docs/pictures/linear_equation.svg")]
///
#[doc = include_str!("../../docs/types/linear_equation.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::LinearEquation};
/// let mut builder = ConstraintSet::builder(2);
/// builder.add("lever", LinearEquation { terms: vec![(0, 1.0), (1, -2.0)], rhs: 3.0 })?;
/// let set = builder.build()?;
/// let mut quantities = set.allocate();
/// set.evaluate(&[5.0, 0.5], &mut quantities)?;
/// assert_eq!(quantities.c(), [1.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LinearEquation {
    /// `(DOF, a_j)`.
    pub terms: Vec<(usize, f64)>,
    /// b.
    pub rhs: f64,
}

/// What can be wrong with a linear equation.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinearEquationError {
    /// It has no terms.
    #[error("the equation has no terms; give at least one DOF and its coefficient")]
    NoTerms,
}

impl Constraint for LinearEquation {
    const NAME: &'static str = "linear equation";
    type Error = LinearEquationError;

    fn process(self, store: &mut Store) -> Result<(), LinearEquationError> {
        if self.terms.is_empty() {
            return Err(LinearEquationError::NoTerms);
        }
        store.equation("", self.terms, self.rhs);
        Ok(())
    }
}
