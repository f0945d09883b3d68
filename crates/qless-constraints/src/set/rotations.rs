//! Keeps rotation vectors below half a turn: `theta - 2 pi k theta / |theta|` is the same rotation.
//!
//! The derivative `d(R s)/d theta` of a rotated vector loses rank if `|theta|` is a nonzero multiple of 2 pi. To stay away from there, a
//! vector longer than pi is replaced by its complement, as proposed by Cardona and Géradin (A beam finite element non-linear theory with
//! finite rotations, 1988).

use std::collections::{BTreeMap, HashMap};
use std::f64::consts::{PI, TAU};

use qless::ArgumentError;

use crate::equations::dof_uses::NO_DOF;
use crate::set::{ConstraintSet, long};

impl ConstraintSet {
    /// The DOFs of rotation vectors that may be replaced by another vector of the same rotation, ascending. Cost: O(nonzeros of G).
    ///
    /// A vector is excluded if one of its DOFs occurs in a linear equation, or in a nonlinear one of a constraint that does not state the
    /// rotation ([`crate::EquationSink::rotation`]): the value of such an equation would change.
    pub fn rotation_vectors(&self) -> Vec<[usize; 3]> {
        let vectors = self.dof_uses.rotations().filter(|dofs| dofs[3] == NO_DOF);
        let mut known: BTreeMap<u32, ([u32; 3], bool)> = BTreeMap::new();
        vectors.for_each(|[x, y, z, _]| _ = known.insert(x, ([x, y, z], true)));
        let first: HashMap<u32, u32> = known.values().flat_map(|&(dofs, _)| dofs.map(|dof| (dof, dofs[0]))).collect();
        let mut tie = |dof: u32| {
            let vector = first.get(&dof).and_then(|first| known.get_mut(first));
            vector.into_iter().for_each(|(_, loose)| *loose = false);
        };
        self.linear.col.iter().for_each(|&dof| tie(dof));
        for batch in self.nonlinear.batches.iter().filter(|_| !first.is_empty()) {
            for i in 0..batch.items() {
                let values = batch.dofs_of(i).iter().filter(|dof| first.contains_key(dof));
                let constraint = batch.owner(i).constraint;
                values.filter(|&&dof| !self.dof_uses.states_rotation(constraint, dof)).for_each(|&dof| tie(dof));
            }
        }
        known.into_values().filter(|(_, loose)| *loose).map(|(dofs, _)| dofs.map(|dof| dof as usize)).collect()
    }

    /// Replaces rotation vectors longer than pi by the shortest vectors of the same rotation. Returns how many were replaced.
    ///
    /// Values of c change by rounding only; G and H become those at the new DOFs. Only [`ConstraintSet::rotation_vectors`] are replaced.
    /// The caller must know whether anything outside the set, such as forces or prescribed values, depends on these DOFs.
    ///
    /// ```
    /// use qless_constraints::{ConstraintSet, types::{Body, Fixed}};
    /// let mut builder = ConstraintSet::builder(6);
    /// builder.add("weld", Fixed { a: Body::ground(), b: Body::with_vector([0, 1, 2], [0.0; 3], [3, 4, 5]), at: [0.0; 3] })?;
    /// let set = builder.build()?;
    /// let mut u = [0.0, 0.0, 0.0, 5.0, 0.0, 0.0];
    /// assert_eq!(set.shorten_rotations(&mut u)?, 1);
    /// assert!((u[3] - (5.0 - std::f64::consts::TAU)).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] if `u` does not have length n.
    pub fn shorten_rotations(&self, u: &mut [f64]) -> Result<usize, ArgumentError> {
        long("u", u.len(), self.dofs)?;
        Ok(self.rotation_vectors().iter().filter(|vector| shorten_rotation(u, **vector)).count())
    }
}

/// `theta <- theta (1 - 2 pi k / |theta|)` with k the nearest whole number of `|theta| / 2 pi`, if `|theta| > pi`: the same rotation by the
/// shortest rotation vector, in radians.
///
/// `vector` names the three entries theta of u. Returns whether they changed; they do not if an entry is outside of u or not finite.
///
/// ```
/// let mut u = [0.0, 5.0, 0.0];
/// assert!(qless_constraints::shorten_rotation(&mut u, [0, 1, 2]));
/// assert!((u[1] - (5.0 - std::f64::consts::TAU)).abs() < 1e-15);
/// assert!(!qless_constraints::shorten_rotation(&mut u, [0, 1, 3]));
/// ```
pub fn shorten_rotation(u: &mut [f64], vector: [usize; 3]) -> bool {
    if vector.iter().any(|&dof| dof >= u.len()) {
        return false;
    }
    let length = vector.iter().fold(0.0, |sum: f64, &dof| sum.hypot(u[dof]));
    let long = length > PI && length.is_finite();
    if long {
        let factor = 1.0 - TAU * (length / TAU).round() / length;
        vector.iter().for_each(|&dof| u[dof] *= factor);
    }
    long
}
