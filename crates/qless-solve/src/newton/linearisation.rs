//! The analysis of `G S y = -c` with the units S, and the Newton step `y_s = T y_q + g` with `y_q = 0`, `du = S y`.
//!
//! T is not needed for a step and would grow with the square of the length of a chain of bodies, so that it stays in factored form.
//! Prescribed DOFs already have their values; their increments are zero.

use qless::{Analysis, Form, Kind, Noise, Options, Reduction, Tolerance, analyse};
use qless_constraints::{ConstraintSet, Evaluation, Rounding};

use super::error::NewtonError;
use crate::common::HALF_DIGITS;

/// Smallest limit for the entries of T. If the first hinge of a chain turns, the end of the chain moves by its length, which is an entry of
/// T. With this limit, chains of up to a million links keep the slaves that elimination prefers.
const GROWTH: f64 = 1e6;

/// Bound on the rounding of a motion `du = T dq` for a dq of size 1: the rounding of the largest entry of T.
pub const LOST: f64 = f64::EPSILON * GROWTH;

/// Constraint values c and their Jacobian G at a configuration, with bounds on their rounding and the units S of the DOFs.
#[derive(Clone, Copy)]
pub struct Place<'a> {
    pub set: &'a ConstraintSet,
    pub evaluation: &'a Evaluation,
    pub rounding: &'a Rounding,
    pub units: &'a [f64],
}

/// Analyses `G S y = -c`, with the units S, for a Newton step; the prescribed DOFs do not move. The tolerance is at least half of the
/// digits.
pub fn linearise(
    place: Place,
    prescribed: &[(usize, f64)],
    (step, options): (usize, &Options),
) -> Result<Analysis, NewtonError> {
    // A row that differs from a combination of others by less than HALF_DIGITS counts as redundant. It is not needed: so close to the
    // solution, the next step reaches rounding without it.
    let tolerance = match options.tolerance {
        Tolerance::Relative(least) => Tolerance::Relative(least.max(HALF_DIGITS)),
        absolute => absolute,
    };
    options.validate().map_err(|source| NewtonError::Analysis { step, source: source.into() })?;
    analyse_rows(
        place,
        prescribed,
        (step, Options { growth: options.growth.max(GROWTH), tolerance, ..options.clone() }),
    )
}

/// As [`linearise`], but entries of row r up to `floors[r]` (in the units S) count as zero, and the tolerance of the options is used
/// unchanged.
pub fn linearise_above(
    floors: Vec<f64>,
    place: Place,
    prescribed: &[(usize, f64)],
    (step, options): (usize, &Options),
) -> Result<Analysis, NewtonError> {
    let noise = Noise::Floors { rhs: vec![0.0; floors.len()], coefficients: floors };
    analyse_with(place, prescribed, (step, Options { growth: options.growth.max(GROWTH), noise, ..options.clone() }))
}

/// Analyses `G S y = -c`, with the units S and the tolerance of the options; the prescribed DOFs do not move.
pub fn analyse_rows(
    place: Place,
    prescribed: &[(usize, f64)],
    (step, options): (usize, Options),
) -> Result<Analysis, NewtonError> {
    // The constraint set has already left out entries within their rounding error, so no other number counts as noise.
    analyse_with(place, prescribed, (step, Options { noise: Noise::None, ..options }))
}

fn analyse_with(
    Place { set, evaluation, rounding, units }: Place,
    prescribed: &[(usize, f64)],
    (step, options): (usize, Options),
) -> Result<Analysis, NewtonError> {
    let still: Vec<(usize, f64)> = prescribed.iter().map(|&(j, v)| (j, 0.0 * v)).collect();
    let system = set.linearised_in(units, evaluation, rounding, &still);
    let system = system.map_err(|source| NewtonError::System { step, source })?;
    analyse(&system, &options).map_err(|source| NewtonError::Analysis { step, source })
}

/// The motions `y_s = T y_q + g`, `du = S y` that an analysis allows, with the units S.
pub struct Motions<'a> {
    pub reduction: Reduction,
    pub units: &'a [f64],
}

impl<'a> Motions<'a> {
    pub fn new(analysis: &Analysis, units: &'a [f64], step: usize) -> Result<Self, NewtonError> {
        let reduction = analysis.reduction_in(Form::Factored);
        Ok(Self { reduction: reduction.map_err(|source| NewtonError::Reduction { step, source })?, units })
    }

    /// The motion `du = S [T; I] z + S g` for increments z of the masters, which are divided by their units S.
    pub fn expand(&self, z: &[f64]) -> Result<Vec<f64>, qless::ArgumentError> {
        let y = self.reduction.expand(z, &vec![0.0; self.reduction.prescribed().len()])?;
        Ok(y.iter().zip(self.units).map(|(y, unit)| y * unit).collect())
    }

    /// The motion du in which no master moves.
    pub fn step(&self) -> Result<Vec<f64>, qless::ArgumentError> {
        self.expand(&vec![0.0; self.reduction.masters().len()])
    }

    /// Forces on the masters for forces f on all DOFs: `T^T (S f)_s + (S f)_q`, with the diagonal matrix S of the units.
    pub fn restrict(&self, f: &[f64]) -> Result<Vec<f64>, qless::ArgumentError> {
        let scaled = |&j: &usize| self.units[j] * f[j];
        let slaves: Vec<f64> = self.reduction.slaves().iter().map(scaled).collect();
        let pulled = self.reduction.apply_transposed(&slaves)?;
        Ok(self.reduction.masters().iter().map(scaled).zip(pulled).map(|(own, pulled)| own + pulled).collect())
    }
}

/// Equations that the analysis found to be redundant or conflicting.
pub fn dependent(analysis: &Analysis) -> Vec<usize> {
    analysis.dependent().iter().map(|dependent| dependent.row).collect()
}

/// Whether each equation is independent.
pub fn kept(analysis: &Analysis) -> Vec<bool> {
    analysis.kinds().iter().map(|&kind| kind == Kind::Independent).collect()
}
