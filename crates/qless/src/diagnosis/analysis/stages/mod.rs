//! The stages of an analysis for one scaling: peeling, elimination, blocks.

mod groups;
mod left;
mod settle;

use std::collections::HashSet;
use std::time::Instant;

use rayon::prelude::*;

use super::{AnalysisError, PresolveStatistics};
use crate::diagnosis::certificate::History;
use crate::diagnosis::classify::{Dependent, classify};
use crate::diagnosis::samples::{Keys, Sweep, is_far, random_sides};
use crate::factor::block::{self, Block, Means};
use crate::input::components::Labels;
use crate::input::numbering::{Column, Local};
use crate::input::preferences::Wishes;
use crate::input::scale::Scaling;
use crate::presolve::basis::{Basis, Diagnosed};
use crate::presolve::eliminate::eliminate;
use crate::presolve::eliminated::Eliminated;
use crate::presolve::gather::gather;
use crate::presolve::peel::{Peeled, peel};

use groups::groups;
pub use settle::Settled;

/// What every run of the stages needs.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    pub local: Local<'a>,
    pub columns: &'a [Column],
    pub scaling: &'a Scaling,
    pub wishes: &'a Wishes,
    /// Rows and DOFs of coefficients that are rounding.
    pub uncertain: &'a HashSet<(u32, u32)>,
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
    pub keys: Keys,
    /// What was found of the slaves and of their rows of T.
    pub swept: Sweep,
    presolve: PresolveStatistics,
    started: Instant,
    presolved: Instant,
    factored: Instant,
}

impl Run<'_> {
    pub fn stages(&self, held: &[bool], started: Instant) -> Result<Stages, AnalysisError> {
        let Self { local, columns, scaling, wishes, uncertain, means } = *self;
        let peeled = peel(local, columns, scaling, wishes, Some(held));
        let remaining = (0..local.equations() as u32).filter(|&i| peeled.remaining[i as usize]).collect();
        let part = |names: Vec<u32>| {
            gather(local, names, scaling, uncertain).map(|gathered| eliminate(gathered, means.tolerance, held))
        };
        let parts: Result<Vec<Eliminated>, _> = groups(local, remaining).into_par_iter().map(part).collect();
        let eliminated = Eliminated::join(parts.map_err(|row| AnalysisError::Range { row: row.0 })?);
        let presolved = Instant::now();
        let parts = eliminated.components(local.free());
        let keys = if parts.is_empty() { Keys::default() } else { Keys::within(&Labels::of(local), local) };
        let random = if parts.is_empty() { Vec::new() } else { random_sides(&eliminated, &keys) };
        let gather = |rows: &Vec<u32>| Block::new(&eliminated.rows, rows, local.free(), &random);
        let blocks: Vec<Block> = parts.iter().map(gather).collect();
        // Blocks are independent: in parallel, in the caller's pool, the result in their order whatever the threads.
        let diagnose = |block: &Block| block::diagnose(block, means);
        let diagnosed: Result<Vec<Diagnosed>, _> = match blocks.as_slice() {
            few @ ([] | [_]) => few.iter().map(diagnose).collect(),
            many => many.par_iter().map(diagnose).collect(),
        };
        let diagnosed = diagnosed?;
        let factored = Instant::now();
        let presolve = statistics(&peeled, &eliminated, &blocks);
        let dependent = classify(&eliminated, &diagnosed, scaling, means.tolerance);
        let far = eliminated.dead.iter().filter(|dead| is_far(dead.reach)).map(|dead| dead.row).collect();
        let steps = eliminated.steps.iter().map(|step| step.row).collect();
        let (rows, factors) = (eliminated.names, eliminated.factors);
        let history = History { rows, factors, steps, exponents: scaling.row.clone() };
        let mut basis = peeled.basis;
        let dofs = blocks.iter().map(|block| block.dofs.clone());
        basis.extend(eliminated.steps, dofs.zip(diagnosed), scaling);
        Ok(Stages {
            basis,
            blocks,
            history,
            dependent,
            far,
            keys,
            swept: Sweep::default(),
            presolve,
            started,
            presolved,
            factored,
        })
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
