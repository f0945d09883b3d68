//! Why constraints cannot be enforced.
//! @@ enforce/error/motion.rs
//! A motion that nothing holds, and its words.

use qless::elimination::EliminationError;
use qless::{AnalysisError, ArgumentError, ReductionError, SystemError};

use super::SolverError;

/// Why constraints cannot be enforced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EnforceError {
    /// K or f does not fit to the constraints.
    #[error("there are {found} {what}, but the constraints are on {dofs} DOFs")]
    Size {
        /// What does not fit.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        dofs: usize,
    },
    /// A number that is not finite, of K, f or a prescribed value.
    #[error("K, f or a prescribed value is {value}; every number must be finite")]
    NotFinite {
        /// The number.
        value: f64,
    },
    /// MeasuredEquations contradict others.
    #[error("{} cannot hold together with the equations that it depends on", .labels.join(" and "))]
    Conflict {
        /// The equations, 0-based.
        rows: Vec<usize>,
        /// Their labels.
        labels: Vec<String>,
    },
    /// Whether an equation follows from others is in doubt, and u depends on it.
    #[error(
        "{label} follows from others but for {left:.1e} of its terms, too little to be sure that it does not; give its coefficients with all \
         their digits, bring the units of its DOFs nearer to one another, or leave it out"
    )]
    Doubtful {
        /// The equation, 0-based.
        row: usize,
        /// Its label.
        label: String,
        /// What is left of it where the others hold, relative to the terms.
        left: f64,
    },
    /// The plan is not one of this problem.
    #[error("the plan has {planned} equations, but {kept} are independent, and each must occur once")]
    Plan {
        /// MeasuredEquations of the plan.
        planned: usize,
        /// MeasuredEquations that it should have.
        kept: usize,
    },
    /// One half of K was given as all of it.
    #[error(
        "all entries of K off the diagonal are on one side; declare Stiffness::{} if K is symmetric and this is one half of it, \
         Stiffness::unsymmetric if K is a triangle",
        if *.lower { "lower" } else { "upper" }
    )]
    Triangle {
        /// Whether it is the lower half.
        lower: bool,
    },
    /// K has an entry in the half that was declared not to be stored.
    #[error(
        "K has an entry in row {row}, column {column} (from 0), which is not in the half declared; give one half, or Stiffness::full"
    )]
    WrongHalf {
        /// Its row.
        row: usize,
        /// Its column.
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
    /// The matrix has no inverse, and no motion that it leaves free was found.
    #[error("{what} is singular, but no single motion that it leaves free was found; look for DOFs without stiffness")]
    Singular {
        /// Which matrix.
        what: &'static str,
    },
    /// A solution that is not in balance.
    #[error(
        "{row}: {imbalance:.1e} of the terms is left after refinement; the model is too ill-conditioned for double precision"
    )]
    OutOfBalance {
        /// The forces on a DOF, or the label of an equation.
        row: String,
        /// What is left, relative to the terms.
        imbalance: f64,
    },
    /// Springs so soft that they leave more than was asked for.
    #[error(
        "penalty factor {factor:.1e}: u is off by {cost:.1e} of its size, and {accuracy:.1e} was asked for; {}",
        advice(*.smallest)
    )]
    PenaltyTooSmall {
        /// The largest factor asked for.
        factor: f64,
        /// The share of u that was asked for.
        accuracy: f64,
        /// The share of u that is left.
        cost: f64,
        /// One that was found to do.
        smallest: Option<f64>,
    },
    /// Numbers that do not fit into memory, or into the integers of the solver.
    #[error("a matrix of {rows} x {cols} is too large")]
    TooLarge {
        /// Its rows.
        rows: usize,
        /// Its columns.
        cols: usize,
    },
    /// Parts of T stay factors.
    #[error(
        "T has parts that stay factors, of which no step is made; make the elimination with Form::Explicit, or use Problem"
    )]
    Factored,
    /// The author's solver gave no solution.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// Augmented equations that rounding keeps from what was asked for.
    #[error(
        "{left:.1e} of the terms of a constraint is left, which is rounding, and {tolerance:.1e} was asked for; ask for more than that"
    )]
    NoConvergence {
        /// Largest residual of an equation, relative to its terms.
        left: f64,
        /// What was asked for.
        tolerance: f64,
    },
    /// Numbers so large or so small that the solution leaves the range of doubles.
    #[error("the solution leaves the range of doubles; choose units in which K, f and u are nearer to one")]
    OutOfRange,
    /// A limit of fill that is no number, or negative.
    #[error("the limit of fill is {0}; it must be zero or more, such as 10")]
    Limit(f64),
    /// The constraints cannot be analysed.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// The constraints cannot be solved for slaves.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// The equations chosen are no valid system.
    #[error(transparent)]
    System(#[from] SystemError),
    /// The equations cannot be put into the form that K is condensed with.
    #[error(transparent)]
    Elimination(#[from] EliminationError),
    /// Numbers that do not fit, or that lead out of the range of doubles.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
}

/// What a factor would have to be, or that there is none.
fn advice(factor: Option<f64>) -> String {
    match factor {
        Some(factor) => format!("a factor that does is {factor:.1e}"),
        None => "no factor does: use multipliers or elimination".into(),
    }
}

/// DOFs that take part by less than this share of the largest are not named; in units without units.
const SHARE: f64 = 1e-6;
/// DOFs in the message.
const NAMED: usize = 8;

/// A motion that constraints and prescribed DOFs leave free, up to rounding.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FreeMotion {
    /// The DOFs that move, ascending.
    pub dofs: Vec<usize>,
    /// How far each of them moves, in its own unit; the largest number is 1 or -1.
    pub motion: Vec<f64>,
    /// The largest force that holds it, relative to its terms: rounding, if not zero.
    pub held: f64,
}

impl FreeMotion {
    /// From a null vector of all DOFs and the unit of each.
    pub(in super::super) fn new(u: &[f64], units: &[f64], held: f64) -> Self {
        let sizes: Vec<f64> = u.iter().zip(units).map(|(u, s)| u.abs() / s).collect();
        let most = sizes.iter().fold(0.0, |most: f64, size| most.max(*size));
        let dofs: Vec<usize> = (0..u.len()).filter(|&j| sizes[j] > SHARE * most).collect();
        let largest =
            dofs.iter().fold(0.0, |largest: f64, &j| if u[j].abs() > f64::abs(largest) { u[j] } else { largest });
        let motion = dofs.iter().map(|&j| u[j] / largest).collect();
        Self { dofs, motion, held }
    }

    /// The same where DOFs have other numbers, ascending.
    pub(in super::super) fn of(mut self, dofs: &[usize]) -> Self {
        self.dofs.iter_mut().for_each(|j| *j = dofs[*j]);
        self
    }

    /// Both, each with its largest number 1 or -1.
    pub(in super::super) fn and(&self, other: &Self) -> Self {
        let moves = |motion: &Self| motion.dofs.iter().copied().zip(motion.motion.clone()).collect::<Vec<_>>();
        let mut both = [moves(self), moves(other)].concat();
        both.sort_by_key(|&(dof, _)| dof);
        let (dofs, motion) = both.into_iter().unzip();
        Self { dofs, motion, held: self.held.max(other.held) }
    }
}

impl std::fmt::Display for FreeMotion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.dofs.is_empty() {
            return write!(f, "the equations depend on one another up to rounding, so that their multipliers are free");
        }
        write!(f, "nothing holds the motion of DOF ")?;
        for (place, (dof, value)) in self.dofs.iter().zip(&self.motion).take(NAMED).enumerate() {
            write!(f, "{}{dof} ({value:+.3})", if place > 0 { ", " } else { "" })?;
        }
        let others = self.dofs.len().saturating_sub(NAMED);
        if others > 0 {
            write!(f, " and {others} others")?;
        }
        write!(f, " but forces of {:.1e} of what they are made of, which is rounding", self.held)
    }
}
