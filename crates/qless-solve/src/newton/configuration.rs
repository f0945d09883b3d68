//! A configuration with its residuals, which are measured independently of units.
//!
//! - Residual of a row: `r_i = eps |c_i| / rounding_i`. The rounding of c_i is a multiple of the size of its terms, so that units of
//!   length, angle and force cancel.
//! - Weights D that make equations comparable: with suitable weights E of the columns, the geometric mean of `D_r |G_rj| E_j` over each row
//!   and column is one (Curtis and Reid 1972).
//!
//! Other units change `D_r c_r` by one common factor only. Sizes of terms would not serve as weights: those of `u_0 + |u|^2 / 2` vanish
//! with u, and so does c.

use qless::{ArgumentError, Csr};
use qless_constraints::{ConstraintSet, Evaluation, Rounding};

use super::parts::{EquationParts, PartColumns};

/// A configuration with its c and G.
pub struct Configuration {
    pub u: Vec<f64>,
    pub evaluation: Evaluation,
    /// Bounds on the rounding of c and G.
    pub rounding: Rounding,
    /// Weights D of the equations.
    pub weights: Vec<f64>,
    /// `max_r D_r |c_r|` of each part, relative to the same maximum of the sizes of terms. Rows with weight 0 are measured by their own
    /// terms.
    pub residuals: Vec<f64>,
}

impl Configuration {
    pub fn new(set: &ConstraintSet, u: Vec<f64>, parts: &EquationParts) -> Result<Self, ArgumentError> {
        let mut evaluation = set.allocate();
        set.evaluate(&u, &mut evaluation)?;
        let rounding = set.rounding(&u)?;
        let weights = weights(evaluation.g(), rounding.g(), &parts.columns);
        let residuals = residuals(evaluation.c(), rounding.c(), &weights, parts);
        Ok(Self { u, evaluation, rounding, weights, residuals })
    }

    /// The largest residual of all parts.
    pub fn residual(&self) -> f64 {
        self.residuals.iter().copied().fold(0.0, f64::max)
    }
}

fn residuals(c: &[f64], bounds: &[f64], weights: &[f64], parts: &EquationParts) -> Vec<f64> {
    let relative = |(all, bound): (f64, f64)| if all == 0.0 { 0.0 } else { all / bound };
    let largest = |x| largest(weights, x, parts);
    let mut list: Vec<f64> = largest(c).into_iter().zip(largest(bounds)).map(relative).collect();
    let without_weight = in_roundings(c, bounds).into_iter().enumerate().filter(|(r, _)| weights[*r] == 0.0);
    without_weight.for_each(|(r, own)| list[parts.of_row(r)] = list[parts.of_row(r)].max(own));
    list.iter_mut().for_each(|residual| *residual *= f64::EPSILON);
    list
}

/// `|c_r|` divided by the bound on its rounding; infinite if c is nonzero and the bound is unknown.
pub fn in_roundings(c: &[f64], rounding: &[f64]) -> Vec<f64> {
    let measure = |(&c, &bound): (&f64, &f64)| {
        if c == 0.0 {
            return 0.0;
        }
        let ratio = c.abs() / bound;
        if bound.is_finite() && !ratio.is_nan() { ratio } else { f64::INFINITY }
    };
    c.iter().zip(rounding).map(measure).collect()
}

/// How far each DOF can move until an equation changes by the size of its terms: `1 / max_r (|G_rj| / size_r)`, or less if the curvature
/// `|H_jj|` limits it. A length for a position, an angle for a rotation, in any unit; 0 for DOFs without equations.
pub fn sizes_of_dofs(set: &ConstraintSet, u: &[f64], evaluation: &mut Evaluation) -> Result<Vec<f64>, ArgumentError> {
    let weights: Vec<f64> = set.rounding(u)?.c().iter().map(|&bound| inverse(bound / f64::EPSILON)).collect();
    set.effective_hessian(u, &weights, evaluation)?;
    let mut steepness = vec![0.0_f64; set.dofs()];
    for (row, weight) in weights.iter().enumerate() {
        evaluation.g().row(row).for_each(|(j, v)| steepness[j] = steepness[j].max(v.abs() * weight));
    }
    for (j, steep) in steepness.iter_mut().enumerate() {
        let curvature = evaluation.h().row(j).find(|&(k, _)| k == j).map_or(0.0, |(_, v)| v.abs().sqrt());
        *steep = inverse(steep.max(curvature));
    }
    Ok(steepness)
}

/// `1 / x`, or 0 if that is not finite.
pub fn inverse(x: f64) -> f64 {
    let inverse = 1.0 / x;
    if inverse.is_finite() { inverse } else { 0.0 }
}

/// `max |G_rj - G'_rj| s_j / max (max(|G_rj|, |G'_rj|) s_j)` over j, then the largest over the rows; s are the sizes of the columns.
pub fn change(
    [before, after]: [&Evaluation; 2],
    rows: impl IntoIterator<Item = usize>,
    (columns, sizes): (&PartColumns, &[f64]),
) -> f64 {
    let of_row = |row: usize| {
        let pairs = || columns.row(before.g(), row).zip(after.g().row(row));
        let most = pairs().map(|((j, a), (_, b))| (a - b).abs() * sizes[j]).fold(0.0, f64::max);
        let size = pairs().map(|((j, a), (_, b))| a.abs().max(b.abs()) * sizes[j]).fold(0.0, f64::max);
        if most == 0.0 { 0.0 } else { most / size }
    };
    rows.into_iter().map(of_row).fold(0.0, f64::max)
}

/// Sweeps over rows and columns.
const SWEEPS: usize = 20;

/// D, one weight per equation. Entries that are rounding do not count; a row without other entries has weight 0.
pub fn weights(g: &Csr, rounding: &[f64], columns: &PartColumns) -> Vec<f64> {
    let entries = entries(g, rounding, columns);
    let (mut row_scales, mut column_scales) = (vec![0.0; g.rows()], vec![0.0; columns.count]);
    let mut counts = (vec![0.0; g.rows()], vec![0.0; columns.count]);
    entries.iter().for_each(|&(r, j, _)| (counts.0[r] += 1.0, counts.1[j] += 1.0).0);
    for _ in 0..SWEEPS {
        average(&mut row_scales, &counts.0, entries.iter().map(|&(r, j, v)| (r, v + column_scales[j])));
        average(&mut column_scales, &counts.1, entries.iter().map(|&(r, j, v)| (j, v + row_scales[r])));
    }
    row_scales.iter().zip(counts.0).map(|(row, count)| if count > 0.0 { row.exp2() } else { 0.0 }).collect()
}

/// Motions below this fraction of a DOF's size are negligible.
const NEGLIGIBLE: f64 = 1e-11;

/// `|c_r|` in roundings, for parts whose c no longer falls. If the row demands a negligible motion only, `|c_r| <= 1e-11 sum_j |G_rj| s_j`
/// with the extents s, it is also measured by the largest rounding in its part, `D_r |c_r| / max_k D_k rounding_k`, and the smaller result
/// counts.
///
/// If the own terms of a row vanish, it still contains rounding of other rows, and further steps among nearly dependent rows do harm. The
/// condition on the motion is needed since weights of rows with small entries are very large.
pub fn at_rest(
    weights: &[f64],
    evaluation: &Evaluation,
    (rounding, extents): (&Rounding, &[f64]),
    parts: &EquationParts,
) -> Vec<f64> {
    let largest = largest(weights, rounding.c(), parts);
    let mut list = in_roundings(evaluation.c(), rounding.c());
    for (r, (own, c)) in list.iter_mut().zip(evaluation.c()).enumerate() {
        let motion: f64 = evaluation.g().row(r).map(|(j, v)| v.abs() * extents[j]).sum();
        let largest = largest[parts.of_row(r)];
        if weights[r] > 0.0 && largest > 0.0 && c.abs() <= NEGLIGIBLE * motion {
            *own = own.min(weights[r] * c.abs() / largest);
        }
    }
    list
}

/// `(row, column, log2 |G_rj|)`.
fn entries(g: &Csr, rounding: &[f64], columns: &PartColumns) -> Vec<(usize, usize, f64)> {
    let mut list = Vec::with_capacity(g.nnz());
    for r in 0..g.rows() {
        let bounds = &rounding[g.starts()[r]..g.starts()[r + 1]];
        let real = columns.row(g, r).zip(bounds).filter(|((_, v), bound)| v.is_finite() && v.abs() > **bound);
        list.extend(real.map(|((j, v), _)| (r, j, v.abs().log2())));
    }
    list
}

/// Minus the mean of the numbers with each index.
fn average(places: &mut [f64], counts: &[f64], numbers: impl Iterator<Item = (usize, f64)>) {
    places.fill(0.0);
    numbers.for_each(|(i, v)| places[i] -= v);
    places.iter_mut().zip(counts).for_each(|(sum, count)| *sum /= count.max(1.0));
}

/// `max_r D_r |x_r|` over the rows of each part.
pub fn largest(weights: &[f64], x: &[f64], parts: &EquationParts) -> Vec<f64> {
    parts.fold(0.0, |most: &mut f64, r| {
        let weighted = if weights[r] > 0.0 { weights[r] * x[r].abs() } else { 0.0 };
        *most = if weighted.is_finite() { most.max(weighted) } else { *most };
    })
}
