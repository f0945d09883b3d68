//! One call of SuiteSparseQR's C interface: its input, its results, and the release of its memory.
#![allow(unsafe_code, reason = "the one module that calls spqr-sys")]

use std::collections::TryReserveError;
use std::ops::Range;
use std::ptr::{from_mut, null_mut};

use rayon::prelude::*;
use spqr_sys::memory::Common;
use spqr_sys::{cholmod_dense, cholmod_sparse};

use super::{Statistics, TallRhs, all_finite, error_of, failed, is_trapezoidal};
use crate::Csr;
use crate::factor::backend::{BackendError, Factor};

/// The memory that C allocates for one factorization; freed on drop, whether the call succeeded or not.
pub(super) struct Call {
    pub common: Common,
    z: *mut cholmod_dense,
    r: *mut cholmod_sparse,
    order: *mut i64,
    order_length: usize,
}

impl Call {
    /// Starts CHOLMOD; None if memory is exhausted.
    pub fn start(order_length: usize) -> Option<Self> {
        let common = Common::start()?;
        Some(Self { common, z: null_mut(), r: null_mut(), order: null_mut(), order_length })
    }

    /// Returns the rank, or CHOLMOD's status if the call failed. The column order is always requested: without it SPQR 2.1 frees a
    /// rank-deficient R twice.
    pub fn run(&mut self, columns: &Csr, b: TallRhs, tolerance: f64) -> Result<usize, i32> {
        let no_memory = |_| spqr_sys::CHOLMOD_OUT_OF_MEMORY;
        let starts = columns.start.iter().map(|&entry| entry as i64);
        let mut start = collected(columns.start.len(), starts).map_err(no_memory)?;
        let mut index =
            collected(columns.col.len(), columns.col.iter().map(|&row| i64::from(row))).map_err(no_memory)?;
        let mut a = sparse_view(columns, &mut start, &mut index);
        let mut dense = dense_view(b);
        let (b_in, z_out) =
            if b.count == 0 { (null_mut(), null_mut()) } else { (from_mut(&mut dense), &raw mut self.z) };
        // With econ = m, the number of rows of A, every row of `Q^T B` is kept. The additional rows of R are empty, so this costs nothing.
        let econ = b.rows as i64;
        // SAFETY: the views outlive the call, which only reads them. Outputs are null or owned by `self`. A dense Z is
        // requested exactly if B is not empty. H, HPinv and HTau may be null.
        let rank = unsafe {
            spqr_sys::SuiteSparseQR_C(
                spqr_sys::SPQR_ORDERING_DEFAULT,
                tolerance,
                econ,
                0,
                &raw mut a,
                null_mut(),
                b_in,
                null_mut(),
                z_out,
                &raw mut self.r,
                &raw mut self.order,
                null_mut(),
                null_mut(),
                null_mut(),
                self.common.as_mut_ptr(),
            )
        };
        if let Some(status) = self.common.failure() {
            return Err(status);
        }
        let complete = !self.r.is_null() && self.z.is_null() == z_out.is_null();
        let accepted = self.common.status() >= spqr_sys::CHOLMOD_OK && complete;
        usize::try_from(rank).ok().filter(|_| accepted).ok_or(self.common.status())
    }

    /// Copies the results, on this number of threads of the caller's pool.
    pub fn read(&self, rank: usize, columns: &Csr, b: TallRhs, threads: usize) -> Result<Factor, BackendError> {
        let (m, n) = (columns.cols, columns.rows());
        let in_columns = self.r(n);
        // Below this size, waking threads takes longer than the copy.
        let threads = if in_columns.row.len() < 1 << 18 { 1 } else { threads };
        let no_memory = |_| error_of(spqr_sys::CHOLMOD_OUT_OF_MEMORY, m, n);
        let r = in_columns.by_rows(rank, threads).map_err(no_memory)?;
        if !is_trapezoidal(&r) {
            return Err(failed("SuiteSparseQR returned an R that is not [R1 R2]".into()));
        }
        let z = self.transformed(b.count);
        if !all_finite(&r.val) || !all_finite(z.values) {
            return Err(failed(format!("the {m} x {n} block overflows: scale it")));
        }
        let dropped = without_last_bits(self.common.dropped());
        let order = self.order(n).map_err(no_memory)?;
        let (rhs, rest) = (z.head(rank).map_err(no_memory)?, z.rest(rank).map_err(no_memory)?);
        Ok(Factor { rank, order, r, rhs, rest, dropped })
    }

    pub fn statistics(&self) -> Statistics {
        let [analysis, factorization] = self.common.times();
        Statistics {
            tasks: self.common.tasks().max(1) as usize,
            memory: self.common.memory_usage(),
            analysis,
            factorization,
            total: 0.0,
        }
    }

    /// The column permutation P. SPQR returns the column order of `[A B]`, with B last, or a null pointer for the identity.
    fn order(&self, n: usize) -> Result<Vec<usize>, TryReserveError> {
        if self.order.is_null() {
            return collected(n, 0..n);
        }
        // SAFETY: SPQR wrote `order_length` >= n entries.
        collected(n, unsafe { slice(self.order, n) }.iter().map(|&j| j as usize))
    }

    fn r(&self, n: usize) -> InColumns<'_> {
        // SAFETY: after `run`, R is packed and real with 64-bit indices: n + 1 starts, the last of which is the number of entries.
        unsafe {
            let r = &*self.r;
            let start = slice(r.p.cast::<i64>(), n + 1);
            let count = start[n] as usize;
            InColumns { start, row: slice(r.i.cast::<i64>(), count), value: slice(r.x.cast::<f64>(), count) }
        }
    }

    /// The transformed right-hand sides `Q^T B`, m x k.
    fn transformed(&self, count: usize) -> TallRhs<'_> {
        if count == 0 {
            return TallRhs { rows: 0, count, values: &[] };
        }
        // SAFETY: after `run`, Z is dense and real with `d` = `nrow`, as CHOLMOD allocates it.
        let (rows, values) = unsafe { ((*self.z).nrow, slice((*self.z).x.cast::<f64>(), (*self.z).nrow * count)) };
        TallRhs { rows, count, values }
    }
}

impl Drop for Call {
    fn drop(&mut self) {
        let common = self.common.as_mut_ptr();
        // SAFETY: each pointer is null or was allocated by SPQR with this `common`; freeing null does nothing.
        unsafe {
            spqr_sys::cholmod_l_free_sparse(&raw mut self.r, common);
            spqr_sys::cholmod_l_free_dense(&raw mut self.z, common);
            spqr_sys::cholmod_l_free(self.order_length, size_of::<i64>(), self.order.cast(), common);
        }
    }
}

/// Rounds the norm of the dropped entries to 24 bits. SuiteSparseQR sums this norm task by task, so its last bits depend on the tree; no
/// other result does.
fn without_last_bits(norm: f64) -> f64 {
    f64::from_bits((norm.to_bits() + (1 << 28)) & !((1 << 29) - 1))
}

/// Collects at most `length` values; an error if the allocation fails.
pub(super) fn collected<T>(length: usize, values: impl Iterator<Item = T>) -> Result<Vec<T>, TryReserveError> {
    let mut collected = reserved(length)?;
    collected.extend(values.take(length));
    Ok(collected)
}

fn reserved<T>(length: usize) -> Result<Vec<T>, TryReserveError> {
    let mut values = Vec::new();
    values.try_reserve_exact(length)?;
    Ok(values)
}

/// # Safety
/// `data` has `length` entries, or `length` is 0.
unsafe fn slice<'a, T>(data: *const T, length: usize) -> &'a [T] {
    // SAFETY: the caller guarantees the length. C may use a null pointer for an empty array; Rust may not.
    if length == 0 { &[] } else { unsafe { std::slice::from_raw_parts(data, length) } }
}

/// The block A as a CHOLMOD matrix, m x n in compressed columns. C takes mutable pointers but only reads.
fn sparse_view(columns: &Csr, start: &mut [i64], index: &mut [i64]) -> cholmod_sparse {
    cholmod_sparse {
        nrow: columns.cols,
        ncol: columns.rows(),
        nzmax: columns.nnz(),
        p: start.as_mut_ptr().cast(),
        i: index.as_mut_ptr().cast(),
        nz: null_mut(),
        x: columns.val.as_ptr().cast_mut().cast(),
        z: null_mut(),
        stype: 0,
        itype: spqr_sys::CHOLMOD_LONG,
        xtype: spqr_sys::CHOLMOD_REAL,
        dtype: spqr_sys::CHOLMOD_DOUBLE,
        sorted: 1,
        packed: 1,
    }
}

/// The right-hand sides B as a CHOLMOD matrix; C only reads it.
fn dense_view(b: TallRhs) -> cholmod_dense {
    cholmod_dense {
        nrow: b.rows,
        ncol: b.count,
        nzmax: b.values.len(),
        d: b.rows,
        x: b.values.as_ptr().cast_mut().cast(),
        z: null_mut(),
        xtype: spqr_sys::CHOLMOD_REAL,
        dtype: spqr_sys::CHOLMOD_DOUBLE,
    }
}

/// The factor R as C returns it: the start of each column, and the row (not sorted) and value of each entry.
#[derive(Clone, Copy)]
struct InColumns<'a> {
    start: &'a [i64],
    row: &'a [i64],
    value: &'a [f64],
}

/// Memory to which the entries of the factor R are written by rows.
#[derive(Clone, Copy)]
struct Places {
    col: *mut u32,
    val: *mut f64,
}

// SAFETY: no two threads write to the same place, see `fill`.
unsafe impl Sync for Places {}

impl InColumns<'_> {
    /// Converts rows `0..rank` of the factor R to compressed rows without exact zeros, on this number of threads of the caller's pool.
    ///
    /// R is by far the largest result, so it is written only once, and its allocation can fail. Each thread takes a range of columns
    /// and writes its entries of each row after those of the ranges before.
    fn by_rows(self, rank: usize, threads: usize) -> Result<Csr, TryReserveError> {
        let parts = self.split(threads.max(1));
        let zeros = |_| collected(rank, std::iter::repeat(0));
        let mut places: Vec<Vec<usize>> = parts.iter().map(zeros).collect::<Result<_, _>>()?;
        let counting = |(part, counts): (&Range<usize>, &mut Vec<usize>)| self.count(part.clone(), counts);
        in_parallel(threads, &parts, &mut places, counting);
        let start = starts(rank, &mut places)?;
        let (mut col, mut val) = (reserved::<u32>(start[rank])?, reserved::<f64>(start[rank])?);
        let to = Places { col: col.as_mut_ptr(), val: val.as_mut_ptr() };
        // SAFETY: `count` counted the same entries, so each one has its own place below start[rank], which is reserved.
        let filling = |(part, next): (&Range<usize>, &mut Vec<usize>)| unsafe { self.fill(part.clone(), next, &to) };
        in_parallel(threads, &parts, &mut places, filling);
        // SAFETY: all places were written.
        unsafe {
            col.set_len(start[rank]);
            val.set_len(start[rank]);
        }
        Ok(Csr { cols: self.start.len() - 1, start, col, val })
    }

    /// Splits the columns into ranges with about the same number of entries.
    fn split(self, count: usize) -> Vec<Range<usize>> {
        let columns = self.start.len() - 1;
        let bound = |part: usize| self.start.partition_point(|&at| (at as usize) < self.row.len() / count * part);
        (0..count).map(|part| bound(part)..if part + 1 == count { columns } else { bound(part + 1) }).collect()
    }

    /// The rows and values of the entries of these columns.
    fn entries(self, columns: Range<usize>) -> impl Iterator<Item = (usize, f64)> {
        let range = self.start[columns.start] as usize..self.start[columns.end] as usize;
        self.row[range.clone()].iter().map(|&row| row as usize).zip(self.value[range].iter().copied())
    }

    /// Counts the nonzero entries of each row in these columns.
    fn count(self, columns: Range<usize>, counts: &mut [usize]) {
        for (row, value) in self.entries(columns) {
            if value != 0.0 && row < counts.len() {
                counts[row] += 1;
            }
        }
    }

    /// # Safety
    /// From `next[row]` on there is a place for each entry of the row in these columns, and no other thread writes to these places.
    unsafe fn fill(self, columns: Range<usize>, next: &mut [usize], to: &Places) {
        for j in columns {
            for (row, value) in self.entries(j..j + 1) {
                if value != 0.0 && row < next.len() {
                    let place = next[row];
                    // SAFETY: the caller guarantees a place for each entry.
                    unsafe {
                        to.col.add(place).write(j as u32);
                        to.val.add(place).write(value);
                    }
                    next[row] = place + 1;
                }
            }
        }
    }
}

/// The start of each row of R. `counts[k][row]` is the number of entries of a row in the k-th range of columns, and becomes the place of
/// the first of them.
fn starts(rank: usize, counts: &mut [Vec<usize>]) -> Result<Vec<usize>, TryReserveError> {
    let mut start = reserved(rank + 1)?;
    let mut place = 0;
    for row in 0..rank {
        start.push(place);
        for part in &mut *counts {
            place += std::mem::replace(&mut part[row], place);
        }
    }
    start.push(place);
    Ok(start)
}

fn in_parallel<A: Sync, B: Send>(threads: usize, a: &[A], b: &mut [B], work: impl Fn((&A, &mut B)) + Sync + Send) {
    if threads > 1 { a.par_iter().zip(b).for_each(work) } else { a.iter().zip(b).for_each(work) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_the_same_for_every_number_of_threads() {
        let (columns, rank) = (300, 250);
        let (mut start, mut row, mut value) = (vec![0], Vec::new(), Vec::new());
        let mut expected = vec![Vec::new(); rank];
        for j in 0..columns {
            // The test covers rows that do not ascend, exact zeros, and rows beyond the rank.
            for i in (0..=j).rev().filter(|i| (i * 7 + j * 5) % 11 < 4) {
                let entry = if (i + j) % 13 == 0 { 0.0 } else { (1 + i) as f64 / (1 + j) as f64 };
                row.push(i as i64);
                value.push(entry);
                if i < rank && entry != 0.0 {
                    expected[i].push((j, entry));
                }
            }
            start.push(row.len() as i64);
        }
        let in_columns = InColumns { start: &start, row: &row, value: &value };
        for threads in [1, 2, 3, 7, 1000] {
            let rows = in_columns.by_rows(rank, threads).expect("memory");
            assert_eq!((rows.cols, rows.rows()), (columns, rank));
            (0..rank).for_each(|i| assert_eq!(rows.row(i).collect::<Vec<_>>(), expected[i], "{threads} threads"));
        }
        let nothing = InColumns { start: &[0], row: &[], value: &[] }.by_rows(0, 2).expect("memory");
        assert_eq!((nothing.rows(), nothing.nnz()), (0, 0));
    }
}
