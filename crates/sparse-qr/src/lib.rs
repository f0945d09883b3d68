//! `A P = Q R` of a sparse m x n matrix of any shape and rank; R and `Q^T B` are kept, Q never is.
//!
//! Multifrontal Householder QR (Matstoms 1994; Puglisi 1993; Davis 2011): the columns are ordered for little fill,
//! consecutive columns with nearly one pattern form a front, and a front is a small dense matrix of its rows of A and of
//! what its children left over. Its pivotal columns are eliminated, which gives rows of R; what is left, upper
//! trapezoidal, waits for the parent. A pivotal column whose remaining part is at most the tolerance is dependent
//! (Heath 1982): its remaining part is treated as zero and the column goes behind all others.
//!
//! ```
//! // [1 1 0]
//! // [1 1 2] has rank 2: columns 0 and 1 are equal.
//! let (start, index, values) = ([0, 2, 4, 5], [0, 1, 0, 1, 1], [1.0, 1.0, 1.0, 1.0, 2.0]);
//! let symbolic = qless_qr::Symbolic::analyse(2, 3, &start, &index)?;
//! let factor = symbolic.factor(&values, &[3.0, 4.0], 1e-12, 1 << 30)?;
//! assert_eq!((factor.rank, factor.order.len()), (2, 3));
//! assert!((factor.rhs[0].hypot(factor.rhs[1]) - 5.0).abs() < 1e-12);
//! # Ok::<(), qless_qr::Error>(())
//! ```

mod analyse;
mod dense;
mod error;
mod factor;
mod numeric;
mod pattern;
mod symbolic;

pub use error::Error;
pub use factor::{Factor, Rows};
pub use symbolic::Symbolic;
