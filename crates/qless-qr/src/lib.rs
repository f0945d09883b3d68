//! Sparse QR, `A P = Q R`, of an m x n matrix of any shape and rank: least squares, minimum-norm solutions, rank.
//!
//! The method is multifrontal Householder QR (Matstoms 1994; Puglisi 1993; Davis 2011). The columns are ordered for little
//! fill. Consecutive columns with nearly the same pattern form a front: a small dense matrix of its rows of A and of the
//! contributions of its children. Eliminating its pivotal columns gives rows of R; the upper trapezoidal remainder is the
//! contribution to the parent. A pivotal column is dependent if the norm of its remaining part is at most the tolerance
//! (Heath 1982): that part is treated as zero, and the column moves behind all others.
//!
//! | task | call |
//! | --- | --- |
//! | square `A x = b` | [`solve`](solve()) |
//! | minimise `|A x - b|` | [`least_squares`] |
//! | the shortest such x | [`minimum_norm`] |
//! | the same pattern again | [`Matrix::analyse`], then [`Symbolic::factor`] for each set of values |
//! | the same matrix again | [`Options::keep_q`], then [`Factor::solve`]; without Q [`Factor::solve_seminormal`] |
//! | full accuracy | [`Options::refinements`] or [`Factor::refine`] |
//! | rank and condition | [`Factor::rank`], [`Factor::condition`], [`Factor::smallest_singular_value`] |
//!
//! R and `Q^T B` are always kept, Q only on request, because it costs memory.
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

mod error;
mod factor;
mod lists;
mod matrix;
mod numeric;
mod options;
mod reflections;
mod solve;
mod staircase;
mod symbolic;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub use error::Error;
pub use factor::{Factor, FactorParts, SparseRows};
pub use matrix::{Index, Matrix};
pub use options::{Options, Tolerance};
pub use solve::{CompleteFactor, Solution, least_squares, minimum_norm, solve};
pub use symbolic::Symbolic;
