//! The stages of an analysis for one scaling, repeated until what presolve keeps is sound.

use std::sync::OnceLock;
use std::time::Instant;

use rayon::prelude::*;

use super::{Analysis, AnalysisError, PresolveStatistics, Timings};
use crate::basis::Basis;
use crate::block::{self, Block, Solved};
use crate::certificate::History;
use crate::classify::{Dependent, Kind, classify};
use crate::confidence::Confidence;
use crate::generated::Generated;
use crate::hold::hold_component;
use crate::local::{Column, Local, Numbering};
use crate::preferences::Wishes;
use crate::presolve::eliminate::{Eliminated, eliminate};
use crate::presolve::gather::gather;
use crate::presolve::peel::{Peeled, peel};
use crate::qr::Backend;
use crate::scale::Scaling;
use crate::sensitivity;
use crate::sweep::{Sweep, sweep};
use crate::{ConstraintSystem, Options};

/// Of the random masters that tell which DOFs are fixed.
pub const SEED: u64 = 0x9e37_79b9;

/// Stages, rows held back from presolve, and how sure their rank is.
pub type Settled = (Stages, Vec<bool>, Confidence);

/// What every run of the stages needs.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    pub local: Local<'a>,
    pub columns: &'a [Column],
    pub scaling: &'a Scaling,
    pub wishes: &'a Wishes,
    pub backend: &'a dyn Backend,
    pub tolerance: f64,
    pub check: bool,
}

/// What the stages up to the blocks leave.
pub struct Stages {
    pub basis: Basis,
    pub blocks: Vec<Block>,
    pub history: History,
    pub dependent: Vec<Dependent>,
    /// What was found of the slaves and of their rows of T.
    pub swept: Sweep,
    presolve: PresolveStatistics,
    started: Instant,
    presolved: Instant,
    factored: Instant,
}

impl Run<'_> {
    /// The stages, repeated with rows held back from presolve until what it keeps is sound; with the rows held back.
    pub fn settle(
        &self,
        system: &ConstraintSystem,
        presolve: bool,
        started: Instant,
    ) -> Result<Settled, AnalysisError> {
        let Self { local, scaling, tolerance, .. } = *self;
        let mut held = vec![!presolve; local.equations()];
        let mut doubt = None;
        loop {
            let mut stages = self.stages(&held, started)?;
            stages.swept = sweep(local, &stages.basis, &stages.history, scaling, SEED);
            let worst = stages.swept.worst.filter(|_| self.check);
            let near = sensitivity::largest(worst, local, &stages.basis, &stages.history, scaling);
            doubt = near.map(|n| n.1).into_iter().chain(doubt).reduce(f64::max);
            // What presolve kept is dependent to within the tolerance: the backend decides.
            match near.filter(|&(_, entry)| entry * tolerance > 1.0) {
                Some((slave, _)) if hold_component(local, slave, &mut held) => {}
                _ => {
                    let confidence = Confidence::new(&stages.basis.blocks, doubt, &stages.dependent, system);
                    return Ok((stages, held, confidence));
                }
            }
        }
    }

    pub fn stages(&self, held: &[bool], started: Instant) -> Result<Stages, AnalysisError> {
        let Self { local, columns, scaling, wishes, backend, tolerance, check } = *self;
        let peeled = peel(local, columns, scaling, wishes, Some(held));
        let gathered = gather(local, &peeled.remaining, scaling).map_err(|row| AnalysisError::Range { row: row.0 })?;
        let eliminated = eliminate(gathered, tolerance, held);
        let presolved = Instant::now();
        let parts = block::split::split(&eliminated.rows, &eliminated.core, local.free());
        let blocks: Vec<Block> = parts.iter().map(|rows| Block::new(&eliminated.rows, rows, local.free())).collect();
        // Blocks are independent: in parallel, in the caller's pool, the result in their order whatever the threads.
        let solve = |block: &Block| block::solve(block, backend, tolerance, check);
        let solved: Result<Vec<Solved>, _> = match blocks.as_slice() {
            few @ ([] | [_]) => few.iter().map(solve).collect(),
            many => many.par_iter().map(solve).collect(),
        };
        let solved = solved?;
        let factored = Instant::now();
        let presolve = statistics(&peeled, &eliminated, &blocks);
        let dependent = classify(&eliminated, &solved, scaling, tolerance);
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
            swept: Sweep::default(),
            presolve,
            started,
            presolved,
            factored,
        })
    }
}

impl Stages {
    #[expect(clippy::too_many_arguments, reason = "every part of the analysis, once")]
    pub fn conclude(
        self,
        numbering: Numbering,
        scaling: Scaling,
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
