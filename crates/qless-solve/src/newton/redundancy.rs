//! Distinguishes equations that are redundant everywhere from those that are redundant in one configuration only.
//!
//! A mechanism may lose rank in a special configuration, such as a flat linkage, although its equations are independent elsewhere. A second
//! configuration decides: a random step `du = T dq` that the kept equations allow, corrected by Newton's method.

use qless::{Analysis, Form, Noise, Options, Reduction, analyse};
use qless_constraints::{ConstraintSet, Evaluation};

use super::configuration::{change, sizes_of_dofs};
use super::error::NewtonError;
use super::linearisation::{dependent, units};
use super::parts::PartColumns;
use super::solution::NewtonOptions;
use super::solve;
use crate::common::random;

/// Relative change of the entries of G on the way to the second configuration, columns scaled by the sizes of DOFs.
const STEP: f64 = 0.05;
/// Number of random directions.
const TRIES: u64 = 8;

/// Whether an equation that is redundant at u is redundant at other configurations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Redundancy {
    /// In all configurations nearby, or there are no others: the equation can be removed.
    Everywhere,
    /// Only in this configuration, which is singular; the equation is needed elsewhere.
    OnlyHere,
    /// Unknown: Newton's method reached no second configuration.
    Unknown,
}

/// Finds the equations that are redundant at a consistent configuration u, and whether they are redundant at others.
///
/// ```
/// use qless_solve::newton::{NewtonOptions, Redundancy, redundancies};
/// use qless_constraints::{ConstraintSet, types::{Distance, OnSphere, PlanarPoint}};
/// // A parallelogram, folded flat: its coupler lies on the line of its arms.
/// let (p, q) = (PlanarPoint::new([0, 1], [1.0, 0.0]), PlanarPoint::new([2, 3], [3.0, 0.0]));
/// let mut builder = ConstraintSet::builder(4);
/// builder.add("arm 1", OnSphere { point: p, centre: [0.0, 0.0], radius: None })?;
/// builder.add("arm 2", OnSphere { point: q, centre: [2.0, 0.0], radius: None })?;
/// builder.add("coupler", Distance::new(p, q))?;
/// let found = redundancies(&builder.build()?, &[0.0; 4], &NewtonOptions::default())?;
/// assert_eq!((found.len(), found[0].1), (1, Redundancy::OnlyHere));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`NewtonError`] if the equations at u cannot be analysed.
pub fn redundancies(
    set: &ConstraintSet,
    u: &[f64],
    options: &NewtonOptions,
) -> Result<Vec<(usize, Redundancy)>, NewtonError> {
    let here = RedundancyAnalysis::new(set, u, &options.analysis)?;
    let rows = dependent(&here.analysis);
    if rows.is_empty() {
        return Ok(Vec::new());
    }
    let elsewhere = match here.nearby(set, u, options) {
        Nearby::Same => rows.clone(),
        Nearby::At(v) => {
            let mut analysis = options.analysis.clone();
            analysis.preferences.equations = (0..set.equations()).filter(|row| !rows.contains(row)).collect();
            dependent(&RedundancyAnalysis::new(set, &v, &analysis)?.analysis)
        }
        Nearby::None => return Ok(rows.into_iter().map(|row| (row, Redundancy::Unknown)).collect()),
    };
    let sort = |row: &usize| if elsewhere.contains(row) { Redundancy::Everywhere } else { Redundancy::OnlyHere };
    Ok(rows.iter().map(|row| (*row, sort(row))).collect())
}

/// Analysis at one configuration.
struct RedundancyAnalysis {
    evaluation: Evaluation,
    sizes: Vec<f64>,
    /// `du_j = s_j y_j`; analysis and reduction are of y.
    units: Vec<f64>,
    analysis: Analysis,
    /// Reduction of `G du = 0`.
    reduction: Reduction,
}

/// A second configuration.
enum Nearby {
    /// G is the same in all configurations, or there is no other configuration.
    Same,
    At(Vec<f64>),
    None,
}

impl RedundancyAnalysis {
    fn new(set: &ConstraintSet, u: &[f64], options: &Options) -> Result<Self, NewtonError> {
        let mut evaluation = set.allocate();
        let argument = |source| NewtonError::Argument { step: 0, source };
        set.evaluate(u, &mut evaluation).map_err(argument)?;
        let sizes = sizes_of_dofs(set, u, &mut evaluation).map_err(argument)?;
        // Only the rank is needed. With c = 0 nothing conflicts.
        evaluation.clear_values();
        let units = units(set, &evaluation, &PartColumns::plain(evaluation.g())).map_err(argument)?;
        let system =
            set.linearised_in(&units, &evaluation, &[]).map_err(|source| NewtonError::System { step: 0, source })?;
        // The set has already left out coefficients that are rounding.
        let options = Options { noise: Noise::None, ..options.clone() };
        let analysis = analyse(&system, &options).map_err(|source| NewtonError::Analysis { step: 0, source })?;
        let reduction = analysis.reduction_in(Form::Factored);
        let reduction = reduction.map_err(|source| NewtonError::Reduction { step: 0, source })?;
        Ok(Self { evaluation, sizes, units, analysis, reduction })
    }

    fn nearby(&self, set: &ConstraintSet, u: &[f64], options: &NewtonOptions) -> Nearby {
        if self.reduction.masters().is_empty() {
            return Nearby::Same;
        }
        let mut moves = false;
        for seed in 0..TRIES {
            let Some(du) = self.step(set, u, seed) else { continue };
            moves = true;
            let start: Vec<f64> = u.iter().zip(&du).map(|(u, du)| u + du).collect();
            // A singular G allows directions that lead nowhere. If one DOF is prescribed, Newton's method can adjust the others.
            let driven = self.reduction.masters()[seed as usize % self.reduction.masters().len()];
            for drive in [&[][..], &[(driven, start[driven])]] {
                let found = solve(set, &start, drive, options);
                // Newton's method may have returned to the start.
                if let Some(found) =
                    found.ok().filter(|found| self.change_at(set, &found.u).is_some_and(|change| change > STEP / 10.0))
                {
                    return Nearby::At(found.u);
                }
            }
        }
        if moves { Nearby::None } else { Nearby::Same }
    }

    /// A random `du = [T; I] dq` that changes G by [`STEP`]; none if G does not change.
    fn step(&self, set: &ConstraintSet, u: &[f64], seed: u64) -> Option<Vec<f64>> {
        let drawn = |(k, &j): (u64, &usize)| self.sizes[j] / self.units[j] * random(seed << 32 | k);
        let masters: Vec<f64> = (0..).zip(self.reduction.masters()).map(drawn).collect();
        let mut du = self.reduction.expand(&masters, &[]).ok()?;
        du.iter_mut().zip(&self.units).for_each(|(du, unit)| *du *= unit);
        let moved = |size: f64| u.iter().zip(&du).map(|(u, du)| u + size * du).collect::<Vec<_>>();
        let mut size = 1.0;
        for _ in 0..60 {
            let changed = self.change_at(set, &moved(size))?;
            if changed == 0.0 {
                return None;
            }
            if changed <= STEP {
                return Some(du.iter().map(|du| size * du).collect());
            }
            size *= (0.9 * STEP / changed).clamp(0.1, 0.9);
        }
        None
    }

    fn change_at(&self, set: &ConstraintSet, v: &[f64]) -> Option<f64> {
        let mut evaluation = set.allocate();
        set.evaluate(v, &mut evaluation).ok()?;
        let columns = PartColumns::plain(evaluation.g());
        Some(change([&self.evaluation, &evaluation], 0..set.equations(), (&columns, &self.sizes)))
    }
}
