//! `u_i = u_0`: DOFs that move together.

use crate::set::repeated;
use crate::{Constraint, Store};

/// Equal DOFs: `u_i - u_0 = 0` for every DOF after the first.
///
/// One equation less than there are DOFs, and as many removed. Rank is lost where two such lists share more than one DOF.
///
#[doc = include_str!("../../docs/pictures/equal.svg")]
///
#[doc = include_str!("../../docs/types/equal.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::Equal};
/// let mut builder = ConstraintSet::builder(4);
/// builder.add("floor", Equal::new([3, 0, 1]))?;
/// let set = builder.build()?;
/// assert_eq!((set.equations(), set.label(1)?), (2, "floor, DOF 1".to_owned()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Equal {
    /// The DOFs, 0-based.
    pub dofs: Vec<usize>,
}

/// What can be wrong with equal DOFs.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EqualError {
    /// Fewer than two DOFs.
    #[error("{found} DOF named; at least two are needed for them to be equal")]
    TooFew {
        /// How many there are.
        found: usize,
    },
    /// A DOF stands in the list twice.
    #[error("DOF {dof} stands in the list twice; a DOF is always equal to itself")]
    Repeated {
        /// The DOF, 0-based.
        dof: usize,
    },
}

impl Equal {
    /// These DOFs are equal.
    pub fn new(dofs: impl Into<Vec<usize>>) -> Self {
        Self { dofs: dofs.into() }
    }
}

impl Constraint for Equal {
    const NAME: &'static str = "equal DOFs";
    type Error = EqualError;

    fn process(self, store: &mut Store) -> Result<(), EqualError> {
        let [first, others @ ..] = self.dofs.as_slice() else { return Err(EqualError::TooFew { found: 0 }) };
        if others.is_empty() {
            return Err(EqualError::TooFew { found: 1 });
        }
        if let Some(dof) = repeated(&self.dofs) {
            return Err(EqualError::Repeated { dof });
        }
        let single = others.len() == 1;
        for &dof in others {
            let part = if single { String::new() } else { format!("DOF {dof}") };
            store.equation(part, [(dof, 1.0), (*first, -1.0)], 0.0);
        }
        Ok(())
    }
}
