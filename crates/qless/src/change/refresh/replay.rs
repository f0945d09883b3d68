//! What elimination did to the right-hand sides, done again: `b_k <- b_k - factor b_p`, in order of time.

use super::Refresher;
use crate::input::numbering::Local;
use crate::input::scale::ldexp;
use crate::presolve::eliminated::Mismatch;
use crate::presolve::rows::Row;

/// The right-hand side of a row.
#[derive(Clone, Copy, Default)]
pub struct Side {
    /// b.
    pub rhs: f64,
    /// `b - C_p u_p`.
    pub effective: Mismatch,
}

impl Side {
    fn subtract(&mut self, factor: f64, other: Self) {
        self.rhs -= factor * other.rhs;
        self.effective.subtract(factor, other.effective);
        // The factor is rounded too.
        self.effective.error += f64::EPSILON * (factor * other.effective.value).abs();
    }
}

/// All that is known of one b and u_p.
pub struct Replay<'a> {
    refresher: &'a Refresher,
    local: Local<'a>,
    /// b as given.
    pub rhs: &'a [f64],
    /// Values of prescribed DOFs, in local numbers.
    values: Vec<f64>,
    /// What each step of the elimination held.
    pub steps: Vec<Side>,
}

impl<'a> Replay<'a> {
    pub fn new(refresher: &'a Refresher, rhs: &'a [f64], prescribed: &[f64]) -> Self {
        let analysis = &refresher.analysis;
        let local = analysis.numbering.view(&analysis.system, rhs);
        let mut values = vec![0.0; if prescribed.is_empty() { 0 } else { local.dofs() }];
        local.prescribed_places().for_each(|(l, place)| values[l] = prescribed[place]);
        let steps = Vec::with_capacity(analysis.history.steps.len());
        let mut replay = Self { refresher, local, rhs, values, steps };
        for &row in &analysis.history.steps {
            let side = replay.row(row);
            replay.steps.push(side);
        }
        replay
    }

    /// Row `i` of those that went through elimination, after all steps, in scaled units.
    pub fn row(&self, i: u32) -> Side {
        let history = &self.refresher.analysis.history;
        let user = history.rows[i as usize] as usize;
        let mut side = self.side(user, true);
        history.factors[i as usize].iter().for_each(|&(step, factor)| side.subtract(factor, self.steps[step as usize]));
        side
    }

    /// `b - C_p u_p` of an equation as the user gave it.
    pub fn of_user(&self, row: usize) -> Mismatch {
        self.side(row, false).effective
    }

    fn side(&self, row: usize, scaled: bool) -> Side {
        let exponent = if scaled { self.refresher.analysis.scaling.row[row] } else { 0 };
        let mut sum = Row::new(ldexp(self.rhs[row], exponent));
        if !self.values.is_empty() {
            let fixed = self.local.row(row).filter(|&(j, _)| !self.local.free()[j]);
            fixed.for_each(|(j, v)| sum.prescribe(ldexp(v, exponent) * self.values[j]));
        }
        Side { rhs: sum.rhs, effective: Mismatch::of(&sum) }
    }
}
