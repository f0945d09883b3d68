//! What each part has to do next: down to c = 0, out of a place where first order knows no way, or nothing.

use qless::{Analysis, ArgumentError};

use super::super::dependent;
use super::super::step::Way;
use super::{Run, State, kept};

impl Run<'_> {
    /// Finds out what each part has to do next.
    ///
    /// A part is done where its kept equations hold to the tolerance, and all others to what that makes of them.
    pub fn decide(&mut self, analysis: &Analysis) -> Result<(), ArgumentError> {
        let (kept, tolerance) = (kept(analysis), self.options.tolerance);
        let off = self.parts.fold(false, |off, r| *off |= kept[r] && self.residuals[r] > tolerance);
        self.contradicted.clear();
        for row in dependent(analysis) {
            let part = self.parts.of_row(row);
            let asked = self.states[part].way != Way::Done && !off[part];
            if asked && self.contradicts(analysis, row)? {
                self.contradicted.push(row);
            }
        }
        let way = |(state, off): (&mut State, bool)| {
            if state.way != Way::Done {
                state.way = if off { Way::Downhill } else { Way::Done };
            }
        };
        self.states.iter_mut().zip(off).for_each(way);
        self.contradicted.iter().for_each(|&row| self.states[self.parts.of_row(row)].way = Way::Out);
        Ok(())
    }

    /// Whether a part is neither done nor has failed. After the last step that there may be, all others have.
    pub fn goes_on(&mut self, step: usize) -> bool {
        if step == self.options.steps {
            let unfinished = |part: &usize| self.states[*part].way != Way::Done;
            let late: Vec<usize> = (0..self.parts.count()).filter(unfinished).collect();
            late.into_iter().for_each(|part| self.fail(part, self.no_convergence(step, part)));
        }
        self.states.iter().any(|state| state.way != Way::Done)
    }

    /// Whether an equation that is left out does not hold: `c_k` is that of its certificate, and so is its rounding.
    fn contradicts(&self, analysis: &Analysis, row: usize) -> Result<bool, ArgumentError> {
        if self.residuals[row] <= self.options.tolerance {
            return Ok(false);
        }
        let rounding = self.place.rounding.c();
        let terms = analysis.because(row)?.into_iter().map(|b| b.coefficient.abs() * rounding[b.row]);
        let allowed = self.options.tolerance * terms.fold(rounding[row], |sum, term| sum + term);
        Ok(!(self.place.quantities.c()[row].abs() <= allowed && allowed.is_finite()))
    }
}
