//! `K u + C^T lambda = f` with `C u = b` (Eq. 1, 2, 10): the constraints on the stiffness equations of a model.
//!
//! | method | equations that are solved |
//! | --- | --- |
//! | transformation | `T^T K T q = T^T (f - K u_0)`, `u = T q + u_0` (Eq. 6-9) |
//! | Lagrange | `[K C^T; C 0] [u; lambda] = [f; b]` (Eq. 10) |
//! | mixed | slaves of some blocks eliminated, multipliers on the others |
//! | penalty | `(K + C^T D C) u = f + C^T D b`, `D` scaled from K (Eq. 11) |
//! | augmented Lagrange | penalty, and `lambda += D (C u - b)` until C u = b |
//!
//! Only independent equations are enforced; without that Lagrange's matrix is singular, and no slave exists for some row.
//! K need not be symmetric, nor regular without the constraints. Prescribed DOFs keep their values.

mod blocks;
mod condensation;
mod error;
mod matrix;
mod penalty;
mod reduced;
mod saddle;
mod solver;
mod steps;

use faer::sparse::SparseColMat;
use qless::{ConstraintSystem, Kind, Options, analyse};

pub use blocks::BlockPlan;
use condensation::Condensation;
pub use error::EnforceError;
use matrix::{Matrix, times, times_transposed};
pub use reduced::reduced;
pub use solver::{Columns, Ldlt, Llt, Lu, Solver, SolverError};
pub use steps::Steps;

/// Stiffness, loads and constraints, checked.
///
/// ```
/// use faer::sparse::{SparseColMat, Triplet};
/// use qless::SystemBuilder;
/// use qless_constraints::enforce::Problem;
/// // Two springs of stiffness 2 and 4 to the ground, tied to one another twice, under a load of 3.
/// let k = SparseColMat::try_new_from_triplets(2, 2, &[Triplet::new(0, 0, 2.0), Triplet::new(1, 1, 4.0)])?;
/// let mut builder = SystemBuilder::new(2);
/// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
/// builder.equation([(0, 2.0), (1, -2.0)], 0.0);
/// let system = builder.build()?;
/// let problem = Problem::new(&k, &[3.0, 0.0], &system)?;
/// let solution = problem.transformation()?;
/// assert!((solution.u[0] - 0.5).abs() < 1e-15 && (solution.u[1] - 0.5).abs() < 1e-15);
/// // The tie carries 2 from the loaded spring to the other; one of its two equations does nothing.
/// assert!((solution.forces[0] + 2.0).abs() < 1e-14);
/// assert_eq!((problem.redundant().len(), solution.multipliers[problem.redundant()[0]]), (1, 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Problem<'a> {
    k: &'a Matrix,
    f: &'a [f64],
    system: &'a ConstraintSystem,
    kept: Vec<usize>,
    redundant: Vec<usize>,
    /// Free DOFs that the equations fix.
    fixed: Vec<usize>,
}

impl std::fmt::Debug for Problem<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct("Problem");
        text.field("dofs", &self.f.len()).field("kept", &self.kept.len()).field("redundant", &self.redundant);
        text.finish_non_exhaustive()
    }
}

/// Displacements, multipliers and forces.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// All DOFs.
    pub u: Vec<f64>,
    /// lambda, one per original equation, of `K u + C^T lambda = f`; redundant equations ([`Problem::redundant`]) have zero.
    pub multipliers: Vec<f64>,
    /// `-C^T lambda`: what the constraints exert on each DOF.
    pub forces: Vec<f64>,
    /// `(DOF, K u + C^T lambda - f)` for each prescribed DOF: what holds it.
    pub reactions: Vec<(usize, f64)>,
}

impl<'a> Problem<'a> {
    /// Checks sizes and analyses the constraints with default settings.
    ///
    /// # Errors
    /// [`EnforceError`] for sizes that do not fit, numbers that are not finite, and equations that conflict, with their labels.
    pub fn new(
        k: &'a SparseColMat<usize, f64>,
        f: &'a [f64],
        system: &'a ConstraintSystem,
    ) -> Result<Self, EnforceError> {
        let dofs = system.dofs();
        for (what, found) in [("rows of K", k.nrows()), ("columns of K", k.ncols()), ("loads", f.len())] {
            if found != dofs {
                return Err(EnforceError::Size { what, found, dofs });
            }
        }
        if let Some(&value) = k.val().iter().chain(f).find(|value| !value.is_finite()) {
            return Err(EnforceError::NotFinite { value });
        }
        let analysis = analyse(system, &Options::default())?;
        let of_kind = |kind| (0..system.equations()).filter(|&row| analysis.kinds()[row] == kind).collect::<Vec<_>>();
        let conflicting = of_kind(Kind::Conflicting);
        if !conflicting.is_empty() {
            let labels = conflicting.iter().map(|&row| system.equation_label(row)).collect();
            return Err(EnforceError::Conflict { rows: conflicting, labels });
        }
        let fixed = analysis.generated().iter().map(|&(dof, _)| dof).collect();
        Ok(Self { k, f, system, kept: of_kind(Kind::Independent), redundant: of_kind(Kind::Redundant), fixed })
    }

    /// The equations that are enforced, ascending.
    pub fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// The equations that follow from others, ascending; they have no multiplier.
    pub fn redundant(&self) -> &[usize] {
        &self.redundant
    }

    /// `(DOF, load)` for loads on free DOFs that the equations fix (generated boundary conditions): they go into the constraints and
    /// move nothing.
    ///
    /// ```
    /// use faer::sparse::{SparseColMat, Triplet};
    /// use qless::SystemBuilder;
    /// use qless_constraints::enforce::Problem;
    /// let k = SparseColMat::try_new_from_triplets(2, 2, &[Triplet::new(0, 0, 1.0), Triplet::new(1, 1, 1.0)])?;
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, 1.0)], 0.0);
    /// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    /// let system = builder.build()?;
    /// let problem = Problem::new(&k, &[3.0, 0.0], &system)?;
    /// assert_eq!(problem.loads_without_effect(), [(0, 3.0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn loads_without_effect(&self) -> Vec<(usize, f64)> {
        let loaded = self.fixed.iter().map(|&dof| (dof, self.f[dof]));
        loaded.filter(|&(_, load)| load != 0.0).collect()
    }

    /// All slaves eliminated: `K* = T^T K T`, `f* = T^T (f - K u_0)` (Eq. 7-9).
    ///
    /// Connected parts of which T would fill ([`qless::Form::Auto`]) get multipliers in the same matrix: the solution is the same.
    ///
    /// # Errors
    /// [`EnforceError::Singular`] if the constraints do not hold the model.
    pub fn transformation(&self) -> Result<Solution, EnforceError> {
        self.solve(&self.kept, &[])
    }

    /// A multiplier for each independent equation (Eq. 10).
    ///
    /// # Errors
    /// [`EnforceError::Singular`] if the constraints do not hold the model.
    pub fn lagrange(&self) -> Result<Solution, EnforceError> {
        self.solve(&[], &self.kept)
    }

    /// Elimination of the blocks that are planned so, as in [`Problem::transformation`], multipliers on the others ([`Problem::plan`]).
    ///
    /// # Errors
    /// [`EnforceError::Plan`] if the plan does not have each independent equation once, and as [`Problem::lagrange`].
    pub fn mixed(&self, plan: &[BlockPlan]) -> Result<Solution, EnforceError> {
        let rows = |eliminate: bool| {
            let blocks = plan.iter().filter(move |block| block.eliminate == eliminate);
            let mut rows: Vec<usize> = blocks.flat_map(|block| block.rows.iter().copied()).collect();
            rows.sort_unstable();
            rows
        };
        let (eliminated, others) = (rows(true), rows(false));
        let mut all = [eliminated.as_slice(), &others].concat();
        all.sort_unstable();
        if all != self.kept {
            return Err(EnforceError::Plan { planned: all.len(), kept: self.kept.len() });
        }
        self.solve(&eliminated, &others)
    }

    fn solve(&self, eliminated: &[usize], others: &[usize]) -> Result<Solution, EnforceError> {
        let condensation = Condensation::new(self.system, eliminated, &*self.stiffness()?)?;
        let (u, lambda) = saddle::solve(self, &condensation, others)?;
        let mut multipliers = vec![0.0; self.system.equations()];
        others.iter().zip(lambda).for_each(|(&row, value)| multipliers[row] = value);
        let rest = self.out_of_balance(&u, &multipliers);
        let carried = condensation.map.multipliers(&rest)?;
        eliminated.iter().zip(carried).for_each(|(&row, value)| multipliers[row] = value);
        Ok(self.finish(u, multipliers))
    }

    /// `f - K u - C^T lambda`.
    fn out_of_balance(&self, u: &[f64], multipliers: &[f64]) -> Vec<f64> {
        let held = times_transposed(self.system.matrix(), multipliers);
        let stressed = times(self.k, u);
        (0..u.len()).map(|j| self.f[j] - stressed[j] - held[j]).collect()
    }

    fn finish(&self, u: Vec<f64>, multipliers: Vec<f64>) -> Solution {
        let rest = self.out_of_balance(&u, &multipliers);
        let reactions = self.system.prescribed().iter().map(|&(j, _)| (j, -rest[j])).collect();
        let forces = times_transposed(self.system.matrix(), &multipliers).iter().map(|force| -force).collect();
        Solution { u, multipliers, forces, reactions }
    }
}
