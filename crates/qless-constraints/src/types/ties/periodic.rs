//! `u_b - u_a = E (X_b - X_a)`: nodes on opposite faces of a periodic cell, under a macroscopic gradient E.

use crate::geometry::node::{Node, field};
use crate::{Constraint, EquationSink};

/// The macroscopic gradient E of F fields in D dimensions, an F x D matrix. Its unit is that of the field divided by a
/// length, so it is dimensionless for displacements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MacroStrain<const D: usize, const F: usize = D> {
    /// Prescribed entries of E.
    Given([[f64; D]; F]),
    /// The DOFs of the entries of E, 0-based. They are unknowns, or other constraints determine them.
    Dofs([[usize; D]; F]),
}

/// A periodic pair of nodes a and b, `u_b - u_a = E (X_b - X_a)`, with the macroscopic gradient E.
///
#[doc = include_str!("../../../docs/pictures/periodic.svg")]
///
#[doc = include_str!("../../../docs/types/periodic.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{MacroStrain, Periodic, PlanarPoint}};
/// let left = PlanarPoint::new([0, 1], [0.0, 0.5]);
/// let right = PlanarPoint::new([2, 3], [2.0, 0.5]);
/// let strain = MacroStrain::Given([[0.01, 0.0], [0.0, 0.0]]);
/// let mut builder = ConstraintSet::builder(4);
/// builder.add("pair", Periodic { a: left, b: right, strain })?;
/// let set = builder.build()?;
/// let mut evaluation = set.allocate();
/// set.evaluate(&[0.0, 0.0, 0.02, 0.0], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [0.0, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A temperature that falls by a given amount across the cell:
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{MacroStrain, Node, Periodic}};
/// let [a, b] = [(0, 0.0), (1, 0.5)].map(|(dof, x)| Node::of_field(dof, [x, 0.0, 1.0]));
/// let mut builder = ConstraintSet::builder(2);
/// builder.add("pair", Periodic { a, b, strain: MacroStrain::Given([[-20.0, 0.0, 0.0]]) })?;
/// let set = builder.build()?;
/// let mut evaluation = set.allocate();
/// set.evaluate(&[35.0, 25.0], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periodic<const D: usize, const F: usize = D> {
    /// The node on one face.
    pub a: Node<D, F>,
    /// The image of node a on the opposite face.
    pub b: Node<D, F>,
    /// The macroscopic gradient E.
    pub strain: MacroStrain<D, F>,
}

/// What can be wrong with a periodic pair.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PeriodicError {
    /// Both nodes are at the same place.
    #[error("the two nodes coincide; a node and its image lie on opposite faces")]
    OnePlace,
}

impl<const D: usize, const F: usize> Constraint for Periodic<D, F> {
    const NAME: &'static str = "periodic pair";
    type Error = PeriodicError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), PeriodicError> {
        let step: [f64; D] = std::array::from_fn(|j| self.b.at[j] - self.a.at[j]);
        if step == [0.0; D] {
            return Err(PeriodicError::OnePlace);
        }
        for k in 0..F {
            let pair = [(self.b.dofs[k], 1.0), (self.a.dofs[k], -1.0)];
            match self.strain {
                MacroStrain::Given(e) => {
                    sink.equation(field::<D, F>(k), pair, (0..D).map(|j| e[k][j] * step[j]).sum());
                }
                MacroStrain::Dofs(e) => {
                    let strain = (0..D).filter(|&j| step[j] != 0.0).map(|j| (e[k][j], -step[j]));
                    sink.equation(field::<D, F>(k), pair.into_iter().chain(strain), 0.0);
                }
            }
        }
        Ok(())
    }
}
