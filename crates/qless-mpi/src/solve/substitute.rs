//! The row of T of a peeled equation: slaves among its DOFs are replaced by their own rows of T.

use std::collections::BTreeMap;

use super::local_analysis::{LOSS, Soundness};
use super::residual_check::residual;
use super::rows::{PRESCRIBED_BIT, ReductionRow, ReductionRows, SlaveRows};
use crate::components::{KnownDofs, NONE, TouchedDofs};
use crate::distribute::Peel;
use crate::share::ShareRows;

/// An entry of T is a sum of terms. If it is below this fraction of its largest term, it is rounding, as in the serial reduction.
const NOISE: f64 = 1e-14;
/// The largest entry of a sound row of T is at least this. If all are smaller, only an analysis of the whole component shows whether the
/// slave is fixed.
const HARDLY: f64 = 1e-6;
/// Largest 2-norm of a sound row of T. The serial analysis rejects rows whose slave exceeds 1e3 for random masters up to 1; this is ten
/// times less.
const STEEP: f64 = 100.0;
/// Largest 2-norm of the coefficients of slaves in a sound row. These slaves can move the slave of the peeled equation by at most about
/// 5e3: the rows of the inverse of their own square matrix `C_S` are at most 1e3. The serial analysis rejects slaves that move more than
/// 3e4 for random right-hand sides.
const HEAVY: f64 = 5.0;

/// Solves a peeled equation for its slave, and appends the row of T, G and g to `into`. Returns whether the row is sound.
pub(crate) fn substitute(
    into: &mut ReductionRows,
    peel: Peel,
    (rows, touched, known): (&ShareRows, &TouchedDofs, &KnownDofs),
    slaves: &SlaveRows,
    growth: f64,
) -> Soundness {
    let range = rows.starts[peel.row()]..rows.starts[peel.row() + 1];
    let slave = peel.place(rows);
    let divisor = -rows.values[slave];
    let mark = |j: u32| if known.flags[j as usize].is_free() { 0 } else { PRESCRIBED_BIT };
    let term = |k: usize| (touched.places[k], rows.dofs[k] | mark(touched.places[k]), rows.values[k] / divisor);
    let terms = range.filter(|&k| k != slave).map(term);
    let constant = rows.rhs[peel.row()] / rows.values[slave];
    let of_slaves = terms.clone().filter(|&(place, ..)| slaves.of_place[place as usize] != NONE);
    let heavy = norm(of_slaves.clone().map(|(.., value)| value));
    if of_slaves.count() > 0 {
        let (constant, terms) = replaced(constant, terms, slaves);
        into.push(rows.dofs[slave], constant, terms);
    } else {
        into.push(rows.dofs[slave], constant, terms.map(|(_, dof, value)| (dof, value)));
    }
    let made = into.row(into.len() - 1);
    let met = residual(peel, rows, touched, slaves, made) <= LOSS;
    let ReductionRow { dofs, values, .. } = made;
    let of_masters = dofs.iter().zip(values).filter(|(dof, _)| *dof & PRESCRIBED_BIT == 0);
    let of_masters = of_masters.map(|(_, value)| value.abs());
    let (largest, steep) = (of_masters.clone().fold(0.0, f64::max), norm(of_masters));
    let is_sound = (HARDLY..=growth).contains(&largest) && steep <= STEEP && heavy <= HEAVY && met;
    if is_sound { Soundness::Sound } else { Soundness::Unsound }
}

fn norm(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |sum, value| sum + value * value).sqrt()
}

/// Replaces slaves by their rows of T, G and g. Adds in the order of the equation's terms, so that sums round as in the serial reduction.
fn replaced(
    mut constant: f64,
    terms: impl Iterator<Item = (u32, u64, f64)>,
    slaves: &SlaveRows,
) -> (f64, impl Iterator<Item = (u64, f64)>) {
    let mut size = constant.abs();
    let mut sums: BTreeMap<u64, (u64, f64, f64)> = BTreeMap::new();
    let mut add = |dof: u64, term: f64| {
        let (_, value, size) = sums.entry(dof & !PRESCRIBED_BIT).or_insert((dof, 0.0, 0.0));
        *value += term;
        *size = size.max(term.abs());
    };
    for (place, dof, value) in terms {
        match slaves.find(place) {
            None => add(dof, value),
            Some(ReductionRow { constant: of_slave, dofs, values, .. }) => {
                let term = value * of_slave;
                constant += term;
                size = size.max(term.abs());
                dofs.iter().zip(values).for_each(|(&dof, t)| add(dof, value * t));
            }
        }
    }
    let terms = sums.into_values().filter(|&(_, value, size)| value.abs() > NOISE * size);
    let constant = if constant.abs() > NOISE * size { constant } else { 0.0 };
    (constant, terms.map(|(dof, value, _)| (dof, value)))
}
