//! The analysis of `G du = -c`, and the Newton step `du_s = T du_q + g` with `du_q = 0`. If G is constant, a new c needs no new analysis.
//!
//! T is not needed for a step and would grow with the square of the length of a chain of bodies, so that it stays in factored form.
//! Prescribed DOFs already have their values; their increments are zero.
//!
//! Columns of G are scaled by units, `du_j = s_j y_j`, which make lengths and angles comparable before the rank of `G S` is determined.
//!
//! With lengths of 1e-6 beside angles in radians, two rows may differ only in columns that are a million times smaller than others. The
//! units are computed from the sizes of the terms of c, so that they adapt to the unit of length. They are powers of two, which cause no
//! rounding.

use qless::{Analysis, ArgumentError, Form, Noise, Options, Tolerance, analyse};
use qless_constraints::{ConstraintSet, Evaluation};

use super::configuration::inverse;
use super::error::NewtonError;
use super::parts::PartColumns;
use super::solution::NewtonOptions;

/// Bound on the entries of T. It can be large: masters do not move, so that T does not affect a step.
const GROWTH: f64 = 1e6;

/// Smallest relative tolerance of the rank on the way to a solution: half of the digits of a double. Rows that smaller changes make
/// independent are not needed: so close to the solution, the next step ends at rounding.
const CHANGE: f64 = 1e-8;

/// The linearised equations at one iterate.
pub struct Linearisation {
    pub analysis: Analysis,
    /// Whether c belongs to this iterate. The choice of independent equations depends on G alone; a step depends on c.
    pub current: bool,
    /// Increments of the prescribed DOFs: zeros.
    increments: Vec<f64>,
    /// `du_j = s_j y_j`; the analysis is of y.
    pub units: Vec<f64>,
}

impl Linearisation {
    /// Linearises and analyses; the DOFs in `prescribed` do not move.
    pub fn new(
        set: &ConstraintSet,
        evaluation: &Evaluation,
        (prescribed, columns): (&[(usize, f64)], &PartColumns),
        (step, options): (usize, &NewtonOptions),
    ) -> Result<Self, NewtonError> {
        options.analysis.validate().map_err(|source| NewtonError::Analysis { step, source: source.into() })?;
        let increments: Vec<(usize, f64)> = prescribed.iter().map(|&(j, v)| (j, 0.0 * v)).collect();
        let units = units(set, evaluation, columns).map_err(|source| NewtonError::Argument { step, source })?;
        let system = set
            .linearised_in(&units, evaluation, &increments)
            .map_err(|source| NewtonError::System { step, source })?;
        // If the first hinge of a chain turns, the end of the chain moves by the length of the chain, which is an entry of T. A smaller
        // bound would require other slaves, far along the chain.
        let growth = options.analysis.growth.max(GROWTH);
        let tolerance = match options.analysis.tolerance {
            Tolerance::Relative(least) => Tolerance::Relative(least.max(CHANGE)),
            absolute => absolute,
        };
        // The set has already left out entries within their rounding error, so no other number counts as noise.
        let loose = Options { growth, tolerance, noise: Noise::None, ..options.analysis.clone() };
        let analysis = analyse(&system, &loose).map_err(|source| NewtonError::Analysis { step, source })?;
        let increments = vec![0.0; prescribed.len()];
        Ok(Self { analysis, current: true, increments, units })
    }

    /// Marks c as changed.
    pub fn outdated(self) -> Self {
        Self { current: false, ..self }
    }

    /// du if masters do not move.
    pub fn step(&self, step: usize) -> Result<Vec<f64>, NewtonError> {
        let reduction = self.analysis.reduction_in(Form::Factored);
        let reduction = reduction.map_err(|source| NewtonError::Reduction { step, source })?;
        let du = reduction.expand(&vec![0.0; reduction.masters().len()], &self.increments);
        let mut du = du.map_err(|source| NewtonError::Argument { step, source })?;
        du.iter_mut().zip(&self.units).for_each(|(du, unit)| *du *= unit);
        Ok(du)
    }
}

/// Equations that the analysis found to be redundant or conflicting.
pub fn dependent(analysis: &Analysis) -> Vec<usize> {
    analysis.dependent().iter().map(|dependent| dependent.row).collect()
}

/// Relative rounding of an entry.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;
/// Most passes over linear rows.
const SWEEPS: usize = 20;

/// The power of two nearest to the reach of each column; 1 for DOFs without a reach. Columns of DOFs come first.
pub fn units(set: &ConstraintSet, evaluation: &Evaluation, columns: &PartColumns) -> Result<Vec<f64>, ArgumentError> {
    let power = |reach: f64| if reach > 0.0 { reach.log2().round().exp2() } else { 1.0 };
    let usable = |unit: f64| if unit.is_normal() && (1.0 / unit).is_normal() { unit } else { 1.0 };
    Ok(reaches(set, evaluation, columns)?.into_iter().map(|reach| usable(power(reach))).collect())
}

/// Reach of each column: how far a DOF moves until a nonlinear c changes by the size of its terms, `1 / max_r (|G_rj| / size_r)`.
///
/// An entry counts as the size of its terms, known from its rounding, even if they cancel. In each row, the entries of all DOFs that move
/// nodes count as the largest of them: otherwise a rod along an axis would give the DOFs across it a longer reach. Terms of linear rows
/// vanish with u, so that only the ratios of their entries count: a DOF without nonlinear rows gets the reach of its neighbours, or 0 if
/// these have none.
fn reaches(set: &ConstraintSet, evaluation: &Evaluation, columns: &PartColumns) -> Result<Vec<f64>, ArgumentError> {
    let (g, rounding) = (evaluation.g(), set.rounding(evaluation.u())?);
    let linear = set.linear_rows();
    let mut steepness = vec![0.0_f64; columns.count];
    for (row, bound) in rounding.c().iter().enumerate().filter(|(row, _)| !linear.contains(row)) {
        let weight = inverse(bound / f64::EPSILON);
        let entries = || columns.row(g, row).zip(g.row(row)).zip(rounding.of_row(row));
        let sizes = || entries().map(|(((j, v), (dof, _)), bound)| (j, dof, v.abs().max(bound / ROUNDINGS)));
        let of_motions =
            sizes().filter(|&(_, dof, _)| set.moves_node(dof)).fold(0.0, |most: f64, (.., size)| most.max(size));
        for (j, dof, size) in sizes() {
            let size = if set.moves_node(dof) { of_motions } else { size };
            steepness[j] = steepness[j].max(size * weight);
        }
    }
    let mut reaches: Vec<f64> = steepness.into_iter().map(inverse).collect();
    spread(|row| columns.row(g, row), linear, &mut reaches);
    Ok(reaches)
}

/// Spreads reaches along the entries of the given rows to columns without one.
fn spread<I: Iterator<Item = (usize, f64)>>(
    entries: impl Fn(usize) -> I,
    rows: std::ops::Range<usize>,
    reaches: &mut [f64],
) {
    for _ in 0..SWEEPS {
        let mut found = false;
        for row in rows.clone() {
            let most = entries(row).map(|(j, v)| v.abs() * reaches[j]).fold(0.0, f64::max);
            for (j, v) in entries(row).filter(|_| most > 0.0) {
                if reaches[j] == 0.0 && v != 0.0 {
                    reaches[j] = most / v.abs();
                    found = true;
                }
            }
        }
        if !found {
            break;
        }
    }
}
