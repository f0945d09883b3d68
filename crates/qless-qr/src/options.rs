//! Options of a factorization: tolerance for dependent columns, memory limit, whether Q is kept, steps of refinement.

/// A column is dependent if its remaining part has at most this 2-norm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Tolerance {
    /// The norm may be at most `20 (m + n) eps max_j |a_j|` with the 2-norms of the columns, as in SuiteSparseQR (Davis 2011, Sec. 2.4).
    #[default]
    Relative,
    /// The norm may be at most this number times `max_j |a_j|`, the largest 2-norm of a column.
    Scaled(f64),
    /// The norm may be at most this number.
    Absolute(f64),
}

/// Options for factoring and solving. Start with [`Options::new`] and change what you need.
///
/// ```
/// use qless_qr::{Options, Tolerance};
/// let options = Options::new().tolerance(Tolerance::Absolute(1e-10)).memory(1 << 30).keep_q(true);
/// assert_eq!(options, options.refinements(0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    pub(crate) tolerance: Tolerance,
    pub(crate) memory: usize,
    pub(crate) keep_q: bool,
    pub(crate) refinements: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { tolerance: Tolerance::default(), memory: usize::MAX, keep_q: false, refinements: 0 }
    }
}

impl Options {
    /// Relative tolerance, no memory limit, Q not kept, no refinement.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Tolerance for dependent columns.
    #[must_use]
    pub fn tolerance(self, tolerance: Tolerance) -> Self {
        Self { tolerance, ..self }
    }

    /// Memory limit of one factorization, in bytes.
    #[must_use]
    pub fn memory(self, memory: usize) -> Self {
        Self { memory, ..self }
    }

    /// If true, the factor keeps Q, which later right-hand sides need.
    #[must_use]
    pub fn keep_q(self, keep_q: bool) -> Self {
        Self { keep_q, ..self }
    }

    /// Steps of iterative refinement in [`solve`](crate::solve()), [`least_squares`](crate::least_squares) and
    /// [`minimum_norm`](crate::minimum_norm). A factorization alone does no refinement.
    #[must_use]
    pub fn refinements(self, refinements: usize) -> Self {
        Self { refinements, ..self }
    }
}
