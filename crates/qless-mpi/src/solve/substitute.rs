//! The row of T of an equation that was solved where it stands: slaves among its DOFs are replaced by their own rows.

use std::collections::BTreeMap;

use super::lines::GIVEN;
use super::{Line, Lines, Soundness};
use crate::deal::Peel;
use crate::parts::{Known, Touched};
use crate::share::Rows;

/// Entries below this, relative to the largest part that went into them, are rounding: as in the serial reduction.
const NOISE: f64 = 1e-14;
/// Of a slave that hardly moves only the whole component tells whether it is fixed.
const HARDLY: f64 = 1e-6;

/// Appends the row of a peeled equation. `slaves` holds the rows of the slaves among its DOFs.
pub(crate) fn substitute(
    lines: &mut Lines,
    peel: Peel,
    (rows, touched, known): (&Rows, &Touched, &Known),
    slaves: &Lines,
    growth: f64,
) -> Soundness {
    let Peel { row, position } = peel;
    let range = rows.starts[row]..rows.starts[row + 1];
    let slave = range.start + position;
    let divisor = -rows.values[slave];
    let terms: Vec<(u64, f64)> = range
        .filter(|&k| k != slave)
        .map(|k| {
            let mark = if known.free[touched.places[k] as usize] { 0 } else { GIVEN };
            (rows.dofs[k] | mark, rows.values[k] / divisor)
        })
        .collect();
    let constant = rows.rhs[row] / rows.values[slave];
    let (constant, terms) = if terms.iter().any(|&(dof, _)| slaves.find(dof).is_some()) {
        replaced(constant, &terms, slaves)
    } else {
        (constant, terms)
    };
    let of_masters = terms.iter().filter(|(dof, _)| dof & GIVEN == 0);
    let largest = of_masters.fold(0.0, |most: f64, (_, value)| most.max(value.abs()));
    lines.push(rows.dofs[slave], constant, terms.into_iter());
    if (HARDLY..=growth).contains(&largest) { Soundness::Sound } else { Soundness::Unsound }
}

/// Sums in the order of the equation's terms, so that they round as those of the serial reduction.
fn replaced(mut constant: f64, terms: &[(u64, f64)], slaves: &Lines) -> (f64, Vec<(u64, f64)>) {
    let mut size = constant.abs();
    let mut parts: BTreeMap<u64, (u64, f64, f64)> = BTreeMap::new();
    let mut add = |dof: u64, part: f64| {
        let (_, value, size) = parts.entry(dof & !GIVEN).or_insert((dof, 0.0, 0.0));
        *value += part;
        *size = size.max(part.abs());
    };
    for &(dof, value) in terms {
        match slaves.find(dof) {
            None => add(dof, value),
            Some(Line { constant: of_slave, dofs, values, .. }) => {
                let part = value * of_slave;
                constant += part;
                size = size.max(part.abs());
                dofs.iter().zip(values).for_each(|(&dof, t)| add(dof, value * t));
            }
        }
    }
    let left = parts.into_values().filter(|&(_, value, size)| value.abs() > NOISE * size);
    let constant = if constant.abs() > NOISE * size { constant } else { 0.0 };
    (constant, left.map(|(dof, value, _)| (dof, value)).collect())
}
