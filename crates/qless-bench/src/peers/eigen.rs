//! `C P = Q R` by Eigen's SparseQR with COLAMD, left-looking and without supernodes: the solver of the paper.

use qless::Csr;
use qless::backend::{Backend, BackendError, Factor};

use super::Rule;
use super::call::{self, CallError, SparseFactor};

const NAME: &str = "Eigen SparseQR";

/// Eigen's SparseQR as a [`Backend`].
#[derive(Clone, Copy, Debug)]
pub struct Eigen(pub Rule);

impl Backend for Eigen {
    fn name(&self) -> &'static str {
        NAME
    }

    fn version(&self) -> String {
        let [world, major, minor] = call::eigen_version();
        format!("Eigen {world}.{major}.{minor}")
    }

    fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError> {
        let (m, n) = (columns.cols(), columns.rows());
        let EigenMatrix { columns: a, full } = without_empty_rows(columns);
        let (rows, k) = (full.len(), rhs.len().checked_div(m).unwrap_or(0));
        if rows == 0 {
            let rest = rhs.chunks(m.max(1)).map(norm).collect();
            let (r, order) = (Csr::empty(n), (0..n).collect());
            return Ok(Factor { rank: 0, order, r, rhs: Vec::new(), rest, dropped: 0.0 });
        }
        let mut turned: Vec<f64> = (0..k).flat_map(|c| full.iter().map(move |&i| rhs[c * m + i])).collect();
        let threshold = (self.0 == Rule::Call).then_some(tolerance);
        let made = call::eigen(&a, &mut turned, threshold).map_err(|error| refused(NAME, error, m, n))?;
        let SparseFactor { order, r, compute, extract } = made;
        log(NAME, compute, extract);
        let rank = r.rows();
        let empty = |c: usize| (0..m).filter(|i| full.binary_search(i).is_err()).map(move |i| rhs[c * m + i]);
        let left = |c: usize| turned[c * rows + rank..(c + 1) * rows].iter().copied().chain(empty(c));
        let rest = (0..k).map(|c| left(c).map(|v| v * v).sum::<f64>().sqrt()).collect();
        let rhs = (0..k).flat_map(|c| &turned[c * rows..c * rows + rank]).copied().collect();
        // Eigen does not report the size of the dropped columns.
        Ok(Factor { rank, order, r, rhs, rest, dropped: 0.0 })
    }
}

/// A without its empty rows, because Eigen refuses them, and the numbers of the rows that remain.
struct EigenMatrix {
    columns: Csr,
    full: Vec<usize>,
}

fn without_empty_rows(columns: &Csr) -> EigenMatrix {
    let mut is_full = vec![false; columns.cols()];
    columns.columns().iter().for_each(|&i| is_full[i as usize] = true);
    let full: Vec<usize> = (0..columns.cols()).filter(|&i| is_full[i]).collect();
    let mut place = vec![0; columns.cols()];
    full.iter().enumerate().for_each(|(at, &i)| place[i] = at as u32);
    let indices = columns.columns().iter().map(|&i| place[i as usize]).collect();
    let kept = Csr::from_parts(full.len(), columns.starts().to_vec(), indices, columns.values().to_vec());
    let kept = kept.expect("without empty rows the others keep their order");
    EigenMatrix { columns: kept, full }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Prints the times of the factorization and of computing R and `Q^T B`, if the environment variable `QLESS_BENCH_PARTS` is set.
pub(super) fn log(name: &str, compute: f64, extract: f64) {
    if std::env::var_os("QLESS_BENCH_PARTS").is_some() {
        eprintln!("{name}: factorization {compute:.4} s, R and Q^T B {extract:.4} s");
    }
}

pub(super) fn refused(backend: &'static str, error: CallError, rows: usize, cols: usize) -> BackendError {
    match error {
        CallError::NoMemory => BackendError::OutOfMemory { backend, rows, cols, advice: "" },
        CallError::TooLarge => BackendError::TooLarge { backend, rows, cols },
        CallError::Failed(message) => BackendError::Failed { backend, message },
    }
}
