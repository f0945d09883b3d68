//! What presolve leaves, block by block: which rows depend on which, then which DOFs are slaves (Eq. 21-26).
//!
//! First `C^T` is factored: its dependent columns are the dependent equations, and `R1 y = R2_k` is their certificate.
//! Then C with the independent rows only: `u_s = -R1^-1 R2 u_q - R1^-1 Q^T C_p u_p + R1^-1 Q^T b`. Heath-style rank
//! detection errs far less often on `C^T` (tall) than on C, and the second factorization knows its rank.
//! Blocks of more than 2^20 numbers choose well-conditioned slaves first and find T by seminormal equations.

pub(crate) mod dependent;
pub(crate) mod large;
pub(crate) mod pick;
mod refine;
mod slaves;
pub(crate) mod split;
mod tableau;

use crate::Csr;
use crate::presolve::eliminate::Mismatch;
use crate::presolve::rows::{Entry, Row};
use crate::qr::{Backend, BackendError};
use crate::scale::{exponent, ldexp};

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
}

/// A dependent row of a block.
#[derive(Clone, Debug)]
pub(crate) struct Dependent {
    pub row: u32,
    /// `row = sum y_i row_i` over kept rows of the block (indices as in [`Block::rows`]).
    pub because: Vec<(u32, f64)>,
    /// What was left of the row, relative to its size.
    pub dropped: f64,
    /// `b - C_p u_p` minus the same of its certificate.
    pub mismatch: Mismatch,
}

/// The block solved: its dependent rows and `u_s = relation (u_q, u_p) + constant`.
#[derive(Clone, Debug)]
pub(crate) struct Solved {
    pub kept: Vec<u32>,
    pub dependent: Vec<Dependent>,
    pub slaves: Vec<u32>,
    /// Columns of `relation`: masters, then prescribed DOFs.
    pub others: Vec<u32>,
    pub relation: Csr,
    pub constant: Vec<f64>,
    /// Estimate of the smallest singular value of the kept rows.
    pub sigma: f64,
}

/// Solves one block; `check` as in [`crate::Options`].
pub(crate) fn solve(block: &Block, backend: &dyn Backend, tolerance: f64, check: bool) -> Result<Solved, BackendError> {
    let rows = dependent::find(block, backend, tolerance, check)?;
    slaves::choose(block, rows, backend, tolerance)
}

impl Block {
    /// Gathers the given rows.
    pub fn new(rows: &[Row], block: &[u32], is_free: &[bool]) -> Self {
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
        };
        block.iter().for_each(|&i| gathered.push(&rows[i as usize]));
        gathered
    }

    fn push(&mut self, row: &Row) {
        let shift = -exponent(row.size.max(f64::MIN_POSITIVE));
        let part = |dofs: &[u32]| {
            let place = |entry: &Entry| Some((dofs.binary_search(&entry.dof).ok()?, ldexp(entry.value, shift)));
            let found = row.entries.iter().filter_map(place);
            let mut entries: Vec<_> = found.collect();
            entries.sort_unstable_by_key(|&(j, _)| j);
            entries
        };
        self.matrix.push_row(part(&self.dofs));
        self.fixed.push_row(part(&self.prescribed));
        self.rhs.push(ldexp(row.rhs, shift));
        self.effective.push(Mismatch::of(row).scaled(shift));
        self.exponents.push(shift);
    }
}
