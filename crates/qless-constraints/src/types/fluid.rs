//! `n . (u_s - u_f) = 0`: structure and fluid keep in touch and slide freely.

use crate::scalar::vector::{Vector, unit};
use crate::{Constraint, Store};

/// The normal displacements of a structure and a fluid in displacement form are equal: `n . (u_s - u_f) = 0`, a length.
///
/// DOFs removed: one. Two normals at one pair of nodes, as at an edge, are independent if they are not parallel; a fourth is redundant.
/// For a fluid in pressure form, whose mesh need not match, see [`crate::types::FluidWall`].
///
#[doc = include_str!("../../docs/pictures/fluid_normal.svg")]
///
#[doc = include_str!("../../docs/types/fluid_normal.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::FluidNormal};
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("wall", FluidNormal { structure: [0, 1, 2], fluid: [3, 4, 5], normal: [3.0, 4.0, 0.0] })?;
/// let g = builder.build()?.allocate().g().clone();
/// assert_eq!(g.row(0).collect::<Vec<_>>(), [(0, 0.6), (1, 0.8), (3, -0.6), (4, -0.8)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluidNormal {
    /// Translations of the structure, 0-based DOFs.
    pub structure: [usize; 3],
    /// Translations of the fluid.
    pub fluid: [usize; 3],
    /// n, of any length.
    pub normal: Vector<f64>,
}

/// What can be wrong with a coupling of normal displacements.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FluidNormalError {
    /// The normal has no direction.
    #[error("the normal has no direction; give a vector that is not zero")]
    Normal,
}

impl Constraint for FluidNormal {
    const NAME: &'static str = "structure and fluid";
    type Error = FluidNormalError;

    fn process(self, store: &mut Store) -> Result<(), FluidNormalError> {
        let n = unit(self.normal).ok_or(FluidNormalError::Normal)?;
        let side = |dofs: [usize; 3], sign: f64| (0..3).map(move |k| (dofs[k], sign * n[k]));
        let terms = side(self.structure, 1.0).chain(side(self.fluid, -1.0));
        store.equation("", terms.filter(|&(_, v)| v != 0.0), 0.0);
        Ok(())
    }
}
