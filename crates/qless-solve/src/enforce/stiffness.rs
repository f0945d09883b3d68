//! Storage of K: all entries, or one half of a symmetric matrix.

use std::borrow::Cow;

use faer::sparse::SparseColMat;
use qless::elimination::Storage;

use super::EnforceError;
use super::matrix::{entries, from_triplets};
use crate::common::SparseMatrix;

/// A stiffness matrix, and which entries are stored. `&k` alone is [`Stiffness::full`].
///
/// If K is symmetric, by declaration or by its entries, Cholesky is tried first; K may still be indefinite.
///
/// ```
/// use faer::sparse::{SparseColMat, Triplet};
/// use qless::SystemBuilder;
/// use qless_solve::enforce::{EnforceError, Problem, Stiffness};
/// // [ 2 -1]  by its lower half, as users of Cholesky hold it.
/// // [-1  2]
/// let lower = [Triplet::new(0, 0, 2.0), Triplet::new(1, 0, -1.0), Triplet::new(1, 1, 2.0)];
/// let k = SparseColMat::try_new_from_triplets(2, 2, &lower)?;
/// let system = SystemBuilder::new(2).build()?;
/// let u = Problem::new(Stiffness::lower(&k), &[3.0, 0.0], &system)?.transformation()?.u;
/// assert!((u[0] - 2.0).abs() < 1e-15 && (u[1] - 1.0).abs() < 1e-15);
/// // Not declared, it is refused rather than read as [2 0; -1 2].
/// assert!(matches!(Problem::new(&k, &[3.0, 0.0], &system), Err(EnforceError::Triangle { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Stiffness<'a> {
    matrix: &'a SparseMatrix,
    storage: Storage,
    /// Whether a triangular matrix is intended.
    triangular: bool,
}

impl<'a> Stiffness<'a> {
    /// All entries are stored; K need not be symmetric.
    pub fn full(matrix: &'a SparseColMat<usize, f64>) -> Self {
        Self { matrix, storage: Storage::Full, triangular: false }
    }

    /// K is symmetric, and entries with column <= row are stored.
    pub fn lower(matrix: &'a SparseColMat<usize, f64>) -> Self {
        Self { storage: Storage::Lower, ..Self::full(matrix) }
    }

    /// K is symmetric, and entries with column >= row are stored.
    pub fn upper(matrix: &'a SparseColMat<usize, f64>) -> Self {
        Self { storage: Storage::Upper, ..Self::full(matrix) }
    }

    /// All entries are stored, and K may be triangular: for example a chain of DOFs each of which acts on the next only.
    pub fn unsymmetric(matrix: &'a SparseColMat<usize, f64>) -> Self {
        Self { triangular: true, ..Self::full(matrix) }
    }

    pub(super) fn matrix(&self) -> &'a SparseMatrix {
        self.matrix
    }

    /// The full matrix, and whether it is declared symmetric.
    pub(super) fn whole(self) -> Result<(Cow<'a, SparseMatrix>, bool), EnforceError> {
        let is_off = |&(i, j, v): &(usize, usize, f64)| i != j && v != 0.0;
        let first = |below: bool| entries(self.matrix).filter(is_off).find(|&(i, j, _)| (i > j) == below);
        let wrong = match self.storage {
            Storage::Full => None,
            Storage::Lower => first(false),
            Storage::Upper => first(true),
        };
        if let Some((row, column, _)) = wrong {
            return Err(EnforceError::WrongHalf { row, column });
        }
        if self.storage != Storage::Full {
            return mirrored(self.matrix).map(|whole| (Cow::Owned(whole), true));
        }
        if !self.triangular && first(true).is_some() != first(false).is_some() {
            return Err(EnforceError::Triangle { lower: first(true).is_some() });
        }
        Ok((Cow::Borrowed(self.matrix), false))
    }
}

impl<'a> From<&'a SparseColMat<usize, f64>> for Stiffness<'a> {
    fn from(matrix: &'a SparseColMat<usize, f64>) -> Self {
        Self::full(matrix)
    }
}

/// The full matrix from one half.
fn mirrored(half: &SparseMatrix) -> Result<SparseMatrix, EnforceError> {
    let others = entries(half).filter(|&(i, j, _)| i != j).map(|(i, j, v)| (j, i, v));
    from_triplets(half.nrows(), half.ncols(), entries(half).chain(others))
}
