//! Step length along du: as far as a second-order model describes c and c gets smaller, for each part separately.
//!
//! At a trial point `u + t du` both c and G are known, so that the curvature along du needs no Hessian. With `g = G du` at the start and
//! `g'` at the trial point, second order predicts `c' = c + t (g + g') / 2`; the difference to the actual c' is of third order. If it is
//! not small compared with the second order, t is too long. This detects a crank that would turn by a million radians: g' grows with du,
//! but c' does not.
//!
//! All parts try their lengths together, so that one evaluation serves all. Parts that have found their length keep it.

use qless::{ArgumentError, Csr};
use qless_constraints::{ConstraintSet, Evaluation};

use super::configuration::{Configuration, largest};
use super::parts::EquationParts;

/// Largest third-order term, relative to the second-order term and to the first-order prediction.
const THIRD: f64 = 0.25;
/// Smallest decrease of the merit function, relative to the first-order prediction.
const DECREASE: f64 = 1e-4;
/// Most trials. At a distance of 1e-150 from a dead centre, du is too long by a factor of about 1e150, so that t may be as small as
/// `4^-250`.
const TRIES: usize = 250;

/// The goal of a part's step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepGoal {
    /// No step: all equations of the part hold, or the part has failed.
    Done,
    /// Smaller residuals of the kept equations, or residuals within the tolerance.
    Downhill,
    /// A way out of a singular configuration: a length that the second-order model describes.
    Out,
}

/// A configuration and a direction.
pub struct StepLine<'a> {
    pub set: &'a ConstraintSet,
    pub parts: &'a EquationParts,
    pub from: &'a Configuration,
    du: Vec<f64>,
    /// `G du` at the start.
    slope: Vec<f64>,
    /// `max_r D_r |c_r|` of each part at the start.
    residuals: Vec<f64>,
}

/// State of the search for the step length of a part.
#[derive(Clone, Copy, PartialEq)]
enum TrialLength {
    /// Length of the next trial.
    Open(f64),
    /// Accepted length; 0 if no length is acceptable.
    Found(f64),
}

/// c and its slope at a trial point.
struct TrialPoint {
    lengths: Vec<TrialLength>,
    c: Vec<f64>,
    slope: Vec<f64>,
}

/// Result of a part at its trial point.
#[derive(Clone)]
struct TrialVerdict {
    trusted: bool,
    /// All kept equations hold to the tolerance.
    holds: bool,
    /// `sum_r D_r^2 c_r^2` over the kept equations.
    now: f64,
    /// Coefficients of `sum_r D_r^2 (c_r + t g_r + t^2 q_r)^2`, from t^0 to t^4.
    model: [f64; 5],
}

impl<'a> StepLine<'a> {
    pub fn new((set, parts): (&'a ConstraintSet, &'a EquationParts), from: &'a Configuration, du: Vec<f64>) -> Self {
        let slope = times(from.evaluation.g(), &du);
        let residuals = largest(&from.weights, from.evaluation.c(), parts);
        Self { set, parts, from, du, slope, residuals }
    }

    /// The first acceptable t of each part, from 1 downwards; 0 for parts that are done or find none.
    pub fn lengths(
        &self,
        goals: &[StepGoal],
        (kept, tolerance): (&[bool], f64),
        buffer: &mut Evaluation,
    ) -> Result<Vec<f64>, ArgumentError> {
        let first =
            |goal: &StepGoal| if *goal == StepGoal::Done { TrialLength::Found(0.0) } else { TrialLength::Open(1.0) };
        let mut lengths: Vec<TrialLength> = goals.iter().map(first).collect();
        for _ in 0..TRIES {
            if !lengths.iter().any(TrialLength::is_open) {
                break;
            }
            let trial = self.trial(lengths, buffer)?;
            let verdicts = self.verdicts(&trial, kept, tolerance);
            let each = trial.lengths.iter().zip(&verdicts).zip(goals);
            lengths = each.map(|((length, verdict), goal)| length.next(verdict, *goal)).collect();
        }
        Ok(lengths.into_iter().map(|length| if length.is_open() { 0.0 } else { length.t() }).collect())
    }

    /// `u + t du`. Parts with t = 0 keep the bits of u.
    pub fn at(&self, t: impl Fn(usize) -> f64) -> Vec<f64> {
        let moved = |(j, (u, du)): (usize, (&f64, &f64))| match self.parts.of_dof(j).map_or(0.0, &t) {
            0.0 => *u,
            t => u + t * du,
        };
        self.from.u.iter().zip(&self.du).enumerate().map(moved).collect()
    }

    fn trial(&self, lengths: Vec<TrialLength>, buffer: &mut Evaluation) -> Result<TrialPoint, ArgumentError> {
        self.set.evaluate(&self.at(|part| lengths[part].t()), buffer)?;
        Ok(TrialPoint { lengths, c: buffer.c().to_vec(), slope: times(buffer.g(), &self.du) })
    }

    /// Verdicts of parts that have found their length are meaningless.
    fn verdicts(&self, trial: &TrialPoint, kept: &[bool], tolerance: f64) -> Vec<TrialVerdict> {
        let rounding = self.from.rounding.c();
        let first = TrialVerdict { trusted: true, holds: true, now: 0.0, model: [0.0; 5] };
        self.parts.fold(first, |verdict, r| {
            let TrialLength::Open(t) = trial.lengths[self.parts.of_row(r)] else { return };
            verdict.trusted &= self.trusts(trial, r, t);
            if kept[r] {
                verdict.holds &= trial.c[r].abs() <= tolerance * rounding[r];
                self.add(verdict, trial, r, t);
            }
        })
    }

    fn trusts(&self, trial: &TrialPoint, r: usize, t: f64) -> bool {
        let c = self.from.evaluation.c()[r];
        let third = trial.c[r] - c - 0.5 * t * (self.slope[r] + trial.slope[r]);
        let second = 0.5 * t * (trial.slope[r] - self.slope[r]);
        let residual = self.residuals[self.parts.of_row(r)];
        let harmless = THIRD * t * residual / self.from.weights[r] + 8.0 * self.from.rounding.c()[r];
        // A third order that is not finite fails the test.
        third.abs() <= THIRD * second.abs() + if harmless.is_finite() { harmless } else { 0.0 }
    }

    /// Adds a weighted equation.
    fn add(&self, TrialVerdict { now, model, .. }: &mut TrialVerdict, trial: &TrialPoint, r: usize, t: f64) {
        let weight = self.from.weights[r];
        let (c, g) = (weight * self.from.evaluation.c()[r], weight * self.slope[r]);
        let q = weight * (0.5 * (trial.slope[r] - self.slope[r]) / t);
        *now += (weight * trial.c[r]) * (weight * trial.c[r]);
        let products = [c * c, 2.0 * (c * g), g * g + 2.0 * (c * q), 2.0 * (g * q), q * q];
        model.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
    }
}

impl TrialLength {
    fn is_open(&self) -> bool {
        matches!(self, Self::Open(_))
    }

    fn t(&self) -> f64 {
        match *self {
            Self::Open(t) | Self::Found(t) => t,
        }
    }

    /// The state after a trial.
    fn next(self, verdict: &TrialVerdict, goal: StepGoal) -> Self {
        let Self::Open(t) = self else { return self };
        if !verdict.trusted {
            return Self::Open(0.25 * t);
        }
        let falls = verdict.now <= (1.0 - DECREASE * t) * verdict.model[0];
        if goal == StepGoal::Out || falls || verdict.holds {
            Self::Found(t)
        } else {
            Self::Open(lowest(&verdict.model, t))
        }
    }
}

/// The t that minimises the polynomial, among `last / 2`, `last / 4` and so on.
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
