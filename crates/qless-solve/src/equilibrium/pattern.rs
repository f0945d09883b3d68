//! Where the entries of a saddle matrix are, and the symbolic part of its factors: the same as long as the same rows are kept.

use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};

/// A sparse matrix, by columns.
pub type Matrix = SparseColMat<usize, f64>;

/// Made at the first matrix, and anew for one with entries elsewhere.
#[derive(Default)]
pub struct Pattern(Option<Known>);

struct Known {
    /// `(row, column)` of each number, repetitions too.
    places: Vec<(usize, usize)>,
    columns: SymbolicSparseColMat<usize>,
    order: Argsort<usize>,
    factors: SymbolicLu<usize>,
}

impl Pattern {
    /// The matrix with these entries `(row, column, value)`, of which those in one place are summed.
    pub fn matrix(&mut self, size: usize, entries: &[(usize, usize, f64)]) -> Result<Matrix, String> {
        let places = || entries.iter().map(|&(i, j, _)| (i, j));
        let known = match self.0.take() {
            Some(known) if known.columns.ncols() == size && places().eq(known.places.iter().copied()) => known,
            _ => Known::new(size, places().collect())?,
        };
        let known = self.0.insert(known);
        let values: Vec<f64> = entries.iter().map(|&(.., v)| v).collect();
        Matrix::new_from_argsort(known.columns.clone(), &known.order, &values).map_err(|e| format!("{e:?}"))
    }

    /// The factors of a matrix with the entries of the last one.
    pub fn factors(&self, matrix: &Matrix) -> Result<Lu<usize, f64>, String> {
        let known = self.0.as_ref().ok_or("there is no matrix")?;
        Lu::try_new_with_symbolic(known.factors.clone(), matrix.as_ref()).map_err(|e| format!("{e:?}"))
    }
}

impl Known {
    fn new(size: usize, places: Vec<(usize, usize)>) -> Result<Self, String> {
        let pairs: Vec<_> = places.iter().map(|&(i, j)| Pair::new(i, j)).collect();
        let (columns, order) =
            SymbolicSparseColMat::try_new_from_indices(size, size, &pairs).map_err(|e| format!("{e:?}"))?;
        let factors = SymbolicLu::try_new(columns.as_ref()).map_err(|e| format!("{e:?}"))?;
        Ok(Self { places, columns, order, factors })
    }
}
