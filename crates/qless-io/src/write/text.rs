//! The text of matrices, numbers and indices. Numbers have the fewest digits that read back as the same 64-bit float.

use std::io::{self, Write};

use qless::Csr;

/// Writes a matrix as a Matrix Market file, `coordinate real general`.
pub(super) fn matrix(out: &mut dyn Write, matrix: &Csr) -> io::Result<()> {
    writeln!(out, "%%MatrixMarket matrix coordinate real general")?;
    writeln!(out, "{} {} {}", matrix.rows(), matrix.cols(), matrix.nnz())?;
    for row in 0..matrix.rows() {
        for (column, value) in matrix.row(row) {
            writeln!(out, "{} {} {value:?}", row + 1, column + 1)?;
        }
    }
    Ok(())
}

pub(super) fn numbers(out: &mut dyn Write, numbers: &[f64]) -> io::Result<()> {
    numbers.iter().try_for_each(|number| writeln!(out, "{number:?}"))
}

/// Writes indices, one on each line. They count from 0 here and from 1 in the file.
pub(super) fn indices(out: &mut dyn Write, indices: &[usize]) -> io::Result<()> {
    indices.iter().try_for_each(|index| writeln!(out, "{}", *index as u128 + 1))
}

pub(super) fn prescribed(out: &mut dyn Write, prescribed: &[(usize, f64)]) -> io::Result<()> {
    writeln!(out, "# column(1-based) value")?;
    prescribed.iter().try_for_each(|(dof, value)| writeln!(out, "{} {value:?}", dof + 1))
}
