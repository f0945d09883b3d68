//! One block as a matrix, and the context of its factorization.

use rayon::prelude::*;

use crate::Csr;
use crate::factor::backend::Backend;
use crate::factor::backend::dense_or_sparse::DenseOrSparse;
use crate::input::scale::{Component, RANGE, exponent, ldexp};
use crate::presolve::eliminated::Mismatch;
use crate::presolve::rows::{Entry, WorkingRow};

/// One block as a matrix: m rows over the free DOFs `dofs`, with right-hand sides and prescribed terms.
#[derive(Clone)]
pub(crate) struct Block {
    /// The rows, numbered as in `Eliminated::rows`.
    pub rows: Vec<u32>,
    /// For each row, the exponent of the power of two by which the block scales the row.
    pub exponents: Vec<i32>,
    /// Free DOFs of the block, ascending; the columns of `matrix`.
    pub dofs: Vec<u32>,
    /// For each DOF, the exponent of its unit in `matrix`: that of its balanced unit until the kept rows are known, then 0.
    pub units: Vec<i32>,
    /// For each DOF, the exponent of its balanced unit relative to the unit that `matrix` uses. It is 0 until [`Block::restore_units`]
    /// takes the balanced units out of `matrix`.
    pub balanced: Vec<i32>,
    pub matrix: Csr,
    /// Prescribed DOFs of the block, ascending; the columns of `fixed`.
    pub prescribed: Vec<u32>,
    pub fixed: Csr,
    pub rhs: Vec<f64>,
    /// `b - C_p u_p` (b minus the prescribed terms), scaled as the rows: first for this block, then for each other block with the same
    /// matrix that is diagnosed with it.
    pub effective: Vec<Vec<Mismatch>>,
    /// For each row, the largest [`Entry::certain_left`] of its free DOFs: the fraction of a coefficient's largest term that certainly
    /// remains after cancellation. Coefficients that presolve dropped count too.
    pub certain: Vec<f64>,
    /// For each row, the largest relative error of a coefficient of its free DOFs; cancellation in presolve raises it above rounding.
    pub errors: Vec<f64>,
    /// A random right-hand side, to which presolve was applied as to the rows; for each block as in `effective`.
    pub random: Vec<Vec<f64>>,
}

/// Data that all stages of a block use.
#[derive(Clone, Copy)]
pub(crate) struct FactorContext<'a> {
    pub backend: &'a dyn Backend,
    pub tolerance: f64,
    /// True if the rank is checked.
    pub check: bool,
    /// True if the unit of no number matters: unless the tolerance is absolute, or errors are stated in the user's units.
    pub is_scaled: bool,
    /// The backend that computes singular values if `backend` is not orthogonal.
    pub reference: DenseOrSparse,
}

impl<'a> FactorContext<'a> {
    /// `memory` bounds the bytes that [`FactorContext::reference`] may allocate for a block.
    pub fn new(backend: &'a dyn Backend, tolerance: f64, check: bool, memory: usize) -> Self {
        Self { backend, tolerance, check, is_scaled: true, reference: DenseOrSparse::new(memory) }
    }

    /// A backend whose triangular factor has the singular values of the block.
    pub fn orthogonal(&self) -> &dyn Backend {
        if self.backend.is_orthogonal() { self.backend } else { &self.reference }
    }
}

impl Block {
    /// The matrix of the selected rows.
    pub fn select(&self, rows: &[usize]) -> Csr {
        let mut selected = Csr::empty(self.matrix.cols);
        rows.iter().for_each(|&i| selected.append(self.matrix.row(i)));
        selected
    }

    /// Gathers blocks of the given rows, scaled and in balanced units unless the tolerance is absolute. A free DOF is in one block at most.
    /// [`Block::set_random`] must follow.
    pub fn gather(rows: &[WorkingRow], blocks: &[Vec<u32>], is_free: &[bool], is_scaled: bool) -> Vec<Self> {
        let mut place = vec![u32::MAX; is_free.len()];
        let of_block = |block: &Vec<u32>| numbered(rows, block, is_free, &mut place);
        let dofs: Vec<Vec<u32>> = blocks.iter().map(of_block).collect();
        let given = Given { rows, place: &place, is_scaled };
        blocks.par_iter().zip(dofs).map(|(block, dofs)| Self::of(given, block, dofs)).collect()
    }

    fn of(given: Given, block: &[u32], dofs: Vec<u32>) -> Self {
        let Given { rows, place, is_scaled } = given;
        let all = block.iter().flat_map(|&i| rows[i as usize].entries.iter().map(|entry| entry.dof));
        let mut prescribed: Vec<u32> = all.filter(|&j| place[j as usize] == u32::MAX).collect();
        prescribed.sort_unstable();
        prescribed.dedup();
        let mut gathered = Self {
            rows: block.to_vec(),
            exponents: Vec::new(),
            matrix: Csr::empty(dofs.len()),
            fixed: Csr::empty(prescribed.len()),
            balanced: vec![0; dofs.len()],
            units: if is_scaled { balanced_units(rows, block, place, dofs.len()) } else { vec![0; dofs.len()] },
            dofs,
            prescribed,
            rhs: Vec::new(),
            effective: vec![Vec::new()],
            certain: Vec::new(),
            errors: Vec::new(),
            random: Vec::new(),
        };
        block.iter().for_each(|&i| gathered.push(&rows[i as usize], place, is_scaled));
        gathered
    }

    fn push(&mut self, row: &WorkingRow, place: &[u32], is_scaled: bool) {
        let free =
            || row.entries.iter().map(|entry| (place[entry.dof as usize], entry)).filter(|&(j, _)| j != u32::MAX);
        let free = || free().map(|(j, entry)| (j as usize, entry));
        // A row without free coefficients is not scaled.
        let largest = free().map(|(j, entry)| ldexp(entry.size(), self.units[j])).reduce(f64::max);
        let shift = if is_scaled { largest.map_or(0, |largest| -exponent(largest)) } else { 0 };
        let sorted = |mut entries: Vec<(usize, f64)>| {
            entries.sort_unstable_by_key(|&(j, _)| j);
            entries
        };
        let entries = sorted(free().map(|(j, entry)| (j, ldexp(entry.value, shift + self.units[j]))).collect());
        let certain = free().map(|(_, entry)| entry.certain_left()).fold(row.dropped, f64::max);
        let error = free().map(|(_, entry)| entry.error() / entry.value.abs()).fold(0.0, f64::max);
        let fixed = |entry: &Entry| Some((self.prescribed.binary_search(&entry.dof).ok()?, ldexp(entry.value, shift)));
        self.fixed.append(sorted(row.entries.iter().filter_map(fixed).collect()));
        self.matrix.append(entries);
        self.rhs.push(ldexp(row.rhs, shift));
        self.effective[0].push(Mismatch::of_row(row).scaled(shift));
        self.certain.push(certain);
        self.errors.push(error);
        self.exponents.push(shift);
    }

    /// Sets the random right-hand side from numbers for all rows.
    pub fn set_random(&mut self, random: &[f64]) {
        let scaled = |(&i, &exponent): (&u32, &i32)| ldexp(random[i as usize], exponent);
        self.random = vec![self.rows.iter().zip(&self.exponents).map(scaled).collect()];
    }

    /// Returns from balanced units to those of the rows. Slaves are chosen, and reductions computed, in these units.
    pub fn restore_units(&mut self) {
        if self.units.iter().all(|&unit| unit == 0) {
            return;
        }
        self.balanced.clone_from(&self.units);
        self.set_units(vec![0; self.units.len()]);
    }

    /// Takes the matrix to balanced units that are near those of its rows; false if it is in these units already.
    pub fn balance(&mut self) -> bool {
        let terms = |i: u32| self.matrix.row(i as usize).filter(|&(_, v)| v != 0.0);
        let count = self.dofs.len();
        let component = Component::gather((0..self.rows.len() as u32).collect(), terms, &mut vec![0; count]);
        let mut units = vec![0; count];
        component.dofs.iter().zip(component.near_units()).for_each(|(&j, unit)| units[j as usize] = unit);
        let is_new = units.iter().any(|&unit| unit != 0);
        if is_new {
            self.set_units(units);
        }
        is_new
    }

    /// Takes the matrix to other units of the DOFs. The largest coefficient of each row keeps its exponent, which is small in a row that
    /// presolve left by cancellation.
    pub fn set_units(&mut self, units: Vec<i32>) {
        let power = |values: &[f64]| {
            let largest = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            if largest > 0.0 { exponent(largest) } else { 0 }
        };
        for i in 0..self.matrix.rows() {
            let range = self.matrix.start[i]..self.matrix.start[i + 1];
            let (dofs, values) = (&self.matrix.col[range.clone()], &mut self.matrix.val[range]);
            let before = power(values);
            values.iter_mut().zip(dofs).for_each(|(v, &j)| *v = ldexp(*v, units[j as usize] - self.units[j as usize]));
            let shift = before - power(values);
            values.iter_mut().for_each(|v| *v = ldexp(*v, shift));
            let range = self.fixed.start[i]..self.fixed.start[i + 1];
            self.fixed.val[range].iter_mut().for_each(|v| *v = ldexp(*v, shift));
            self.rhs[i] = ldexp(self.rhs[i], shift);
            self.effective.iter_mut().for_each(|sides| sides[i] = sides[i].scaled(shift));
            self.random.iter_mut().for_each(|sides| sides[i] = ldexp(sides[i], shift));
            self.exponents[i] += shift;
        }
        self.units = units;
    }

    /// The exponent of the power of two that scales a row to a largest coefficient of about 1 in balanced units.
    pub fn balanced_row(&self, i: usize) -> i32 {
        let powers = self.matrix.row(i).filter(|&(_, v)| v != 0.0).map(|(j, v)| exponent(v) + self.balanced[j]);
        -powers.max().unwrap_or(0)
    }
}

/// Input of [`Block::gather`].
#[derive(Clone, Copy)]
struct Given<'a> {
    rows: &'a [WorkingRow],
    /// For each DOF, its column in its block; `u32::MAX` for a DOF in no block, such as a prescribed one.
    place: &'a [u32],
    is_scaled: bool,
}

/// The free DOFs of a block, ascending; writes the column of each to `place`.
fn numbered(rows: &[WorkingRow], block: &[u32], is_free: &[bool], place: &mut [u32]) -> Vec<u32> {
    let mut dofs = Vec::new();
    for entry in block.iter().flat_map(|&i| &rows[i as usize].entries) {
        let j = entry.dof as usize;
        if is_free[j] && place[j] == u32::MAX {
            place[j] = 0;
            dofs.push(entry.dof);
        }
    }
    dofs.sort_unstable();
    dofs.iter().zip(0..).for_each(|(&j, at)| place[j as usize] = at);
    dofs
}

/// Exponents of the balanced units of the DOFs of a block.
fn balanced_units(rows: &[WorkingRow], block: &[u32], place: &[u32], count: usize) -> Vec<i32> {
    let terms = |i: u32| {
        let certain = rows[i as usize].entries.iter().filter(|entry| entry.is_certain());
        let placed = certain.map(|entry| (place[entry.dof as usize] as usize, entry.value));
        placed.filter(|&(j, _)| j < count)
    };
    let component = Component::gather(block.to_vec(), terms, &mut vec![0; count]);
    let mut units = vec![0; count];
    // If balanced numbers might leave the range of doubles, the user's units are kept.
    if let Some(found) = component.units().filter(|found| found.iter().all(|unit| unit.abs() < RANGE)) {
        component.dofs.iter().zip(found).for_each(|(&j, unit)| units[j as usize] = unit);
    }
    units
}
