//! `A P = Q R` of a sparse m x n matrix of any shape and rank, and what it solves.
//!
//! Multifrontal Householder QR (Matstoms 1994; Puglisi 1993; Davis 2011): the columns are ordered for little fill,
//! consecutive columns with nearly one pattern form a front, and a front is a small dense matrix of its rows of A and of
//! what its children left over. Its pivotal columns are eliminated, which gives rows of R; what is left, upper
//! trapezoidal, waits for the parent. A pivotal column whose remaining part is at most the tolerance is dependent
//! (Heath 1982): its remaining part is treated as zero and the column goes behind all others.
//!
//! | what for | call |
//! | --- | --- |
//! | `A x = b`, square | [`solve`](solve()) |
//! | least `|A x - b|` | [`least_squares`] |
//! | the shortest such x | [`minimum_norm`] |
//! | the same pattern again | [`Matrix::analyse`], then [`Symbolic::factor`] for each set of values |
//! | the same matrix again | [`Options::keep_q`], then [`Factor::solve`]; without Q [`Factor::solve_seminormal`] |
//! | all digits | [`Options::refinements`] or [`Factor::refine`] |
//! | how good the matrix is | [`Factor::rank`], [`Factor::condition`], [`Factor::smallest_singular_value`] |
//!
//! R and `Q^T B` are always kept, Q only on request: without it, memory and time stay those of R.
//!
//! ```
//! // [1 1 0]
//! // [1 1 2] has rank 2: columns 0 and 1 are equal.
//! let (start, index, values) = ([0, 2, 4, 5], [0, 1, 0, 1, 1], [1.0, 1.0, 1.0, 1.0, 2.0]);
//! let symbolic = qless_qr::Symbolic::analyse(2, 3, &start, &index)?;
//! let factor = symbolic.factor(&values, &[3.0, 4.0], qless_qr::Options::new())?;
//! assert_eq!((factor.rank(), factor.cols()), (2, 3));
//! assert!((factor.rhs()[0].hypot(factor.rhs()[1]) - 5.0).abs() < 1e-12);
//! # Ok::<(), qless_qr::Error>(())
//! ```

mod analyse;
mod dense;
mod error;
mod factor;
mod matrix;
mod numeric;
mod options;
mod pattern;
mod q;
mod solve;
mod symbolic;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub use error::Error;
pub use factor::{Factor, Parts, Rows};
pub use matrix::{Index, Matrix};
pub use options::{Options, Tolerance};
pub use solve::{Complete, Solution, least_squares, minimum_norm, solve};
pub use symbolic::Symbolic;
