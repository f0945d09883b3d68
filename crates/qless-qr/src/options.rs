//! What a factorization may be told: which columns count as dependent, how much memory it may take, whether Q stays.

use crate::Error;
use crate::dense::scaled_norm;
use crate::symbolic::Symbolic;

/// When a column is dependent: its remaining part is at most this in 2-norm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Tolerance {
    /// `20 (m + n) eps max_j |a_j|` with the 2-norms of the columns, as SuiteSparseQR does (Davis 2011, Sec. 2.4).
    #[default]
    Relative,
    /// This number times `max_j |a_j|`.
    Scaled(f64),
    /// This number.
    Absolute(f64),
}

impl Tolerance {
    /// The distance that it means for a matrix with these values; infinite where that is beyond all numbers.
    pub(crate) fn distance(self, symbolic: &Symbolic, values: &[f64]) -> Result<f64, Error> {
        let factor = match self {
            Self::Absolute(distance) => return checked(distance),
            Self::Scaled(factor) => checked(factor)?,
            Self::Relative => 20.0 * (symbolic.rows + symbolic.cols) as f64 * f64::EPSILON,
        };
        Ok(factor * largest_column(symbolic, values))
    }
}

fn checked(distance: f64) -> Result<f64, Error> {
    if distance.is_nan() || distance < 0.0 { Err(Error::Tolerance(distance)) } else { Ok(distance) }
}

/// `max_j |a_j|`, kept finite.
fn largest_column(symbolic: &Symbolic, values: &[f64]) -> f64 {
    let mut square = vec![0.0; symbolic.cols];
    for (&column, &entry) in symbolic.pattern.index.iter().zip(&symbolic.entry) {
        square[column as usize] += values[entry as usize] * values[entry as usize];
    }
    let largest = square.iter().copied().fold(0.0, f64::max);
    if largest > 1e-280 && largest < 1e280 {
        return largest.sqrt();
    }
    let mut columns = vec![Vec::new(); symbolic.cols];
    for (&column, &entry) in symbolic.pattern.index.iter().zip(&symbolic.entry) {
        columns[column as usize].push(values[entry as usize]);
    }
    columns.iter().map(|column| scaled_norm(column)).fold(0.0, f64::max).min(f64::MAX)
}

/// How to factor and to solve. Start with [`Options::new`] and change what you need.
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
    /// A relative tolerance, no limit of memory, Q not kept, no refinement.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// When a column counts as dependent.
    #[must_use]
    pub fn tolerance(self, tolerance: Tolerance) -> Self {
        Self { tolerance, ..self }
    }

    /// How many bytes one factorization may allocate.
    #[must_use]
    pub fn memory(self, memory: usize) -> Self {
        Self { memory, ..self }
    }

    /// Whether the factor keeps Q, for right-hand sides that come later.
    #[must_use]
    pub fn keep_q(self, keep_q: bool) -> Self {
        Self { keep_q, ..self }
    }

    /// Steps of iterative refinement in [`solve`](crate::solve()), [`least_squares`](crate::least_squares) and
    /// [`minimum_norm`](crate::minimum_norm); the factorizations themselves have none.
    #[must_use]
    pub fn refinements(self, refinements: usize) -> Self {
        Self { refinements, ..self }
    }
}
