//! The DOFs of a rank's equations, numbered locally from 0, and the magnitudes in their columns.

use std::ops::Range;

use rustc_hash::FxHashMap;

use crate::share::ShareRows;

/// The DOFs in ascending order. `places` holds, for each term of the equations, the index of its DOF in `dofs`.
pub(crate) struct TouchedDofs {
    pub dofs: Vec<u64>,
    pub places: Vec<u32>,
    /// For each DOF in `dofs`, a summary of its coefficients.
    pub columns: Vec<ColumnSizes>,
}

/// The coefficients of a DOF in the equations of a rank.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ColumnSizes {
    /// Number of coefficients.
    pub count: u32,
    /// Whether all coefficients are small; then the DOF may have another unit.
    pub is_small: bool,
    /// Whether one of the coefficients may be a rounding error.
    pub is_faint: bool,
}

/// A coefficient is small if it is below this fraction of the largest coefficient of its row.
const SMALL: f64 = 1.0 / 512.0;
/// A coefficient may be a rounding error if it is below this fraction of the largest coefficient of its row.
const FAINT: f64 = 1e-12;
/// A range of DOFs gets a lookup table only if it has at most this many DOFs for each term. So the memory grows with the equations and not
/// with the owned range.
const TABLE: u64 = 16;

impl TouchedDofs {
    /// Collects the DOFs of `rows`. A table finds the DOFs in the range `near`, to which most DOFs usually belong; a hash map finds the
    /// others.
    pub fn by(rows: &ShareRows, near: &Range<u64>) -> Self {
        let is_dense = near.end - near.start <= TABLE * (rows.dofs.len() as u64 + 64);
        let near = if is_dense { near.clone() } else { near.start..near.start };
        let mut table = vec![NONE; (near.end - near.start) as usize];
        let mut far: FxHashMap<u64, u32> = FxHashMap::default();
        for &dof in &rows.dofs {
            if near.contains(&dof) {
                table[(dof - near.start) as usize] = 0;
            } else {
                far.insert(dof, 0);
            }
        }
        let mut dofs: Vec<u64> = far.keys().copied().collect();
        dofs.sort_unstable();
        let own = table.iter().zip(near.clone()).filter(|&(&place, _)| place != NONE).map(|(_, dof)| dof);
        let between = dofs.partition_point(|&dof| dof < near.start);
        dofs.splice(between..between, own);
        for (&dof, place) in dofs.iter().zip(0..) {
            if near.contains(&dof) {
                table[(dof - near.start) as usize] = place;
            } else {
                far.insert(dof, place);
            }
        }
        let place = |&dof: &u64| if near.contains(&dof) { table[(dof - near.start) as usize] } else { far[&dof] };
        let places: Vec<u32> = rows.dofs.iter().map(place).collect();
        let columns = columns(rows, &places, dofs.len());
        Self { dofs, places, columns }
    }

    /// For each term of row i, the index of its DOF in `dofs`.
    pub fn row<'a>(&'a self, rows: &ShareRows, i: usize) -> &'a [u32] {
        &self.places[rows.starts[i]..rows.starts[i + 1]]
    }
}

const NONE: u32 = u32::MAX;

fn columns(rows: &ShareRows, places: &[u32], count: usize) -> Vec<ColumnSizes> {
    let mut columns = vec![ColumnSizes { count: 0, is_small: true, is_faint: false }; count];
    for i in 0..rows.len() {
        let values = rows.values(i);
        let largest = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let (small, faint) = (SMALL * largest, FAINT * largest);
        for (&j, value) in places[rows.starts[i]..].iter().zip(values) {
            let column = &mut columns[j as usize];
            column.count += 1;
            column.is_small &= value.abs() < small;
            column.is_faint |= value.abs() < faint;
        }
    }
    columns
}
