//! nalgebra-sparse: `CsrMatrix<f64>` and `CscMatrix<f64>`.

use nalgebra_sparse::{CscMatrix, CsrMatrix};

use super::from_rows;
use crate::{Csr, SystemError};

impl From<&Csr> for CsrMatrix<f64> {
    /// A matrix with the same entries.
    fn from(matrix: &Csr) -> Self {
        let columns = matrix.col.iter().map(|&j| j as usize).collect();
        let parts =
            Self::try_from_csr_data(matrix.rows(), matrix.cols, matrix.start.clone(), columns, matrix.val.clone());
        parts.expect("columns of a Csr ascend within its width")
    }
}

impl TryFrom<&CsrMatrix<f64>> for Csr {
    type Error = SystemError;

    /// A matrix with the same entries.
    fn try_from(matrix: &CsrMatrix<f64>) -> Result<Self, SystemError> {
        let rows = matrix.row_iter().map(|row| {
            let entries: Vec<_> = row.col_indices().iter().copied().zip(row.values().iter().copied()).collect();
            entries.into_iter()
        });
        from_rows(matrix.ncols(), rows)
    }
}

impl TryFrom<&CscMatrix<f64>> for Csr {
    type Error = SystemError;

    /// A matrix with the same entries, compressed by rows.
    fn try_from(matrix: &CscMatrix<f64>) -> Result<Self, SystemError> {
        Self::try_from(&CsrMatrix::from(matrix))
    }
}
