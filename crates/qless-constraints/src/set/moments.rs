//! Moments in space at the rotations of bodies.
//!
//! A list of loads or forces has one number for each DOF. At the three DOFs of a rotation vector these are the components of a moment M in
//! space; at four Euler parameters they are a zero and then the three components of M. Generalised forces, which are conjugate to u, are
//! `L^T M` at rotations, where `L du/dt` is the angular velocity.

use qless::ArgumentError;

use crate::equations::dof_uses::NO_DOF;
use crate::geometry::spin;
use crate::scalar::vector::Vector;
use crate::set::evaluation::Evaluation;
use crate::set::per_constraint::PerConstraint;
use crate::set::register::ConstraintId;
use crate::set::{ConstraintSet, EditError, long};

impl ConstraintSet {
    /// The DOFs of the rotation of each body: three of a rotation vector, or four Euler parameters.
    pub fn rotations(&self) -> impl Iterator<Item = Vec<usize>> + '_ {
        let dofs = |all: [u32; 4]| all.into_iter().filter(|&dof| dof != NO_DOF).map(|dof| dof as usize).collect();
        self.dof_uses.rotations().map(dofs)
    }

    /// Generalised forces of `loads`, n numbers each: `L^T M` at rotations with a moment M, the loads themselves elsewhere.
    ///
    /// ```
    /// use qless_constraints::{ConstraintSet, types::{Body, Spherical}};
    /// let arm = Body::with_vector([0, 1, 2], [0.0; 3], [3, 4, 5]);
    /// let mut builder = ConstraintSet::builder(6);
    /// builder.add("pin", Spherical { a: Body::ground(), b: arm, at: [0.0; 3] })?;
    /// let set = builder.build()?;
    /// // After half a turn about z, a moment about x has no power in the first component of the rotation vector.
    /// let u = [0.0, 0.0, 0.0, 0.0, 0.0, std::f64::consts::PI];
    /// let forces = set.generalised_forces(&u, &[0.0, 0.0, 7.0, 5.0, 0.0, 0.0])?;
    /// assert!(forces[2] == 7.0 && forces[3].abs() < 1e-15);
    /// let back = set.forces_in_space(&u, &forces)?;
    /// assert!((back[3] - 5.0).abs() < 1e-14 && back[4].abs() < 1e-14);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] if u or the loads do not have length n.
    pub fn generalised_forces(&self, u: &[f64], loads: &[f64]) -> Result<Vec<f64>, ArgumentError> {
        self.at_rotations(u, loads, |turned, own| {
            spin::generalised(turned, moment(own)).into_iter().take(own.len()).collect()
        })
    }

    /// The inverse of [`ConstraintSet::generalised_forces`]: moments in space at rotations. They are not finite where a rotation vector is
    /// a whole number of turns, since generalised forces do not determine them there.
    ///
    /// # Errors
    /// [`ArgumentError`] if u or the forces do not have length n.
    pub fn forces_in_space(&self, u: &[f64], forces: &[f64]) -> Result<Vec<f64>, ArgumentError> {
        self.at_rotations(u, forces, |turned, own| {
            let mut all = vec![0.0; own.len() - 3];
            all.extend(spin::moment(turned, own));
            all
        })
    }

    /// Calls `of(u_r, f_r)` for each rotation, where `u_r` and `f_r` are its entries of u and of the list, and replaces `f_r` by the
    /// result. If all of `f_r` are zero, they stay.
    fn at_rotations(
        &self,
        u: &[f64],
        list: &[f64],
        of: impl Fn(&[f64], &[f64]) -> Vec<f64>,
    ) -> Result<Vec<f64>, ArgumentError> {
        long("u", u.len(), self.dofs)?;
        long("the list of forces", list.len(), self.dofs)?;
        let mut all = list.to_vec();
        for dofs in self.rotations() {
            let [turned, own] = [u, list].map(|all| dofs.iter().map(|&dof| all[dof]).collect::<Vec<f64>>());
            if own.iter().any(|x| *x != 0.0) {
                dofs.iter().zip(of(&turned, &own)).for_each(|(&dof, x)| all[dof] = x);
            }
        }
        Ok(all)
    }

    /// Calls `entry(i, j, d f_i / du_j)` for the generalised forces f of moments. f depends on u, because a moment that is fixed in space
    /// rotates relative to the body.
    ///
    /// # Errors
    /// [`ArgumentError`] if u or the loads do not have length n.
    pub fn moment_stiffness(
        &self,
        u: &[f64],
        loads: &[f64],
        entry: &mut dyn FnMut(usize, usize, f64),
    ) -> Result<(), ArgumentError> {
        long("u", u.len(), self.dofs)?;
        long("the list of loads", loads.len(), self.dofs)?;
        for dofs in self.rotations() {
            let [turned, own] = [u, loads].map(|all| dofs.iter().map(|&dof| all[dof]).collect::<Vec<f64>>());
            if own.iter().any(|x| *x != 0.0) {
                let slopes = spin::stiffness(&turned, moment(&own));
                let rows = dofs.iter().zip(slopes);
                rows.for_each(|(&i, row)| dofs.iter().zip(row).for_each(|(&j, v)| entry(i, j, v)));
            }
        }
        Ok(())
    }

    /// Force of a constraint on the model, `(DOF, -G^T lambda)`, as moments in space at rotations.
    ///
    /// # Errors
    /// [`EditError`]: the constraint or the evaluation belongs to another set, or is out of date.
    pub fn forces_of(
        &self,
        constraint: ConstraintId,
        evaluation: &Evaluation,
        multipliers: &PerConstraint,
    ) -> Result<Vec<(usize, f64)>, EditError> {
        self.current(evaluation)?;
        let (rows, lambda) = (self.rows_of(constraint)?, multipliers.of(constraint));
        let (mut forces, mut dofs) = (vec![0.0; self.dofs], Vec::new());
        for (&row, lambda) in rows.iter().zip(lambda) {
            for (j, v) in evaluation.g.row(row) {
                forces[j] -= v * lambda;
                dofs.push(j);
            }
        }
        dofs.sort_unstable();
        dofs.dedup();
        let forces = self.forces_in_space(&evaluation.u, &forces)?;
        Ok(dofs.into_iter().map(|j| (j, forces[j])).collect())
    }
}

/// The moment among the numbers of a rotation: the last three.
fn moment(own: &[f64]) -> Vector<f64> {
    std::array::from_fn(|k| own[own.len() - 3 + k])
}
