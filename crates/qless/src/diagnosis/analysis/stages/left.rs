//! What the stages left, asked by row and by component.

use std::sync::OnceLock;

use super::Stages;
use crate::common::identity::Identity;
use crate::diagnosis::analysis::{Analysis, Timings};
use crate::diagnosis::classify::Kind;
use crate::diagnosis::confidence::Confidence;
use crate::diagnosis::generated::Generated;
use crate::factor::backend::Backend;
use crate::input::components::Labels;
use crate::input::numbering::Numbering;
use crate::input::scale::Scaling;
use crate::{ConstraintSystem, Options};

impl Stages {
    /// The user's rows on which presolve should not have decided.
    pub fn doubtful_rows(&self) -> Vec<usize> {
        let kept = self.swept.doubtful.iter().map(|doubtful| self.users_row(doubtful.row));
        kept.chain(self.far.iter().map(|&row| self.history.rows[row as usize] as usize)).collect()
    }

    /// The user's row of row t of the basis, peeled or eliminated.
    pub fn users_row(&self, t: usize) -> usize {
        let first = self.basis.peeled.len();
        match self.basis.peeled.get(t) {
            Some(&row) => row as usize,
            None => self.history.rows[self.history.steps[t - first] as usize] as usize,
        }
    }

    /// By component, whether presolve lost digits there, or kept what is nearer to dependence than the tolerance.
    pub fn lost_by(&self, labels: &Labels, tolerance: f64) -> Vec<bool> {
        let mut lost = vec![false; labels.count];
        for doubtful in self.swept.doubtful.iter().filter(|doubtful| !doubtful.is_within(tolerance)) {
            lost[labels.of_row[self.users_row(doubtful.row)] as usize] = true;
        }
        self.far.iter().for_each(|&row| lost[labels.of_row[self.history.rows[row as usize] as usize] as usize] = true);
        lost
    }

    /// The number of dependent equations of each component.
    pub fn dependent_by(&self, labels: &Labels) -> Vec<u32> {
        let mut counts = vec![0; labels.count];
        self.dependent.iter().for_each(|d| counts[labels.of_row[d.row] as usize] += 1);
        counts
    }

    #[expect(clippy::too_many_arguments, reason = "every part of the analysis, once")]
    pub fn conclude(
        self,
        system: ConstraintSystem,
        numbering: Numbering,
        scaling: Scaling,
        rhs: Vec<f64>,
        options: Options,
        generated: Generated,
        confidence: Confidence,
        unmet_equations: Vec<usize>,
        backend: &dyn Backend,
    ) -> Analysis {
        let mut kinds = vec![Kind::Independent; self.history.exponents.len()];
        self.dependent.iter().for_each(|d| kinds[d.row] = d.kind);
        Analysis {
            identity: Identity::new(),
            system,
            kinds,
            confidence,
            dependent: self.dependent,
            generated: generated.values,
            unmet_equations,
            presolve: self.presolve,
            timings: Timings {
                presolve: self.presolved - self.started,
                factor: self.factored - self.presolved,
                classify: self.factored.elapsed(),
            },
            backend: (backend.name(), backend.version()),
            options,
            basis: self.basis,
            bounds: self.swept.bounds,
            blocks: self.blocks,
            history: self.history,
            scaling,
            rhs,
            numbering,
            fixed: generated.dofs,
            times: OnceLock::new(),
            solved: OnceLock::new(),
            ignored: Vec::new(),
        }
    }
}
