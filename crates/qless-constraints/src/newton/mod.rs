//! Newton's method with the elimination applied to G: `G du = -c`, `du_s = T du_q + G du_p + g` (Eq. 23-26 at every iterate).
//!
//! Redundant constraints are found by the analysis at every iterate, and left out of the step. Off the solution their rows of G
//! may be independent by as little as the distance to it. That does no harm: their values differ by the square of the
//! distance, so that a step which satisfies both is no longer than the distance, and the convergence stays quadratic.

mod linearisation;
mod redundancy;
mod residual;

use qless::{Analysis, AnalysisError, ArgumentError, Kind, Options, ReductionError};

use linearisation::Linearisation;
pub use redundancy::{Redundancy, redundancies};
use residual::residuals;

use crate::set::rotations::shorten;
use crate::{ConstraintSet, LineariseError, Quantities};

/// Settings of [`solve`].
#[derive(Clone, Debug)]
pub struct NewtonOptions {
    /// Done when `max_i |c_i| / max_j |G_ij| <= tolerance max(1, max |u|)`: what is left to move. Default 1e-12.
    pub tolerance: f64,
    /// Most steps. Default 30.
    pub steps: usize,
    /// How the linearised equations are analysed.
    pub analysis: Options,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self { tolerance: 1e-12, steps: 30, analysis: Options::default() }
    }
}

/// One iterate: what was found before its step was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Iterate {
    /// `max_i |c_i| / max_j |G_ij|`, and what prescribed DOFs have yet to move if that is more.
    pub residual: f64,
    /// Rank of G.
    pub rank: usize,
    /// Equations left out of the step.
    pub left_out: Vec<usize>,
}

/// A configuration that satisfies all constraints.
#[derive(Clone, Debug)]
pub struct Solution {
    /// The DOFs.
    pub u: Vec<f64>,
    /// The way there; the last one is the solution.
    pub iterates: Vec<Iterate>,
    /// Equations that are redundant at the solution.
    pub redundant: Vec<usize>,
}

/// Why no solution was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NewtonError {
    /// A number of the linearised equations is not finite, or a prescribed DOF is not valid.
    #[error("at step {step}: {source}")]
    System {
        /// From 0.
        step: usize,
        /// What is wrong.
        source: LineariseError,
    },
    /// u does not have one value per DOF, or a step leads out of the range of doubles.
    #[error("at step {step}: {source}")]
    Argument {
        /// From 0.
        step: usize,
        /// What is wrong.
        source: ArgumentError,
    },
    /// The linearised equations cannot be analysed.
    #[error("at step {step}: {source}")]
    Analysis {
        /// From 0.
        step: usize,
        /// What is wrong.
        source: AnalysisError,
    },
    /// The linearised equations cannot be solved for slaves.
    #[error("at step {step}: {source}")]
    Reduction {
        /// From 0.
        step: usize,
        /// What is wrong.
        source: ReductionError,
    },
    /// Constraints that cannot hold together with those that they depend on.
    #[error("{} cannot hold together with the equations that it depends on: {amount} is left of it", .labels.join(" and "))]
    Conflict {
        /// The equations.
        rows: Vec<usize>,
        /// Their labels.
        labels: Vec<String>,
        /// The largest residual among them.
        amount: f64,
    },
    /// Too many steps.
    #[error("no convergence in {steps} steps: the residual is {residual}; start nearer to the solution")]
    NoConvergence {
        /// Steps made.
        steps: usize,
        /// Residual at the end.
        residual: f64,
    },
}

/// Finds `c(u) = 0` from `u`; DOFs that are not slaves stay, prescribed ones `(DOF, value)` take their values.
///
/// Rotation vectors are kept below half a turn: one that is longer is replaced by a shorter one of the same rotation
/// ([`ConstraintSet::shorten_rotations`]), unless one of its DOFs is prescribed.
///
/// Near a solution the residual falls as `r_(k+1) <= C r_k^2`, with redundant constraints in the set too.
///
/// ```
/// use qless_constraints::newton::{NewtonOptions, solve};
/// use qless_constraints::{ConstraintSet, types::{OnSphere, PlanarPoint}};
/// let point = PlanarPoint::new([0, 1], [1.0, 0.0]);
/// let mut builder = ConstraintSet::builder(2);
/// builder.add("crank", OnSphere { point, centre: [0.0; 2], radius: None })?;
/// let solution = solve(&builder.build()?, &[0.0, 0.5], &[(1, 0.6)], &NewtonOptions::default())?;
/// // (0.8, 0.6) is on the circle.
/// assert!((solution.u[0] + 0.2).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`NewtonError`].
pub fn solve(
    set: &ConstraintSet,
    u: &[f64],
    prescribed: &[(usize, f64)],
    options: &NewtonOptions,
) -> Result<Solution, NewtonError> {
    let mut run = Run::new(set, u, prescribed, options)?;
    let mut before = None;
    for step in 0..=options.steps {
        let mut linearisation = run.look(step, before)?;
        if run.done() {
            let redundant = dependent(&linearisation.analysis);
            return Ok(Solution { u: run.u, iterates: run.iterates, redundant });
        }
        run.check_conflict(&linearisation.analysis)?;
        run.advance(&mut linearisation, step)?;
        before = Some(linearisation);
    }
    Err(NewtonError::NoConvergence { steps: options.steps, residual: run.last() })
}

/// Equations that are not kept.
pub(crate) fn dependent(analysis: &Analysis) -> Vec<usize> {
    analysis.dependent().iter().map(|dependent| dependent.row).collect()
}

/// The state between two steps.
struct Run<'a> {
    set: &'a ConstraintSet,
    options: &'a NewtonOptions,
    prescribed: &'a [(usize, f64)],
    /// Rotation vectors, none of them prescribed: kept below half a turn, so that none comes to a whole one, where it is singular.
    rotations: Vec<[usize; 3]>,
    u: Vec<f64>,
    quantities: Quantities,
    residuals: Vec<f64>,
    iterates: Vec<Iterate>,
}

impl<'a> Run<'a> {
    fn new(
        set: &'a ConstraintSet,
        u: &[f64],
        prescribed: &'a [(usize, f64)],
        options: &'a NewtonOptions,
    ) -> Result<Self, NewtonError> {
        let (quantities, mut rotations) = (set.allocate(), set.rotation_vectors());
        rotations.retain(|vector| prescribed.iter().all(|(dof, _)| !vector.contains(dof)));
        crate::set::long("u", u.len(), set.dofs()).map_err(|source| NewtonError::Argument { step: 0, source })?;
        let (u, residuals) = (u.to_vec(), Vec::new());
        let mut run = Self { set, options, prescribed, rotations, u, quantities, residuals, iterates: Vec::new() };
        run.arrive(0)?;
        Ok(run)
    }

    /// c and G at u, with rotations in the shortest vectors.
    fn arrive(&mut self, step: usize) -> Result<(), NewtonError> {
        self.rotations.iter().for_each(|&vector| _ = shorten(&mut self.u, vector));
        let argument = |source| NewtonError::Argument { step, source };
        self.set.evaluate(&self.u, &mut self.quantities).map_err(argument)?;
        self.residuals = residuals(&self.quantities);
        Ok(())
    }

    /// Linearises and analyses at the present u; where all equations are linear, what was found before still holds.
    fn look(&mut self, step: usize, before: Option<Linearisation>) -> Result<Linearisation, NewtonError> {
        let increments: Vec<_> = self.prescribed.iter().map(|&(j, v)| (j, v - self.u.get(j).unwrap_or(&0.0))).collect();
        let constant = self.set.linear_rows().len() == self.set.equations();
        let known = before.filter(|_| constant).and_then(|before| before.refreshed(&self.quantities, &increments));
        let found = match known {
            Some(known) => known,
            None => Linearisation::new(self.set, &self.quantities, &increments, (step, self.options))?,
        };
        let ahead = increments.iter().map(|&(_, increment): &(usize, f64)| increment.abs());
        self.iterates.push(Iterate {
            residual: self.residuals.iter().copied().chain(ahead).fold(0.0, f64::max),
            rank: found.analysis.rank(),
            left_out: dependent(&found.analysis),
        });
        Ok(found)
    }

    fn last(&self) -> f64 {
        self.iterates.last().map_or(0.0, |iterate| iterate.residual)
    }

    /// Whether the chosen equations hold to the tolerance.
    fn satisfied(&self, chosen: impl Fn(usize) -> bool) -> bool {
        let size = self.u.iter().fold(1.0, |most: f64, u| most.max(u.abs()));
        let holds = |r: f64| r <= self.options.tolerance * size;
        self.residuals.iter().enumerate().all(|(row, &r)| holds(r) || !chosen(row))
    }

    fn done(&self) -> bool {
        let there = |&(j, v): &(usize, f64)| (self.u[j] - v).abs() <= self.options.tolerance * v.abs().max(1.0);
        self.satisfied(|_| true) && self.prescribed.iter().all(there)
    }

    /// All that is kept holds, and something that is left out does not.
    fn check_conflict(&self, analysis: &Analysis) -> Result<(), NewtonError> {
        if !self.satisfied(|row| analysis.kinds()[row] == Kind::Independent) {
            return Ok(());
        }
        let unsatisfied = |&row: &usize| !self.satisfied(|other| other == row);
        let rows: Vec<usize> = dependent(analysis).into_iter().filter(unsatisfied).collect();
        if rows.is_empty() {
            return Ok(());
        }
        let labels = rows.iter().filter_map(|&row| self.set.label(row).ok()).collect();
        let amount = rows.iter().map(|&row| self.residuals[row]).fold(0.0, f64::max);
        Err(NewtonError::Conflict { rows, labels, amount })
    }

    /// `u += du`, masters staying where they are.
    fn advance(&mut self, linearisation: &mut Linearisation, step: usize) -> Result<(), NewtonError> {
        let du = linearisation.step(step)?;
        self.u.iter_mut().zip(du).for_each(|(u, du)| *u += du);
        self.arrive(step)
    }
}
