//! `u_j = v`: fixed and prescribed DOFs as equations, so that they take part in the diagnosis.

use crate::{Constraint, Store};

/// DOFs with given values, `u_j = v_j`; fixed where the value is zero.
///
#[doc = include_str!("../../docs/pictures/prescribed.svg")]
///
#[doc = include_str!("../../docs/types/prescribed.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::Prescribed};
/// let mut builder = ConstraintSet::builder(4);
/// builder.add("clamp", Prescribed::fixed([0, 1]))?;
/// builder.add("push", Prescribed { values: vec![(3, 0.1)] })?;
/// assert_eq!(builder.build()?.equations(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Prescribed {
    /// `(DOF, value)`.
    pub values: Vec<(usize, f64)>,
}

/// What can be wrong with prescribed DOFs.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PrescribedError {
    /// No DOF is named.
    #[error("no DOF is named; give at least one")]
    NoDofs,
    /// A DOF has two values.
    #[error("DOF {dof} is prescribed as {first} and as {second}; take one of them out")]
    TwoValues {
        /// The DOF, 0-based.
        dof: usize,
        /// One value.
        first: f64,
        /// The other.
        second: f64,
    },
}

impl Prescribed {
    /// DOFs that do not move.
    pub fn fixed(dofs: impl IntoIterator<Item = usize>) -> Self {
        Self { values: dofs.into_iter().map(|dof| (dof, 0.0)).collect() }
    }
}

impl Constraint for Prescribed {
    const NAME: &'static str = "prescribed DOF";
    type Error = PrescribedError;

    fn process(mut self, store: &mut Store) -> Result<(), PrescribedError> {
        if self.values.is_empty() {
            return Err(PrescribedError::NoDofs);
        }
        self.values.sort_by_key(|&(dof, _)| dof);
        let differ = |pair: &&[(usize, f64)]| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1;
        if let Some(pair) = self.values.windows(2).find(differ) {
            return Err(PrescribedError::TwoValues { dof: pair[0].0, first: pair[0].1, second: pair[1].1 });
        }
        self.values.dedup_by_key(|&mut (dof, _)| dof);
        let single = self.values.len() == 1;
        for (dof, value) in self.values {
            let part = if single { String::new() } else { format!("DOF {dof}") };
            store.equation(part, [(dof, 1.0)], value);
        }
        Ok(())
    }
}
