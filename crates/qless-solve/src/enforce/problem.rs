//! Stiffness, loads and constraints, checked.
//! @@ enforce/problem/solution.rs
//! What comes out of a solve, and what it is worth.
//! @@ enforce/method.rs
//! How each equation is enforced.
//! @@ enforce/doubt.rs
//! MeasuredEquations that follow from others, where it is in doubt whether they do.
//!
//! ```text
//! row_i = sum c_k row_k + e        e u = (C_i u - b_i) - sum c_k (C_k u - b_k)
//! ```
//!
//! e is what the analysis took for nothing. Where it does nothing to u, whether it is nothing does not matter.

use std::borrow::Cow;

use qless::{Analysis, ConstraintSystem, Kind, Options, analyse};

use super::{EnforceError, Stiffness};
use crate::common::SparseMatrix;

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
    pub(super) k: Cow<'a, SparseMatrix>,
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
        let refined = |analysis| check_redundant(analysis, analysis.kinds(), self.system.rhs(), u);
        self.doubted.as_ref().map_or(Ok(()), refined)
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

/// Displacements, multipliers and forces.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// All DOFs.
    pub u: Vec<f64>,
    /// lambda, one per original equation, of `K u + C^T lambda = f`; redundant equations ([`super::Problem::redundant`]) have zero.
    pub multipliers: Vec<f64>,
    /// `-C^T lambda`: what the constraints exert on each DOF.
    pub forces: Vec<f64>,
    /// `(DOF, K u + C^T lambda - f)` for each prescribed DOF: what holds it.
    pub reactions: Vec<(usize, f64)>,
    /// The share of u, in its largest number per connected part, that may be wrong: what rounding of K and C does to it, and what
    /// penalties leave; if that is more, the share of what loads would do to the stiffness they act on.
    /// Translations and rotations are compared in units of energy; DOFs of a part of K without a number on its diagonal, which has no
    /// such units, each by itself, and by the terms of its equations where it is zero. An estimate: as a rule too large, seldom several times too small.
    pub accuracy: f64,
    /// The largest imbalance, relative to its terms, of a row of the equations that were solved: `K u + C^T lambda = f`, and `C u = b` of
    /// equations by multipliers. What springs leave of theirs, `C u - b = lambda / D`, is balanced by lambda and part of `accuracy`.
    pub imbalance: f64,
}

/// How one equation is enforced. [`Problem::enforce`](super::Problem::enforce) takes one for each, in one solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// A slave is eliminated: `u = L q + u_0` (Eq. 6-9).
    Elimination,
    /// lambda is an unknown (Eq. 10).
    Multiplier,
    /// A spring of `D = factor k / |C_i|^2` pulls towards the equation (Eq. 11): `C_i u - b_i = lambda_i / D` is left of it, and nothing
    /// where it acts on a part without any stiffness, since the factor would have no meaning.
    Penalty {
        /// How much stiffer the spring is than what it holds.
        factor: f64,
    },
    /// The same spring, and lambda takes over step by step: nothing is left.
    Augmented {
        /// How much stiffer the spring is than what it holds.
        factor: f64,
    },
}

impl Method {
    /// The factor of the spring, if there is one.
    pub(super) fn factor(self) -> Option<f64> {
        match self {
            Self::Penalty { factor } | Self::Augmented { factor } => Some(factor),
            Self::Elimination | Self::Multiplier => None,
        }
    }

    /// Whether its numbers can be used.
    pub(super) fn checked(self) -> Result<(), EnforceError> {
        match self.factor() {
            Some(factor) if !(factor > 0.0 && factor.is_finite()) => Err(EnforceError::Factor(factor)),
            _ => Ok(()),
        }
    }

    /// The same with `share` times the spring.
    pub(super) fn times(self, share: f64) -> Self {
        match self {
            Self::Penalty { factor } => Self::Penalty { factor: factor * share },
            Self::Augmented { factor } => Self::Augmented { factor: factor * share },
            other => other,
        }
    }

    /// The same without a spring.
    pub(super) fn without_spring(self) -> Self {
        if self.factor().is_some() { Self::Multiplier } else { self }
    }
}

/// What `e u` may be of the terms of the combination.
const NOTHING: f64 = 1e-9;

/// Refuses u where a redundant equation of a doubtful rank does not hold as well as those that it is said to follow from.
pub fn check_redundant(analysis: &Analysis, kinds: &[Kind], rhs: &[f64], u: &[f64]) -> Result<(), EnforceError> {
    if !analysis.confidence().ambiguous {
        return Ok(());
    }
    let system = analysis.system();
    let gap = |row: usize| {
        let terms = system.matrix().row(row).map(|(j, v)| v * u[j]);
        terms.fold((-rhs[row], rhs[row].abs()), |(left, size), term| (left + term, size + term.abs()))
    };
    for row in (0..kinds.len()).filter(|&row| kinds[row] == Kind::Redundant) {
        let (mut left, mut size) = gap(row);
        for term in analysis.because(row)? {
            let (of_kept, size_of_kept) = gap(term.row);
            left -= term.coefficient * of_kept;
            size += (term.coefficient * size_of_kept).abs();
        }
        if left.is_nan() || left.abs() > NOTHING * size {
            return Err(EnforceError::Doubtful { row, label: system.equation_label(row), left: left.abs() / size });
        }
    }
    Ok(())
}
