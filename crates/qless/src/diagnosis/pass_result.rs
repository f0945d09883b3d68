//! The result of one run of the stages, by row and by component, and its conversion to an [`Analysis`].

use std::collections::BTreeSet;
use std::sync::OnceLock;
use std::time::Instant;

use super::certificate::History;
use super::classify::{Dependent, Kind};
use super::confidence::Confidence;
use super::distance::KeptRows;
use super::generated::Generated;
use super::nullspace_probe::{NullspaceProbe, RandomKeys};
use super::{Analysis, PresolveStatistics, Timings};
use crate::common::identity::Identity;
use crate::factor::backend::Backend;
use crate::factor::block::Block;
use crate::factor::block::triangle::Triangle;
use crate::input::components::{Labels, components};
use crate::input::numbering::{LocalSystem, Numbering};
use crate::input::scale::Scaling;
use crate::presolve::basis::Basis;
use crate::presolve::eliminated::Eliminated;
use crate::presolve::peel::Peeled;
use crate::{ConstraintSystem, Options};

/// The result of one run of the stages.
pub struct PassResult {
    pub basis: Basis,
    pub blocks: Vec<Block>,
    /// Factors of the kept rows of the blocks.
    pub triangles: Vec<Triangle>,
    pub history: History,
    pub dependent: Vec<Dependent>,
    /// Rows that elimination found dependent after it had added large multiples of other rows.
    pub far_dependent: Vec<u32>,
    pub keys: RandomKeys,
    /// Estimates for the slaves and their rows of T.
    pub probe: NullspaceProbe,
    /// The fixed DOFs, ascending by the user's numbers.
    pub fixed: Vec<u32>,
    /// A solution of the kept equations by DOF, if some DOFs may be fixed.
    pub particular: Vec<f64>,
    /// One equation of each core of kept equations, and the distance of the core from dependence.
    pub distances: Vec<(u32, f64)>,
    pub presolve: PresolveStatistics,
    pub started: Instant,
    pub presolved: Instant,
    pub factored: Instant,
}

pub fn statistics(peeled: &Peeled, eliminated: &Eliminated, blocks: &[Block]) -> PresolveStatistics {
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

impl PassResult {
    /// The kept equations with their factors.
    pub fn kept<'a>(&'a self, system: LocalSystem<'a>, scaling: &'a Scaling) -> KeptRows<'a> {
        let Self { basis, history, blocks, triangles, .. } = self;
        KeptRows { system, basis, history, scaling, blocks, triangles }
    }

    /// The user's rows that presolve kept but that are not reliable ([`NullspaceProbe::doubtful`]).
    pub fn steep_rows(&self) -> impl Iterator<Item = usize> {
        self.probe.doubtful.iter().map(|&t| self.users_row(t))
    }

    /// The user's rows that presolve kept but whose slaves have too few digits left ([`NullspaceProbe::lost`]).
    pub fn lost_rows(&self) -> impl Iterator<Item = usize> {
        self.probe.lost.iter().map(|&t| self.users_row(t))
    }

    /// The user's rows that presolve dropped after it had added large multiples of other rows.
    pub fn far_rows(&self) -> impl Iterator<Item = usize> {
        self.far_dependent.iter().map(|&row| self.history.rows[row as usize] as usize)
    }

    /// The user's equation that became row t of the basis, which is peeled or eliminated.
    pub fn users_row(&self, t: usize) -> usize {
        let first = self.basis.peeled.len();
        match self.basis.peeled.get(t) {
            Some(&row) => row as usize,
            None => self.history.rows[self.history.steps[t - first] as usize] as usize,
        }
    }

    /// For each component, the numbers of dependent and of conflicting equations.
    pub fn counts_by_component(&self, labels: &Labels) -> Vec<(u32, u32)> {
        let mut counts = vec![(0, 0); labels.count];
        for d in &self.dependent {
            let (all, conflicting) = &mut counts[labels.of_row[d.row] as usize];
            *all += 1;
            *conflicting += u32::from(d.kind == Kind::Conflicting);
        }
        counts
    }

    #[expect(clippy::too_many_arguments, reason = "each argument becomes one field")]
    pub fn into_analysis(
        self,
        system: ConstraintSystem,
        numbering: Numbering,
        scaling: Scaling,
        options: Options,
        generated: Generated,
        confidence: Confidence,
        backend: &dyn Backend,
    ) -> Analysis {
        let mut kinds = vec![Kind::Independent; self.history.exponents.len()];
        self.dependent.iter().for_each(|d| kinds[d.row] = d.kind);
        let wanted: BTreeSet<usize> = options.preferences.equations.iter().copied().collect();
        let unmet_equations = wanted.into_iter().filter(|&row| kinds[row] != Kind::Independent).collect();
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
            bounds: self.probe.bounds,
            blocks: self.blocks,
            history: self.history,
            scaling,
            numbering,
            fixed: generated.dofs,
            times: OnceLock::new(),
            incidence: OnceLock::new(),
            labels: OnceLock::new(),
            distances: self.distances,
            distance_of_label: OnceLock::new(),
            solved: OnceLock::new(),
            noise: Vec::new(),
            other: None,
            exact: None,
            proof: None,
        }
    }
}

/// Least number of rows for which another thread is used.
const ROWS_PER_GROUP: usize = 1 << 14;
/// Largest number of groups; each group visits all DOFs once.
const MOST_GROUPS: usize = 16;

/// Splits rows into groups of whole components, one thread each. Groups share no free DOF.
pub fn groups(local: LocalSystem, rows: Vec<u32>) -> Vec<Vec<u32>> {
    let count = (rows.len() / ROWS_PER_GROUP).min(MOST_GROUPS);
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
    // Rows of a group ascend, as they would without groups.
    groups.iter_mut().for_each(|group| group.sort_unstable());
    groups
}
