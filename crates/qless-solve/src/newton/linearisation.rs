//! `G du = -c` analysed: `du_s = T du_q + g`. Where G is constant, a new c needs no new analysis until a step is wanted.
//!
//! A step is `du_q = 0`: of T nothing is needed, and along a chain of bodies it is as large as the square of their number. Connected
//! parts stay factors. Prescribed DOFs have their values from the start, so that their increments are zero.
//! @@ newton/units.rs
//! Units of the DOFs, `du_j = s_j y_j`: lengths and angles made comparable before the rank of `G S` is asked for.
//!
//! Lengths of 1e-6 beside radians hide rows: what distinguishes two of them may be in columns that are a million times shorter than
//! others. From the sizes of the terms of c, s follows the unit of length; powers of two round nothing.

use qless::{Analysis, ArgumentError, Form, Options, analyse};
use qless_constraints::{ConstraintSet, Quantities};

use super::configuration::inverse;
use super::error::NewtonError;
use super::parts::PartColumns;
use super::solution::NewtonOptions;

/// T may have entries up to this: masters stay where they are, so that T does not enter a step.
const GROWTH: f64 = 1e6;

/// The linearised equations at one iterate.
pub struct Linearisation {
    pub analysis: Analysis,
    /// Whether c is still that of the iterate: which equations are independent depends on G alone, a step does not.
    pub current: bool,
    /// Of prescribed DOFs.
    increments: Vec<f64>,
    /// `du_j = s_j y_j`: what was analysed are equations for y.
    pub units: Vec<f64>,
}

impl Linearisation {
    /// Linearises and analyses; DOFs in `held` do not move.
    pub fn new(
        set: &ConstraintSet,
        quantities: &Quantities,
        (held, of): (&[(usize, f64)], &PartColumns),
        (step, options): (usize, &NewtonOptions),
    ) -> Result<Self, NewtonError> {
        options.analysis.validate().map_err(|source| NewtonError::Analysis { step, source: source.into() })?;
        let increments: Vec<(usize, f64)> = held.iter().map(|&(j, v)| (j, 0.0 * v)).collect();
        let units = units(set, quantities, of).map_err(|source| NewtonError::Argument { step, source })?;
        let system = set
            .linearised_in(&units, quantities, &increments)
            .map_err(|source| NewtonError::System { step, source })?;
        // Along a chain the end moves by its length where the first hinge turns: to avoid that, slaves would have to be looked for far away.
        let growth = options.analysis.growth.max(GROWTH);
        // PartColumns are in units already: what moves little for c is no slave, or steps are as large as it is small.
        let loose = Options { growth, balance: false, ..options.analysis.clone() };
        let analysis = analyse(&system, &loose).map_err(|source| NewtonError::Analysis { step, source })?;
        let increments = vec![0.0; held.len()];
        Ok(Self { analysis, current: true, increments, units })
    }

    /// The same G, for another c.
    pub fn outdated(self) -> Self {
        Self { current: false, ..self }
    }

    /// du with masters staying where they are.
    pub fn step(&self, step: usize) -> Result<Vec<f64>, NewtonError> {
        let reduction = self.analysis.reduction_in(Form::Factored);
        let reduction = reduction.map_err(|source| NewtonError::Reduction { step, source })?;
        let du = reduction.expand(&vec![0.0; reduction.masters().len()], &self.increments);
        let mut du = du.map_err(|source| NewtonError::Argument { step, source })?;
        du.iter_mut().zip(&self.units).for_each(|(du, unit)| *du *= unit);
        Ok(du)
    }
}

/// Equations that are not kept.
pub fn dependent(analysis: &Analysis) -> Vec<usize> {
    analysis.dependent().iter().map(|dependent| dependent.row).collect()
}

/// Roundings of an entry.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;
/// Passes over linear rows.
const SWEEPS: usize = 20;

/// s: the power of two nearest to the reach of each column, those of DOFs first; 1 where there is none, and for DOFs that are held.
pub fn units(set: &ConstraintSet, quantities: &Quantities, of: &PartColumns) -> Result<Vec<f64>, ArgumentError> {
    let power = |reach: f64| if reach > 0.0 { reach.log2().round().exp2() } else { 1.0 };
    let usable = |unit: f64| if unit.is_normal() && (1.0 / unit).is_normal() { unit } else { 1.0 };
    Ok(reaches(set, quantities, of)?.into_iter().map(|reach| usable(power(reach))).collect())
}

/// `1 / max_r (|G_rj| / size_r)` over the nonlinear rows: how far each DOF goes until some c has changed by the size of its terms.
///
/// An entry counts for what its terms are, which its rounding tells, where they cancel. Displacements of a row have one unit, that of their largest
/// entry: a rod along an axis gives those across it no longer reach.
/// Of linear rows only the ratios of their entries count, since their terms vanish with u: a DOF of no nonlinear row goes as far as its partners. 0
/// where nothing is known.
fn reaches(set: &ConstraintSet, quantities: &Quantities, of: &PartColumns) -> Result<Vec<f64>, ArgumentError> {
    let (g, rounding) = (quantities.g(), set.rounding(quantities.u())?);
    let linear = set.linear_rows();
    let mut steepness = vec![0.0_f64; of.count()];
    for (row, bound) in rounding.c().iter().enumerate().filter(|(row, _)| !linear.contains(row)) {
        let weight = inverse(bound / f64::EPSILON);
        let entries = || of.row(g, row).zip(g.row(row)).zip(rounding.of_row(row));
        let sizes = || entries().map(|(((j, v), (dof, _)), bound)| (j, dof, v.abs().max(bound / ROUNDINGS)));
        let of_displacements =
            sizes().filter(|&(_, dof, _)| set.is_displacement(dof)).fold(0.0, |most: f64, (.., size)| most.max(size));
        for (j, dof, size) in sizes() {
            let size = if set.is_displacement(dof) { of_displacements } else { size };
            steepness[j] = steepness[j].max(size * weight);
        }
    }
    let mut reaches: Vec<f64> = steepness.into_iter().map(inverse).collect();
    spread(|row| of.row(g, row), linear, &mut reaches);
    Ok(reaches)
}

/// Gives DOFs without a reach that of their partners in the given rows, from row to row.
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
