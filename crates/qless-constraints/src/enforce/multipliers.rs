//! `C_s^T lambda = (f - K u)_s`: multipliers of equations that were eliminated, from what their slaves are out of balance.

use qless::ConstraintSystem;

use super::EnforceError;
use super::matrix::{Factor, from_triplets};

/// Writes the multipliers of `rows`, which have `slaves`; `rest` is `f - K u` less what other multipliers carry.
pub fn recover(
    system: &ConstraintSystem,
    rows: &[usize],
    slaves: &[usize],
    rest: &[f64],
    multipliers: &mut [f64],
) -> Result<(), EnforceError> {
    let mut place = vec![usize::MAX; system.dofs()];
    slaves.iter().enumerate().for_each(|(s, &dof)| place[dof] = s);
    let place = &place;
    let column = |(i, &row): (usize, &usize)| {
        let terms = system.matrix().row(row).filter(|&(dof, _)| place[dof] != usize::MAX);
        terms.map(move |(dof, v)| (place[dof], i, v))
    };
    let matrix = from_triplets(slaves.len(), rows.len(), rows.iter().enumerate().flat_map(column))?;
    let rhs: Vec<f64> = slaves.iter().map(|&dof| rest[dof]).collect();
    let lambda = Factor::new(&matrix, "the part of C on slaves")?.solve(&rhs)?;
    rows.iter().zip(lambda).for_each(|(&row, value)| multipliers[row] = value);
    Ok(())
}
