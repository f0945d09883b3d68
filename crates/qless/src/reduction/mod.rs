//! `u_s = T u_q + G u_p + g` (Eq. 23-26): slaves by masters, prescribed DOFs and a constant.

mod again;
pub(crate) mod block;
mod exchange;
mod factored;
pub(crate) mod gate;
mod growth;
mod of_analysis;
mod order;
mod output;
mod parts;
mod rows;
mod using;
mod wishes;

use std::collections::BTreeMap;

use crate::common::identity::Identity;
use crate::factor::backend::BackendError;
use crate::input::components::Labels;
use crate::input::numbering::Local;
use crate::input::preferences::{Preferences, Wishes};
use crate::input::scale::Scaling;
use crate::presolve::basis::Basis;
use crate::{ConstraintSystem, Csr};

pub use factored::{FactoredBlock, Parts};
pub(crate) use factored::{factor, predict::predict};

/// How T is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Form {
    /// All of it as numbers.
    #[default]
    Explicit,
    /// Connected parts whose rows are more than single equations solved for a DOF stay factors.
    Factored,
    /// Parts stay factors if T would have more than 4 times the nonzeros of their equations and of their factors, and more than 4,096.
    Auto,
}

/// Why there is no reduction: none that is wrong leaves the library.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReductionError {
    /// T, G and g do not meet an equation.
    #[error(
        "row {row}: the reduced form leaves {residual:.1e} of the equation where 1e-10 is allowed; the equations are too nearly \
         dependent to be solved for slaves: see their confidence, and rescale or leave out what is nearly said twice"
    )]
    Residual {
        /// The equation that is met worst, 0-based.
        row: usize,
        /// Its residual, relative to the parts of its component.
        residual: f64,
    },
    /// A number of T, G or g beyond the range of doubles.
    #[error("DOF {dof}: the equations give it a value beyond 1e308; rescale them")]
    NotFinite {
        /// The slave, 0-based.
        dof: usize,
    },
    /// A block could not be factored again.
    #[error(transparent)]
    Backend(BackendError),
}

/// The reduced form of a constraint system.
///
/// `C u = b` holds for every `u_q`, and for every `u_p` for which the redundant equations are consistent.
/// DOFs are 0-based; `masters` are all free DOFs that are not slaves, those outside all equations included.
#[derive(Clone, Debug, Default)]
pub struct Reduction {
    /// The analysis that made it.
    pub(crate) of: Identity,
    pub(crate) slaves: Vec<usize>,
    pub(crate) masters: Vec<usize>,
    pub(crate) prescribed: Vec<usize>,
    pub(crate) t: Csr,
    pub(crate) g_matrix: Csr,
    pub(crate) g: Vec<f64>,
    pub(crate) unmet_masters: Vec<usize>,
    pub(crate) unmet_slaves: Vec<usize>,
    pub(crate) growth: f64,
    pub(crate) exchanges: usize,
    pub(crate) factored: Vec<FactoredBlock>,
}

/// What [`build`] needs to know of an analysis.
pub(crate) struct Basics<'a> {
    pub basis: &'a Basis,
    /// Bounds of the rows of T, infinite where slaves are to be replaced.
    pub bounds: &'a [f64],
    /// Local DOFs that move with no master; empty if there are none.
    pub fixed: Vec<bool>,
    pub wishes: Wishes,
    /// The bound of growth.
    pub growth: f64,
    pub scaling: &'a Scaling,
    /// By equation.
    pub independent: Vec<bool>,
    /// Bytes for sparse factors.
    pub memory: usize,
}

/// A residual above this is worth computing T again from the user's equations.
const LOSS: f64 = 1e-13;

/// Builds T, G and g; exchanges slaves and masters until the wishes are met and `max |T_ij|` is below the bound. What leaves has
/// passed the gate.
pub(crate) fn build(
    system: &ConstraintSystem,
    local: Local,
    basics: &Basics,
    factored: Vec<FactoredBlock>,
) -> Result<Reduction, ReductionError> {
    let limit = basics.growth.max(growth::LEAST);
    let mut relation = rows::assemble(local, basics, limit);
    let exchanged = wishes::meet(&mut relation, &basics.wishes, limit);
    let exchanges = growth::bound(&mut relation, limit, &basics.wishes, exchanged);
    let reduction = output::write(system, &relation);
    let growth = factored.iter().map(|block| block.growth).fold(relation.growth, f64::max);
    checked(Reduction { growth, exchanges, factored, ..reduction }, local, basics)
}

/// The reduction, computed again component by component where it has lost digits and that brings some back, if it passes the gate.
fn checked(mut reduction: Reduction, local: Local, basics: &Basics) -> Result<Reduction, ReductionError> {
    let Basics { scaling, ref independent, memory, .. } = *basics;
    let residuals = |reduction: &Reduction| gate::residuals(local, reduction, independent, scaling, LOSS);
    let found = residuals(&reduction);
    if found.above.is_empty() {
        return Ok(reduction);
    }
    let labels = Labels::of(local);
    let before = worst_by_part(&found, &labels);
    let is_factored = |label: u32| reduction.factored.iter().any(|block| labels.of_row[block.equations[0]] == label);
    let wanted: Vec<u32> = before.keys().copied().filter(|&label| !is_factored(label)).collect();
    let mut rows = again::compute(local, &reduction, (independent, &labels), scaling, &wanted, memory);
    let mut tried = reduction.clone();
    again::replace(&mut tried, &rows);
    let after = worst_by_part(&residuals(&tried), &labels);
    drop(tried);
    // What has become no better stays as it was, whatever the others have become.
    let part = part_of_slaves(local, &reduction, &labels);
    rows.iter_mut()
        .zip(&part)
        .filter(|(_, label)| after.get(label) >= before.get(label))
        .for_each(|(row, _)| *row = None);
    if rows.iter().any(Option::is_some) {
        again::replace(&mut reduction, &rows);
        let growth = reduction.t.val.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        reduction.growth = reduction.factored.iter().map(|block| block.growth).fold(growth, f64::max);
    }
    gate::pass(&residuals(&reduction), &reduction).map(|()| reduction)
}

/// The largest residual of each connected part that has one above what was asked for.
fn worst_by_part(found: &gate::Found, labels: &Labels) -> BTreeMap<u32, f64> {
    let mut worst = BTreeMap::new();
    for &(row, residual) in &found.above {
        let most: &mut f64 = worst.entry(labels.of_row[row]).or_default();
        *most = most.max(residual);
    }
    worst
}

/// The connected part of each slave.
fn part_of_slaves(local: Local, reduction: &Reduction, labels: &Labels) -> Vec<u32> {
    let mut part = vec![0; reduction.slaves.len() + reduction.masters.len() + reduction.prescribed.len()];
    for (i, &label) in labels.of_row.iter().enumerate() {
        let free = local.row(i).filter(|&(j, _)| local.free()[j]);
        free.for_each(|(j, _)| part[local.numbering.dofs[j] as usize] = label);
    }
    reduction.slaves.iter().map(|&j| part[j]).collect()
}

impl Reduction {
    /// Compares the slaves with what was wanted.
    pub(crate) fn compare(mut self, preferences: &Preferences) -> Self {
        let listed = |numbers: &[usize], unmet: &dyn Fn(usize) -> bool| {
            let mut all: Vec<usize> = numbers.iter().copied().filter(|&j| unmet(j)).collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        let is_slave = |j: usize| self.slaves.binary_search(&j).is_ok();
        let masters = listed(&preferences.masters, &is_slave);
        self.unmet_slaves = listed(&preferences.slaves, &|j| !is_slave(j));
        self.unmet_masters = masters;
        self
    }
}
