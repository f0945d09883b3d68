//! The text of each kind of file.

use std::io::{Result, Write};

use qless::Csr;

pub(super) fn matrix(out: &mut dyn Write, matrix: &Csr) -> Result<()> {
    writeln!(out, "%%MatrixMarket matrix coordinate real general")?;
    writeln!(out, "{} {} {}", matrix.rows(), matrix.cols(), matrix.nnz())?;
    for row in 0..matrix.rows() {
        for (column, value) in matrix.row(row) {
            writeln!(out, "{} {} {value:?}", row + 1, column + 1)?;
        }
    }
    Ok(())
}

pub(super) fn numbers(out: &mut dyn Write, numbers: &[f64]) -> Result<()> {
    numbers.iter().try_for_each(|number| writeln!(out, "{number:?}"))
}

pub(super) fn indices(out: &mut dyn Write, indices: &[usize]) -> Result<()> {
    indices.iter().try_for_each(|index| writeln!(out, "{}", *index as u128 + 1))
}

pub(super) fn prescribed(out: &mut dyn Write, prescribed: &[(usize, f64)]) -> Result<()> {
    writeln!(out, "# column(1-based) value")?;
    prescribed.iter().try_for_each(|(dof, value)| writeln!(out, "{} {value:?}", dof + 1))
}

pub(super) fn labels(out: &mut dyn Write, labels: &[String]) -> Result<()> {
    labels.iter().try_for_each(|label| writeln!(out, "{label}"))
}
