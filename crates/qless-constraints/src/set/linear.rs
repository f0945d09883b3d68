//! All linear equations, `c = G u - b`; G is written once.

use std::sync::Arc;

use qless::{Csr, SystemError};

use super::batch::{Batch, ROWS};
use super::labels::Owner;
use super::lists::Lists;
use super::time::{Function, Rhs};

/// Linear equations, whatever types they come from.
#[derive(Default)]
pub(super) struct Rows {
    owners: Vec<Owner>,
    nnz: usize,
    /// Where each row ends among the terms; like these, of no use when the set is built.
    end: Vec<usize>,
    terms: Vec<(u32, f64)>,
    rhs: Vec<f64>,
    /// Rows whose right-hand sides are functions of time.
    driven: Vec<(u32, Function)>,
    batches: Vec<Batch>,
    lists: Vec<f64>,
}

impl Rows {
    pub fn push(&mut self, owner: Owner, terms: &[(u32, f64)], rhs: &Rhs) {
        if let Rhs::Function(function) = rhs {
            self.driven.push((self.owners.len() as u32, Arc::clone(function)));
        }
        self.terms.extend_from_slice(terms);
        self.end.push(self.terms.len());
        self.rhs.push(rhs.at(0.0));
        self.owners.push(owner);
        self.nnz = self.terms.len();
    }

    pub fn rows(&self) -> usize {
        self.owners.len()
    }

    pub fn nnz(&self) -> usize {
        self.nnz
    }

    pub fn owner(&self, row: usize) -> &Owner {
        &self.owners[row]
    }

    /// Moves the terms to the end of `g`, which has no rows yet, and into batches.
    pub fn write_pattern(&mut self, g: &mut Csr) -> Result<(), SystemError> {
        let mut equations = Vec::with_capacity(self.rows());
        let mut first = 0;
        for (&end, &rhs) in self.end.iter().zip(&self.rhs) {
            equations.push((&self.terms[first..end], rhs));
            g.push_row(self.terms[first..end].iter().map(|&(j, v)| (j as usize, v)))?;
            first = end;
        }
        let mut lists = Lists::default();
        self.batches = equations.chunks(ROWS).map(|equations| Batch::new(equations, &mut lists)).collect();
        self.lists = lists.numbers();
        (self.end, self.terms, self.rhs) = (Vec::new(), Vec::new(), Vec::new());
        Ok(())
    }

    /// Rows with their right-hand sides in time.
    pub fn driven(&self) -> impl Iterator<Item = (usize, &Function)> {
        self.driven.iter().map(|(row, function)| (*row as usize, function))
    }

    pub fn set_rhs(&mut self, row: usize, rhs: f64) {
        self.batches[row / ROWS].rhs[row % ROWS] = rhs;
    }

    /// Number of batches; each has [`ROWS`] equations, the last one what is left.
    pub fn batches(&self) -> usize {
        self.batches.len()
    }

    /// A DOF of one batch.
    pub fn first_dof(&self, batch: usize) -> u32 {
        self.batches[batch].first_dof()
    }

    /// `c = G u - b` of one batch.
    pub fn evaluate(&self, batch: usize, u: &[f64], c: &mut [f64]) {
        self.batches[batch].evaluate(&self.lists, u, c);
    }
}
