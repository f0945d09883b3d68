//! Weights that make equations of different units comparable: `D_r |G_rj| E_j` is one in the mean of logarithms (Curtis and Reid 1972).
//!
//! In other units of length, angle or force D changes with the equations, so that `D_r c_r` is the same number but for one factor
//! common to all. Sizes of terms would not do: those of `u_0 + |u|^2 / 2` vanish with u, and what is left is as large as its terms.

use qless::Csr;

use super::parts::{Columns, Parts};
use super::residual::in_roundings;
use qless_constraints::{Quantities, Rounding};

/// Sweeps over rows and columns.
const SWEEPS: usize = 20;

/// D, one weight per equation; entries that are no more than their rounding do not count, and rows without others have weight 0.
pub fn weights(g: &Csr, rounding: &[f64], of: &Columns) -> Vec<f64> {
    let entries = entries(g, rounding, of);
    let (mut rows, mut columns) = (vec![0.0; g.rows()], vec![0.0; of.count()]);
    let mut counts = (vec![0.0; g.rows()], vec![0.0; of.count()]);
    entries.iter().for_each(|&(r, j, _)| (counts.0[r] += 1.0, counts.1[j] += 1.0).0);
    for _ in 0..SWEEPS {
        average(&mut rows, &counts.0, entries.iter().map(|&(r, j, v)| (r, v + columns[j])));
        average(&mut columns, &counts.1, entries.iter().map(|&(r, j, v)| (j, v + rows[r])));
    }
    rows.iter().zip(counts.0).map(|(row, count)| if count > 0.0 { row.exp2() } else { 0.0 }).collect()
}

/// Motions below this part of a DOF are none.
const NEGLIGIBLE: f64 = 1e-11;

/// `|c_r|` in roundings where c has come to rest: of its own terms, or of the largest in its part, `D_r |c_r| / max_s D_s rounding_s`, if that
/// is less and the motion that the row asks for is none, `|c_r| <= 1e-11 sum_j |G_rj| s_j`, with s their extents.
///
/// Where own terms vanish, the rounding of other rows is felt in this one, and among nearly dependent rows steps only do harm. The second
/// condition is the bound: weights of rows with small entries are huge, and those rows as large as they like.
pub fn at_rest(
    weights: &[f64],
    quantities: &Quantities,
    (rounding, extents): (&Rounding, &[f64]),
    parts: &Parts,
) -> Vec<f64> {
    let largest = largest(weights, rounding.c(), parts);
    let mut list = in_roundings(quantities.c(), rounding.c());
    for (r, (own, c)) in list.iter_mut().zip(quantities.c()).enumerate() {
        let motion: f64 = quantities.g().row(r).map(|(j, v)| v.abs() * extents[j]).sum();
        let largest = largest[parts.of_row(r)];
        if weights[r] > 0.0 && largest > 0.0 && c.abs() <= NEGLIGIBLE * motion {
            *own = own.min(weights[r] * c.abs() / largest);
        }
    }
    list
}

/// `(row, column, log2 |G_rj|)`.
fn entries(g: &Csr, rounding: &[f64], of: &Columns) -> Vec<(usize, usize, f64)> {
    let mut list = Vec::with_capacity(g.nnz());
    for r in 0..g.rows() {
        let bounds = &rounding[g.starts()[r]..g.starts()[r + 1]];
        let real = of.row(g, r).zip(bounds).filter(|((_, v), bound)| v.is_finite() && v.abs() > **bound);
        list.extend(real.map(|((j, v), _)| (r, j, v.abs().log2())));
    }
    list
}

/// Minus the mean of the numbers of each place.
fn average(places: &mut [f64], counts: &[f64], numbers: impl Iterator<Item = (usize, f64)>) {
    places.fill(0.0);
    numbers.for_each(|(i, v)| places[i] -= v);
    places.iter_mut().zip(counts).for_each(|(place, count)| *place /= count.max(1.0));
}

/// `max_r D_r |x_r|` over the rows of each part.
pub fn largest(weights: &[f64], x: &[f64], parts: &Parts) -> Vec<f64> {
    parts.fold(0.0, |most: &mut f64, r| {
        let weighted = if weights[r] > 0.0 { weights[r] * x[r].abs() } else { 0.0 };
        *most = if weighted.is_finite() { most.max(weighted) } else { *most };
    })
}
