//! How far to go along du: as far as second order describes c, and only where c gets smaller.
//!
//! At a trial point `u + t du` both c and G are known, so that the curvature along du needs no Hessian: with `g = G du` before and
//! `g'` after, second order is `c' = c + t (g + g') / 2`. What c' differs from that is of third order. Where it is no longer small
//! beside the second order, t is too long: a crank that would turn by a million radians is found out, wherever it ends, since g'
//! then grows with du and c' does not.

use qless::{ArgumentError, Csr};

use crate::{ConstraintSet, Quantities};

/// Third order may be this part of second order, and of the residual.
const THIRD: f64 = 0.25;
/// The merit falls by at least this part of what first order promises.
const DECREASE: f64 = 1e-4;
/// t below `4^-60` is no step.
const TRIES: usize = 60;

/// A configuration with its c and G.
pub struct Place {
    pub u: Vec<f64>,
    pub quantities: Quantities,
    /// Bounds on the rounding of c.
    pub rounding: Vec<f64>,
}

impl Place {
    pub fn new(set: &ConstraintSet, u: Vec<f64>) -> Result<Self, ArgumentError> {
        let mut quantities = set.allocate();
        set.evaluate(&u, &mut quantities)?;
        let rounding = set.rounding(&u)?.c().to_vec();
        Ok(Self { u, quantities, rounding })
    }

    /// Takes another u.
    pub fn move_to(&mut self, set: &ConstraintSet, u: Vec<f64>) -> Result<(), ArgumentError> {
        set.evaluate(&u, &mut self.quantities)?;
        self.rounding = set.rounding(&u)?.c().to_vec();
        self.u = u;
        Ok(())
    }
}

/// A direction from a place.
pub struct Line<'a> {
    set: &'a ConstraintSet,
    from: &'a Place,
    du: Vec<f64>,
    /// `G du` there.
    slope: Vec<f64>,
    /// Largest `|c_r|` in roundings.
    residual: f64,
}

/// c and its slope at a trial point.
struct Trial {
    t: f64,
    c: Vec<f64>,
    slope: Vec<f64>,
}

impl<'a> Line<'a> {
    pub fn new(set: &'a ConstraintSet, from: &'a Place, du: Vec<f64>) -> Self {
        let slope = times(from.quantities.g(), &du);
        let measures = super::residual::in_roundings(from.quantities.c(), &from.rounding);
        Self { set, from, du, slope, residual: measures.into_iter().fold(0.0, f64::max) }
    }

    pub fn at(&self, t: f64) -> Vec<f64> {
        self.from.u.iter().zip(&self.du).map(|(u, du)| u + t * du).collect()
    }

    /// The first t from 1 down that second order describes.
    pub fn trusted(&self, room: &mut Quantities) -> Result<Option<f64>, ArgumentError> {
        let mut t = 1.0;
        for _ in 0..TRIES {
            if self.trusts(&self.trial(t, room)?) {
                return Ok(Some(t));
            }
            t *= 0.25;
        }
        Ok(None)
    }

    /// A t at which the equations `kept` are nearer to zero.
    pub fn downhill(&self, kept: &[bool], room: &mut Quantities) -> Result<Option<f64>, ArgumentError> {
        let mut t = 1.0;
        for _ in 0..TRIES {
            let trial = self.trial(t, room)?;
            if !self.trusts(&trial) {
                t *= 0.25;
                continue;
            }
            let model = self.model(&trial, kept);
            let now: f64 = self.sum(kept, |r| trial.c[r] * trial.c[r]);
            if now <= (1.0 - DECREASE * t) * model[0] {
                return Ok(Some(t));
            }
            t = lowest(&model, t);
        }
        Ok(None)
    }

    fn trial(&self, t: f64, room: &mut Quantities) -> Result<Trial, ArgumentError> {
        self.set.evaluate(&self.at(t), room)?;
        Ok(Trial { t, c: room.c().to_vec(), slope: times(room.g(), &self.du) })
    }

    fn trusts(&self, trial: &Trial) -> bool {
        let c = self.from.quantities.c();
        (0..c.len()).all(|r| {
            let third = trial.c[r] - c[r] - 0.5 * trial.t * (self.slope[r] + trial.slope[r]);
            let second = 0.5 * trial.t * (trial.slope[r] - self.slope[r]);
            let rounding = self.from.rounding[r] * (THIRD * self.residual + 8.0);
            third.abs() <= THIRD * second.abs() + if rounding.is_nan() { 0.0 } else { rounding }
        })
    }

    /// Coefficients of `sum_r ((c_r + t g_r + t^2 q_r / 2) / rounding_r)^2`, from t^0 to t^4.
    fn model(&self, trial: &Trial, kept: &[bool]) -> [f64; 5] {
        let (c, g) = (self.from.quantities.c(), &self.slope);
        let q = |r: usize| 0.5 * (trial.slope[r] - g[r]) / trial.t;
        [
            self.sum(kept, |r| c[r] * c[r]),
            self.sum(kept, |r| 2.0 * c[r] * g[r]),
            self.sum(kept, |r| g[r] * g[r] + 2.0 * c[r] * q(r)),
            self.sum(kept, |r| 2.0 * g[r] * q(r)),
            self.sum(kept, |r| q(r) * q(r)),
        ]
    }

    /// Squares of numbers of the kept equations, each by its rounding.
    fn sum(&self, kept: &[bool], square: impl Fn(usize) -> f64) -> f64 {
        let term = |r: usize| {
            let rounding = self.from.rounding[r];
            let term = square(r) / (rounding * rounding);
            if rounding.is_finite() && rounding > 0.0 { term } else { 0.0 }
        };
        (0..kept.len()).filter(|&r| kept[r]).map(term).sum()
    }
}

/// The t below half of `last` at which the polynomial is lowest, among halves of halves.
fn lowest(model: &[f64; 5], last: f64) -> f64 {
    let value = |t: f64| model.iter().rev().fold(0.0, |sum, a| sum * t + a);
    let half = |t: &f64| Some(0.5 * t);
    let candidates = std::iter::successors(Some(0.5 * last), half).take(40);
    candidates.min_by(|&a, &b| value(a).total_cmp(&value(b))).unwrap_or(0.5 * last)
}

/// `G x`.
pub fn times(g: &Csr, x: &[f64]) -> Vec<f64> {
    (0..g.rows()).map(|r| g.row(r).map(|(j, v)| v * x[j]).sum()).collect()
}
