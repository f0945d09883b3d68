//! Keeps rotation vectors below half a turn: `theta - 2 pi k theta / |theta|` is the same rotation.
//!
//! `d(R s)/d theta` loses rank if `|theta|` is a nonzero multiple of 2 pi. To stay away from there, a vector longer than pi is replaced by its
//! complement, as proposed by Cardona and Géradin (A beam finite element non-linear theory with finite rotations, 1988).

use std::f64::consts::{PI, TAU};

use qless::ArgumentError;

use crate::set::{ConstraintSet, long};

impl ConstraintSet {
    /// The DOFs of rotation vectors that may be replaced by another vector of the same rotation, in the order of first use. O(nonzeros of G).
    ///
    /// All constraints on these DOFs must use the rotation only. A vector is excluded if one of its DOFs occurs in a linear equation, or if a
    /// constraint uses the DOFs in another order.
    pub fn rotation_vectors(&self) -> Vec<[usize; 3]> {
        let mut found = RotationVectors { owner: vec![DofUse::Nobody; self.dofs], vectors: Vec::new() };
        let each = |visit: &mut dyn FnMut(&[u32], &[usize])| {
            self.nonlinear.batches.iter().for_each(|batch| batch.rotation_vectors(visit));
        };
        each(&mut |dofs, places| {
            places.iter().for_each(|&k| found.put([dofs[k], dofs[k + 1], dofs[k + 2]].map(|dof| dof as usize)));
        });
        if found.vectors.is_empty() {
            return Vec::new();
        }
        each(&mut |dofs, places| {
            let others = (0..dofs.len()).filter(|j| !places.iter().any(|k| (*k..k + 3).contains(j)));
            others.for_each(|j| found.tie(dofs[j] as usize));
        });
        self.linear.col.iter().for_each(|&dof| found.tie(dof as usize));
        found.vectors.iter().filter(|vector| found.owner[vector[0]] != DofUse::Tied).copied().collect()
    }

    /// Replaces rotation vectors longer than pi by the shortest vectors of the same rotation. Returns how many were replaced.
    ///
    /// Values of c change by rounding only; G and H become those at the new DOFs. Only [`ConstraintSet::rotation_vectors`] are replaced. The
    /// caller must know whether anything outside the set, such as forces or prescribed values, depends on these DOFs.
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

/// How a DOF is used.
#[derive(Clone, Copy, PartialEq)]
enum DofUse {
    Nobody,
    /// By the vector with this index.
    Vector(usize),
    /// By an equation that needs its value.
    Tied,
}

/// Rotation vectors found so far, and the use of each DOF.
struct RotationVectors {
    owner: Vec<DofUse>,
    vectors: Vec<[usize; 3]>,
}

impl RotationVectors {
    fn put(&mut self, vector: [usize; 3]) {
        let owners = vector.map(|dof| self.owner[dof]);
        if owners == [DofUse::Nobody; 3] {
            vector.iter().for_each(|&dof| self.owner[dof] = DofUse::Vector(self.vectors.len()));
            self.vectors.push(vector);
            return;
        }
        let same = matches!(owners[0], DofUse::Vector(k) if self.vectors[k] == vector && owners == [owners[0]; 3]);
        if !same {
            vector.iter().for_each(|&dof| self.tie(dof));
            vector.iter().for_each(|&dof| self.owner[dof] = DofUse::Tied);
        }
    }

    /// Excludes the vector that contains this DOF.
    fn tie(&mut self, dof: usize) {
        if let DofUse::Vector(k) = self.owner[dof] {
            self.vectors[k].iter().for_each(|&dof| self.owner[dof] = DofUse::Tied);
        }
    }
}
