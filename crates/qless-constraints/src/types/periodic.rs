//! `u_b - u_a = E (X_b - X_a)`: a pair of nodes on opposite faces of a periodic cell under a macroscopic strain E.

use crate::geometry::node::{AXES, Node};
use crate::{Constraint, Store};

/// The macroscopic displacement gradient E, D x D, dimensionless.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MacroStrain<const D: usize> {
    /// Given numbers.
    Given([[f64; D]; D]),
    /// DOFs of their own, 0-based: unknown, or driven by other constraints.
    Dofs([[usize; D]; D]),
}

/// A periodic pair, D equations.
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{MacroStrain, Periodic, PlanarPoint}};
/// let left = PlanarPoint::new([0, 1], [0.0, 0.5]);
/// let right = PlanarPoint::new([2, 3], [2.0, 0.5]);
/// let strain = MacroStrain::Given([[0.01, 0.0], [0.0, 0.0]]);
/// let mut builder = ConstraintSet::builder(4);
/// builder.add("pair", Periodic { a: left, b: right, strain })?;
/// let set = builder.build()?;
/// let mut quantities = set.allocate();
/// set.evaluate(&[0.0, 0.0, 0.02, 0.0], &mut quantities)?;
/// assert_eq!(quantities.c(), [0.0, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periodic<const D: usize> {
    /// The node on one face.
    pub a: Node<D>,
    /// Its image on the opposite face.
    pub b: Node<D>,
    /// E.
    pub strain: MacroStrain<D>,
}

/// What can be wrong with a periodic pair.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PeriodicError {
    /// Both nodes are in one place.
    #[error("the two nodes are in one place; a node and its image lie on opposite faces")]
    OnePlace,
}

impl<const D: usize> Constraint for Periodic<D> {
    const NAME: &'static str = "periodic pair";
    type Error = PeriodicError;

    fn process(self, store: &mut Store) -> Result<(), PeriodicError> {
        let step: [f64; D] = std::array::from_fn(|k| self.b.at[k] - self.a.at[k]);
        if step == [0.0; D] {
            return Err(PeriodicError::OnePlace);
        }
        for axis in 0..D {
            let pair = [(self.b.dofs[axis], 1.0), (self.a.dofs[axis], -1.0)];
            match self.strain {
                MacroStrain::Given(e) => {
                    store.equation(AXES[axis], pair, (0..D).map(|k| e[axis][k] * step[k]).sum());
                }
                MacroStrain::Dofs(e) => {
                    let strain = (0..D).filter(|&k| step[k] != 0.0).map(|k| (e[axis][k], -step[k]));
                    store.equation(AXES[axis], pair.into_iter().chain(strain), 0.0);
                }
            }
        }
        Ok(())
    }
}
