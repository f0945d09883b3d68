//! `x = A^+ b`: of a tall A by its own factors, of a wide one by those of `A^T`.

use super::{each, finished, refine};
use crate::dense::scaled_norm;
use crate::factor::columns_of;
use crate::{Error, Factor, Index, Matrix, Options, Solution};

/// The shortest x of least `|A x - b|`, `x = A^+ b`, for A of any shape and rank, and k right-hand sides by columns.
///
/// Tall matrices are factored as they are, wide ones as `A^T` with Q kept. Only where the rank is not full (of wide ones:
/// and the dependent equations contradict the others) there is a second factorization, of `[R1 R2]^T`.
///
/// ```
/// use qless_qr::{Matrix, Options, minimum_norm};
/// let a = Matrix::by_rows(1, 2, &[0, 2], &[0_u32, 1], &[3.0, 4.0])?;
/// let solution = minimum_norm(&a, &[5.0], Options::new())?;
/// assert!((solution.x[0] - 0.6).abs() < 1e-15 && (solution.x[1] - 0.8).abs() < 1e-15);
/// # Ok::<(), qless_qr::Error>(())
/// ```
///
/// # Errors
/// As [`least_squares`](crate::least_squares).
pub fn minimum_norm<P: Index, I: Index>(a: &Matrix<P, I>, b: &[f64], options: Options) -> Result<Solution, Error> {
    columns_of(b.len(), a.rows())?;
    if a.rows() < a.cols() { wide(a, b, options) } else { tall(a, b, options) }
}

fn tall<P: Index, I: Index>(a: &Matrix<P, I>, b: &[f64], options: Options) -> Result<Solution, Error> {
    let options = options.keep_q(options.refinements > 0);
    let factor = a.analyse()?.factor(a.values(), b, options)?;
    let mut x;
    if factor.rank() == a.cols() {
        x = factor.basic()?;
        factor.refine(a, b, &mut x, options.refinements)?;
    } else {
        let complete = factor.complete(options.memory)?;
        x = complete.minimum_norm()?;
        refine::repeat(a, b, &mut x, options.refinements, |b| complete.solve(b))?;
    }
    finished(a, b, x, &factor)
}

fn wide<P: Index, I: Index>(a: &Matrix<P, I>, b: &[f64], options: Options) -> Result<Solution, Error> {
    let at = a.transposed();
    let factor = at.analyse()?.factor(at.values(), &[], options.keep_q(true))?;
    if !b.iter().all(|v| v.is_finite()) {
        return Err(Error::NotFinite("the right-hand side"));
    }
    let mut x = factor.solve_transposed(b)?;
    if factor.rank() == a.rows() || agree(a, b, &x, &factor) {
        refine::repeat(a, b, &mut x, options.refinements, |b| factor.solve_transposed(b))?;
    } else {
        let complete = factor.complete(options.memory)?;
        x = complete.solve_transposed(b)?;
        refine::repeat(a, b, &mut x, options.refinements, |b| complete.solve_transposed(b))?;
    }
    finished(a, b, x, &factor)
}

/// Whether the dependent equations hold where the independent ones do, but for what counts as zero: then these decide.
fn agree<P: Index, I: Index>(a: &Matrix<P, I>, b: &[f64], x: &[f64], factor: &Factor) -> bool {
    let (rounding, dependent) = (20.0 * (a.rows() + a.cols()) as f64 * f64::EPSILON, a.rows() - factor.rank());
    let taken = factor.tolerance() * (dependent as f64).sqrt();
    let pairs = b.chunks_exact(a.rows().max(1)).zip(each(x, a.cols()));
    pairs.into_iter().all(|(b, x)| {
        let mut left = b.to_vec();
        a.add_product(-1.0, x, &mut left);
        scaled_norm(&left) <= taken * scaled_norm(x) + rounding * scaled_norm(b)
    })
}
