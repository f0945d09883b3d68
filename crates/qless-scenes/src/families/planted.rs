//! Sparse rows with small whole coefficients, and combinations `row = sum c_i row_i` of them.

use std::collections::BTreeMap;

use qless::SystemBuilder;

use super::MOST;
use crate::error::within;
use crate::{Rng, Scene, SceneError, Truth};

/// Independent sparse rows and combinations of two to four of them, all in random order.
///
/// Each independent row has a DOF that no later independent row has, so the rank is exactly `rows`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Planted {
    /// Number of independent rows.
    pub rows: usize,
    /// Number of DOFs, at least `rows`.
    pub dofs: usize,
    /// Number of combinations.
    pub combos: usize,
    /// Largest number of coefficients of an independent row; each has 2 to `terms` if enough DOFs remain.
    pub terms: usize,
    /// Whether the last combination contradicts the rows that it combines.
    pub conflict: bool,
}

/// [`Planted`] with up to 5 coefficients per independent row.
///
/// # Errors
/// As [`Planted::scene`].
pub fn planted(rows: usize, dofs: usize, combos: usize, seed: u64, conflict: bool) -> Result<Scene, SceneError> {
    Planted { rows, dofs, combos, terms: 5, conflict }.scene(seed)
}

/// Terms by DOF, and the right-hand side.
type PlantedEquation = (BTreeMap<usize, f64>, f64);

impl Planted {
    /// Builds the scene. Coefficients are whole numbers, so combinations are exact.
    ///
    /// # Errors
    /// [`SceneError::Size`] for no rows, fewer DOFs than rows, less than 2 terms, or a conflict without
    /// combinations.
    pub fn scene(&self, seed: u64) -> Result<Scene, SceneError> {
        within("rows", self.rows, 1, MOST)?;
        within("dofs", self.dofs, self.rows, MOST)?;
        within("terms", self.terms, 2, 1000)?;
        within("combos", self.combos, usize::from(self.conflict), MOST)?;
        let mut rng = Rng::new(seed);
        let order = rng.shuffled(self.dofs);
        let mut equations: Vec<PlantedEquation> =
            (0..self.rows).map(|i| self.independent(i, &order, &mut rng)).collect();
        for _ in 0..self.combos {
            equations.push(combination(&equations[..self.rows], &mut rng));
        }
        if self.conflict {
            equations[self.rows + self.combos - 1].1 += 1.0;
        }
        let mut builder = SystemBuilder::new(self.dofs);
        for k in rng.shuffled(equations.len()) {
            let (terms, rhs) = &equations[k];
            let label = match k.checked_sub(self.rows) {
                None => format!("independent {}", k + 1),
                Some(combo) => format!("combination {}", combo + 1),
            };
            builder.labelled_equation(label, terms.iter().map(|(&dof, &a)| (dof, a)), *rhs);
        }
        Scene::bare(builder, Truth::rank(equations.len(), self.rows).with_conflict(self.conflict))
    }

    /// Row i with its own DOF `order[i]`; its other DOFs come later in the order.
    fn independent(&self, i: usize, order: &[usize], rng: &mut Rng) -> PlantedEquation {
        let later = &order[i + 1..];
        let wanted = 1 + rng.below(self.terms - 1);
        let others = rng.drawn(wanted, later.len()).into_iter().map(|k| later[k]);
        let terms = others.chain([order[i]]).map(|dof| (dof, rng.coefficient(2))).collect();
        (terms, rng.below(7) as f64 - 3.0)
    }
}

fn combination(rows: &[PlantedEquation], rng: &mut Rng) -> PlantedEquation {
    let (mut terms, mut rhs) = (BTreeMap::new(), 0.0);
    let parts = 2 + rng.below(3);
    for k in rng.drawn(parts, rows.len()) {
        let factor = rng.coefficient(2);
        rows[k].0.iter().for_each(|(&dof, &a)| *terms.entry(dof).or_insert(0.0) += factor * a);
        rhs += factor * rows[k].1;
    }
    terms.retain(|_, a| *a != 0.0);
    (terms, rhs)
}
