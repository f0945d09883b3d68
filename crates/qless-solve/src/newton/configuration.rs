//! A configuration with its residuals, which are measured independently of units in two ways:
//!
//! - `D_r |c_r|` with the weights D, relative to the largest weighted size of terms in the part. It tells whether c falls.
//! - `|c_r| / rounding_r`: multiples of the bound on the rounding of c_r. It tells whether an equation holds.

use qless::{ArgumentError, Csr};
use qless_constraints::{ConstraintSet, Evaluation, Rounding};

use super::linearisation::Place;
use super::parts::Parts;
use super::scales::Scales;

/// Values u of the DOFs, with the constraint values c and their Jacobian G at u.
pub struct Configuration {
    pub u: Vec<f64>,
    pub evaluation: Evaluation,
    /// Bounds on the rounding of the constraint values c and their Jacobian G.
    pub rounding: Rounding,
    pub scales: Scales,
    /// For each part, `max_r D_r |c_r|` relative to the same maximum of the sizes of terms, with the weights D of the equations. A row r
    /// with weight 0 is measured by its own terms.
    pub residuals: Vec<f64>,
}

impl Configuration {
    /// The numbers that a linearisation needs.
    pub fn place<'a>(&'a self, set: &'a ConstraintSet) -> Place<'a> {
        Place { set, evaluation: &self.evaluation, rounding: &self.rounding, units: &self.scales.units }
    }

    pub fn new(set: &ConstraintSet, u: Vec<f64>, parts: &Parts) -> Result<Self, ArgumentError> {
        let mut evaluation = set.allocate();
        set.evaluate(&u, &mut evaluation)?;
        let rounding = set.rounding(&u)?;
        let scales = Scales::new(set, &evaluation, &rounding, parts);
        let (own, weights) = (in_roundings(evaluation.c(), rounding.c()), &scales.weights);
        let sizes = largest(weights, rounding.c(), parts);
        let residuals = parts.fold(0.0, |most: &mut f64, r| {
            let weighted = weights[r] * evaluation.c()[r].abs() / sizes[parts.of_row(r)];
            let roundings = if weights[r] > 0.0 && weighted.is_finite() { weighted } else { own[r] };
            *most = most.max(f64::EPSILON * roundings);
        });
        Ok(Self { u, evaluation, rounding, scales, residuals })
    }
}

/// For each equation, the constraint value `|c_r|` divided by the bound on its rounding; infinite if c_r is nonzero and the bound is
/// unknown.
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

/// The largest `D_r |x_r|` over the rows r of each part, with the weights D; numbers that are not finite do not count.
pub fn largest(weights: &[f64], x: &[f64], parts: &Parts) -> Vec<f64> {
    let weighted = |r: usize| Some(weights[r] * x[r].abs()).filter(|x| x.is_finite()).unwrap_or(0.0);
    parts.fold(0.0, |most: &mut f64, r| *most = most.max(weighted(r)))
}

/// A motion below this fraction of a coordinate is negligible. The fraction is about 50,000 machine epsilons, so it is above rounding; a
/// model has no use for motions that small.
const NEGLIGIBLE: f64 = 1e-11;

/// For each equation, `|c_r|` divided by the bound on its rounding, for parts whose c no longer falls. A row with weight `D_r > 0` demands
/// a negligible motion if `|c_r| <= 1e-11 sum_j |G_rj| s_j` with the extents s ([`ConstraintSet::extents`]). Such a row gets the smaller of
/// this ratio and `D_r |c_r| / max_k D_k rounding_k` over its part. The reason is that the row's own terms may vanish with u, and that
/// further steps among nearly dependent rows do harm.
pub fn at_rest(
    set: &ConstraintSet,
    (evaluation, rounding, weights): (&Evaluation, &Rounding, &[f64]),
    parts: &Parts,
) -> Result<Vec<f64>, ArgumentError> {
    let (c, bounds, extents) = (evaluation.c(), rounding.c(), set.extents(evaluation.u())?);
    let largest = largest(weights, bounds, parts);
    let mut list = in_roundings(c, bounds);
    for (r, own) in list.iter_mut().enumerate() {
        let motion: f64 = evaluation.g().row(r).map(|(j, v)| v.abs() * extents[j]).sum();
        let largest = largest[parts.of_row(r)];
        if weights[r] > 0.0 && largest > 0.0 && c[r].abs() <= NEGLIGIBLE * motion {
            *own = own.min(weights[r] * c[r].abs() / largest);
        }
    }
    Ok(list)
}

/// The relative change of a Jacobian from G to G': `max_j |G_rj - G'_rj| s_j / max_j max(|G_rj|, |G'_rj|) s_j` over the free DOFs of a row
/// r, with the units s. The largest of all rows counts.
pub fn change([before, after]: [&Csr; 2], rows: &[usize], units: &[f64], parts: &Parts) -> f64 {
    let of_row = |&row: &usize| {
        let pairs = before.row(row).zip(after.row(row)).filter(|((j, _), _)| parts.of_dof(*j).is_some());
        let (most, size) = pairs.fold((0.0_f64, 0.0_f64), |(most, size), ((j, a), (_, b))| {
            (most.max((a - b).abs() * units[j]), size.max(a.abs().max(b.abs()) * units[j]))
        });
        if most == 0.0 { 0.0 } else { most / size }
    };
    rows.iter().map(of_row).fold(0.0, f64::max)
}
