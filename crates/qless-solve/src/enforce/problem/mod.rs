//! Stiffness, loads and constraints, checked.

mod methods;
mod solution;

use std::borrow::Cow;

use qless::{Analysis, ConstraintSystem, Kind, Options, analyse};

pub use solution::Solution;

use super::matrix::Matrix;
use super::{EnforceError, Stiffness, doubt};

/// Stiffness, loads and constraints, checked.
///
/// ```
/// use faer::sparse::{SparseColMat, Triplet};
/// use qless::SystemBuilder;
/// use qless_solve::enforce::Problem;
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
    /// All entries of K.
    pub(super) k: Cow<'a, Matrix>,
    /// Whether K was declared to be symmetric.
    pub(super) declared: bool,
    pub(super) f: &'a [f64],
    pub(super) system: &'a ConstraintSystem,
    pub(super) kept: Vec<usize>,
    redundant: Vec<usize>,
    /// Where it is in doubt whether those are redundant.
    doubted: Option<Analysis>,
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

impl<'a> Problem<'a> {
    /// Checks sizes and analyses the constraints with default settings. K is `&k`, or a [`Stiffness`] that says what is stored.
    ///
    /// # Errors
    /// [`EnforceError`] for sizes that do not fit, numbers that are not finite, one half of K that is not declared as such
    /// ([`EnforceError::Triangle`]), and equations that conflict, with their labels.
    pub fn new(k: impl Into<Stiffness<'a>>, f: &'a [f64], system: &'a ConstraintSystem) -> Result<Self, EnforceError> {
        let (stiffness, dofs) = (k.into(), system.dofs());
        let k = stiffness.matrix();
        for (what, found) in [("rows of K", k.nrows()), ("columns of K", k.ncols()), ("loads", f.len())] {
            if found != dofs {
                return Err(EnforceError::Size { what, found, dofs });
            }
        }
        if let Some(&value) = k.val().iter().chain(f).find(|value| !value.is_finite()) {
            return Err(EnforceError::NotFinite { value });
        }
        let (k, declared) = stiffness.whole()?;
        let analysis = analyse(system, &Options::default())?;
        let of_kind = |kind| (0..system.equations()).filter(|&row| analysis.kinds()[row] == kind).collect::<Vec<_>>();
        let conflicting = of_kind(Kind::Conflicting);
        if !conflicting.is_empty() {
            let labels = conflicting.iter().map(|&row| system.equation_label(row)).collect();
            return Err(EnforceError::Conflict { rows: conflicting, labels });
        }
        let fixed = analysis.generated().iter().map(|&(dof, _)| dof).collect();
        let (kept, redundant) = (of_kind(Kind::Independent), of_kind(Kind::Redundant));
        let doubted = (analysis.confidence().ambiguous && !redundant.is_empty()).then_some(analysis);
        Ok(Self { k, declared, f, system, kept, redundant, doubted, fixed })
    }

    /// The equations that are enforced, ascending.
    pub fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// The equations that follow from others, ascending; they have no multiplier.
    pub fn redundant(&self) -> &[usize] {
        &self.redundant
    }

    /// Refuses u where it breaks an equation that is said to be redundant and may not be.
    pub(super) fn without_doubt(&self, u: &[f64]) -> Result<(), EnforceError> {
        let settled = |analysis| doubt::settled(analysis, analysis.kinds(), self.system.rhs(), u);
        self.doubted.as_ref().map_or(Ok(()), settled)
    }

    /// `(DOF, load)` for loads on free DOFs that the equations fix (generated boundary conditions): they go into the constraints and
    /// move nothing.
    ///
    /// ```
    /// use faer::sparse::{SparseColMat, Triplet};
    /// use qless::SystemBuilder;
    /// use qless_solve::enforce::Problem;
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
}
