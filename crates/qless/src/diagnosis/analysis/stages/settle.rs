//! The stages again and again, until what presolve keeps is sound.

use std::time::Instant;

use super::{Run, Stages};
use crate::diagnosis::analysis::AnalysisError;
use crate::diagnosis::confidence::{self, Confidence};
use crate::diagnosis::samples::{Inverse, Keys, Sample, sweep};
use crate::diagnosis::sensitivity;
use crate::factor::backend::BackendError;
use crate::input::components::Labels;

/// Stages that presolve's doubts have been taken from.
pub struct Settled {
    pub stages: Stages,
    /// Rows held back from presolve.
    pub held: Vec<bool>,
    pub confidence: Confidence,
    /// Equations of the components whose rank or verdict is in doubt.
    pub doubted: Vec<usize>,
}

impl Settled {
    /// Whether the rank or a verdict is in doubt, by component.
    pub fn doubted(&self, labels: &Labels) -> Vec<bool> {
        let mut of = vec![false; labels.count];
        self.doubted.iter().for_each(|&i| of[labels.of_row[i] as usize] = true);
        of
    }

    /// The smallest singular value of the blocks, by component; 1 where there are none.
    pub fn sigmas(&self, labels: &Labels) -> Vec<f64> {
        let mut of = vec![1.0_f64; labels.count];
        for block in &self.stages.basis.blocks {
            if let Some(&row) = block.rows.first() {
                let label = labels.of_row[self.stages.history.rows[row as usize] as usize] as usize;
                of[label] = of[label].min(block.nearness.sigma);
            }
        }
        of
    }
}

impl Run<'_> {
    /// The stages; what presolve should not have kept goes to the backend with all that is connected to it, once. With the
    /// rows held back from presolve.
    pub fn settle(&self, presolve: bool, started: Instant) -> Result<Settled, AnalysisError> {
        let mut held = vec![!presolve; self.local.equations()];
        let first = self.swept(&held, started)?;
        let doubtful = if presolve && self.means.check { first.doubtful_rows() } else { Vec::new() };
        if doubtful.is_empty() {
            let doubted = if presolve { Vec::new() } else { self.second_opinion(&first, started)? };
            return self.settled(first, held, doubted);
        }
        let labels = Labels::of(self.local);
        labels.mark(&doubtful, &mut held);
        match self.swept(&held, started) {
            Ok(second) => {
                let counts = [first.dependent_by(&labels), second.dependent_by(&labels)];
                // Where equations were independent number by number, they are not quite dependent.
                let parted: Vec<bool> = (0..labels.count).map(|k| counts[0][k] < counts[1][k]).collect();
                let remainders = first.dependent.iter().filter(|d| d.dropped > 0.0 && held[d.row]).map(|d| d.row);
                let in_parted = doubtful.iter().copied().filter(|&i| parted[labels.of_row[i] as usize]);
                let doubted = in_parted.chain(remainders).collect();
                let lost = first.lost_by(&labels, self.means.tolerance);
                let back: Vec<bool> = (0..labels.count).map(|k| parted[k] && !lost[k]).collect();
                if !back.contains(&true) {
                    return self.settled(second, held, doubted);
                }
                // No nearer to dependence than the tolerance, as far as presolve can tell: its rank stands.
                let of_row = held.iter_mut().zip(&labels.of_row);
                of_row.for_each(|(held, &label)| *held &= !back[label as usize]);
                let third = self.swept(&held, started)?;
                self.settled(third, held, doubted)
            }
            // Too large for the backend: presolve's answer, in doubt.
            Err(AnalysisError::Backend(BackendError::OverLimit { .. } | BackendError::OutOfMemory { .. })) => {
                held.fill(false);
                self.settled(first, held, doubtful)
            }
            Err(error) => Err(error),
        }
    }

    /// Equations in doubt by presolve, which follows each number by itself, in components where the backend alone, which sees
    /// sizes, found dependent ones.
    fn second_opinion(&self, first: &Stages, started: Instant) -> Result<Vec<usize>, AnalysisError> {
        if !self.means.check || first.dependent.is_empty() {
            return Ok(Vec::new());
        }
        let labels = Labels::of(self.local);
        let (own, other) = (first.dependent_by(&labels), self.settle(true, started)?);
        let theirs = other.stages.dependent_by(&labels);
        let parted = first.dependent.iter().map(|d| d.row).filter(|&i| {
            let label = labels.of_row[i] as usize;
            theirs[label] < own[label]
        });
        let both = parted.chain(other.doubted.iter().copied().filter(|&i| own[labels.of_row[i] as usize] > 0));
        Ok(both.collect())
    }

    fn swept(&self, held: &[bool], started: Instant) -> Result<Stages, AnalysisError> {
        let mut stages = self.stages(held, started)?;
        let sweep =
            |s: &Stages, how| sweep(self.local, &s.basis, &s.history, self.scaling, &s.keys, Sample::First, how);
        stages.swept = sweep(&stages, Inverse::Bound);
        if !stages.swept.is_harmless() {
            if !stages.keys.are_within() {
                stages.keys = Keys::within(&Labels::of(self.local), self.local);
            }
            let bound_of_inverse = std::mem::take(&mut stages.swept.bound_of_inverse);
            stages.swept = sweep(&stages, Inverse::Sample);
            stages.swept.bound_of_inverse = bound_of_inverse;
        }
        Ok(stages)
    }

    /// `doubted` are equations on which two ways parted.
    fn settled(&self, stages: Stages, held: Vec<bool>, mut doubted: Vec<usize>) -> Result<Settled, AnalysisError> {
        let Stages { basis, history, dependent, swept, .. } = &stages;
        let row = |t: usize| stages.users_row(t);
        let kept = sensitivity::Kept { system: self.local, basis, history, scaling: self.scaling };
        let sigma = if self.means.check { kept.sigma(swept, dependent, row, self.means.memory())? } else { 1.0 };
        doubted.extend(confidence::doubted(dependent, self.local.system()));
        let near = basis.blocks.iter().filter(|block| !block.nearness.is_sound());
        doubted.extend(near.filter_map(|block| block.rows.first()).map(|&row| history.rows[row as usize] as usize));
        let confidence = Confidence::new(&basis.blocks, sigma, dependent, &doubted);
        Ok(Settled { stages, held, confidence, doubted })
    }
}
