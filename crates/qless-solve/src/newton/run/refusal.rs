//! What is said of a part that has no way to go.

use qless::Analysis;

use super::super::NewtonError;
use super::super::step::Way;
use super::Run;

impl Run<'_> {
    /// The part stays where it is.
    pub(super) fn fail(&mut self, part: usize, error: NewtonError) {
        self.states[part].way = Way::Done;
        self.failures.push((part, error));
    }

    pub(super) fn conflict(&self, part: usize, analysis: &Analysis) -> NewtonError {
        let rows: Vec<usize> =
            self.contradicted.iter().copied().filter(|&row| self.parts.of_row(row) == part).collect();
        let named = |rows: &[usize]| rows.iter().filter_map(|&row| self.set.label(row).ok()).collect();
        let mut others: Vec<usize> =
            rows.iter().flat_map(|&row| analysis.because(row).unwrap_or_default()).map(|b| b.row).collect();
        others.sort_unstable();
        others.dedup();
        let amount = rows.iter().map(|&row| self.place.quantities.c()[row].abs()).fold(0.0, f64::max);
        NewtonError::Conflict { labels: named(&rows), others: named(&others), rows, amount }
    }

    pub(super) fn no_convergence(&self, steps: usize, part: usize) -> NewtonError {
        let weighted = |&r: &usize| self.place.weights[r] * self.place.quantities.c()[r].abs();
        let rows = (0..self.residuals.len()).filter(|&r| self.parts.of_row(r) == part);
        let worst = rows.max_by(|a, b| weighted(a).total_cmp(&weighted(b)));
        let label = worst.and_then(|row| self.set.label(row).ok()).unwrap_or_default();
        NewtonError::NoConvergence { steps, residual: self.place.residuals[part], label }
    }
}
