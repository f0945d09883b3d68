//! How far a configuration is from the constraints, and how much G changes between two.

use qless::Csr;

use crate::Quantities;

/// `|c_i| / max_j |G_ij|`, in the units of u; `|c_i|` where the row is zero.
pub fn residuals(quantities: &Quantities) -> Vec<f64> {
    let measure = |(row, c): (usize, &f64)| {
        let largest = largest(&quantities.g, row);
        if largest > 0.0 { c.abs() / largest } else { c.abs() }
    };
    quantities.c.iter().enumerate().map(measure).collect()
}

fn largest(g: &Csr, row: usize) -> f64 {
    g.row(row).map(|(_, v)| v.abs()).fold(0.0, f64::max)
}

/// `max_ij |G_ij - G'_ij| / max_j |G'_ij|` of two matrices with the same pattern.
pub fn change(before: &Csr, after: &Csr) -> f64 {
    let of_row = |row: usize| {
        let most = before.row(row).zip(after.row(row)).map(|((_, a), (_, b))| (a - b).abs()).fold(0.0, f64::max);
        if most == 0.0 { 0.0 } else { most / largest(after, row).max(largest(before, row)) }
    };
    (0..after.rows()).map(of_row).fold(0.0, f64::max)
}
