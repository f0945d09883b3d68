//! Distinguishes equations that are redundant everywhere from those that are redundant in one configuration only.
//!
//! A mechanism may lose rank in a special configuration, such as a flat linkage, although its equations are independent elsewhere. A second
//! configuration decides: a random step `du = S [T; I] z` that the kept equations allow, corrected by Newton's method.

use qless::ArgumentError;
use qless_constraints::ConstraintSet;

use super::configuration::{Configuration, change};
use super::error::NewtonError;
use super::iteration::free_rotations;
use super::linearisation::{Motions, analyse_rows, dependent};
use super::parts::Parts;
use super::solution::NewtonOptions;
use super::solve_each;
use crate::common::random;

/// Largest motion of a DOF on the way to the second configuration, relative to its reach. The constraint Jacobian G changes by about this
/// fraction: far more than the rank needs, and far less than in a full turn.
const STEP: f64 = 0.05;
/// Number of random directions in which another configuration is searched for. In a singular configuration, the null space of the
/// constraint Jacobian contains directions in which the mechanism cannot move, so one direction may fail.
const TRIES: u64 = 8;

/// Whether an equation that is redundant at u is redundant at other configurations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Redundancy {
    /// The equation is redundant in all configurations nearby, or no other configuration exists: it can be removed.
    Everywhere,
    /// The equation is redundant in this configuration only, which is singular; it is needed elsewhere.
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
    let parts = Parts::new(set.allocate().g(), &[], free_rotations(set, &[]));
    let argument = |source| NewtonError::Argument { step: 0, source };
    let mut here = Configuration::new(set, u.to_vec(), &parts).map_err(argument)?;
    // Only the rank is needed. With c = 0 nothing conflicts.
    here.evaluation.clear_values();
    let analysis = analyse_rows(here.place(set), &[], (0, options.analysis.clone()))?;
    let rows = dependent(&analysis);
    if rows.is_empty() {
        return Ok(Vec::new());
    }
    let motions = Motions::new(&analysis, &here.scales.units, 0)?;
    let search =
        Search { set, here: &here, parts: &parts, motions: &motions, options: preferring(options, set, &rows) };
    let found = search.run(&rows)?;
    Ok(rows.into_iter().zip(found).collect())
}

/// Options with which an analysis prefers to keep all equations except `rows`. Equations that are independent here then stay independent
/// elsewhere.
fn preferring(options: &NewtonOptions, set: &ConstraintSet, rows: &[usize]) -> NewtonOptions {
    let mut options = options.clone();
    options.analysis.preferences.equations = (0..set.equations()).filter(|row| !rows.contains(row)).collect();
    options
}

/// A search for a second configuration of each part.
struct Search<'a> {
    set: &'a ConstraintSet,
    here: &'a Configuration,
    parts: &'a Parts,
    motions: &'a Motions<'a>,
    options: NewtonOptions,
}

impl Search<'_> {
    fn run(&self, rows: &[usize]) -> Result<Vec<Redundancy>, NewtonError> {
        let argument = |source| NewtonError::Argument { step: 0, source };
        // If no direction changes G, there is no other configuration to compare with, and the equations count as redundant everywhere.
        let mut found = vec![Redundancy::Everywhere; rows.len()];
        let mut open: Vec<bool> =
            (0..self.parts.list.len()).map(|p| rows.iter().any(|&r| self.parts.of_row(r) == p)).collect();
        for seed in 0..TRIES {
            let start = self.start(seed).map_err(argument)?;
            let moves = self.changes(&start, 0.0).map_err(argument)?;
            let of_moving = rows
                .iter()
                .zip(&mut found)
                .filter(|(r, _)| open[self.parts.of_row(**r)] && moves[self.parts.of_row(**r)]);
            of_moving.for_each(|(_, found)| *found = Redundancy::Unknown);
            // The second attempt prescribes the new value of one master in each part. Newton's method then adjusts the other DOFs only.
            for driven in [Vec::new(), self.driven(seed, &start)] {
                let parts = Parts::new(self.here.evaluation.g(), &driven, free_rotations(self.set, &driven));
                let Ok(there) = solve_each((self.set, &parts), &start, &driven, &self.options) else { continue };
                // Newton's method may have returned to the start.
                let is_elsewhere = self.changes(&there.u, 0.1 * STEP).map_err(argument)?;
                for part in 0..open.len() {
                    let fails = |&r: &usize| there.errors[parts.of_row(r)].is_some();
                    if open[part] && is_elsewhere[part] && !self.parts.list[part].rows.iter().any(fails) {
                        open[part] = false;
                        let own = rows.iter().zip(&mut found).filter(|(r, _)| self.parts.of_row(**r) == part);
                        own.for_each(|(r, found)| *found = kind(there.redundant.contains(r)));
                    }
                }
            }
        }
        Ok(found)
    }

    /// For each part, whether its constraint Jacobian G changes from here to v by more than the fraction `least` of its entries.
    fn changes(&self, v: &[f64], least: f64) -> Result<Vec<bool>, ArgumentError> {
        let mut there = self.set.allocate();
        self.set.evaluate(v, &mut there)?;
        let pair = [self.here.evaluation.g(), there.g()];
        Ok(self
            .parts
            .list
            .iter()
            .map(|part| change(pair, &part.rows, self.motions.units, self.parts) > least)
            .collect())
    }

    /// u after a random motion of each part, whose largest DOF moves by [`STEP`] times its reach.
    fn start(&self, seed: u64) -> Result<Vec<f64>, ArgumentError> {
        let masters = self.motions.reduction.masters();
        let drawn: Vec<f64> = (0..masters.len() as u64).map(|k| random(seed << 32 | k)).collect();
        let (mut u, du) = (self.here.u.clone(), self.motions.expand(&drawn)?);
        for part in &self.parts.list {
            let most = part.free.iter().map(|&j| (du[j] / self.motions.units[j]).abs()).fold(0.0, f64::max);
            part.free.iter().filter(|_| most > 0.0).for_each(|&j| u[j] += STEP / most * du[j]);
        }
        Ok(u)
    }

    /// One master of each part, chosen by the seed, with its value in `start`.
    fn driven(&self, seed: u64, start: &[f64]) -> Vec<(usize, f64)> {
        let mut masters: Vec<Vec<usize>> = vec![Vec::new(); self.parts.list.len()];
        self.motions
            .reduction
            .masters()
            .iter()
            .for_each(|&j| masters[self.parts.of_dof(j).expect("nothing is prescribed")].push(j));
        let one = |own: &Vec<usize>| own.get(seed as usize % own.len().max(1)).map(|&j| (j, start[j]));
        masters.iter().filter_map(one).collect()
    }
}

fn kind(redundant: bool) -> Redundancy {
    if redundant { Redundancy::Everywhere } else { Redundancy::OnlyHere }
}
