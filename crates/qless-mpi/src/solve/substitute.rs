//! The row of T of an equation that was solved where it stands: slaves among its DOFs are replaced by their own rows.

use std::collections::BTreeMap;

use super::lines::GIVEN;
use super::{Line, Lines, Soundness};
use crate::deal::Peel;
use crate::parts::{Known, NONE, Touched};
use crate::share::Rows;

/// Entries below this, relative to the largest part that went into them, are rounding: as in the serial reduction.
const NOISE: f64 = 1e-14;
/// Of a slave that hardly moves only the whole component tells whether it is fixed.
const HARDLY: f64 = 1e-6;

/// Rows of the slaves among the DOFs of a rank's equations.
pub(crate) struct Slaves {
    pub lines: Lines,
    /// Index into them, by place of the DOF.
    pub of_place: Vec<u32>,
}

impl Slaves {
    fn find(&self, place: u32) -> Option<Line<'_>> {
        let i = self.of_place[place as usize];
        (i != NONE).then(|| self.lines.line(i as usize))
    }
}

/// Appends the row of a peeled equation.
pub(crate) fn substitute(
    lines: &mut Lines,
    peel: Peel,
    (rows, touched, known): (&Rows, &Touched, &Known),
    slaves: &Slaves,
    growth: f64,
) -> Soundness {
    let range = rows.starts[peel.row()]..rows.starts[peel.row() + 1];
    let slave = peel.place(rows);
    let divisor = -rows.values[slave];
    let mark = |j: u32| if known.said[j as usize].is_free() { 0 } else { GIVEN };
    let term = |k: usize| (touched.places[k], rows.dofs[k] | mark(touched.places[k]), rows.values[k] / divisor);
    let terms = range.filter(|&k| k != slave).map(term);
    let constant = rows.rhs[peel.row()] / rows.values[slave];
    if terms.clone().any(|(place, ..)| slaves.of_place[place as usize] != NONE) {
        let (constant, terms) = replaced(constant, terms, slaves);
        lines.push(rows.dofs[slave], constant, terms);
    } else {
        lines.push(rows.dofs[slave], constant, terms.map(|(_, dof, value)| (dof, value)));
    }
    let Line { dofs, values, .. } = lines.line(lines.len() - 1);
    let of_masters = dofs.iter().zip(values).filter(|(dof, _)| *dof & GIVEN == 0);
    let largest = of_masters.fold(0.0, |most: f64, (_, value)| most.max(value.abs()));
    if (HARDLY..=growth).contains(&largest) { Soundness::Sound } else { Soundness::Unsound }
}

/// Sums in the order of the equation's terms, so that they round as those of the serial reduction.
fn replaced(
    mut constant: f64,
    terms: impl Iterator<Item = (u32, u64, f64)>,
    slaves: &Slaves,
) -> (f64, impl Iterator<Item = (u64, f64)>) {
    let mut size = constant.abs();
    let mut parts: BTreeMap<u64, (u64, f64, f64)> = BTreeMap::new();
    let mut add = |dof: u64, part: f64| {
        let (_, value, size) = parts.entry(dof & !GIVEN).or_insert((dof, 0.0, 0.0));
        *value += part;
        *size = size.max(part.abs());
    };
    for (place, dof, value) in terms {
        match slaves.find(place) {
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
    (constant, left.map(|(dof, value, _)| (dof, value)))
}
