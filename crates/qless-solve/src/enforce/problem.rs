//! The model with its constraints, the methods of enforcement, the solution, and the check of equations that may be redundant.
//! A redundant row is a combination of kept rows, up to an error e that the analysis took for zero:
//!
//! ```text
//! row_i = sum c_k row_k + e        e u = (C_i u - b_i) - sum c_k (C_k u - b_k)
//! ```
//!
//! If u satisfies the kept rows and `e u` is zero, u satisfies the redundant row too, even if e is not zero.

use std::borrow::Cow;

use qless::{Analysis, ConstraintSystem, Kind, Options, analyse};

use super::{EnforceError, Stiffness};
use crate::common::SparseMatrix;

/// A stiffness matrix, loads and constraint equations, validated.
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
    /// All entries of K, also if only one half was given.
    pub(super) k: Cow<'a, SparseMatrix>,
    /// Whether K was declared to be symmetric.
    pub(super) declared: bool,
    pub(super) f: &'a [f64],
    pub(super) system: &'a ConstraintSystem,
    pub(super) kept: Vec<usize>,
    redundant: Vec<usize>,
    /// The analysis, if it is not sure which equations are redundant.
    doubted: Option<Analysis>,
    /// Free DOFs whose value follows from the equations alone.
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
    /// Validates sizes and analyses the constraints with default settings. K is `&k`, or a [`Stiffness`] that declares which half is
    /// stored.
    ///
    /// # Errors
    /// [`EnforceError`] if sizes do not match, a number is not finite, half of K is passed as a full matrix ([`EnforceError::Triangle`]),
    /// or equations conflict; the error has their labels.
    pub fn new(k: impl Into<Stiffness<'a>>, f: &'a [f64], system: &'a ConstraintSystem) -> Result<Self, EnforceError> {
        let stiffness = k.into();
        check_arguments(stiffness.matrix(), f, system.dofs())?;
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

    /// The redundant equations, ascending; they have no multiplier.
    pub fn redundant(&self) -> &[usize] {
        &self.redundant
    }

    /// Fails if u violates an equation that the analysis is not sure to be redundant.
    pub(super) fn check_doubtful(&self, u: &[f64]) -> Result<(), EnforceError> {
        let refined = |analysis| check_redundant(analysis, analysis.kinds(), self.system.rhs(), u);
        self.doubted.as_ref().map_or(Ok(()), refined)
    }

    /// `(DOF, load)` of loads on free DOFs whose value follows from the equations alone (generated boundary conditions). The constraints
    /// carry these loads; they do not change u.
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

/// Checks that sizes match and all numbers are finite.
fn check_arguments(k: &SparseMatrix, f: &[f64], dofs: usize) -> Result<(), EnforceError> {
    let sizes = [("rows of K", k.nrows()), ("columns of K", k.ncols()), ("loads", f.len())];
    if let Some((what, found)) = sizes.into_iter().find(|&(_, found)| found != dofs) {
        return Err(EnforceError::Size { what, found, dofs });
    }
    let mut numbers = k.val().iter().chain(f);
    numbers.find(|value| !value.is_finite()).map_or(Ok(()), |&value| Err(EnforceError::NotFinite { value }))
}

/// Displacements, multipliers, forces and error estimates.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Displacements of all DOFs.
    pub u: Vec<f64>,
    /// Multipliers lambda of `K u + C^T lambda = f`, one per equation; zero for redundant equations ([`Problem::redundant`]).
    pub multipliers: Vec<f64>,
    /// `-C^T lambda`: force of the constraints on each DOF.
    pub forces: Vec<f64>,
    /// `(DOF, K u + C^T lambda - f)` for each prescribed DOF: the support reaction.
    pub reactions: Vec<(usize, f64)>,
    /// Estimated error of u, relative to the largest displacement of each connected part: the effect of rounding of K and C, plus the error
    /// of penalties. If the displacement that the loads would cause on the stiffness of their DOFs is larger, the error is relative to
    /// that. Translations and rotations are compared in units of energy. If K has no diagonal entry in a part, there is no such unit: each
    /// DOF is then compared with itself, or with the terms of its equations if it is zero. The estimate is usually too large, and seldom
    /// several times too small.
    pub accuracy: f64,
    /// Residual of `K u + C^T lambda = f` and `C u = b`, relative to the terms of its row, in the row that is closest to its limit. The
    /// equation of a penalty is `C u - lambda / D = b`; the error `lambda / D` is part of `accuracy` instead.
    pub imbalance: f64,
}

/// How one equation is enforced. [`Problem::enforce`] takes one method per equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Eliminate a slave: `u = L q + u_0` (Eq. 6-9).
    Elimination,
    /// Solve for lambda as an unknown (Eq. 10).
    Multiplier,
    /// A spring of stiffness `D = factor k / |C_i|^2` pulls towards the equation (Eq. 11) and leaves `C_i u - b_i = lambda_i / D`. Here k
    /// is the largest stiffness of the equation's DOFs. In a part without any stiffness, the factor has no meaning and the equation is
    /// satisfied exactly.
    Penalty {
        /// Stiffness of the spring relative to that of its DOFs.
        factor: f64,
    },
    /// A spring as in `Penalty`, whose force a multiplier takes over step by step. The solution is the limit, which satisfies the equation.
    Augmented {
        /// Stiffness of the spring relative to that of its DOFs.
        factor: f64,
    },
}

impl Method {
    /// Validates the factor.
    pub(super) fn checked(self) -> Result<(), EnforceError> {
        match self {
            Self::Penalty { factor } | Self::Augmented { factor } if !(factor > 0.0 && factor.is_finite()) => {
                Err(EnforceError::Factor(factor))
            }
            _ => Ok(()),
        }
    }
}

/// A redundant row holds if its residual differs from the combination of residuals in its certificate by at most this fraction of the
/// absolute terms. The certificate and the combined residuals may each be wrong by a tenth of that.
const NOTHING: f64 = 1e-9;

/// Fails if the rank is ambiguous and the residual of a redundant equation is not the combination of residuals in its certificate.
pub fn check_redundant(analysis: &Analysis, kinds: &[Kind], rhs: &[f64], u: &[f64]) -> Result<(), EnforceError> {
    if !analysis.confidence().ambiguous {
        return Ok(());
    }
    let system = analysis.system();
    let gap = |row: usize| {
        let terms = system.matrix().row(row).map(|(j, v)| v * u[j]);
        terms.fold((-rhs[row], rhs[row].abs()), |(sum, size), term| (sum + term, size + term.abs()))
    };
    for row in (0..kinds.len()).filter(|&row| kinds[row] == Kind::Redundant) {
        let (mut residual, mut size) = gap(row);
        for term in analysis.because(row)? {
            let (of_kept, size_of_kept) = gap(term.row);
            residual -= term.coefficient * of_kept;
            size += (term.coefficient * size_of_kept).abs();
        }
        if residual.is_nan() || residual.abs() > NOTHING * size {
            return Err(EnforceError::Doubtful {
                row,
                label: system.equation_label(row),
                residual: residual.abs() / size,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use qless::{Options, SystemBuilder, analyse};

    use super::*;
    use crate::common::random;

    /// The third equation is the second one plus 1e-4 of the first to about 1e-12 of its coefficients, which leaves its rank in doubt.
    #[test]
    fn an_equation_in_doubt_is_refused_only_if_it_does_not_hold() {
        for seed in 0..100 {
            let row = |k: u64| -> Vec<f64> { (0..6).map(|j| random(100 * seed + 10 * k + j)).collect() };
            let [first, second, off] = [0, 1, 2].map(row);
            let both = (0..6).map(|j| 1e-4 * first[j] + second[j] + 1e-12 * off[j]).collect();
            let mut builder = SystemBuilder::new(6);
            for row in [&first, &second, &both] {
                builder.equation(row.iter().copied().enumerate(), 0.0);
            }
            let system = builder.build().expect("valid");
            let analysis = analyse(&system, &Options::default()).expect("small");
            assert!(analysis.confidence().ambiguous && analysis.rank() == 2, "{seed}: {:?}", analysis.confidence());
            let u = row(3);
            let mut rhs = system.matrix().times(&u).expect("a number for each DOF");
            assert_eq!(check_redundant(&analysis, analysis.kinds(), &rhs, &u), Ok(()), "{seed}");
            // A certificate is wrong by as much.
            rhs[2] += 1e-10;
            assert_eq!(check_redundant(&analysis, analysis.kinds(), &rhs, &u), Ok(()), "{seed}");
            // What the first equation misses, the third one misses by the same combination.
            rhs[0] += 0.5;
            rhs[2] += 0.5e-4;
            assert_eq!(check_redundant(&analysis, analysis.kinds(), &rhs, &u), Ok(()), "{seed}");
            rhs[2] += 1e-6;
            let refused = check_redundant(&analysis, analysis.kinds(), &rhs, &u);
            assert!(matches!(refused, Err(EnforceError::Doubtful { row: 2, .. })), "{seed}: {refused:?}");
        }
    }
}
