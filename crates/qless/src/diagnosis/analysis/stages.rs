//! The stages of an analysis for one scaling, repeated until what presolve keeps is sound.

use std::collections::HashSet;
use std::sync::OnceLock;
use std::time::Instant;

use rayon::prelude::*;

use super::{Analysis, AnalysisError, PresolveStatistics, Timings};
use crate::common::identity::Identity;
use crate::diagnosis::certificate::History;
use crate::diagnosis::classify::{Dependent, Kind, classify};
use crate::diagnosis::confidence::{self, Confidence};
use crate::diagnosis::generated::Generated;
use crate::diagnosis::samples::{Inverse, Keys, Sample, Sweep, is_far, random_sides, sweep};
use crate::diagnosis::sensitivity;
use crate::factor::block::{self, Block, Means};
use crate::factor::qr::{Backend, BackendError};
use crate::input::components::{Labels, components};
use crate::input::numbering::{Column, Local, Numbering};
use crate::input::preferences::Wishes;
use crate::input::scale::Scaling;
use crate::presolve::basis::Basis;
use crate::presolve::basis::Diagnosed;
use crate::presolve::eliminate::eliminate;
use crate::presolve::eliminated::Eliminated;
use crate::presolve::gather::gather;
use crate::presolve::peel::{Peeled, peel};
use crate::{ConstraintSystem, Options};

/// Stages that presolve's doubts have been taken from.
pub struct Settled {
    pub stages: Stages,
    /// Rows held back from presolve.
    pub held: Vec<bool>,
    pub confidence: Confidence,
    /// Equations of the components whose rank or verdict is in doubt.
    pub doubted: Vec<usize>,
}

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

/// Fewer rows than this are not worth a thread of their own.
const WORTH_A_GROUP: usize = 1 << 14;
/// Most groups: each looks at all DOFs once.
const MOST_GROUPS: usize = 16;

/// Rows in groups that share no free DOF, for threads of their own: whole components, in order.
fn groups(local: Local, rows: Vec<u32>) -> Vec<Vec<u32>> {
    let count = (rows.len() / WORTH_A_GROUP).min(MOST_GROUPS);
    if count < 2 {
        return vec![rows];
    }
    let free = |i: u32| local.parts(i as usize).0.iter().copied().filter(|&j| local.free()[j as usize]);
    let each = rows.len().div_ceil(count);
    let mut groups: Vec<Vec<u32>> = vec![Vec::new()];
    for part in components(&rows, local.dofs(), free) {
        if groups.last().is_some_and(|group| group.len() >= each) {
            groups.push(Vec::new());
        }
        groups.last_mut().into_iter().for_each(|group| group.extend(&part));
    }
    // Rows of a group are taken in their own order, whatever their components.
    groups.iter_mut().for_each(|group| group.sort_unstable());
    groups
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

impl Stages {
    /// The user's rows on which presolve should not have decided.
    fn doubtful_rows(&self) -> Vec<usize> {
        let kept = self.swept.doubtful.iter().map(|doubtful| self.users_row(doubtful.row));
        kept.chain(self.far.iter().map(|&row| self.history.rows[row as usize] as usize)).collect()
    }

    /// The user's row of row t of the basis, peeled or eliminated.
    fn users_row(&self, t: usize) -> usize {
        let first = self.basis.peeled.len();
        match self.basis.peeled.get(t) {
            Some(&row) => row as usize,
            None => self.history.rows[self.history.steps[t - first] as usize] as usize,
        }
    }

    /// By component, whether presolve lost digits there, or kept what is nearer to dependence than the tolerance.
    fn lost_by(&self, labels: &Labels, tolerance: f64) -> Vec<bool> {
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
