//! sprs: `CsMat<f64>`, compressed rows or columns.

use sprs::CsMat;

use super::from_rows;
use crate::{Csr, SystemError};

impl From<&Csr> for CsMat<f64> {
    /// A matrix with the same entries, compressed by rows.
    fn from(matrix: &Csr) -> Self {
        let columns = matrix.col.iter().map(|&j| j as usize).collect();
        Self::new((matrix.rows(), matrix.cols), matrix.start.clone(), columns, matrix.val.clone())
    }
}

impl TryFrom<&CsMat<f64>> for Csr {
    type Error = SystemError;

    /// A matrix with the same entries; the given one may be compressed by rows or by columns.
    fn try_from(matrix: &CsMat<f64>) -> Result<Self, SystemError> {
        if matrix.is_csc() {
            return Self::try_from(&matrix.to_csr());
        }
        let row = |row: sprs::CsVecView<'_, f64>| row.iter().map(|(j, &v)| (j, v)).collect::<Vec<_>>().into_iter();
        from_rows(matrix.cols(), matrix.outer_iterator().map(row))
    }
}
