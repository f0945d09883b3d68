//! `sum_j a_j u_j = b(t)`: a motion that is prescribed as a function of time.

use std::sync::Arc;

use crate::{Constraint, Store};

/// A linear equation `sum_j a_j u_j = b(t)`; with the one term `(j, 1)` a DOF that is prescribed in time.
///
/// a has the unit that makes `a_j u_j` one of b; t is what [`crate::ConstraintSet::set_time`] is given, 0 before.
///
#[doc = include_str!("../../docs/pictures/driven.svg")]
///
#[doc = include_str!("../../docs/types/driven.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::Driven};
/// let mut builder = ConstraintSet::builder(1);
/// builder.add("crank", Driven::new([(0, 1.0)], |t| (2.0 * t).sin()))?;
/// let mut set = builder.build()?;
/// let mut quantities = set.allocate();
/// set.set_time(0.5)?;
/// set.evaluate(&[0.0], &mut quantities)?;
/// assert_eq!(quantities.c(), [-1_f64.sin()]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Driven {
    /// `(DOF, a_j)`; terms on the same DOF are summed.
    pub terms: Vec<(usize, f64)>,
    /// `b(t)`.
    pub rhs: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
}

impl std::fmt::Debug for Driven {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Driven").field("terms", &self.terms).finish_non_exhaustive()
    }
}

/// What can be wrong with a driven equation.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DrivenError {
    /// It has no terms.
    #[error("the equation has no terms; give at least one DOF and its coefficient")]
    NoTerms,
}

impl Driven {
    /// `sum_j a_j u_j = b(t)`.
    pub fn new(
        terms: impl IntoIterator<Item = (usize, f64)>,
        rhs: impl Fn(f64) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self { terms: terms.into_iter().collect(), rhs: Arc::new(rhs) }
    }
}

impl Constraint for Driven {
    const NAME: &'static str = "driven equation";
    type Error = DrivenError;

    fn process(self, store: &mut Store) -> Result<(), DrivenError> {
        if self.terms.is_empty() {
            return Err(DrivenError::NoTerms);
        }
        store.equation_in_time("", self.terms, move |time| (self.rhs)(time));
        Ok(())
    }
}
