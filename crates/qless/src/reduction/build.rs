//! Builds a reduction from a diagnosis, and decides which parts are explicit and which are factored.

use std::borrow::Cow;
use std::collections::HashMap;

use rayon::prelude::*;

use super::exchange_goals::{self, bound_growth, meet_preferences};
use super::factored::{factor, predict};
use super::relation::{self, ReductionInput};
use super::retry::{self, CheckRules, CheckedTerms};
use super::{FactoredBlock, Form, Reduction, ReductionError, block, output};
use crate::factor::backend::BackendError;
use crate::input::components::Labels;
use crate::input::numbering::LocalSystem;
use crate::input::preferences::{Preferences, SlavePreference, SlavePreferences};
use crate::input::scale::Scaling;
use crate::presolve::basis::{Basis, Solved};
use crate::{Analysis, ArgumentError, ConstraintSystem, Kind};

/// With [`Form::Auto`], a part is explicit if its rows of T have at most this many times the nonzeros of its equations, or of its
/// factors.
const MULTIPLE: usize = 4;
/// With [`Form::Auto`], a part is also explicit if its rows of T have at most this many nonzeros.
const FEW: usize = 1 << 12;

impl Analysis {
    /// `u_s = T u_q + G u_p + g` with all rows of T explicit: [`Analysis::reduction_in`].
    ///
    /// # Errors
    /// [`ReductionError`].
    pub fn reduction(&self) -> Result<Reduction, ReductionError> {
        self.reduction_in(Form::Explicit)
    }

    /// Computes `u_s = T u_q + G u_p + g` with T in this form.
    ///
    /// Conflicting equations are left out like redundant ones; the caller decides whether that is acceptable.
    ///
    /// ```
    /// use qless::{Form, Options, SystemBuilder, analyse};
    /// // A chain: T has about as many nonzeros as the equations, so it is explicit.
    /// let mut builder = SystemBuilder::new(4);
    /// (0..3).for_each(|i| {
    ///     builder.equation([(i, 1.0), (i + 1, -1.0)], 0.0);
    /// });
    /// let system = builder.build()?;
    /// let reduction = analyse(&system, &Options::default())?.reduction_in(Form::Auto)?;
    /// assert!(reduction.is_explicit());
    /// let factored = analyse(&system, &Options::default())?.reduction_in(Form::Factored)?;
    /// assert_eq!(factored.expand(&[2.0], &[])?, reduction.expand(&[2.0], &[])?);
    /// assert_eq!(factored.apply_transposed(&[1.0, 1.0, 1.0])?, [3.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ReductionError`] if [`Analysis::residual`] would be above 1e-10, if an entry would exceed the range of doubles, or if a block
    /// cannot be factored again. So every reduction that is returned meets the independent equations.
    pub fn reduction_in(&self, form: Form) -> Result<Reduction, ReductionError> {
        let local = self.local();
        if form == Form::Explicit {
            let basis = self.solved()?;
            let bounds = self.bounds_of(local, basis);
            return self.built(local, &self.input(basis, &bounds), Vec::new());
        }
        let labels = Labels::of(local);
        let mut as_numbers = vec![false; labels.count];
        loop {
            let parts = self.factored(local, &labels, (form, &as_numbers), &self.input(&self.basis, &self.bounds))?;
            let blocks: Vec<FactoredBlock> = parts.into_iter().flatten().collect();
            if blocks.is_empty() {
                return self.reduction_in(Form::Explicit);
            }
            let basis = self.rest(local, &labels, &blocks)?;
            let bounds = basis.bounds(local);
            let held: HashMap<usize, usize> =
                blocks.iter().flat_map(|block| block.slaves.iter().map(|&j| (j, block.equations[0]))).collect();
            let failed = match self.built(local, &self.input(&basis, &bounds), blocks) {
                Err(ReductionError::Residual { row, residual }) => {
                    let label = labels.of_row[row];
                    let is_held = held.values().any(|&first| labels.of_row[first] == label);
                    is_held.then_some(row).ok_or(ReductionError::Residual { row, residual })?
                }
                Err(ReductionError::NotFinite { dof }) => {
                    held.get(&dof).copied().ok_or(ReductionError::NotFinite { dof })?
                }
                done => return done,
            };
            // An explicit T of this part may be accurate enough, because its slaves are chosen in another way.
            as_numbers[labels.of_row[failed] as usize] = true;
        }
    }

    /// The relative residual of the independent equations, separately for T u_q, G u_p and g with random u_q and u_p:
    /// `max_i |C_i u - b_i| / (|C_i D| 1 max_j(s_j / d_j) + |b_i|)`. Here s_j is the sum of the magnitudes of the terms of u_j, and D =
    /// diag(d_j) is the scaling of columns (the identity unless units mix). 1 is the vector of ones, and j runs over the free DOFs of the
    /// part of equation i; prescribed DOFs count by their terms in the equation. A residual stays relative to the terms of its own equation
    /// if that is at most 1e-13. For g, so does the residual of each equation with `b_i != 0`:
    /// `|C_i g - b_i| / (sum_j |C_ij g_j| + |b_i|)`.
    ///
    /// The residual is about 1e-16 times the condition of the kept equations, `1 / confidence.distance`. Computing it takes one pass over C
    /// and T.
    ///
    /// # Errors
    /// [`ArgumentError`] if the reduction has other DOFs. It may have been computed elsewhere ([`Reduction::from_parts`]).
    pub fn residual(&self, reduction: &Reduction) -> Result<f64, ArgumentError> {
        reduction.fits(&self.system)?;
        let local = self.local();
        let [matrices, constants] = self.rules(&self.independent()).residuals(local, reduction, CheckedTerms::All);
        Ok(matrices.worse(constants).worst)
    }

    /// How reductions of this analysis are checked.
    pub(crate) fn rules<'a>(&'a self, independent: &'a [bool]) -> CheckRules<'a> {
        CheckRules { independent, scaling: &self.scaling, memory: self.options.memory }
    }

    fn input<'a>(&'a self, basis: &'a Basis, bounds: &'a [f64]) -> ReductionInput<'a> {
        let mut fixed = vec![false; if self.fixed.is_empty() { 0 } else { self.numbering.dofs.len() }];
        self.fixed.iter().for_each(|&j| fixed[j as usize] = true);
        ReductionInput {
            basis,
            bounds,
            fixed,
            preferences: SlavePreferences::new(&self.options.preferences, &self.numbering, self.system.dofs()),
            growth: self.options.growth,
            scaling: &self.scaling,
            independent: self.independent(),
            memory: self.options.memory,
        }
    }

    fn built(
        &self,
        local: LocalSystem,
        input: &ReductionInput,
        blocks: Vec<FactoredBlock>,
    ) -> Result<Reduction, ReductionError> {
        let reduction = build(&self.system, local, input, blocks)?;
        Ok(Reduction { of: self.identity, ..reduction.compare(&self.options.preferences) })
    }

    fn bounds_of(&self, local: LocalSystem, basis: &Basis) -> Cow<'_, [f64]> {
        if basis.blocks.is_empty() { Cow::Borrowed(&self.bounds) } else { Cow::Owned(basis.bounds(local)) }
    }

    /// The basis of the analysis, extended by the rows of all blocks.
    pub(crate) fn solved(&self) -> Result<&Basis, BackendError> {
        if self.basis.blocks.is_empty() {
            return Ok(&self.basis);
        }
        if let Some(basis) = self.solved.get() {
            return Ok(basis);
        }
        let solved = self.solve_blocks(|_| true)?;
        let basis = self.basis.with_blocks(&solved, &self.scaling);
        Ok(self.solved.get_or_init(|| basis))
    }

    fn solve_blocks(&self, which: impl Fn(usize) -> bool + Sync) -> Result<Vec<Solved>, BackendError> {
        let wanted: Vec<usize> = (0..self.blocks.len()).filter(|&k| which(k)).collect();
        let solve = |&k: &usize| block::solve(&self.blocks[k], &self.basis.blocks[k], self.options.memory);
        wanted.par_iter().map(solve).collect()
    }

    /// The user's equation of row t of the basis of the diagnosis.
    fn row_of(&self, t: usize) -> usize {
        let first = self.basis.peeled.len();
        match self.basis.peeled.get(t) {
            Some(&row) => row as usize,
            None => self.history.rows[self.history.steps[t - first] as usize] as usize,
        }
    }

    fn row_of_block(&self, k: usize) -> usize {
        self.history.rows[self.blocks[k].rows[0] as usize] as usize
    }

    /// For each part (by its label), its factored form; None if the part is explicit.
    fn factored(
        &self,
        local: LocalSystem,
        labels: &Labels,
        (form, as_numbers): (Form, &[bool]),
        input: &ReductionInput,
    ) -> Result<Vec<Option<FactoredBlock>>, BackendError> {
        let predicted = predict(local, &self.basis, labels, |t| self.row_of(t), |k| self.row_of_block(k));
        let has_preferences = Self::has_preferences(local, labels, &input.preferences);
        let is_wanted = |label: usize| {
            let part = predicted[label];
            let large = part.predicted > (MULTIPLE * part.given).max(FEW);
            part.needs_work && !has_preferences[label] && !as_numbers[label] && (large || form == Form::Factored)
        };
        let mut equations = vec![Vec::new(); labels.count];
        for (i, &label) in labels.of_row.iter().enumerate() {
            if is_wanted(label as usize) && self.kinds[i] == Kind::Independent {
                equations[label as usize].push(i);
            }
        }
        let factor_part = |(label, equations): (usize, &Vec<usize>)| {
            if equations.is_empty() {
                return Ok(None);
            }
            let block = factor(local, equations, input, predicted[label].predicted)?;
            Ok(block.filter(|block| form == Form::Factored || block.predicted > (MULTIPLE * block.nnz()).max(FEW)))
        };
        equations.par_iter().enumerate().map(factor_part).collect()
    }

    /// The parts with preferred DOFs; these are explicit, because exchanges of slaves need explicit rows.
    fn has_preferences(local: LocalSystem, labels: &Labels, preferences: &SlavePreferences) -> Vec<bool> {
        let mut has_preferences = vec![false; labels.count];
        if preferences.any() {
            for (i, &label) in labels.of_row.iter().enumerate() {
                has_preferences[label as usize] |=
                    local.parts(i).0.iter().any(|&j| preferences.of(j) != SlavePreference::None);
            }
        }
        has_preferences
    }

    /// The basis of the explicit parts, with empty rows for the slaves of factored parts.
    fn rest(&self, local: LocalSystem, labels: &Labels, blocks: &[FactoredBlock]) -> Result<Basis, BackendError> {
        let mut is_factored = vec![false; labels.count];
        blocks.iter().for_each(|block| is_factored[labels.of_row[block.equations[0]] as usize] = true);
        let is_number = |row: usize| !is_factored[labels.of_row[row] as usize];
        let block = |k: usize| is_number(self.row_of_block(k));
        let solved = self.solve_blocks(block)?;
        let mut basis = self.basis.only(|t| is_number(self.row_of(t)), block).with_blocks(&solved, &self.scaling);
        let mut constants = HashMap::new();
        blocks.iter().for_each(|block| constants.extend(block.slaves.iter().copied().zip(block.constants())));
        for (&j, l) in local.numbering.dofs.iter().zip(0..) {
            constants.get(&(j as usize)).into_iter().for_each(|&constant| basis.close(l, constant));
        }
        Ok(basis)
    }
}

/// Builds T, G and g, exchanges slaves and masters to meet the preferences and the bound of `max |T_ij|`, and checks the residuals. In the
/// units of a user who mixes them, slaves with a small T can be as good as dependent; then T of their part is bounded in scaled units.
fn build(
    system: &ConstraintSystem,
    local: LocalSystem,
    input: &ReductionInput,
    factored: Vec<FactoredBlock>,
) -> Result<Reduction, ReductionError> {
    if input.scaling.col.is_empty() {
        return build_in(None, system, local, input, factored);
    }
    let labels = Labels::of(local);
    let mut units = Scaling::none(0);
    let mut is_scaled = vec![false; labels.count];
    loop {
        let own = Some(&units).filter(|units| !units.col.is_empty());
        match build_in(own, system, local, input, factored.clone()) {
            Err(ReductionError::Residual { row, .. }) if !is_scaled[labels.of_row[row] as usize] => {
                is_scaled[labels.of_row[row] as usize] = true;
                units.col.resize(local.dofs(), 0);
                for i in (0..local.equations()).filter(|&i| labels.of_row[i] == labels.of_row[row]) {
                    local.parts(i).0.iter().for_each(|&j| units.col[j as usize] = input.scaling.col(j as usize));
                }
            }
            built => return built,
        }
    }
}

fn build_in(
    units: Option<&Scaling>,
    system: &ConstraintSystem,
    local: LocalSystem,
    input: &ReductionInput,
    factored: Vec<FactoredBlock>,
) -> Result<Reduction, ReductionError> {
    let limit = input.growth.max(exchange_goals::LEAST);
    let mut relation = relation::assemble(local, input, limit, units);
    let exchanged = meet_preferences(&mut relation, &input.preferences, limit);
    let exchanges = bound_growth(&mut relation, limit, &input.preferences, exchanged);
    let reduction = output::write(system, &relation);
    let own = if units.is_some() { retry::largest_entry(&reduction.t) } else { relation.growth };
    let growth = factored.iter().map(|block| block.growth).fold(own, f64::max);
    let mut reduction = Reduction { growth, exchanges, factored, ..reduction };
    retry::checked(&mut reduction, local, CheckedTerms::All, &input.rules()).map(|()| reduction)
}

impl Reduction {
    /// Lists the preferences that the slaves do not satisfy.
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
