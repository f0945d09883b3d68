//! From a diagnosis to a reduction: which parts become numbers and which stay factors.

use std::borrow::Cow;
use std::collections::HashMap;

use rayon::prelude::*;

use super::block;
use crate::Analysis;
use crate::factor::backend::BackendError;
use crate::input::components::Labels;
use crate::input::numbering::Local;
use crate::input::preferences::{Wish, Wishes};
use crate::presolve::basis::Basis;
use crate::reduction::{self, Basics, FactoredBlock, Form, Reduction, ReductionError, factor, gate, predict};
use crate::{ArgumentError, Kind};

/// T is numbers where it has at most this many times the nonzeros of its equations, or of its factors, ...
const MULTIPLE: usize = 4;
/// ... or so few that nobody minds.
const FEW: usize = 1 << 12;

impl Analysis {
    /// `u_s = T u_q + G u_p + g`, all of T as numbers: [`Analysis::reduction_in`].
    ///
    /// # Errors
    /// [`ReductionError`].
    pub fn reduction(&self) -> Result<Reduction, ReductionError> {
        self.reduction_in(Form::Explicit)
    }

    /// `u_s = T u_q + G u_p + g`.
    ///
    /// Conflicting equations are left out, as redundant ones are: the caller decides whether that is wanted.
    ///
    /// ```
    /// use qless::{Form, Options, SystemBuilder, analyse};
    /// // A chain: its T has as many nonzeros as its equations, and stays numbers.
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
    /// [`ReductionError`] where [`Analysis::residual`] would be above 1e-10, or a number beyond the range of doubles: what is
    /// returned meets the independent equations.
    pub fn reduction_in(&self, form: Form) -> Result<Reduction, ReductionError> {
        let local = self.numbering.view(&self.system, &self.rhs);
        if form == Form::Explicit {
            let basis = self.solved()?;
            let bounds = self.bounds_of(local, basis);
            return self.built(local, &self.basics(basis, &bounds), Vec::new());
        }
        let labels = Labels::of(local);
        let mut as_numbers = vec![false; labels.count];
        loop {
            let parts = self.factored(local, &labels, (form, &as_numbers), &self.basics(&self.basis, &self.bounds))?;
            let blocks: Vec<FactoredBlock> = parts.into_iter().flatten().collect();
            if blocks.is_empty() {
                return self.reduction_in(Form::Explicit);
            }
            let basis = self.rest(local, &labels, &blocks)?;
            let bounds = basis.bounds(local);
            let held: HashMap<usize, usize> =
                blocks.iter().flat_map(|block| block.slaves.iter().map(|&j| (j, block.equations[0]))).collect();
            let failed = match self.built(local, &self.basics(&basis, &bounds), blocks) {
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
            // What factors cannot do numbers may, for this part alone: there slaves are chosen in another way.
            as_numbers[labels.of_row[failed] as usize] = true;
        }
    }

    /// How well a reduction meets the independent equations: for random u_q and u_p, the parts T, G and g each on their own,
    /// `max_i |C_i u - b_i| / (|C_i D| 1 max_j(s_j / d_j) + |b_i|)`, where s_j is the sum of the sizes of the parts that make
    /// u_j, D the scaling of columns (1 unless units mix) and j runs over the DOFs connected with equation i.
    ///
    /// About 1e-16 times the condition of the kept equations, `1 / confidence.sigma_kept`. One pass over C and T.
    ///
    /// # Errors
    /// [`ArgumentError`] if it is a reduction of other DOFs; of the same DOFs it may be anybody's ([`Reduction::from_parts`]).
    pub fn residual(&self, reduction: &Reduction) -> Result<f64, ArgumentError> {
        reduction.fits(&self.system)?;
        let local = self.numbering.view(&self.system, &self.rhs);
        Ok(gate::residuals(local, reduction, &self.independent(), &self.scaling, f64::INFINITY).worst)
    }

    fn basics<'a>(&'a self, basis: &'a Basis, bounds: &'a [f64]) -> Basics<'a> {
        let mut fixed = vec![false; if self.fixed.is_empty() { 0 } else { self.numbering.dofs.len() }];
        self.fixed.iter().for_each(|&j| fixed[j as usize] = true);
        Basics {
            basis,
            bounds,
            fixed,
            wishes: Wishes::new(&self.options.preferences, &self.numbering, self.system.dofs()),
            growth: self.options.growth,
            scaling: &self.scaling,
            independent: self.independent(),
            memory: self.options.memory,
        }
    }

    fn built(&self, local: Local, basics: &Basics, blocks: Vec<FactoredBlock>) -> Result<Reduction, ReductionError> {
        let reduction = reduction::build(&self.system, local, basics, blocks)?;
        Ok(Reduction { of: self.identity, ..reduction.compare(&self.options.preferences) })
    }

    fn bounds_of(&self, local: Local, basis: &Basis) -> Cow<'_, [f64]> {
        if basis.blocks.is_empty() { Cow::Borrowed(&self.bounds) } else { Cow::Owned(basis.bounds(local)) }
    }

    /// The basis with the rows of all blocks.
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

    fn solve_blocks(
        &self,
        which: impl Fn(usize) -> bool + Sync,
    ) -> Result<Vec<crate::presolve::basis::Solved>, BackendError> {
        let wanted: Vec<usize> = (0..self.blocks.len()).filter(|&k| which(k)).collect();
        let solve = |&k: &usize| block::solve(&self.blocks[k], &self.basis.blocks[k], self.options.memory);
        wanted.par_iter().map(solve).collect()
    }

    /// The user's equation of row t of a diagnosis' basis.
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

    /// The parts that stay factors, by label.
    fn factored(
        &self,
        local: Local,
        labels: &Labels,
        (form, as_numbers): (Form, &[bool]),
        basics: &Basics,
    ) -> Result<Vec<Option<FactoredBlock>>, BackendError> {
        let predicted = predict(local, &self.basis, labels, |t| self.row_of(t), |k| self.row_of_block(k));
        let wished = Self::wished(local, labels, &basics.wishes);
        let is_wanted = |label: usize| {
            let part = predicted[label];
            let large = part.predicted > (MULTIPLE * part.given).max(FEW);
            part.needs_work && !wished[label] && !as_numbers[label] && (large || form == Form::Factored)
        };
        let mut equations = vec![Vec::new(); labels.count];
        for (i, &label) in labels.of_row.iter().enumerate() {
            if is_wanted(label as usize) && self.kinds[i] == Kind::Independent {
                equations[label as usize].push(i);
            }
        }
        let make = |(label, equations): (usize, &Vec<usize>)| {
            if equations.is_empty() {
                return Ok(None);
            }
            let block = factor(local, equations, basics, predicted[label].predicted)?;
            Ok(block.filter(|block| form == Form::Factored || block.predicted > (MULTIPLE * block.nnz()).max(FEW)))
        };
        equations.par_iter().enumerate().map(|(label, rows)| make((label, rows))).collect()
    }

    /// Parts in which the user has a say: there slaves are chosen by exchanges on numbers.
    fn wished(local: Local, labels: &Labels, wishes: &Wishes) -> Vec<bool> {
        let mut wished = vec![false; labels.count];
        if wishes.any() {
            for (i, &label) in labels.of_row.iter().enumerate() {
                wished[label as usize] |= local.parts(i).0.iter().any(|&j| wishes.of(j) != Wish::None);
            }
        }
        wished
    }

    /// The basis of the parts that become numbers, with empty rows for the slaves of the others.
    fn rest(&self, local: Local, labels: &Labels, blocks: &[FactoredBlock]) -> Result<Basis, BackendError> {
        let mut is_factored = vec![false; labels.count];
        blocks.iter().for_each(|block| is_factored[labels.of_row[block.equations[0]] as usize] = true);
        let is_number = |row: usize| !is_factored[labels.of_row[row] as usize];
        let block = |k: usize| is_number(self.row_of_block(k));
        let solved = self.solve_blocks(block)?;
        let mut basis = self.basis.only(|t| is_number(self.row_of(t)), block).with_blocks(&solved, &self.scaling);
        let mut constants = HashMap::new();
        blocks.iter().for_each(|block| constants.extend(block.slaves.iter().copied().zip(block.constants())));
        for (&j, l) in local.numbering.dofs.iter().zip(0..) {
            constants.get(&(j as usize)).into_iter().for_each(|&constant| basis.place(l, constant));
        }
        Ok(basis)
    }
}
