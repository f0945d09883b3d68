//! A configuration, and how far each part is from its constraints there.

use qless::ArgumentError;

use super::parts::Parts;
use super::residual::in_roundings;
use super::scaling::{largest, weights};
use qless_constraints::{ConstraintSet, Quantities, Rounding};

/// A configuration with its c and G.
pub struct Place {
    pub u: Vec<f64>,
    pub quantities: Quantities,
    /// Bounds on the rounding of c and G.
    pub rounding: Rounding,
    /// What makes equations comparable.
    pub weights: Vec<f64>,
    /// `max_r D_r |c_r|` of each part, relative to the largest terms that went into any c of it; a row without slope by its own terms.
    pub residuals: Vec<f64>,
}

impl Place {
    pub fn new(set: &ConstraintSet, u: Vec<f64>, parts: &Parts) -> Result<Self, ArgumentError> {
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

fn residuals(c: &[f64], bounds: &[f64], weights: &[f64], parts: &Parts) -> Vec<f64> {
    let relative = |(all, bound): (f64, f64)| if all == 0.0 { 0.0 } else { all / bound };
    let largest = |x| largest(weights, x, parts);
    let mut list: Vec<f64> = largest(c).into_iter().zip(largest(bounds)).map(relative).collect();
    let flat = in_roundings(c, bounds).into_iter().enumerate().filter(|(r, _)| weights[*r] == 0.0);
    flat.for_each(|(r, own)| list[parts.of_row(r)] = list[parts.of_row(r)].max(own));
    list.iter_mut().for_each(|residual| *residual *= f64::EPSILON);
    list
}
