//! `|C u - b|_i` against what its terms are made of, for the equations that others do not follow from.
//!
//! An equation between DOFs that are zero but for rounding has nothing to be measured by: its terms count as at least [`FLOOR`] of what they would
//! be if every DOF of its connected part were as large as the largest one, in the units of K spread along the equations.
//! Cost: a pass over C; units are looked for only where an equation does not meet its own terms.

use qless::elimination::EliminationError;
use qless::{ConstraintSystem, Elimination, Kind};

use super::super::equations::FLOOR;
use super::super::{EnforceError, scale};
use super::terms::sizes_of_dofs;

/// What may be left of an equation, relative to its terms; T meets the equations to 1e-10.
const MET: f64 = 1e-9;

/// Refuses u where it does not meet the equations; x are its unknowns, in these units.
pub fn closed(map: &Elimination, (x, units): (&[f64], &[f64]), u: &[f64]) -> Result<(), EnforceError> {
    let (sizes, mut levels) = (sizes_of_dofs(map, x), None);
    let system = map.analysis().ok_or(EliminationError::NoEquations)?.system();
    for i in (0..system.equations()).filter(|&i| map.kinds()[i] == Kind::Independent) {
        let (mut left, mut size) = (-map.rhs()[i], map.rhs()[i].abs());
        for (j, v) in system.matrix().row(i) {
            left += v * u[j];
            size += v.abs() * sizes[j];
        }
        let is_met = |size: f64| left.abs() <= MET * size;
        if !is_met(size) {
            let levels = levels.get_or_insert_with(|| levelled(map, system, units, &sizes));
            let level = system.matrix().row(i).map(|(j, v)| v.abs() * levels[j]).sum::<f64>();
            if !is_met(FLOOR * level) {
                return Err(EnforceError::OutOfBalance { row: system.equation_label(i), imbalance: left.abs() / size });
            }
        }
    }
    Ok(())
}

/// Each DOF as large as the largest of its connected part; zero where it is prescribed.
fn levelled(map: &Elimination, system: &ConstraintSystem, of_masters: &[f64], sizes: &[f64]) -> Vec<f64> {
    let n = map.dofs();
    let mut free = vec![true; n];
    map.prescribed().iter().for_each(|&j| free[j] = false);
    let rows = 0..system.equations();
    let terms: Vec<_> = rows.flat_map(|i| system.matrix().row(i).map(move |(j, v)| (n + i, j, v))).collect();
    let terms = || terms.iter().copied().filter(|&(_, j, v)| free[j] && v != 0.0);
    let parts = scale::parts(n + system.equations(), terms().map(|(i, j, _)| (i, j)));
    let (mut units, mut has_unit) = (vec![0.0; parts.len()], vec![false; parts.len()]);
    map.masters().iter().zip(of_masters).for_each(|(&j, &unit)| (units[j], has_unit[parts[j]]) = (unit, true));
    // What equations alone know has any unit.
    (0..n).filter(|&j| parts[j] == j && !has_unit[j]).for_each(|j| units[j] = 1.0);
    scale::spread(&mut units, terms());
    let mut largest = vec![0.0_f64; parts.len()];
    let known = |j: &usize| free[*j] && units[*j] > 0.0;
    (0..n).filter(known).for_each(|j| largest[parts[j]] = largest[parts[j]].max(sizes[j] / units[j]));
    (0..n).map(|j| if free[j] { units[j] * largest[parts[j]] } else { 0.0 }).collect()
}
