//! Step length along du: as far as a second-order model describes c and c gets smaller, for each part separately.
//!
//! At a trial point `u + t du` both c and G are known, so that the curvature along du needs no Hessian. With `g = G du` at the start and
//! `g'` at the trial point, second order predicts `c' = c + t (g + g') / 2`. The difference to the actual c' is of third order. If it is
//! not small compared with the first and second order, t is too long. This detects a crank that would turn by a million radians: g' grows
//! with du, but c' does not.
//!
//! All parts try their lengths together, so that one evaluation serves all. Parts that have found their length keep it.

use qless::{ArgumentError, Csr};
use qless_constraints::{ConstraintSet, Evaluation};

use super::configuration::{Configuration, largest};
use super::parts::Parts;

/// Largest third-order term, relative to the first- and second-order prediction. With a quarter, steps near a solution are full ones, and
/// far from it a model that is wrong is not followed.
const SHARE: f64 = 0.25;

/// The goal of a part's step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepGoal {
    /// No step: all equations of the part hold, or the part has failed.
    Done,
    /// The part reduces the residuals of its kept equations, or brings them within the tolerance.
    Downhill,
    /// The part leaves a singular configuration, by a step length at which the second-order model describes c.
    Out,
}

/// A configuration u and a direction du from it.
pub struct StepLine<'a> {
    pub set: &'a ConstraintSet,
    pub parts: &'a Parts,
    pub from: &'a Configuration,
    /// For each equation, whether it is independent.
    pub kept: &'a [bool],
    pub tolerance: f64,
    pub du: Vec<f64>,
}

/// A step of length t is accepted only if the merit function falls by at least this fraction times t. Almost any decrease that is clearly
/// above rounding is enough.
const DECREASE: f64 = 1e-4;

/// How far each part moves along du.
pub struct StepLengths {
    /// For each part, its step length t: it moves by t du. Parts with t = 0 do not move.
    pub lengths: Vec<f64>,
    /// For each part, the fraction of the merit function `sum_r D_r^2 c_r^2` that the step leaves: 0 if the kept equations then hold, 1
    /// without a step.
    pub left: Vec<f64>,
}

/// Result of a part at its trial point.
#[derive(Clone)]
struct TrialVerdict {
    trusted: bool,
    /// All kept equations hold to the tolerance.
    holds: bool,
    /// The merit function `sum_r D_r^2 c_r^2` over the kept equations, with the weights D, at the trial point.
    now: f64,
    /// The merit function along the step by the second-order model `c_r + t g_r + t^2 q_r`, with `g = G du`: coefficients from t^0 to t^4.
    model: [f64; 5],
}

impl StepLine<'_> {
    /// Finds the first acceptable length t of each part, from 1 downwards, and the fraction of the merit function that it leaves. The
    /// length is 0 for parts that are done, or that no acceptable t moves.
    pub fn lengths(&self, goals: &[StepGoal], buffer: &mut Evaluation) -> Result<StepLengths, ArgumentError> {
        let slope = times(self.from.evaluation.g(), &self.du);
        let mut open: Vec<bool> = goals.iter().map(|&goal| goal != StepGoal::Done).collect();
        let mut lengths: Vec<f64> = open.iter().map(|&open| if open { 1.0 } else { 0.0 }).collect();
        let mut left = vec![1.0; open.len()];
        while open.contains(&true) {
            let u = self.at(&lengths);
            self.set.evaluate(&u, buffer)?;
            let verdicts = self.verdicts((buffer.c(), &slope, &times(buffer.g(), &self.du)), &lengths, &open);
            for (part, verdict) in verdicts.iter().enumerate().filter(|(part, _)| open[*part]).collect::<Vec<_>>() {
                let t = &mut lengths[part];
                let falls = verdict.now <= (1.0 - DECREASE * *t) * verdict.model[0];
                let moves = self.parts.list[part].free.iter().any(|&j| u[j] != self.from.u[j]);
                if verdict.trusted && (goals[part] == StepGoal::Out || falls || verdict.holds) {
                    open[part] = false;
                    left[part] = if verdict.holds { 0.0 } else { verdict.now / verdict.model[0] };
                } else {
                    let next = if verdict.trusted { lowest(&verdict.model, *t) } else { 0.25 * *t };
                    (*t, open[part]) = (if moves { next } else { 0.0 }, moves);
                }
            }
        }
        Ok(StepLengths { lengths, left })
    }

    /// `u + t du`. Parts with t = 0 keep the bits of u.
    pub fn at(&self, lengths: &[f64]) -> Vec<f64> {
        let moved = |(j, (u, du)): (usize, (&f64, &f64))| match self.parts.of_dof(j).map_or(0.0, |part| lengths[part]) {
            0.0 => *u,
            t => u + t * du,
        };
        self.from.u.iter().zip(&self.du).enumerate().map(moved).collect()
    }

    /// Tests the trial point of each open part; the verdicts of other parts are meaningless. `slopes` are `G du` at the start and at the
    /// trial point.
    fn verdicts(
        &self,
        (now, slope, slope_now): (&[f64], &[f64], &[f64]),
        lengths: &[f64],
        open: &[bool],
    ) -> Vec<TrialVerdict> {
        let (c, rounding) = (self.from.evaluation.c(), self.from.rounding.c());
        let residuals = largest(&self.from.scales.weights, c, self.parts);
        let first = TrialVerdict { trusted: true, holds: true, now: 0.0, model: [0.0; 5] };
        self.parts.fold(first, |verdict, r| {
            let (part, weight) = (self.parts.of_row(r), self.from.scales.weights[r]);
            if !open[part] {
                return;
            }
            let t = lengths[part];
            let third = now[r] - c[r] - 0.5 * t * (slope[r] + slope_now[r]);
            let second = 0.5 * t * (slope_now[r] - slope[r]);
            // An equation without weight has no first-order prediction.
            let first = if weight > 0.0 { t * residuals[part] / weight } else { 0.0 };
            let unknown = if rounding[r].is_finite() { 8.0 * rounding[r] } else { 0.0 };
            // A third order that is not finite fails the test.
            verdict.trusted &= third.abs() <= SHARE * (second.abs() + first) + unknown;
            if self.kept[r] {
                verdict.holds &= now[r].abs() <= self.tolerance * rounding[r];
                verdict.now += (weight * now[r]).powi(2);
                let [c, g, q] = [c[r], slope[r], second / (t * t)].map(|x| weight * x);
                let products = [c * c, 2.0 * c * g, g * g + 2.0 * c * q, 2.0 * g * q, q * q];
                verdict.model.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
            }
        })
    }
}

/// The t that minimises the polynomial `model`, among `last / 2`, `last / 4` and so on.
fn lowest(model: &[f64; 5], last: f64) -> f64 {
    let value = |t: f64| model.iter().rev().fold(0.0, |sum, a| sum * t + a);
    let candidates = std::iter::successors(Some(0.5 * last), |t| Some(0.5 * t)).take(40);
    candidates.min_by(|&a, &b| value(a).total_cmp(&value(b))).unwrap_or(0.5 * last)
}

/// `G x`.
pub fn times(g: &Csr, x: &[f64]) -> Vec<f64> {
    (0..g.rows()).map(|r| g.row(r).map(|(j, v)| v * x[j]).sum()).collect()
}
