//! Repeated solves of one model: `K_q u_q = f_q`, `u = L u_q + u_0`. The analysis, the pattern and the symbolic factors are made once.

mod checks;
mod terms;

use qless::Elimination;
use qless::elimination::{CondensedPattern, EliminationError, Index, PrescribedDofs, Storage, View};

use super::condensation::TransformNoise;
use super::matrix::uneven;
use super::solver::{Solver, SolverError, SolverMatrix};
use super::{EnforceError, problem, units};
use terms::StiffnessPattern;

/// An elimination, the pattern of the condensed K, and a solver; it owns all three, so that it can be kept beside the model.
///
/// ```
/// use qless::{Elimination, Options, SystemBuilder};
/// use qless::elimination::View;
/// use qless_solve::enforce::{Llt, Steps};
/// // Two springs of stiffness 2 and 4 to the ground, tied with a gap that grows, under a load of 3.
/// let mut builder = SystemBuilder::new(2);
/// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
/// let elimination = Elimination::new(&builder.build()?, &Options::default())?;
/// let mut steps = Steps::new(elimination, View::columns(&[0, 1, 2], &[0_u32, 1]), Llt::default())?;
/// let mut u = [0.0; 2];
/// for gap in [0.0, 0.75, 1.5] {
///     steps.elimination_mut().update(&[gap], &[])?;
///     steps.solve(&[2.0, 4.0], &[3.0, 0.0], &mut u)?;
///     assert!((u[0] - (0.5 + gap * 2.0 / 3.0)).abs() < 1e-14 && (u[0] - u[1] - gap).abs() < 1e-14);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Steps<S> {
    elimination: Elimination,
    condensed: CondensedPattern,
    solver: S,
    /// For an unsymmetric matrix by rows: conversion of K_q to columns.
    transposed: Option<TransposedPattern>,
    /// Which half of the columns is stored.
    storage: Storage,
    k_q: Vec<f64>,
    /// Positions of the entries of K.
    pattern: StiffnessPattern,
    /// The connected part of each unknown.
    parts: Vec<usize>,
    /// Which entries of T are rounding.
    noise: TransformNoise,
    /// Whether the solver has factors of a supported K_q.
    is_held: bool,
}

impl<S: Solver> Steps<S> {
    /// Prepares solves for matrices with the pattern of K.
    ///
    /// # Errors
    /// [`EnforceError::Elimination`] if the elimination has no equations or the arrays are not a valid pattern, [`EnforceError::Factored`]
    /// if parts of T are kept as factors, [`EnforceError::Triangle`] if the pattern is half of a matrix but not declared so.
    pub fn new<P: Index, I: Index>(elimination: Elimination, k: View<P, I>, solver: S) -> Result<Self, EnforceError> {
        let steps = Self::unsymmetric(elimination, k, solver)?;
        match steps.pattern.triangle() {
            Some(lower) => Err(EnforceError::Triangle { lower }),
            None => Ok(steps),
        }
    }

    /// As [`Steps::new`], but accepts a triangular K that is meant as an unsymmetric matrix.
    ///
    /// # Errors
    /// As [`Steps::new`], except for triangles.
    pub fn unsymmetric<P: Index, I: Index>(
        elimination: Elimination,
        k: View<P, I>,
        solver: S,
    ) -> Result<Self, EnforceError> {
        if elimination.analysis().is_none() {
            return Err(EliminationError::NoEquations.into());
        }
        if !elimination.reduction().is_explicit() {
            return Err(EnforceError::Factored);
        }
        let condensed = elimination.condensed(k, PrescribedDofs::Eliminated)?;
        // The construction of the condensed pattern has validated k.
        let pattern = StiffnessPattern::new(&k);
        // The solver reads columns: the lower half by rows is the upper half by columns.
        let storage = match (condensed.is_by_columns(), condensed.storage()) {
            (false, Storage::Lower) => Storage::Upper,
            (false, Storage::Upper) => Storage::Lower,
            (_, storage) => storage,
        };
        let is_transposed = !condensed.is_by_columns() && storage == Storage::Full;
        let transposed = is_transposed.then(|| TransposedPattern::new(&condensed));
        let parts = units::parts(condensed.unknowns(), condensed.entries());
        let (k_q, noise) = (vec![0.0; condensed.nnz()], TransformNoise::new(elimination.reduction().t()));
        Ok(Self { elimination, condensed, solver, transposed, storage, k_q, pattern, parts, noise, is_held: false })
    }

    /// The elimination, with the constraints.
    pub fn elimination(&self) -> &Elimination {
        &self.elimination
    }

    /// The elimination, to change right-hand sides and prescribed values.
    pub fn elimination_mut(&mut self) -> &mut Elimination {
        &mut self.elimination
    }

    /// The pattern of K_q.
    pub fn condensed(&self) -> &CondensedPattern {
        &self.condensed
    }

    /// Computes u of all DOFs from the values of K and the forces: condenses, factors, checks the support, and solves.
    ///
    /// Cost: one factorization and some five solves.
    ///
    /// # Errors
    /// [`EnforceError::Argument`] for lists of the wrong length or numbers that are not finite, [`EnforceError::Solver`],
    /// [`EnforceError::Unsupported`] with the free motion, and as [`Steps::solve_again`].
    pub fn solve(&mut self, k: &[f64], f: &[f64], u: &mut [f64]) -> Result<(), EnforceError> {
        self.is_held = false;
        self.condensed.condense_matrix_into(&self.elimination, k, &mut self.k_q)?;
        let factored = self.factor(0.0, &[]);
        self.check_model(k, factored)?;
        self.is_held = true;
        self.solve_again(k, f, u)
    }

    /// Solves for other forces, right-hand sides or prescribed values with the factors of the last [`Steps::solve`]; K must be the same.
    ///
    /// # Errors
    /// As [`Steps::solve`]; [`EnforceError::OutOfBalance`] if a residual is larger than 1e-10 of its terms after refinement;
    /// [`EnforceError::Doubtful`] if an equation may be redundant or not and u depends on it.
    pub fn solve_again(&mut self, k: &[f64], f: &[f64], u: &mut [f64]) -> Result<(), EnforceError> {
        if !self.is_held {
            return Err(SolverError("there are no factors; call Steps::solve first, which must succeed".into()).into());
        }
        let (x, units) = self.solve_balanced(k, f)?;
        self.elimination.expand_into(&x, u)?;
        checks::check_equations(&self.elimination, (&x, &units), u)?;
        let analysis = self.elimination.analysis().ok_or(EliminationError::NoEquations)?;
        problem::check_redundant(analysis, self.elimination.kinds(), self.elimination.rhs(), u)
    }

    /// Factors K_q, with a shift of its diagonal in these units.
    fn factor(&mut self, shift: f64, units: &[f64]) -> Result<(), EnforceError> {
        if self.condensed.unknowns() == 0 {
            return Ok(());
        }
        let storage = self.storage;
        if shift > 0.0 {
            let diagonal = self.condensed.entries().enumerate().filter(|(_, (i, j))| i == j);
            diagonal.for_each(|(place, (i, _))| self.k_q[place] += uneven(shift, i, units[i]));
        }
        let columns = match &mut self.transposed {
            None => SolverMatrix {
                starts: self.condensed.starts(),
                rows: self.condensed.index(),
                values: &self.k_q,
                storage,
            },
            Some(transposed) => transposed.columns(&self.k_q),
        };
        Ok(self.solver.factor(columns)?)
    }
}

/// Converts a matrix from rows to columns.
#[derive(Debug)]
pub struct TransposedPattern {
    starts: Vec<u32>,
    rows: Vec<u32>,
    /// The index by rows of each entry.
    places: Vec<u32>,
    values: Vec<f64>,
}

impl TransposedPattern {
    pub fn new(condensed: &CondensedPattern) -> Self {
        let (n, by_row) = (condensed.unknowns(), condensed.starts());
        let mut starts = vec![0_u32; n + 1];
        condensed.index().iter().for_each(|&j| starts[j as usize + 1] += 1);
        (0..n).for_each(|j| starts[j + 1] += starts[j]);
        let mut next = starts.clone();
        let (mut rows, mut places) = (vec![0; condensed.nnz()], vec![0; condensed.nnz()]);
        for i in 0..n {
            for place in by_row[i]..by_row[i + 1] {
                let slot = &mut next[condensed.index()[place as usize] as usize];
                rows[*slot as usize] = i as u32;
                places[*slot as usize] = place;
                *slot += 1;
            }
        }
        Self { starts, rows, places, values: vec![0.0; condensed.nnz()] }
    }

    pub fn columns(&mut self, k_q: &[f64]) -> SolverMatrix<'_> {
        self.values.iter_mut().zip(&self.places).for_each(|(value, &place)| *value = k_q[place as usize]);
        SolverMatrix { starts: &self.starts, rows: &self.rows, values: &self.values, storage: Storage::Full }
    }
}
