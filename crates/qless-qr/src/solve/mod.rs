//! Least-squares and minimum-norm solutions, `x = A^+ b`, from `A P = Q [R1 R2; 0 0]`.
//!
//! | stage | formula | in | out | operations beside the QR |
//! | --- | --- | --- | --- | --- |
//! | basic | `x = P [R1^{-1} (Q^T b)_1; 0]` | b, m x k | x, n x k | 2 k nnz(R1) |
//! | transposed | `x = Q [R1^{-T} (P^T c)_1; 0]` | c, n x k | x, m x k | 2 k nnz(R1) + 4 k nnz(Q) |
//! | complete | `[R1 R2]^T P2 = Q2 [R3; 0]`, `x = P Q2 [R3^{-T} P2^T (Q^T b)_1; 0]` | b, m x k | x, n x k | a second QR, n x r |
//! | seminormal | `x = P [R1^{-1} R1^{-T} (P^T A^T b)_1; 0]` | A, b | x | 4 k nnz(R1) + 4 k nnz(A), each time |
//! | refined | `[I A; A^T 0] [dr; dx] = [b - r - A x; -A^T r]` | A, b, x | x | 4 k (nnz(R1) + 2 nnz(Q)) each step |
//!
//! Basic: an x that minimises `|A x - b|` and has at most r nonzeros. Complete: the shortest x that minimises `|A x - b|`
//! (Golub, Van Loan, Sec. 5.5.3). Transposed: the shortest x that satisfies the independent equations of
//! `A^T x = c`. Wide systems are factored as `A^T` and use this stage.
//! Source: Björck, Numerical Methods for Least Squares Problems, 1996, Sec. 2.7, 2.9, 6.6.

mod by_factor;
mod refine;

pub use by_factor::CompleteFactor;

use crate::factor::columns_of;
use crate::staircase::scaled_norm;
use crate::{Error, Factor, Index, Matrix, Options};

/// Solutions for all right-hand sides, their residuals, and the rank of A.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Solution {
    /// The solutions X, n x k by columns.
    pub x: Vec<f64>,
    /// `|A x - b|` for each right-hand side.
    pub residuals: Vec<f64>,
    /// Numerical rank of A.
    pub rank: usize,
    /// Tolerance for dependent columns, as a 2-norm.
    pub tolerance: f64,
}

/// Solves `A x = b` with a square nonsingular A, for k right-hand sides by columns.
///
/// ```
/// use qless_qr::{Matrix, Options, solve};
/// let a = Matrix::by_columns(2, 2, &[0, 2, 3], &[0_u32, 1, 1], &[2.0, 1.0, 4.0])?;
/// let solution = solve(&a, &[2.0, 9.0], Options::new())?;
/// assert!((solution.x[0] - 1.0).abs() < 1e-15 && (solution.x[1] - 2.0).abs() < 1e-15);
/// # Ok::<(), qless_qr::Error>(())
/// ```
///
/// # Errors
/// [`Error::NotSquare`], [`Error::Singular`], or as [`least_squares`].
pub fn solve<P: Index, I: Index>(a: &Matrix<P, I>, b: &[f64], options: Options) -> Result<Solution, Error> {
    let (rows, cols) = (a.rows(), a.cols());
    if rows != cols {
        return Err(Error::NotSquare { rows, cols });
    }
    let solution = least_squares(a, b, options)?;
    if solution.rank < cols { Err(Error::Singular { rank: solution.rank, cols }) } else { Ok(solution) }
}

/// An x that minimises `|A x - b|`, for A of any shape and rank and k right-hand sides by columns, like `x = A\b` with
/// SuiteSparseQR. It is a basic solution: zero for dependent columns. A matrix without rows has one right-hand side.
///
/// ```
/// use qless_qr::{Matrix, Options, least_squares};
/// // The line x0 + x1 t through (0, 1), (1, 3), (2, 4).
/// let a = Matrix::by_rows(3, 2, &[0, 1, 3, 5], &[0_u32, 0, 1, 0, 1], &[1.0, 1.0, 1.0, 1.0, 2.0])?;
/// let solution = least_squares(&a, &[1.0, 3.0, 4.0], Options::new())?;
/// assert!((solution.x[0] - 7.0 / 6.0).abs() < 1e-14 && (solution.x[1] - 1.5).abs() < 1e-14);
/// assert!((solution.residuals[0] - 6.0_f64.sqrt() / 6.0).abs() < 1e-14);
/// # Ok::<(), qless_qr::Error>(())
/// ```
///
/// # Errors
/// [`Error::Length`], [`Error::TooLarge`], [`Error::Tolerance`], [`Error::NotFinite`], [`Error::Overflow`],
/// [`Error::OutOfMemory`] or [`Error::Ordering`].
pub fn least_squares<P: Index, I: Index>(a: &Matrix<P, I>, b: &[f64], options: Options) -> Result<Solution, Error> {
    columns_of(b.len(), a.rows())?;
    let options = options.keep_q(options.refinements > 0);
    let factor = a.analyse()?.factor(a.values(), b, options)?;
    let mut x = if a.rows() == 0 { vec![0.0; a.cols()] } else { factor.basic()? };
    factor.refine(a, b, &mut x, options.refinements)?;
    finished(a, b, x, &factor)
}

fn finished<P: Index, I: Index>(a: &Matrix<P, I>, b: &[f64], x: Vec<f64>, factor: &Factor) -> Result<Solution, Error> {
    let mut residual = b.to_vec();
    for (residual, x) in residual.chunks_exact_mut(a.rows().max(1)).zip(each(&x, a.cols())) {
        a.add_product(-1.0, x, residual);
    }
    let count = columns_of(b.len(), a.rows())?;
    let residuals = (0..count).map(|c| scaled_norm(&residual[c * a.rows()..(c + 1) * a.rows()])).collect();
    let (rank, tolerance) = (factor.rank(), factor.tolerance());
    Ok(Solution { x: all_finite(x)?, residuals, rank, tolerance })
}

/// The consecutive vectors of this length in x; after the last one, empty vectors follow without end.
fn each(x: &[f64], length: usize) -> impl Iterator<Item = &[f64]> {
    (0..).map(move |c| x.get(c * length..(c + 1) * length).unwrap_or_default())
}

fn all_finite(x: Vec<f64>) -> Result<Vec<f64>, Error> {
    if x.iter().all(|v| v.is_finite()) { Ok(x) } else { Err(Error::Overflow) }
}

/// An error if the matrix has another shape than the factored one.
fn same_shape<P: Index, I: Index>(a: &Matrix<P, I>, factor: &Factor) -> Result<(), Error> {
    let pairs = [("the matrix by rows", a.rows(), factor.rows()), ("the matrix by columns", a.cols(), factor.cols())];
    match pairs.into_iter().find(|&(_, found, expected)| found != expected) {
        Some((what, found, expected)) => Err(Error::Length { what, found, expected }),
        None => Ok(()),
    }
}

/// The shortest x that minimises `|A x - b|`, `x = A^+ b`, for A of any shape and rank and k right-hand sides by columns.
///
/// A tall A is factored directly, a wide A as `A^T` with Q kept. A second factorization, of `[R1 R2]^T`, is needed only if
/// the rank is not full; for a wide A, only if its dependent equations also contradict the others.
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
        refine::refine_by(a, b, &mut x, options.refinements, |b| complete.solve(b))?;
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
    if factor.rank() == a.rows() || is_consistent(a, b, &x, &factor) {
        refine::refine_by(a, b, &mut x, options.refinements, |b| factor.solve_transposed(b))?;
    } else {
        let complete = factor.complete(options.memory)?;
        x = complete.solve_transposed(b)?;
        refine::refine_by(a, b, &mut x, options.refinements, |b| complete.solve_transposed(b))?;
    }
    finished(a, b, x, &factor)
}

/// Returns true if x, a solution of the independent equations, satisfies the dependent ones to tolerance.
fn is_consistent<P: Index, I: Index>(a: &Matrix<P, I>, b: &[f64], x: &[f64], factor: &Factor) -> bool {
    let (rounding, dependent) = (20.0 * (a.rows() + a.cols()) as f64 * f64::EPSILON, a.rows() - factor.rank());
    let dropped = factor.tolerance() * (dependent as f64).sqrt();
    let pairs = b.chunks_exact(a.rows().max(1)).zip(each(x, a.cols()));
    pairs.into_iter().all(|(b, x)| {
        let mut residual = b.to_vec();
        a.add_product(-1.0, x, &mut residual);
        scaled_norm(&residual) <= dropped * scaled_norm(x) + rounding * scaled_norm(b)
    })
}
