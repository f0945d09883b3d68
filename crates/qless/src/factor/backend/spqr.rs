//! `Q^T A P = [R1 R2; 0 0]` and `Q^T B` by SuiteSparseQR (Davis 2011, Algorithm 915), so W = Q^T.
//!
//! Multifrontal Householder QR with Heath's rank detection. One call of its C interface factors A and transforms B; Q is neither
//! formed nor kept. Results are copied to owned data and the C memory is freed before the call returns. So no value here holds a C
//! pointer, and all of them can be sent to other threads.
//! SuiteSparseQR is GPL-2.0-or-later; a binary built with the feature `spqr` is too.

mod call;

use super::sparse::analyse;
use super::{Backend, BackendError, Factor, check_block, check_limit, norm};
use crate::Csr;
use call::{Call, collected};
use std::collections::TryReserveError;
use std::time::Instant;

#[cfg(feature = "faults")]
#[doc(hidden)]
pub use spqr_sys as sys;
#[cfg(feature = "faults")]
pub use spqr_sys::memory::faults;

const NAME: &str = "spqr";

/// Upper bound of the bytes per entry of a dense m x n block: one front with all entries, and two copies of R.
const FULL: usize = 3 * size_of::<f64>();

/// SuiteSparseQR, ordering by its own default (COLAMD, AMD or METIS).
///
/// BLAS runs on one thread during a factorization, so the results are the same to the last bit for every value of `threads`. Several
/// threads need the feature `tbb` and SuiteSparseQR 2.1; otherwise the tasks run in sequence ([`Spqr::has_trees`]).
///
/// It returns [`BackendError::OutOfMemory`] if any allocation of SuiteSparse, OpenBLAS or the task tree fails. It does not change the
/// hooks of SuiteSparse or the `cholmod_common` of other users in the process (`spqr_sys::memory`). OpenBLAS starts threads when a
/// program is loaded, unless the program prevents that (`spqr_sys::blas`).
///
/// A program that factors large systems repeatedly saves up to a fifth of the time if freed memory stays in the process. By default glibc
/// returns arrays above 32 MB to the system and requests zeroed pages for the next ones. These settings prevent that:
/// `GLIBC_TUNABLES=glibc.malloc.mmap_threshold=8000000000:glibc.malloc.trim_threshold=32000000000:glibc.malloc.top_pad=1000000000`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spqr {
    /// Threads for the task tree of one factorization; 0 for the number of threads of the caller's rayon pool. Default: 1, without a
    /// tree.
    pub threads: usize,
    /// Lower bound of the ratio of all work to the work of one task, so larger values make smaller tasks. Default: 5, for any number of
    /// threads.
    pub grain: f64,
    /// Lower bound of the operations of a task. Default: 1e6; starting a thread for less costs more than it saves.
    pub small: f64,
    /// Limit of the bytes that [`super::sparse`] predicts for the same pattern; a block above it is refused before the work. The
    /// prediction assumes qless' own column order, so SuiteSparseQR can use more or less. Default: no limit.
    pub memory: usize,
}

impl Default for Spqr {
    fn default() -> Self {
        Self { threads: 1, grain: 5.0, small: 1e6, memory: usize::MAX }
    }
}

/// Tasks, memory and time of one factorization.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Tasks in the tree; 1 for a factorization in sequence.
    pub tasks: usize,
    /// Peak memory of CHOLMOD, in bytes.
    pub memory: usize,
    /// Seconds of the symbolic analysis.
    pub analysis: f64,
    /// Seconds of the factorization alone.
    pub factorization: f64,
    /// Seconds of the whole call, including the copy of the results.
    pub total: f64,
}

impl Spqr {
    /// SuiteSparseQR with this number of threads for each factorization.
    pub fn on(threads: usize) -> Self {
        Self { threads, ..Self::default() }
    }

    /// Number of task trees that have run in this process.
    pub fn trees() -> u64 {
        spqr_sys::tree::count()
    }

    /// Returns true if task trees run on oneTBB in this process.
    pub fn has_trees() -> bool {
        spqr_sys::tree::is_active()
    }

    /// [`Backend::factor`] with its statistics.
    ///
    /// # Errors
    /// [`BackendError`].
    pub fn factor_measured(
        &self,
        columns: &Csr,
        rhs: &[f64],
        tolerance: f64,
    ) -> Result<(Factor, Statistics), BackendError> {
        if tolerance.is_nan() || tolerance < 0.0 {
            // SuiteSparseQR gives negative tolerances a special meaning.
            return Err(failed(format!("the tolerance {tolerance} is negative or not a number")));
        }
        spqr_sys::version().map_err(|mismatch| failed(mismatch.to_string()))?;
        let (m, n) = (columns.cols, columns.rows());
        if u32::try_from(n).is_err() || i64::try_from(m).is_err() {
            return Err(BackendError::TooLarge { backend: NAME, rows: m, cols: n });
        }
        // SuiteSparseQR treats a NaN as an independent entry and reports success.
        check_block(columns, rhs, tolerance)?;
        let tall = TallRhs { rows: m, count: rhs.len().checked_div(m).unwrap_or(0), values: rhs };
        if columns.nnz() == 0 {
            let factor = nothing_to_factor(n, tall).map_err(|_| error_of(spqr_sys::CHOLMOD_OUT_OF_MEMORY, m, n))?;
            return Ok((factor, Statistics { tasks: 1, ..Statistics::default() }));
        }
        let start = Instant::now();
        self.allow(columns, tall.count)?;
        let (factor, statistics) = self.factor_in_c(columns, tall, tolerance)?;
        Ok((factor, Statistics { total: start.elapsed().as_secs_f64(), ..statistics }))
    }

    /// Refuses a block whose predicted memory is above the limit. A block that would fit even if dense is not analysed.
    fn allow(self, columns: &Csr, rhs: usize) -> Result<(), BackendError> {
        let (rows, cols, limit) = (columns.cols, columns.rows(), self.memory);
        let full = rows.saturating_mul(cols.saturating_add(rhs)).saturating_mul(FULL);
        if full <= limit {
            return Ok(());
        }
        let needed = analyse(columns)?.memory(rhs);
        check_limit(NAME, (rows, cols), needed, limit)
    }

    fn factor_in_c(self, columns: &Csr, b: TallRhs, tolerance: f64) -> Result<(Factor, Statistics), BackendError> {
        let (m, n) = (columns.cols, columns.rows());
        let no_memory = || error_of(spqr_sys::CHOLMOD_OUT_OF_MEMORY, m, n);
        let mut call = Call::start(n + b.count).ok_or_else(no_memory)?;
        let wanted = if self.threads == 0 { rayon::current_num_threads() } else { self.threads };
        let blas = spqr_sys::blas::hold(spqr_sys::tree::runners(wanted)).ok_or_else(no_memory)?;
        let threads = blas.callers();
        if threads > 1 {
            call.common.set_task_tree(self.grain, self.small);
        }
        let rank = spqr_sys::tree::with_threads(threads, || call.run(columns, b, tolerance));
        drop(blas);
        let factor = call.read(rank.map_err(|status| error_of(status, m, n))?, columns, b, wanted)?;
        Ok((factor, call.statistics()))
    }
}

impl Backend for Spqr {
    fn name(&self) -> &'static str {
        NAME
    }

    fn version(&self) -> String {
        let library = spqr_sys::version().unwrap_or_else(|mismatch| mismatch.library);
        let way = match spqr_sys::tree::runtime().filter(|_| Self::has_trees()) {
            Some(tbb) => format!("task tree on oneTBB {tbb}"),
            None => "in sequence".to_owned(),
        };
        format!("SuiteSparseQR {}, SuiteSparse {library}, {way}", spqr_sys::SPQR)
    }

    fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError> {
        self.factor_measured(columns, rhs, tolerance).map(|(factor, _)| factor)
    }
}

/// A dense m x k matrix of right-hand sides, by columns.
#[derive(Clone, Copy)]
struct TallRhs<'a> {
    rows: usize,
    count: usize,
    values: &'a [f64],
}

impl<'a> TallRhs<'a> {
    fn columns(self) -> impl Iterator<Item = &'a [f64]> {
        self.values.chunks_exact(self.rows.max(1))
    }

    fn head(self, rank: usize) -> Result<Vec<f64>, TryReserveError> {
        collected(self.count * rank, self.columns().flat_map(|b| &b[..rank]).copied())
    }

    fn rest(self, rank: usize) -> Result<Vec<f64>, TryReserveError> {
        collected(self.count, self.columns().map(|b| norm(&b[rank..])))
    }
}

fn all_finite(values: &[f64]) -> bool {
    values.iter().all(|v| v.is_finite())
}

/// The factorization `W A P = [R1 R2; 0 0]` with W = I of a block A without nonzero entries. The C code does not accept every empty matrix.
fn nothing_to_factor(n: usize, b: TallRhs) -> Result<Factor, TryReserveError> {
    let (order, r) = (collected(n, 0..n)?, Csr::empty(n));
    Ok(Factor { rank: 0, order, r, rhs: Vec::new(), rest: b.rest(0)?, dropped: 0.0 })
}

/// Returns true if row i of R starts at column i; then R1, its leading square part, is upper triangular and nonsingular.
fn is_trapezoidal(r: &Csr) -> bool {
    (0..r.rows()).all(|i| r.row(i).next().is_some_and(|(j, _)| j == i))
}

fn error_of(status: i32, rows: usize, cols: usize) -> BackendError {
    match status {
        spqr_sys::CHOLMOD_OUT_OF_MEMORY => BackendError::OutOfMemory { backend: NAME, rows, cols, advice: "" },
        spqr_sys::CHOLMOD_TOO_LARGE => BackendError::TooLarge { backend: NAME, rows, cols },
        spqr_sys::CHOLMOD_INVALID => failed(format!("CHOLMOD calls the {rows} x {cols} block invalid input")),
        _ => failed(format!("no factorization of the {rows} x {cols} block, CHOLMOD status {status}")),
    }
}

fn failed(message: String) -> BackendError {
    BackendError::Failed { backend: NAME, message }
}

#[cfg(test)]
mod tests;
