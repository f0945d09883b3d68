//! A configuration, and how far each part is from its constraints there.
//! @@ newton/residual.rs
//! How far a configuration is from the constraints, in units of the model.
//!
//! `r_i = eps |c_i| / rounding_i`: relative to the size of the terms of c_i, which is what its rounding is a multiple of. The unit of
//! length, angle or force drops out, row by row.
//! @@ newton/scaling.rs
//! Weights that make equations of different units comparable: `D_r |G_rj| E_j` is one in the mean of logarithms (Curtis and Reid 1972).
//!
//! In other units of length, angle or force D changes with the equations, so that `D_r c_r` is the same number but for one factor
//! common to all. Sizes of terms would not do: those of `u_0 + |u|^2 / 2` vanish with u, and what is left is as large as its terms.

use qless::{ArgumentError, Csr};
use qless_constraints::{ConstraintSet, Quantities, Rounding};

use super::parts::{EquationParts, PartColumns};

/// A configuration with its c and G.
pub struct Configuration {
    pub u: Vec<f64>,
    pub quantities: Quantities,
    /// Bounds on the rounding of c and G.
    pub rounding: Rounding,
    /// What makes equations comparable.
    pub weights: Vec<f64>,
    /// `max_r D_r |c_r|` of each part, relative to the largest terms that went into any c of it; a row without slope by its own terms.
    pub residuals: Vec<f64>,
}

impl Configuration {
    pub fn new(set: &ConstraintSet, u: Vec<f64>, parts: &EquationParts) -> Result<Self, ArgumentError> {
        let mut quantities = set.allocate();
        set.evaluate(&u, &mut quantities)?;
        let rounding = set.rounding(&u)?;
        let weights = weights(quantities.g(), rounding.g(), &parts.columns);
        let residuals = residuals(quantities.c(), rounding.c(), &weights, parts);
        Ok(Self { u, quantities, rounding, weights, residuals })
    }

    /// The largest of all parts.
    pub fn residual(&self) -> f64 {
        self.residuals.iter().copied().fold(0.0, f64::max)
    }
}

fn residuals(c: &[f64], bounds: &[f64], weights: &[f64], parts: &EquationParts) -> Vec<f64> {
    let relative = |(all, bound): (f64, f64)| if all == 0.0 { 0.0 } else { all / bound };
    let largest = |x| largest(weights, x, parts);
    let mut list: Vec<f64> = largest(c).into_iter().zip(largest(bounds)).map(relative).collect();
    let flat = in_roundings(c, bounds).into_iter().enumerate().filter(|(r, _)| weights[*r] == 0.0);
    flat.for_each(|(r, own)| list[parts.of_row(r)] = list[parts.of_row(r)].max(own));
    list.iter_mut().for_each(|residual| *residual *= f64::EPSILON);
    list
}

/// `|c_r|` in roundings of c_r; infinite where the rounding is not known and c is not zero.
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

/// How much each DOF can move until something nonlinear has changed by its own size: `1 / max_r (|G_rj| / size_r)`, and less where
/// the curvature `|H_jj|`, each row by its size, says so. A length for a position, an angle for a rotation, in any unit. 0 for
/// DOFs in no equation.
pub fn sizes_of_dofs(set: &ConstraintSet, u: &[f64], quantities: &mut Quantities) -> Result<Vec<f64>, ArgumentError> {
    let weights: Vec<f64> = set.rounding(u)?.c().iter().map(|&bound| inverse(bound / f64::EPSILON)).collect();
    set.effective_hessian(u, &weights, quantities)?;
    let mut steepness = vec![0.0_f64; set.dofs()];
    for (row, weight) in weights.iter().enumerate() {
        quantities.g().row(row).for_each(|(j, v)| steepness[j] = steepness[j].max(v.abs() * weight));
    }
    for (j, steep) in steepness.iter_mut().enumerate() {
        let bent = quantities.h().row(j).find(|&(k, _)| k == j).map_or(0.0, |(_, v)| v.abs().sqrt());
        *steep = inverse(steep.max(bent));
    }
    Ok(steepness)
}

/// `1 / x`, and 0 where that is no number of use.
pub fn inverse(x: f64) -> f64 {
    let inverse = 1.0 / x;
    if inverse.is_finite() { inverse } else { 0.0 }
}

/// `max |G_rj - G'_rj| s_j / max |G'_rj| s_j` over j, the largest over the rows, with columns measured by their sizes s.
pub fn change(
    [before, after]: [&Quantities; 2],
    rows: impl IntoIterator<Item = usize>,
    (of, sizes): (&PartColumns, &[f64]),
) -> f64 {
    let of_row = |row: usize| {
        let pairs = || of.row(before.g(), row).zip(after.g().row(row));
        let most = pairs().map(|((j, a), (_, b))| (a - b).abs() * sizes[j]).fold(0.0, f64::max);
        let size = pairs().map(|((j, a), (_, b))| a.abs().max(b.abs()) * sizes[j]).fold(0.0, f64::max);
        if most == 0.0 { 0.0 } else { most / size }
    };
    rows.into_iter().map(of_row).fold(0.0, f64::max)
}

/// Sweeps over rows and columns.
const SWEEPS: usize = 20;

/// D, one weight per equation; entries that are no more than their rounding do not count, and rows without others have weight 0.
pub fn weights(g: &Csr, rounding: &[f64], of: &PartColumns) -> Vec<f64> {
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

/// AllowedMotions below this part of a DOF are none.
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
    parts: &EquationParts,
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
fn entries(g: &Csr, rounding: &[f64], of: &PartColumns) -> Vec<(usize, usize, f64)> {
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
pub fn largest(weights: &[f64], x: &[f64], parts: &EquationParts) -> Vec<f64> {
    parts.fold(0.0, |most: &mut f64, r| {
        let weighted = if weights[r] > 0.0 { weights[r] * x[r].abs() } else { 0.0 };
        *most = if weighted.is_finite() { most.max(weighted) } else { *most };
    })
}
