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
mod rows;
mod wishes;

use std::collections::BTreeMap;

use crate::factor::qr::BackendError;
use crate::input::components::Labels;
use crate::input::numbering::Local;
use crate::input::preferences::{Preferences, Wishes};
use crate::input::scale::Scaling;
use crate::presolve::basis::Basis;
use crate::{ConstraintSystem, Csr};

pub use factored::{FactoredBlock, Parts};
pub(crate) use factored::{factor, predict::predict};

/// How T is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
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
    /// u_s, ascending.
    pub slaves: Vec<usize>,
    /// u_q, ascending.
    pub masters: Vec<usize>,
    /// u_p, ascending.
    pub prescribed: Vec<usize>,
    /// T, slaves x masters; rows of slaves of factored blocks are empty.
    pub t: Csr,
    /// G, slaves x prescribed DOFs; rows of slaves of factored blocks are empty.
    pub g_matrix: Csr,
    /// g, one number per slave.
    pub g: Vec<f64>,
    /// DOFs of [`crate::Preferences::masters`] that are slaves all the same, ascending: no choice avoids that.
    pub unmet_masters: Vec<usize>,
    /// DOFs of [`crate::Preferences::slaves`] that are not slaves, ascending: prescribed, in no equation, or at the cost of
    /// other such DOFs or of growth beyond the bound only.
    pub unmet_slaves: Vec<usize>,
    /// `max |T_ij|`; of factored blocks the largest entry that was found.
    pub growth: f64,
    /// How many times a slave and a master changed places to keep the growth down.
    pub exchanges: usize,
    /// Connected parts that stay factors: [`Form`].
    pub factored: Vec<FactoredBlock>,
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

impl Reduction {
    /// All DOFs from masters (length of `masters`) and prescribed values (length of `prescribed`).
    ///
    /// ```
    /// use qless::{Options, SystemBuilder, analyse};
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, -2.0)], 3.0);
    /// let system = builder.build()?;
    /// let reduction = analyse(&system, &Options::default())?.reduction(&system)?;
    /// let u = reduction.expand(&[0.5], &[]);
    /// assert!((u[0] - 2.0 * u[1] - 3.0).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn expand(&self, masters: &[f64], prescribed: &[f64]) -> Vec<f64> {
        let mut u = vec![0.0; self.slaves.len() + self.masters.len() + self.prescribed.len()];
        self.masters.iter().zip(masters).for_each(|(&j, &v)| u[j] = v);
        self.prescribed.iter().zip(prescribed).for_each(|(&j, &v)| u[j] = v);
        let (t, g) = (self.t.times(masters), self.g_matrix.times(prescribed));
        self.factored.iter().for_each(|block| block.set_slaves(&mut u));
        // Rows of factored blocks are empty: nothing is lost by adding them.
        self.slaves.iter().enumerate().for_each(|(i, &j)| u[j] += t[i] + g[i] + self.g[i]);
        u
    }

    /// Whether all of T is numbers.
    pub fn is_explicit(&self) -> bool {
        self.factored.is_empty()
    }

    /// `f_q = T^T f_s`: what forces on slaves are worth at the masters.
    pub fn apply_transposed(&self, slaves: &[f64]) -> Vec<f64> {
        let mut f = vec![0.0; self.slaves.len() + self.masters.len() + self.prescribed.len()];
        self.slaves.iter().zip(slaves).for_each(|(&j, &v)| f[j] = v);
        self.factored.iter().for_each(|block| block.pull_back(&mut f));
        let mut sum: Vec<f64> = self.masters.iter().map(|&j| f[j]).collect();
        for (i, &v) in slaves.iter().enumerate() {
            self.t.row(i).for_each(|(q, t)| sum[q] += t * v);
        }
        sum
    }

    /// Row i of T, ascending: how slave `slaves[i]` follows the masters.
    pub fn row(&self, i: usize) -> Vec<(usize, f64)> {
        let slave = self.slaves[i];
        let held = self.factored.iter().find_map(|block| Some((block, block.slaves.iter().position(|&j| j == slave)?)));
        match held {
            Some((block, k)) => block.row(k).into_iter().map(|(j, v)| (self.place_of_master(j), v)).collect(),
            None => self.t.row(i).collect(),
        }
    }

    /// Column q of T, ascending: how the slaves follow master `masters[q]`.
    pub fn column(&self, q: usize) -> Vec<(usize, f64)> {
        let entry = |i: usize| self.t.row(i).find(|&(j, _)| j == q).map(|(_, v)| (i, v));
        let mut column: Vec<(usize, f64)> = (0..self.slaves.len()).filter_map(entry).collect();
        let place = |j: usize| self.slaves.binary_search(&j).unwrap_or_default();
        for block in &self.factored {
            if let Ok(k) = block.masters.binary_search(&self.masters[q]) {
                let own = block.column_of(k).into_iter().zip(&block.slaves).filter(|(v, _)| *v != 0.0);
                column.extend(own.map(|(v, &j)| (place(j), v)));
            }
        }
        column.sort_unstable_by_key(|&(i, _)| i);
        column
    }

    fn place_of_master(&self, dof: usize) -> usize {
        self.masters.binary_search(&dof).unwrap_or_default()
    }
}
