//! Slaves of a large block: as many columns of C as it has rows, well-conditioned, by sparse QR.
//!
//! A QR without pivoting takes the first independent columns, however nearly dependent they are. Of those the weak ones, by
//! the singular vectors of R, give way: with A the others and U an orthonormal basis of what A does not reach, the columns j
//! that make `U^T C_j` most independent take their places (QR with column pivoting, k x n for k places).

use faer::Mat;

use crate::Csr;
use crate::qr::faer::Faer;
use crate::qr::{Backend, BackendError, Factor};
use crate::random::randoms;

/// Singular values of the slaves' columns that call for others, the strictest that can be had first.
const LIMITS: [f64; 3] = [1e-2, 1e-4, 1e-6];

/// Most rounds of dropping weak columns.
const ROUNDS: usize = 16;

/// Columns of full row rank, and the factor of them alone. `c` holds C by columns, and its rows are independent. None if the
/// backend finds no such columns.
pub(super) fn slaves(
    c: &Csr,
    backend: &dyn Backend,
    tolerance: f64,
) -> Result<Option<(Vec<usize>, Factor)>, BackendError> {
    let first = backend.factor(c, &[], tolerance)?;
    for limit in LIMITS {
        let Some(picked) = strong(c, &first, limit, backend)? else { continue };
        let factor = backend.factor(&columns(c, picked.iter().copied()), &[], 0.0)?;
        if factor.rank == c.cols && factor.smallest_singular_value().0 > limit * limit {
            return Ok(Some((picked, factor)));
        }
    }
    Ok(None)
}

/// The live columns of a factor without the weak ones, and others in their places.
fn strong(c: &Csr, first: &Factor, limit: f64, backend: &dyn Backend) -> Result<Option<Vec<usize>>, BackendError> {
    let mut picked = first.order[..first.rank].to_vec();
    let mut factor = first.clone();
    let mut rounds = 0..ROUNDS;
    // The smallest values hide those that are merely small: several rounds.
    loop {
        let Some(mut weak) = factor.weak_columns(limit)?.filter(|_| rounds.next().is_some()) else { return Ok(None) };
        if weak.is_empty() {
            break;
        }
        weak.sort_unstable_by(|a, b| b.cmp(a));
        for k in weak {
            picked.swap_remove(k);
        }
        factor = backend.factor(&columns(c, picked.iter().copied()), &[], 0.0)?;
        picked = factor.order[..factor.rank].iter().map(|&k| picked[k]).collect();
    }
    if picked.len() < c.cols {
        let beyond = complement(&columns(c, picked.iter().copied()), &factor);
        picked.extend(most_independent(c, &picked, &beyond)?);
    }
    picked.sort_unstable();
    Ok((picked.len() == c.cols).then_some(picked))
}

/// An orthonormal basis of what the columns of `a`, in the order of their factor, do not reach.
fn complement(a: &Csr, factor: &Factor) -> Mat<f64> {
    let (m, width) = (a.cols, a.cols - factor.rank);
    let mut random = randoms(3);
    let mut basis = Mat::from_fn(m, width, |_, _| random.next().unwrap_or(1.0) - 1.0);
    // Twice is enough (Kahan and Parlett): the first leaves what rounding makes of large parts.
    for _ in 0..2 {
        for k in 0..width {
            let mut column: Vec<f64> = (0..m).map(|i| basis[(i, k)]).collect();
            let along: Vec<f64> = (0..a.rows()).map(|j| a.row(j).map(|(i, v)| v * column[i]).sum()).collect();
            let x = factor.solve(&factor.solve_transposed(&along));
            for (j, x) in x.iter().enumerate() {
                a.row(j).for_each(|(i, v)| column[i] -= v * x);
            }
            column.iter().enumerate().for_each(|(i, &v)| basis[(i, k)] = v);
        }
        basis = basis.qr().compute_thin_Q();
    }
    basis
}

/// The columns that reach most of the space spanned by `beyond`, one for each of its dimensions if there are so many.
fn most_independent(c: &Csr, picked: &[usize], beyond: &Mat<f64>) -> Result<Vec<usize>, BackendError> {
    let mut is_picked = vec![false; c.rows()];
    picked.iter().for_each(|&j| is_picked[j] = true);
    let others: Vec<usize> = (0..c.rows()).filter(|&j| !is_picked[j]).collect();
    let mut parts = Csr::empty(beyond.ncols());
    for &j in &others {
        parts.push_row((0..beyond.ncols()).map(|k| (k, c.row(j).map(|(i, v)| v * beyond[(i, k)]).sum())));
    }
    let factor = Faer.factor(&parts, &[], 0.0)?;
    Ok(factor.order[..factor.rank].iter().map(|&k| others[k]).collect())
}

/// Some columns of C.
pub(crate) fn columns(c: &Csr, which: impl Iterator<Item = usize>) -> Csr {
    let mut some = Csr::empty(c.cols);
    which.for_each(|j| some.push_row(c.row(j)));
    some
}
