//! `D_r C D_c` and `P C Q`: the same scene in other scales, in another order, or with more in it.

use qless::{ConstraintSystem, SystemBuilder};

use crate::{Rng, Scene, SceneError, Truth};

/// Where the rows and DOFs of a shuffled scene come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Order {
    /// `rows[i]` is the original row of row i.
    pub rows: Vec<usize>,
    /// `dofs[j]` is the original DOF of DOF j.
    pub dofs: Vec<usize>,
}

impl Scene {
    /// Multiplies row i, and its right-hand side, by a random power of two `2^k`, `-most <= k <= most`.
    ///
    /// Returns the factors too. Exact while no number leaves the normal range, so the truth stands.
    ///
    /// ```
    /// let (scaled, factors) = qless_scenes::families::path(4)?.scale_rows(20, 1)?;
    /// assert_eq!(scaled.system.matrix().row(2).next(), Some((2, factors[2])));
    /// # Ok::<(), qless_scenes::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::Size`] for `most` above 1000; [`SceneError::System`] where a number overflows.
    pub fn scale_rows(&self, most: usize, seed: u64) -> Result<(Self, Vec<f64>), SceneError> {
        crate::error::within("the largest exponent", most, 0, 1000)?;
        let mut rng = Rng::new(seed);
        let factors: Vec<f64> =
            (0..self.system.equations()).map(|_| power_of_two(rng.below(2 * most + 1) as i64 - most as i64)).collect();
        let (rows, dofs) = identity(&self.system);
        let system = rebuild(&self.system, &rows, &dofs, &factors, &vec![1.0; dofs.len()])?;
        Ok((Self { system, ..self.clone() }, factors))
    }

    /// Measures DOF j in another unit: `u_j = units[j] u'_j`, which multiplies column j by `units[j]`.
    ///
    /// Exact for powers of two. Other units round each coefficient once: the truth then stands numerically,
    /// while the exact rank of the rounded numbers may be higher.
    ///
    /// # Errors
    /// [`SceneError::Size`] unless there is one unit per DOF; [`SceneError::Number`] for a unit of zero, NaN
    /// or infinity; [`SceneError::System`] where a number overflows.
    pub fn scale_dofs(&self, units: &[f64]) -> Result<Self, SceneError> {
        let n = self.system.dofs();
        crate::error::within("the number of units", units.len(), n, n)?;
        if let Some(&found) = units.iter().find(|unit| !unit.is_finite() || **unit == 0.0) {
            return Err(SceneError::Number { what: "a unit", found });
        }
        let (rows, dofs) = identity(&self.system);
        let system = rebuild(&self.system, &rows, &dofs, &vec![1.0; rows.len()], units)?;
        let mut truth = self.truth.clone();
        for (dof, value) in truth.generated.iter_mut().flatten() {
            *value /= units.get(*dof).unwrap_or(&1.0);
        }
        Ok(Self { system, truth, ..self.clone() })
    }

    /// Puts rows and DOFs in random order; labels, nodes and truth go with them.
    ///
    /// ```
    /// let scene = qless_scenes::families::path(9)?;
    /// let (shuffled, order) = scene.shuffle(3)?;
    /// assert_eq!(shuffled.system.equation_label(0), scene.system.equation_label(order.rows[0]));
    /// # Ok::<(), qless_scenes::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// None in practice: [`SceneError::System`] would mean that the scene itself was not valid.
    pub fn shuffle(&self, seed: u64) -> Result<(Self, Order), SceneError> {
        let mut rng = Rng::new(seed);
        let rows = rng.shuffled(self.system.equations());
        let dofs = rng.shuffled(self.system.dofs());
        let system = rebuild(&self.system, &rows, &dofs, &vec![1.0; rows.len()], &vec![1.0; dofs.len()])?;
        let new = inverse(&dofs);
        let mut truth = self.truth.clone();
        for (dof, _) in truth.generated.iter_mut().flatten() {
            *dof = new.get(*dof).copied().unwrap_or(*dof);
        }
        truth.generated.iter_mut().for_each(|all| all.sort_by_key(|&(dof, _)| dof));
        let places = dofs.iter().filter_map(|&j| self.dofs.get(j).copied()).collect();
        Ok((Self { system, truth, nodes: self.nodes.clone(), dofs: places }, Order { rows, dofs }))
    }

    /// Prescribes further DOFs. What is known about the rank is lost: [`crate::oracle`] can restore it.
    ///
    /// # Errors
    /// [`SceneError::System`] for a DOF out of range, prescribed twice, or a value that is not finite.
    pub fn with_prescribed(&self, values: &[(usize, f64)]) -> Result<Self, SceneError> {
        let mut builder = copy(&self.system, self.system.dofs());
        for &(dof, value) in values {
            builder.prescribe(dof, value);
        }
        builder.dof_labels((0..self.system.dofs()).map(|j| self.system.dof_label(j)).collect());
        let truth = Truth { ambiguous: self.truth.ambiguous, ..Truth::default() };
        Ok(Self { system: builder.build()?, truth, ..self.clone() })
    }

    /// Adds `rows` equations `u_own + sum a_j u_j = 0`, each with a new DOF of its own and `others` random old ones.
    ///
    /// The rank grows by `rows`. The new DOFs have no node: the geometry is dropped.
    ///
    /// # Errors
    /// [`SceneError::System`] where the system becomes too large.
    pub fn with_singletons(&self, rows: usize, others: usize, seed: u64) -> Result<Self, SceneError> {
        let n = self.system.dofs();
        crate::error::within("rows", rows, 0, crate::families::MOST)?;
        crate::error::within("others", others.min(n), 0, 1 << 16)?;
        let mut builder = copy(&self.system, n + rows);
        let mut rng = Rng::new(seed);
        for i in 0..rows {
            let old = rng.drawn(others, n).into_iter().map(|j| (j, rng.real())).collect::<Vec<_>>();
            builder.labelled_equation(format!("singleton {}", i + 1), old.into_iter().chain([(n + i, 1.0)]), 0.0);
        }
        let mut truth = Truth { generated: None, ..self.truth.clone() };
        truth.rank_free = truth.rank_free.map(|rank| rank.saturating_add(rows));
        Self::bare(builder, truth)
    }
}

/// `2^k` for a normal result, without the platform's `pow`.
fn power_of_two(k: i64) -> f64 {
    f64::from_bits(((1023 + k) as u64) << 52)
}

fn identity(system: &ConstraintSystem) -> (Vec<usize>, Vec<usize>) {
    ((0..system.equations()).collect(), (0..system.dofs()).collect())
}

fn inverse(order: &[usize]) -> Vec<usize> {
    let mut inverse = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        inverse[old] = new;
    }
    inverse
}

/// The same equations in a builder for `dofs` DOFs.
fn copy(system: &ConstraintSystem, dofs: usize) -> SystemBuilder {
    let mut builder = SystemBuilder::new(dofs);
    for row in 0..system.equations() {
        builder.labelled_equation(system.equation_label(row), system.matrix().row(row), system.rhs()[row]);
    }
    for &(dof, value) in system.prescribed() {
        builder.prescribe(dof, value);
    }
    builder
}

/// Rows and DOFs taken in the given orders, each row times its factor, each DOF in its unit; factors and
/// units are indexed by old numbers.
fn rebuild(
    old: &ConstraintSystem,
    rows: &[usize],
    dofs: &[usize],
    factors: &[f64],
    units: &[f64],
) -> Result<ConstraintSystem, SceneError> {
    let new = inverse(dofs);
    let mut builder = SystemBuilder::new(old.dofs());
    for &row in rows {
        let terms = old.matrix().row(row).map(|(j, v)| (new[j], v * factors[row] * units[j]));
        builder.labelled_equation(old.equation_label(row), terms, old.rhs()[row] * factors[row]);
    }
    for &(dof, value) in old.prescribed() {
        builder.prescribe(new[dof], value / units[dof]);
    }
    builder.dof_labels(dofs.iter().map(|&j| old.dof_label(j)).collect());
    Ok(builder.build()?)
}
