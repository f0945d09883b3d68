//! Scaling `C' = D_r C D_c` with diagonal matrices of powers of two: exact, and internal to the factorization.
//!
//! Rows are always scaled, so that the largest coefficient of a free DOF in each row lies in `[1, 2)`. The columns of a component
//! are scaled only if equilibration would change a column with several coefficients by more than `2^10`. The rank of a block is found in
//! balanced units ([`balance`]); slaves are chosen and reductions computed in units near those of the user.

mod balance;
mod laplacian;
mod powers;
mod rows;

use super::components::Labels;
use super::numbering::{Exponents, LocalSystem};

pub(crate) use balance::{Component, RANGE};
pub(crate) use powers::{exponent, ldexp};

/// Columns keep the user's units if these are within this power of two of equilibrated units: pivots then lose about 10 of 53 bits.
const NEAR: i32 = 10;

/// Exponents of the scaling: `C'_ij = C_ij 2^(row[i] + col[j])`.
#[derive(Clone, Debug)]
pub(crate) struct Scaling {
    pub row: Vec<i32>,
    /// The exponent of each column; empty if no column is scaled.
    pub col: Vec<i32>,
}

impl Scaling {
    /// The scaling that changes no entry.
    pub fn none(rows: usize) -> Self {
        Self { row: vec![0; rows], col: Vec::new() }
    }

    pub fn col(&self, j: usize) -> i32 {
        self.col.get(j).copied().unwrap_or(0)
    }

    /// The scaled coefficient.
    pub fn entry(&self, i: usize, j: usize, value: f64) -> f64 {
        ldexp(value, self.row[i] + self.col(j))
    }
}

/// Scales each row by its free DOFs, and columns if units mix. A row without free DOFs is scaled by its prescribed DOFs.
pub(crate) fn balanced(system: LocalSystem, exponents: &[Exponents]) -> Scaling {
    let mut scaling = Scaling::none(system.equations());
    if rows::scale(system, exponents, &mut scaling) >= -NEAR {
        return scaling;
    }
    let spans_much = |i| rows::span(system, &scaling, i).is_some_and(|(least, top)| least - top < -NEAR);
    let col = units(system, spans_much, |component| component.near_users(NEAR));
    if !col.is_empty() {
        scaling.col = col;
        rows::scale(system, exponents, &mut scaling);
    }
    scaling
}

/// The scaling that balances columns in components that contain a marked equation, with rows scaled to match.
pub(crate) fn balanced_where(system: LocalSystem, is_marked: impl Fn(usize) -> bool) -> Scaling {
    let mut scaling = Scaling::none(system.equations());
    let in_range = |units: &Vec<i32>| units.iter().all(|unit| unit.abs() < RANGE);
    scaling.col = units(system, is_marked, |component| component.units_beyond(0.0).filter(in_range));
    for i in 0..system.equations() {
        scaling.row[i] = rows::span(system, &scaling, i).map_or(0, |(_, top)| -top);
    }
    scaling
}

/// For each equation, the exponent of the factor that brings it to balanced units, up to a constant for each component. NaN for an equation
/// without free DOFs, and for components without a marked equation.
pub(crate) fn balanced_rows(system: LocalSystem, is_marked: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut units = vec![f64::NAN; system.equations()];
    for component in marked_components(system, is_marked) {
        component.row_units(|row, unit| units[component.rows[row] as usize] = unit);
    }
    units
}

/// Calls `job` with each equation of the components that contain a marked one, and with the base-2 logarithms of its free coefficients in
/// balanced units.
pub(crate) fn balanced_powers(
    system: LocalSystem,
    is_marked: impl Fn(usize) -> bool,
    mut job: impl FnMut(usize, &[f64]),
) {
    for component in marked_components(system, is_marked) {
        component.balanced_rows(|row, powers| job(component.rows[row] as usize, powers));
    }
}

/// Exponents of the columns; empty if no component is scaled. Only components with an equation for which `spans_much` is true are scaled.
fn units(
    system: LocalSystem,
    spans_much: impl Fn(usize) -> bool,
    of: impl Fn(&Component) -> Option<Vec<i32>>,
) -> Vec<i32> {
    let mut col = Vec::new();
    for component in marked_components(system, spans_much) {
        if let Some(units) = of(&component) {
            col.resize(system.dofs(), 0);
            component.dofs.iter().zip(units).for_each(|(&j, unit)| col[j as usize] = unit);
        }
    }
    col
}

/// The components with a marked equation.
fn marked_components(system: LocalSystem, is_marked: impl Fn(usize) -> bool) -> Vec<Component> {
    let labels = Labels::of(system);
    let mut is_wanted = vec![false; labels.count];
    (0..system.equations()).filter(|&i| is_marked(i)).for_each(|i| is_wanted[labels.of_row[i] as usize] = true);
    let mut rows = vec![Vec::new(); labels.count];
    for (&label, i) in labels.of_row.iter().zip(0..) {
        if is_wanted[label as usize] {
            rows[label as usize].push(i);
        }
    }
    let mut place = vec![0; system.dofs()];
    let some = rows.into_iter().filter(|rows| !rows.is_empty());
    some.map(|rows| Component::gather(rows, |i| free(system, i as usize), &mut place)).collect()
}

pub(crate) fn free(system: LocalSystem<'_>, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
    system.row(i).filter(move |&(j, _)| system.free()[j])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ConstraintSystem;
    use crate::input::numbering::Numbering;

    fn scaled(triplets: &[(usize, usize, f64)], rows: usize, dofs: usize) -> Vec<f64> {
        let system = ConstraintSystem::from_triplets(rows, dofs, triplets, &vec![0.0; rows], &[]).expect("valid");
        let (numbering, _, exponents) = Numbering::new(&system);
        let local = numbering.view(&system, system.rhs());
        let scaling = balanced(local, &exponents);
        (0..rows).flat_map(|i| local.row(i).map(|(j, v)| scaling.entry(i, j, v)).collect::<Vec<_>>()).collect()
    }

    #[test]
    fn columns_in_other_units_come_back_to_one_size() {
        let mut triplets = Vec::new();
        for i in 0..30_usize {
            for k in 0..4 {
                let j = (i * 7 + k * 5) % 40;
                triplets.push((i, j, [1e-6, 1.0, 1e6][j % 3] * (1.0 + k as f64)));
            }
        }
        assert!(scaled(&triplets, 30, 40).iter().all(|v| (0.01..2.0).contains(v)));
    }

    #[test]
    fn a_number_left_of_a_zero_has_no_unit() {
        let ring = (0..20).flat_map(|i| [(i, i, 1.0), (i, (i + 1) % 20, -1.0), (i, (i + 7) % 20, 1e-159)]);
        let values = scaled(&ring.collect::<Vec<_>>(), 20, 20);
        assert_eq!(values.iter().filter(|v| v.abs() == 1.0).count(), 40);
    }
}
