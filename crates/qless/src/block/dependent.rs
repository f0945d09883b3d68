//! `C^T P = Q [R1 R2]`: which rows of a block are combinations of others, and of which.

use super::tableau::Tableau;
use super::{Block, Dependent};
use crate::Csr;
use crate::qr::faer::Faer;
use crate::qr::{Backend, BackendError, Factor};
use crate::scale::ldexp;

/// Coefficients of a certificate below this, relative to its largest, are rounding.
const NOISE: f64 = 1e-11;

/// Kept rows (positions in the block) and dependent ones.
pub(super) struct Rows {
    pub kept: Vec<usize>,
    pub dependent: Vec<Dependent>,
    pub sigma: f64,
}

pub(super) fn find(block: &Block, backend: &dyn Backend, tolerance: f64) -> Result<Rows, BackendError> {
    let factor = backend.factor(&block.matrix, &[], tolerance)?;
    let sigma = if backend.is_orthogonal() { factor.smallest_singular_value() } else { sigma_of(block, &factor)? };
    let left = factor.dropped;
    let mut tableau = certificates(&factor);
    // Of equations that say the same, the earlier one is kept.
    tableau.prefer(|candidate, holder| candidate > holder);
    let mut kept: Vec<usize> = tableau.free.iter().map(|&k| k as usize).collect();
    kept.sort_unstable();
    Ok(Rows { dependent: (0..tableau.basic.len()).map(|i| dependent(block, &tableau, i, left)).collect(), kept, sigma })
}

/// Row k of the tableau: `R1^-1 R2_k`, the dependent equation over the kept ones.
fn certificates(factor: &Factor) -> Tableau {
    let position = |k: &usize| *k as u32;
    Tableau {
        basic: factor.order[factor.rank..].iter().map(position).collect(),
        free: factor.order[..factor.rank].iter().map(position).collect(),
        width: factor.rank,
        data: factor.coefficients().concat(),
    }
}

fn dependent(block: &Block, tableau: &Tableau, i: usize, left: f64) -> Dependent {
    let (k, y) = (tableau.basic[i] as usize, tableau.row(i));
    let largest = y.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
    let terms = y.iter().zip(&tableau.free).filter(|(v, _)| v.abs() > NOISE * largest);
    let unscaled = |(&v, &i): (&f64, &u32)| (block.rows[i as usize], ldexp(v, block.exponents[i as usize] - block.exponents[k]));
    let mut because: Vec<_> = terms.map(unscaled).collect();
    because.sort_unstable_by_key(|&(row, _)| row);
    Dependent { row: block.rows[k], because, dropped: left }
}

/// For a backend whose R is not that of a QR: the same estimate from a QR of the rows that it kept.
fn sigma_of(block: &Block, factor: &Factor) -> Result<f64, BackendError> {
    let mut kept = Csr::empty(block.matrix.cols);
    factor.order[..factor.rank].iter().for_each(|&i| kept.push_row(block.matrix.row(i)));
    Ok(Faer.factor(&kept, &[], 0.0)?.smallest_singular_value())
}
