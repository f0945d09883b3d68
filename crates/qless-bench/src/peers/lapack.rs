//! `C P = Q R` by LAPACK's dgeqp3: dense Householder QR with column pivoting, in O(m n min(m, n)) time and 8 m n bytes.

use qless::Csr;
use qless::backend::{Backend, BackendError, Factor};

use super::Rule;
use super::call;
use super::eigen::{log, refused};

const NAME: &str = "LAPACK dgeqp3";

/// Largest number of entries of a dense matrix: 4 GiB.
const MOST: usize = 1 << 29;

/// dgeqp3 as a [`Backend`].
#[derive(Clone, Copy, Debug)]
pub struct Lapack(pub Rule);

impl Backend for Lapack {
    fn name(&self) -> &'static str {
        NAME
    }

    fn version(&self) -> String {
        "the LAPACK that the system links".to_owned()
    }

    fn pivots(&self, _: usize, _: usize) -> bool {
        true
    }

    fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError> {
        let (m, n) = (columns.cols(), columns.rows());
        let k = rhs.len().checked_div(m).unwrap_or(0);
        let mut a = dense(columns)?;
        let (order, tau, compute) = call::geqp3(&mut a, m, n).map_err(|error| refused(NAME, error, m, n))?;
        let at = |i: usize, j: usize| a[j * m + i];
        let first = if m.min(n) > 0 { at(0, 0).abs() } else { 0.0 };
        let zero = if self.0 == Rule::Own { m.max(n) as f64 * f64::EPSILON * first } else { tolerance };
        let rank = (0..m.min(n)).take_while(|&i| at(i, i).abs() > zero).count();
        let mut turned = rhs.to_vec();
        let extract = call::apply(&a, m, rank, &tau, &mut turned).map_err(|error| refused(NAME, error, m, n))?;
        log(NAME, compute, extract);
        let mut r = Csr::empty(n);
        (0..rank).for_each(|i| {
            r.push_row((i..n).map(|j| (j, at(i, j))).filter(|&(_, v)| v != 0.0)).expect("columns ascend");
        });
        let square = |i: usize| (i..n).map(|j| at(i, j).powi(2)).sum::<f64>();
        let dropped = (rank..m.min(n)).map(square).sum::<f64>().sqrt();
        let rest =
            (0..k).map(|c| turned[c * m + rank..(c + 1) * m].iter().map(|v| v * v).sum::<f64>().sqrt()).collect();
        let rhs = (0..k).flat_map(|c| &turned[c * m..c * m + rank]).copied().collect();
        Ok(Factor { rank, order, r, rhs, rest, dropped })
    }
}

/// A by columns; an error if it is too large.
fn dense(columns: &Csr) -> Result<Vec<f64>, BackendError> {
    let (rows, cols) = (columns.cols(), columns.rows());
    let refuse = || BackendError::OutOfMemory { backend: NAME, rows, cols, advice: "" };
    let len = rows.checked_mul(cols).filter(|&len| len <= MOST).ok_or_else(refuse)?;
    let mut a = Vec::new();
    a.try_reserve_exact(len).map_err(|_| refuse())?;
    a.resize(len, 0.0);
    (0..cols).for_each(|j| columns.row(j).for_each(|(i, v)| a[j * rows + i] = v));
    Ok(a)
}
