//! The stages of an analysis for one scaling, repeated until what presolve keeps is sound.

use std::sync::OnceLock;
use std::time::Instant;

use rayon::prelude::*;

use super::{Analysis, AnalysisError, PresolveStatistics, Timings};
use crate::basis::Basis;
use crate::block::{self, Block, Means, Solved};
use crate::certificate::History;
use crate::classify::{Dependent, Kind, classify};
use crate::components::hold_components;
use crate::confidence::Confidence;
use crate::generated::Generated;
use crate::local::{Column, Local, Numbering};
use crate::preferences::Wishes;
use crate::presolve::eliminate::{Eliminated, eliminate};
use crate::presolve::gather::gather;
use crate::presolve::peel::{Peeled, peel};
use crate::qr::{Backend, BackendError};
use crate::scale::Scaling;
use crate::sensitivity;
use crate::sweep::{SEED, Sweep, is_far, random_sides, sweep};
use crate::{ConstraintSystem, Options};

/// Stages, rows held back from presolve, and how sure their rank is.
pub type Settled = (Stages, Vec<bool>, Confidence);

/// What every run of the stages needs.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    pub local: Local<'a>,
    pub columns: &'a [Column],
    pub scaling: &'a Scaling,
    pub wishes: &'a Wishes,
    pub means: Means<'a>,
}

/// What the stages up to the blocks leave.
pub struct Stages {
    pub basis: Basis,
    pub blocks: Vec<Block>,
    pub history: History,
    pub dependent: Vec<Dependent>,
    /// Dependent rows, among those that went through elimination, of which much was made of others.
    far: Vec<u32>,
    /// What was found of the slaves and of their rows of T.
    pub swept: Sweep,
    presolve: PresolveStatistics,
    started: Instant,
    presolved: Instant,
    factored: Instant,
}

impl Run<'_> {
    /// The stages; what presolve should not have kept goes to the backend with all that is connected to it, once. With the
    /// rows held back from presolve.
    pub fn settle(
        &self,
        system: &ConstraintSystem,
        presolve: bool,
        started: Instant,
    ) -> Result<Settled, AnalysisError> {
        let mut held = vec![!presolve; self.local.equations()];
        let first = self.swept(&held, started)?;
        let doubtful = if presolve && self.means.check { first.doubtful_rows() } else { Vec::new() };
        if doubtful.is_empty() {
            let confidence = self.confidence(&first, false, system);
            return Ok((first, held, confidence));
        }
        hold_components(self.local, &doubtful, &mut held);
        let (stages, parted) = match self.swept(&held, started) {
            // Equations that were independent number by number are not quite dependent.
            Ok(second) => {
                let parted = first.kept_of(&held) > second.kept_of(&held);
                (second, parted)
            }
            // Too large for the backend: presolve's answer, in doubt.
            Err(AnalysisError::Backend(BackendError::OverLimit { .. } | BackendError::OutOfMemory { .. })) => {
                held.fill(false);
                (first, true)
            }
            Err(error) => return Err(error),
        };
        let confidence = self.confidence(&stages, parted, system);
        Ok((stages, held, confidence))
    }

    fn swept(&self, held: &[bool], started: Instant) -> Result<Stages, AnalysisError> {
        let mut stages = self.stages(held, started)?;
        stages.swept = sweep(self.local, &stages.basis, &stages.history, self.scaling, SEED);
        Ok(stages)
    }

    fn confidence(&self, stages: &Stages, parted: bool, system: &ConstraintSystem) -> Confidence {
        let Stages { basis, history, dependent, swept, .. } = stages;
        let worst = swept.worst.filter(|_| self.means.check);
        let sigma = sensitivity::sigma(worst, self.local, basis, history, self.scaling);
        Confidence::new(&basis.blocks, sigma, parted, dependent, system)
    }

    pub fn stages(&self, held: &[bool], started: Instant) -> Result<Stages, AnalysisError> {
        let Self { local, columns, scaling, wishes, means } = *self;
        let peeled = peel(local, columns, scaling, wishes, Some(held));
        let gathered = gather(local, &peeled.remaining, scaling).map_err(|row| AnalysisError::Range { row: row.0 })?;
        let eliminated = eliminate(gathered, means.tolerance, held);
        let presolved = Instant::now();
        let parts = eliminated.components(local.free());
        let random = if parts.is_empty() { Vec::new() } else { random_sides(&eliminated) };
        let gather = |rows: &Vec<u32>| Block::new(&eliminated.rows, rows, local.free(), &random);
        let blocks: Vec<Block> = parts.iter().map(gather).collect();
        // Blocks are independent: in parallel, in the caller's pool, the result in their order whatever the threads.
        let solve = |block: &Block| block::solve(block, means);
        let solved: Result<Vec<Solved>, _> = match blocks.as_slice() {
            few @ ([] | [_]) => few.iter().map(solve).collect(),
            many => many.par_iter().map(solve).collect(),
        };
        let solved = solved?;
        let factored = Instant::now();
        let presolve = statistics(&peeled, &eliminated, &blocks);
        let dependent = classify(&eliminated, &solved, scaling, means.tolerance);
        let far = eliminated.dead.iter().filter(|dead| is_far(dead.reach)).map(|dead| dead.row).collect();
        let steps = eliminated.steps.iter().map(|step| step.row).collect();
        let (rows, factors) = (eliminated.names, eliminated.factors);
        let history = History { rows, factors, steps, exponents: scaling.row.clone() };
        let mut basis = peeled.basis;
        basis.extend(eliminated.steps, solved, scaling);
        Ok(Stages {
            basis,
            blocks,
            history,
            dependent,
            far,
            swept: Sweep::default(),
            presolve,
            started,
            presolved,
            factored,
        })
    }
}

impl Stages {
    /// The user's rows on which presolve should not have decided.
    fn doubtful_rows(&self) -> Vec<usize> {
        let user = |&row: &u32| self.history.rows[row as usize] as usize;
        let first = self.basis.peeled.len();
        let kept = |&t: &usize| match self.basis.peeled.get(t) {
            Some(&row) => row as usize,
            None => user(&self.history.steps[t - first]),
        };
        self.swept.doubtful.iter().map(kept).chain(self.far.iter().map(user)).collect()
    }

    /// How many of the rows that are held in the end were found independent.
    fn kept_of(&self, held: &[bool]) -> usize {
        let dependent = self.dependent.iter().filter(|d| held[d.row]).count();
        held.iter().filter(|&&held| held).count() - dependent
    }

    #[expect(clippy::too_many_arguments, reason = "every part of the analysis, once")]
    pub fn conclude(
        self,
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
        }
    }
}

fn statistics(peeled: &Peeled, eliminated: &Eliminated, blocks: &[Block]) -> PresolveStatistics {
    PresolveStatistics {
        rows_removed_by_column_singletons: peeled.basis.peeled.len(),
        rows_removed_by_elimination: eliminated.steps.len(),
        rows_found_dependent: eliminated.dead.len(),
        core_rows: eliminated.core.len(),
        core_dofs: blocks.iter().map(|block| block.dofs.len()).sum(),
        blocks: blocks.len(),
        largest_block: blocks.iter().map(|block| block.rows.len()).max().unwrap_or(0),
    }
}
