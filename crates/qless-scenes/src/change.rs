//! Variants of a scene: rows and DOFs scaled by diagonal matrices, `D_r C D_c`, or permuted, `P C Q`; more prescribed DOFs or equations.

use qless::{ConstraintSystem, SystemBuilder};

use crate::error::within;
use crate::{Dof, Rng, Scene, SceneError, Truth};

/// The order of rows and DOFs of a shuffled scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Order {
    /// Row i of the shuffled scene is row `rows[i]` of the original scene.
    pub rows: Vec<usize>,
    /// DOF j of the shuffled scene is DOF `dofs[j]` of the original scene.
    pub dofs: Vec<usize>,
}

impl Scene {
    /// Multiplies row i and its right-hand side by a random power of two `2^k`, `-most <= k <= most`.
    ///
    /// Also returns the factors. The products are exact unless a number leaves the normal range, so the truth does not change.
    ///
    /// ```
    /// let (scaled, factors) = qless_scenes::families::path(4)?.scale_rows(20, 1)?;
    /// assert_eq!(scaled.system.matrix().row(2).next(), Some((2, factors[2])));
    /// # Ok::<(), qless_scenes::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::Size`] for `most` above 1000; [`SceneError::System`] if a number overflows.
    pub fn scale_rows(&self, most: usize, seed: u64) -> Result<(Self, Vec<f64>), SceneError> {
        within("the largest exponent", most, 0, 1000)?;
        let mut rng = Rng::new(seed);
        let factors: Vec<f64> =
            (0..self.system.equations()).map(|_| power_of_two(rng.below(2 * most + 1) as i64 - most as i64)).collect();
        let (rows, dofs) = identity(&self.system);
        let system = rebuild(&self.system, &rows, &dofs, &factors, &vec![1.0; dofs.len()])?;
        Ok((Self { system, ..self.clone() }, factors))
    }

    /// Measures DOF j in another unit: `u_j = units[j] u'_j`, which multiplies column j by `units[j]`.
    ///
    /// Exact for powers of two. Other units round each coefficient once: the truth then holds numerically, but the exact
    /// rank of the rounded numbers may be higher.
    ///
    /// # Errors
    /// [`SceneError::Size`] unless there is one unit per DOF; [`SceneError::Number`] for a unit of zero, NaN
    /// or infinity; [`SceneError::System`] if a number overflows.
    pub fn scale_dofs(&self, units: &[f64]) -> Result<Self, SceneError> {
        let n = self.system.dofs();
        within("the number of units", units.len(), n, n)?;
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

    /// Puts rows and DOFs in random order, with their labels, nodes and truth.
    ///
    /// ```
    /// let scene = qless_scenes::families::path(9)?;
    /// let (shuffled, order) = scene.shuffle(3)?;
    /// assert_eq!(shuffled.system.equation_label(0), scene.system.equation_label(order.rows[0]));
    /// # Ok::<(), qless_scenes::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::System`] if the scene itself is not valid.
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

    /// Prescribes further DOFs. The truth about the rank becomes unknown; [`crate::oracle`] can compute it.
    ///
    /// # Errors
    /// [`SceneError::System`] for a DOF out of range, prescribed twice, or a value that is not finite.
    pub fn with_prescribed(&self, values: &[(usize, f64)]) -> Result<Self, SceneError> {
        let mut builder = SystemBuilder::new(self.system.dofs());
        for row in 0..self.system.equations() {
            builder.labelled_equation(
                self.system.equation_label(row),
                self.system.matrix().row(row),
                self.system.rhs()[row],
            );
        }
        for &(dof, value) in self.system.prescribed().iter().chain(values) {
            builder.prescribe(dof, value);
        }
        builder.dof_labels((0..self.system.dofs()).map(|j| self.system.dof_label(j)).collect());
        let truth = Truth { ambiguous: self.truth.ambiguous, ..Truth::default() };
        Ok(Self { system: builder.build()?, truth, ..self.clone() })
    }

    /// Adds `rows` equations `u_own + sum a_j u_j = 0`, each with a new DOF of its own and `others` random old DOFs.
    ///
    /// The rank grows by `rows`. The new DOFs have no node, so the result has no geometry.
    ///
    /// # Errors
    /// [`SceneError::System`] if the system becomes too large.
    pub fn with_singletons(&self, rows: usize, others: usize, seed: u64) -> Result<Self, SceneError> {
        let n = self.system.dofs();
        within("rows", rows, 0, crate::error::MOST)?;
        within("others", others.min(n), 0, 1 << 16)?;
        let mut builder = SystemBuilder::new(n + rows);
        append(&mut builder, &self.system, 0);
        let mut rng = Rng::new(seed);
        for i in 0..rows {
            let old = rng.drawn(others, n).into_iter().map(|j| (j, rng.real())).collect::<Vec<_>>();
            builder.labelled_equation(format!("singleton {}", i + 1), old.into_iter().chain([(n + i, 1.0)]), 0.0);
        }
        let mut truth = Truth { generated: None, ..self.truth.clone() };
        truth.rank_free = truth.rank_free.map(|rank| rank.saturating_add(rows));
        Self::bare(builder, truth)
    }

    /// Both scenes in one system: first the equations and DOFs of this one, then those of the other.
    ///
    /// A property is known if it is known of both scenes. The result is ambiguous or conflicting if one of the scenes is. It has
    /// labels if one scene has any, and a geometry if both have one. [`Scene::shuffle`] mixes the rows and DOFs.
    ///
    /// ```
    /// use qless_scenes::families::{Near, near, rotations};
    /// let scene = near(2, 1e-8, Near::Own)?.beside(&rotations(50)?)?;
    /// assert_eq!((scene.system.equations(), scene.system.dofs()), (6 + 100, 14 + 102));
    /// assert!(scene.truth.rank_free == Some(106) && scene.truth.ambiguous);
    /// # Ok::<(), qless_scenes::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::System`] if the system becomes too large.
    pub fn beside(&self, other: &Self) -> Result<Self, SceneError> {
        let first = self.system.dofs();
        let mut builder = SystemBuilder::new(first + other.system.dofs());
        append(&mut builder, &self.system, 0);
        append(&mut builder, &other.system, first);
        if !(self.system.dof_labels().is_empty() && other.system.dof_labels().is_empty()) {
            let names = |system: &ConstraintSystem| (0..system.dofs()).map(|j| system.dof_label(j)).collect::<Vec<_>>();
            builder.dof_labels([names(&self.system), names(&other.system)].concat());
        }
        let placed = !self.dofs.is_empty() && !other.dofs.is_empty();
        let moved = |dof: &Dof| Dof { node: dof.node.saturating_add(self.nodes.len()), ..*dof };
        let dofs = self.dofs.iter().copied().chain(other.dofs.iter().map(moved)).filter(|_| placed).collect();
        let nodes = if placed { [&self.nodes[..], &other.nodes].concat() } else { Vec::new() };
        Ok(Self { system: builder.build()?, truth: self.truth.beside(&other.truth, first), nodes, dofs })
    }
}

impl Truth {
    /// The truth about two systems without common DOFs; the DOFs of the second are numbered from `first` on.
    fn beside(&self, other: &Self, first: usize) -> Self {
        let sum = |a: Option<usize>, b: Option<usize>| Some(a?.saturating_add(b?));
        let moved = |&(dof, value): &(usize, f64)| (first.saturating_add(dof), value);
        let generated = self.generated.as_ref().zip(other.generated.as_ref());
        Self {
            rank_free: sum(self.rank_free, other.rank_free),
            redundant: sum(self.redundant, other.redundant),
            conflicting: self.conflicting || other.conflicting,
            generated: generated.map(|(a, b)| a.iter().copied().chain(b.iter().map(moved)).collect()),
            ambiguous: self.ambiguous || other.ambiguous,
        }
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

/// Appends the equations and prescribed values of a system, with DOFs numbered from `first` on.
fn append(builder: &mut SystemBuilder, system: &ConstraintSystem, first: usize) {
    for row in 0..system.equations() {
        let terms = system.matrix().row(row).map(|(j, v)| (first + j, v));
        match system.equation_labels().get(row) {
            Some(label) => builder.labelled_equation(label, terms, system.rhs()[row]),
            None => builder.equation(terms, system.rhs()[row]),
        };
    }
    system.prescribed().iter().for_each(|&(dof, value)| builder.prescribe(first + dof, value));
}

/// The system with rows and DOFs in the given orders, each row times its factor, each DOF in its unit. Factors and units
/// are indexed by old numbers.
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
