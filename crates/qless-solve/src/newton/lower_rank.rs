//! Steps with a lower rank, for parts whose step is shorter than the full one.
//!
//! At a distance d from a solution, rows of G that are redundant there may be independent by an amount of order d, in some places of order
//! d^2. A step that satisfies them is then of order one: it leads away from the solution, or has to be cut. The step with the rank of the
//! solution is of order d and converges quadratically.
//!
//! A step changes G. Rows that this change can make dependent do not determine the motion. Let e be the change relative to the largest
//! entry of a row. If entries up to e count as zero, the analysis finds the rank for the tolerance e. Rows that are then redundant are left
//! out, and the others keep all their entries. The change e is not known before the step; it is at least about the relative residual of the
//! part. So e is raised from there by factors of four until the rank falls. If the rank does not fall for `e = 1/4`, nothing is tried.

use qless::{Options, Tolerance};
use qless_constraints::Evaluation;

use super::error::NewtonError;
use super::linearisation::{Motions, kept, linearise_above};
use super::step::{StepGoal, StepLengths, StepLine};
use crate::common::HALF_DIGITS;

/// A step is slow if it leaves more than this fraction of the merit function, which is the square of c. Where Newton's method is known to
/// converge (Kantorovich's h is at most 1/2), a full step leaves at most h / 2 of c.
const SLOW: f64 = 1.0 / 16.0;

/// When a part may search for a step with a lower rank. After `k >= 2` failed searches in a row, the part takes `2^(k - 2)` steps without a
/// search. So a part with many short steps, such as a long chain that falls into place, rarely searches in vain.
#[derive(Clone, Default)]
pub struct Searches {
    failed: u32,
    /// The first step at which the part may search again.
    next: usize,
}

impl Searches {
    fn end(&mut self, step: usize, found: bool) {
        self.failed = if found { 0 } else { self.failed + 1 };
        self.next = step + 1 + (1_usize << self.failed.min(30)) / 4;
    }
}

/// Searches steps with a lower rank, which ignore rows that are nearly dependent.
pub struct LowerRank<'a> {
    pub prescribed: &'a [(usize, f64)],
    pub options: &'a Options,
    pub goals: &'a [StepGoal],
    pub step: usize,
}

impl LowerRank<'_> {
    /// For each part whose step is shorter than the full one and whose next search is due, tries steps with a lower rank. The part takes
    /// the new step if it leaves less of the constraint values c.
    pub fn improve(
        &self,
        line: &mut StepLine,
        best: &mut StepLengths,
        (searches, buffer): (&mut [Searches], &mut Evaluation),
    ) -> Result<(), NewtonError> {
        // A relative residual below HALF_DIGITS counts as HALF_DIGITS, the least tolerance with which `linearise` analyses rows.
        let residual = |part: usize| line.from.residuals[part].max(HALF_DIGITS);
        let is_short = |part: &usize| self.goals[*part] == StepGoal::Downhill && best.lengths[*part] < 1.0;
        let searches_now = |part: &usize| is_short(part) && searches[*part].next <= self.step;
        let mut open: Vec<usize> = (0..self.goals.len()).filter(searches_now).collect();
        open.iter().for_each(|&part| searches[part].end(self.step, false));
        if open.is_empty() {
            return Ok(());
        }
        let parts = line.parts;
        let rank = |of: &[bool]| parts.fold(0, |rank, r| *rank += usize::from(of[r]));
        let (full, lowest) = (rank(line.kept), rank(&self.independent(line, 0.25)?));
        open.retain(|&part| lowest[part] < full[part]);
        // All parts share one series of tolerances e: powers of four. A part skips those below its residual, so that it tries the same ones
        // as it would alone.
        let first = open.iter().map(|&part| residual(part)).fold(1.0, f64::min);
        for e in (1..=(-0.5 * first.log2()) as i32).rev().map(|k| f64::from(-2 * k).exp2()) {
            if !open.iter().any(|&part| residual(part) <= e) {
                continue;
            }
            let rows = self.independent(line, e)?;
            let lower = rank(&rows);
            let falls = |part: &usize| residual(*part) <= e && lower[*part] < full[*part];
            let (tried, rest) = open.into_iter().partition::<Vec<usize>, _>(falls);
            open = rest;
            if !tried.is_empty() {
                self.replace(line, best, (&rows, &tried), (searches, buffer))?;
            }
        }
        Ok(())
    }

    /// Whether each row is independent by more than e, relative to its largest entry. Linear rows do not change, so that all their entries
    /// count.
    fn independent(&self, line: &StepLine, e: f64) -> Result<Vec<bool>, NewtonError> {
        let (g, units, linear) = (line.from.evaluation.g(), &line.from.scales.units, line.set.linear_rows());
        let largest = |r: usize| g.row(r).map(|(j, v)| (v * units[j]).abs()).fold(0.0, f64::max);
        let floors = (0..g.rows()).map(|r| if linear.contains(&r) { 0.0 } else { e * largest(r) }).collect();
        let options = Options { tolerance: Tolerance::Relative(e), ..self.options.clone() };
        Ok(kept(&linearise_above(floors, line.from.place(line.set), self.prescribed, (self.step, &options))?))
    }

    /// Replaces the steps of the parts `tried` by those that satisfy only `rows`, if these leave less of c and are either full or not slow.
    ///
    /// A step that is short and slow although it ignores rows shows that the ignored rows are needed.
    fn replace(
        &self,
        line: &mut StepLine,
        best: &mut StepLengths,
        (rows, tried): (&[bool], &[usize]),
        (searches, buffer): (&mut [Searches], &mut Evaluation),
    ) -> Result<(), NewtonError> {
        let Some(du) = self.step_of(line, rows)? else { return Ok(()) };
        let mut goals = vec![StepGoal::Done; self.goals.len()];
        tried.iter().for_each(|&part| goals[part] = StepGoal::Downhill);
        let other = StepLine { du, ..*line };
        let argument = |source| NewtonError::Argument { step: self.step, source };
        let found = other.lengths(&goals, buffer).map_err(argument)?;
        let converges = |part: usize| found.left[part] <= SLOW || found.lengths[part] == 1.0;
        let is_better = |part: &usize| found.left[*part] < best.left[*part] && converges(*part);
        let better: Vec<usize> = tried.iter().copied().filter(is_better).collect();
        for part in better {
            searches[part].end(self.step, true);
            (best.lengths[part], best.left[part]) = (found.lengths[part], found.left[part]);
            line.parts.list[part].free.iter().for_each(|&j| line.du[j] = other.du[j]);
        }
        Ok(())
    }

    /// The step that satisfies only `rows`; `None` if T of these rows cannot be computed accurately.
    fn step_of(&self, line: &StepLine, rows: &[bool]) -> Result<Option<Vec<f64>>, NewtonError> {
        let floors = rows.iter().map(|&row| if row { 0.0 } else { f64::MAX }).collect();
        let options = Options { tolerance: Tolerance::Relative(HALF_DIGITS), ..self.options.clone() };
        let place = line.from.place(line.set);
        let analysis = linearise_above(floors, place, self.prescribed, (self.step, &options))?;
        let Ok(motions) = Motions::new(&analysis, &line.from.scales.units, self.step) else { return Ok(None) };
        motions.step().map(Some).map_err(|source| NewtonError::Argument { step: self.step, source })
    }
}
