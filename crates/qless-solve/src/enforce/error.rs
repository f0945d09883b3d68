//! Errors of enforcement, and the motion of a model that lacks support.

use qless::elimination::EliminationError;
use qless::{AnalysisError, ArgumentError, ReductionError, SystemError};

use super::SolverError;

/// Why constraints cannot be enforced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EnforceError {
    /// The size of K or f does not match the constraints.
    #[error("there are {found} {what}, but the constraints are on {dofs} DOFs")]
    Size {
        /// Name of what has the wrong size: the rows or columns of K, or the loads.
        what: &'static str,
        /// Size that was found.
        found: usize,
        /// Size that is required, the number of DOFs.
        dofs: usize,
    },
    /// A number of K or f is not finite.
    #[error("K or f contains {value}; every number must be finite")]
    NotFinite {
        /// The first number that is not finite.
        value: f64,
    },
    /// Equations contradict others.
    #[error("conflicting equations: {}; each contradicts the equations that it depends on", .labels.join(" and "))]
    Conflict {
        /// Indices of the conflicting equations, from 0.
        rows: Vec<usize>,
        /// Labels of the conflicting equations.
        labels: Vec<String>,
    },
    /// The analysis cannot tell whether an equation is redundant, and u does not satisfy it.
    #[error(
        "{label} may be redundant or not: it differs from a combination of other equations by {residual:.1e} of its terms; give its \
         coefficients with all digits, choose units of similar size for its DOFs, or remove it"
    )]
    Doubtful {
        /// Index of the equation that may be redundant, from 0.
        row: usize,
        /// Label of the equation that may be redundant.
        label: String,
        /// Residual of equation `row` if the other equations hold, relative to the terms of all these equations.
        residual: f64,
    },
    /// The plan does not contain each independent equation of this problem exactly once.
    #[error("the plan has {planned} equations, but {kept} are independent, and each must occur once")]
    Plan {
        /// Number of equations in the plan.
        planned: usize,
        /// Number of independent equations, which the plan should have.
        kept: usize,
    },
    /// Half of a symmetric K was passed as a full matrix.
    #[error(
        "all entries of K off the diagonal are on one side; declare Stiffness::{} if K is symmetric and this is one half of it, \
         Stiffness::unsymmetric if K is a triangle",
        if *.lower { "lower" } else { "upper" }
    )]
    Triangle {
        /// Whether the passed half is the lower one.
        lower: bool,
    },
    /// K has an entry outside of the half that was declared.
    #[error(
        "K has an entry in row {row}, column {column} (from 0), outside of the declared half; pass one half, or declare Stiffness::full"
    )]
    WrongHalf {
        /// Row of the entry outside of the declared half.
        row: usize,
        /// Column of the entry outside of the declared half.
        column: usize,
    },
    /// A penalty factor is not a positive number.
    #[error("the penalty factor is {0}; it must be positive, such as 1e6")]
    Factor(f64),
    /// An accuracy is not a positive number.
    #[error("the accuracy is {0}; it must be positive, such as 1e-6")]
    Accuracy(f64),
    /// The constraints and prescribed DOFs leave the model free to move.
    #[error("{0}; support it, or give it stiffness")]
    Unsupported(FreeMotion),
    /// The matrix is singular, but no free motion was found.
    #[error("{what} is singular, but no free motion was found; look for DOFs without stiffness")]
    Singular {
        /// Name of the singular matrix.
        what: &'static str,
    },
    /// A residual stays above its limit after refinement, or rounding leaves no correct digit of u.
    #[error(
        "{row}: the residual is {imbalance:.1e} of its terms after refinement; the model is too ill-conditioned for double precision"
    )]
    OutOfBalance {
        /// Name of the row with the residual: the forces on a DOF, or the label of an equation.
        row: String,
        /// Residual of the row `row`, relative to its terms.
        imbalance: f64,
    },
    /// The springs are so soft that u misses the requested accuracy.
    #[error(
        "penalty factor {factor:.1e}: the relative error of u is {cost:.1e}, more than the requested {accuracy:.1e}; {}",
        advice(*.smallest)
    )]
    PenaltyTooSmall {
        /// The largest penalty factor requested.
        factor: f64,
        /// Requested relative accuracy of u.
        accuracy: f64,
        /// Relative error of u that the springs cause; 1 if they are too soft for an estimate.
        cost: f64,
        /// A penalty factor that reaches the accuracy, if one was found.
        smallest: Option<f64>,
    },
    /// A matrix exceeds the memory or the integers of the solver.
    #[error("a matrix of {rows} x {cols} is too large")]
    TooLarge {
        /// Number of rows of the matrix.
        rows: usize,
        /// Number of columns of the matrix.
        cols: usize,
    },
    /// Parts of T are kept as factors, which `Steps` does not support.
    #[error(
        "parts of T are kept as factors, which Steps does not support; create the elimination with Form::Explicit, or use Problem"
    )]
    Factored,
    /// The caller's [`Solver`](super::Solver) failed.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// Rounding keeps the residuals of augmented equations above the tolerance.
    #[error(
        "rounding keeps the residual of an equation at {residual:.1e} of its terms, above the requested {tolerance:.1e}; request a larger tolerance"
    )]
    NoConvergence {
        /// Largest residual of an equation, relative to its terms.
        residual: f64,
        /// Requested tolerance.
        tolerance: f64,
    },
    /// The solution leaves the range of doubles.
    #[error("the solution leaves the range of doubles; choose units in which K, f and u are closer to one")]
    OutOfRange,
    /// The limit of fill is negative or not a number.
    #[error("the limit of fill is {0}; it must be zero or more, such as 10")]
    Limit(f64),
    /// The constraints cannot be analysed.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// The constraints cannot be solved for slaves.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// The chosen equations are not a valid system.
    #[error(transparent)]
    System(#[from] SystemError),
    /// The equations cannot be brought into the form that condenses K.
    #[error(transparent)]
    Elimination(#[from] EliminationError),
    /// An argument has the wrong length or range.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
}

/// The end of the message for a penalty that is too small: a sufficient factor, if one was found.
fn advice(factor: Option<f64>) -> String {
    match factor {
        Some(factor) => format!("a sufficient factor is {factor:.1e}"),
        None => "no factor is sufficient: use multipliers or elimination".into(),
    }
}

/// A DOF belongs to a free motion only if its dimensionless motion exceeds this fraction of the largest. A null vector is accurate to at
/// least half of its digits, so that smaller entries may be errors.
const SHARE: f64 = 1e-6;
/// Largest number of DOFs that the message names.
const NAMED: usize = 8;

/// A motion that constraints and prescribed DOFs leave free, up to rounding.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FreeMotion {
    /// The DOFs that move, ascending.
    pub dofs: Vec<usize>,
    /// Displacement of each DOF in `dofs`, in the unit of the DOF; the largest is 1 or -1.
    pub motion: Vec<f64>,
    /// Largest force that resists the motion, relative to its terms: zero or rounding.
    pub resistance: f64,
}

impl FreeMotion {
    /// Creates the free motion from the motion u of all DOFs, and from the same motion `sizes` in dimensionless numbers.
    pub(super) fn new(u: &[f64], sizes: &[f64], resistance: f64) -> Self {
        let most = sizes.iter().fold(0.0, |most: f64, size| most.max(size.abs()));
        let dofs: Vec<usize> = (0..u.len()).filter(|&j| sizes[j].abs() > SHARE * most).collect();
        let largest =
            dofs.iter().fold(0.0, |largest: f64, &j| if u[j].abs() > f64::abs(largest) { u[j] } else { largest });
        let motion = dofs.iter().map(|&j| u[j] / largest).collect();
        Self { dofs, motion, resistance }
    }

    /// Renumbers the DOFs: j becomes `dofs[j]`. The list `dofs` ascends, so that the order stays the same.
    pub(super) fn renumbered(mut self, dofs: &[usize]) -> Self {
        self.dofs.iter_mut().for_each(|j| *j = dofs[*j]);
        self
    }

    /// The union of both motions, each scaled to a largest displacement of 1 or -1.
    pub(super) fn union(&self, other: &Self) -> Self {
        let moves = |motion: &Self| motion.dofs.iter().copied().zip(motion.motion.clone()).collect::<Vec<_>>();
        let mut both = [moves(self), moves(other)].concat();
        both.sort_by_key(|&(dof, _)| dof);
        let (dofs, motion) = both.into_iter().unzip();
        Self { dofs, motion, resistance: self.resistance.max(other.resistance) }
    }
}

impl std::fmt::Display for FreeMotion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.dofs.is_empty() {
            return write!(
                f,
                "the equations are dependent up to rounding, so that their multipliers are not determined"
            );
        }
        write!(f, "only rounding resists a motion of DOF ")?;
        for (place, (dof, value)) in self.dofs.iter().zip(&self.motion).take(NAMED).enumerate() {
            write!(f, "{}{dof} ({value:+.3})", if place > 0 { ", " } else { "" })?;
        }
        let others = self.dofs.len().saturating_sub(NAMED);
        if others > 0 {
            write!(f, " and {others} others")?;
        }
        write!(f, " (the largest force is {:.1e} of its terms)", self.resistance)
    }
}

#[cfg(test)]
mod tests {
    use super::FreeMotion;

    #[test]
    fn a_motion_of_any_size_has_the_same_dofs() {
        for size in [1e-200, 1e-3, 1.0, 1e3, 1e200] {
            let u = [2.0, -0.5, 3e-7, 3e-6].map(|u| u * size);
            let found = FreeMotion::new(&u, &u, 0.0);
            assert_eq!((&found.dofs[..], &found.motion[..2]), (&[0, 1, 3][..], &[1.0, -0.25][..]), "{size}");
        }
    }
}
