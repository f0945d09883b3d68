//! Singular values of `D_r C_f`, with rows scaled to about the same size, by a dense decomposition.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::svd::{ComputeSvdVectors, SvdParams, svd, svd_scratch};
use faer::{Mat, Par, Spec};
use qless::ConstraintSystem;

use super::{OracleError, free_of};

/// Largest number of entries of the dense matrix.
const MOST: usize = 100_000_000;

/// Singular values of `D_r C_f`, descending; as many as the smaller of equations and free DOFs.
///
/// C_f are the columns of the free DOFs. The powers of two in D_r bring the largest coefficient of each row into `[1, 2)`.
/// [`qless`] does the same if it keeps the units of the DOFs. The cost is O(m n min(m, n)), so matrices should not exceed about
/// 600 x 600. The absolute error of each value is about the rounding of the largest, so values below 1e-14 of the largest
/// should count as zeros.
///
/// A path of n nodes, `u_i - u_(i+1) = 0`, has the singular values `2 sin(k pi / 2n)`:
///
/// ```
/// use qless_scenes::{families, oracle};
/// let values = oracle::singular_values(&families::path(3)?.system)?;
/// assert!((values[0] - 3_f64.sqrt()).abs() < 1e-14 && (values[1] - 1.0).abs() < 1e-14);
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
///
/// # Errors
/// [`OracleError::TooLarge`] for more than 1e8 entries, [`OracleError::NoConvergence`].
pub fn singular_values(system: &ConstraintSystem) -> Result<Vec<f64>, OracleError> {
    let free = free_of(system);
    let dofs: Vec<usize> = (0..system.dofs()).filter(|&j| free(j)).collect();
    if system.equations() == 0 || dofs.is_empty() {
        return Ok(Vec::new());
    }
    let found = system.equations().saturating_mul(dofs.len());
    if found > MOST {
        return Err(OracleError::TooLarge { found, most: MOST });
    }
    let mut dense = Mat::zeros(system.equations(), dofs.len());
    for i in 0..system.equations() {
        let row = || system.matrix().row(i).filter_map(|(j, v)| Some((dofs.binary_search(&j).ok()?, v)));
        let unit = power_of_two(row().fold(0.0, |a: f64, (_, v)| a.max(v.abs())));
        row().for_each(|(j, v)| dense[(i, j)] = v / unit);
    }
    by_qr_algorithm(&dense)
}

/// Uses the QR algorithm at every size. From 128 rows on faer would use divide and conquer, which returned 2e-5 for one of many
/// zero singular values.
fn by_qr_algorithm(dense: &Mat<f64>) -> Result<Vec<f64>, OracleError> {
    let mut params = Spec::<SvdParams, f64>::default();
    params.config.recursion_threshold = usize::MAX;
    let ((m, n), none) = (dense.shape(), ComputeSvdVectors::No);
    let mut values = Diag::zeros(m.min(n));
    let mut room = MemBuffer::new(svd_scratch::<f64>(m, n, none, none, Par::Seq, params));
    svd(dense.as_ref(), values.as_mut(), None, None, Par::Seq, MemStack::new(&mut room), params)
        .map_err(|_| OracleError::NoConvergence)?;
    Ok(values.column_vector().iter().copied().collect())
}

/// `2^floor(log2 x)` for x >= 0, by clearing the mantissa; at least the smallest normal number.
fn power_of_two(x: f64) -> f64 {
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & (0x7ff << 52))
}
