//! One block as a matrix, and what its factorization needs from the caller.

use crate::Csr;
use crate::factor::backend::Backend;
use crate::factor::backend::dense_or_sparse::DenseOrSparse;
use crate::input::scale::{exponent, ldexp};
use crate::presolve::eliminated::Mismatch;
use crate::presolve::rows::{Entry, WorkingRow};

/// One block as a matrix: m rows over the free DOFs `dofs`, with what stands on the other side.
pub(crate) struct Block {
    /// Indices of the rows among those that went through presolve.
    pub rows: Vec<u32>,
    /// Power of two that brings each row back to size 1.
    pub exponents: Vec<i32>,
    /// Free DOFs of the block, ascending; the columns of `matrix`.
    pub dofs: Vec<u32>,
    pub matrix: Csr,
    /// Prescribed DOFs of the block, ascending; the columns of `fixed`.
    pub prescribed: Vec<u32>,
    pub fixed: Csr,
    pub rhs: Vec<f64>,
    /// `b - C_p u_p`, scaled as the rows.
    pub effective: Vec<Mismatch>,
    /// The largest coefficient of each row that is more than its own rounding.
    pub certain: Vec<f64>,
    /// A random right-hand side, after presolve.
    pub random: Vec<f64>,
}

/// What the stages of a block share.
#[derive(Clone, Copy)]
pub(crate) struct FactorContext<'a> {
    pub backend: &'a dyn Backend,
    pub tolerance: f64,
    /// As in [`crate::Options`].
    pub check: bool,
    /// What finds singular values where the backend does not.
    pub reference: DenseOrSparse,
}

impl<'a> FactorContext<'a> {
    /// `memory` bounds the bytes of a block.
    pub fn new(backend: &'a dyn Backend, tolerance: f64, check: bool, memory: usize) -> Self {
        Self { backend, tolerance, check, reference: DenseOrSparse::new(memory) }
    }

    /// A backend that finds singular values.
    pub fn orthogonal(&self) -> &dyn Backend {
        if self.backend.is_orthogonal() { self.backend } else { &self.reference }
    }

    /// Bytes for the sparse factors of a block.
    pub fn memory(&self) -> usize {
        self.reference.memory
    }
}

impl Block {
    /// Some rows of the matrix.
    pub fn select(&self, rows: &[usize]) -> Csr {
        let mut selected = Csr::empty(self.matrix.cols);
        rows.iter().for_each(|&i| selected.append(self.matrix.row(i)));
        selected
    }

    /// Gathers the given rows, scaled unless the tolerance is absolute; `random` has a number for every row.
    pub fn new(rows: &[WorkingRow], block: &[u32], is_free: &[bool], random: &[f64], is_scaled: bool) -> Self {
        let all = || block.iter().flat_map(|&i| rows[i as usize].entries.iter().map(|entry| entry.dof));
        let sorted = |free: bool| {
            let mut dofs: Vec<u32> = all().filter(|&j| is_free[j as usize] == free).collect();
            dofs.sort_unstable();
            dofs.dedup();
            dofs
        };
        let (dofs, prescribed) = (sorted(true), sorted(false));
        let mut gathered = Self {
            rows: block.to_vec(),
            exponents: Vec::new(),
            matrix: Csr::empty(dofs.len()),
            fixed: Csr::empty(prescribed.len()),
            dofs,
            prescribed,
            rhs: Vec::new(),
            effective: Vec::new(),
            certain: Vec::new(),
            random: Vec::new(),
        };
        block.iter().for_each(|&i| gathered.push(&rows[i as usize], random[i as usize], is_scaled));
        gathered
    }

    fn push(&mut self, row: &WorkingRow, random: f64, is_scaled: bool) {
        let shift = if is_scaled { -exponent(row.size.max(f64::MIN_POSITIVE)) } else { 0 };
        let part = |dofs: &[u32]| {
            let place = |entry: &Entry| Some((dofs.binary_search(&entry.dof).ok()?, ldexp(entry.value, shift)));
            let found = row.entries.iter().filter_map(place);
            let mut entries: Vec<_> = found.collect();
            entries.sort_unstable_by_key(|&(j, _)| j);
            entries
        };
        self.matrix.append(part(&self.dofs));
        self.fixed.append(part(&self.prescribed));
        self.rhs.push(ldexp(row.rhs, shift));
        self.effective.push(Mismatch::of_row(row).scaled(shift));
        let free = row.entries.iter().filter(|entry| self.dofs.binary_search(&entry.dof).is_ok());
        let certain =
            free.filter(|entry| entry.is_certain()).map(|entry| entry.value.abs()).fold(row.dropped, f64::max);
        self.certain.push(ldexp(certain, shift));
        self.random.push(ldexp(random, shift));
        self.exponents.push(shift);
    }
}
