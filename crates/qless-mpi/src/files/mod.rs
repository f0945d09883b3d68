//! Cases in files, read by all ranks together: each takes the lines that start in its part of the bytes, and what they say goes to the
//! rank that holds the row.

mod blocks;
mod error;
mod found;
mod rows;
#[cfg(test)]
mod tests;

use std::path::Path;

use qless_io::ReadError;
use qless_io::chunk::{self, CaseFiles, ChunkedFile, ChunkedMatrix, ChunkedRhs, PrescribedLine};

use crate::error::agree;
use crate::ranks::{Outbox, Ranks, real};
use crate::share::Share;
use blocks::{FilePiece, NumberBlocks};
pub use error::CaseError;
pub use found::{Equation, Facts, Found};

/// A case, as one rank holds it: a block of rows, and the prescribed DOFs of a block of columns.
#[derive(Debug)]
pub struct Case {
    share: Share,
    files: CaseFiles,
    rows: NumberBlocks,
    dofs: NumberBlocks,
    /// Rows, columns, coefficients that are not zero, prescribed DOFs of the whole.
    counts: [u64; 4],
}

/// Reads the case that [`qless_io::read_case`] reads, in parts. Collective.
///
/// A rank holds its part of each file, and the rows that it is given; of labels only the number is checked. An equation's number is its
/// row, a DOF's its column, from 0.
///
/// ```
/// use qless_mpi::{read_case, together};
/// # let place = tempfile::tempdir()?;
/// # let folder = place.path();
/// std::fs::write(folder.join("C.mtx"), "%%MatrixMarket matrix coordinate real general\n2 2 3\n2 1 2\n1 1 1\n1 2 -1\n")?;
/// let rows = together(2, |ranks| read_case(ranks, folder, None, None).map(|case| case.share().numbers().to_vec()));
/// assert_eq!(rows, [Ok(vec![0]), Ok(vec![1])]);
///
/// std::fs::write(folder.join("C.mtx"), "%%MatrixMarket matrix coordinate real general\n2 2 2\n2 1 2\n1 1 inf\n")?;
/// let errors = together(2, |ranks| read_case(ranks, folder, None, None).unwrap_err().to_string());
/// assert!(errors.iter().all(|error| error.contains("C.mtx:4: the coefficient in row 1, column 1 is `inf`")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`CaseError`], the same on all ranks.
pub fn read_case(
    ranks: &dyn Ranks,
    path: &Path,
    rhs: Option<&Path>,
    prescribed: Option<&Path>,
) -> Result<Case, CaseError> {
    let files = agree(ranks, CaseFiles::find(path, rhs, prescribed).map_err(CaseError::from))?;
    let (matrix, entries) = read_matrix(ranks, &files.matrix)?;
    let (rows, dofs) = (matrix.rows() as u64, matrix.columns() as u64);
    let (rows, dofs, counts) = (NumberBlocks::new(ranks, rows), NumberBlocks::new(ranks, dofs), [rows, dofs, 0, 0]);
    let own = rows.of(ranks.rank());
    let entries = rows::deal(ranks, rows, entries);
    let values = match &files.rhs {
        Some(path) => read_rhs(ranks, path, rows, matrix.rows())?,
        None => vec![0.0; (own.end - own.start) as usize],
    };
    let given = match &files.prescribed {
        Some(path) => read_prescribed(ranks, path, dofs, matrix.columns())?,
        None => Vec::new(),
    };
    count_labels(ranks, files.rows.as_deref(), matrix.rows(), "row")?;
    count_labels(ranks, files.columns.as_deref(), matrix.columns(), "column")?;
    let mut share = Share::new(dofs.of(ranks.rank()));
    rows::fill(&mut share, own, &entries, &values);
    given.iter().for_each(|&(dof, value)| share.prescribe(dof as u64, value));
    agree(ranks, rows::check_sums(&files, &share))?;
    let mut of_all = [share.rows.dofs.len() as u64, given.len() as u64];
    ranks.sum(&mut of_all);
    let counts = [counts[0], counts[1], of_all[0], of_all[1]];
    Ok(Case { share, files, rows, dofs, counts })
}

fn read_matrix(ranks: &dyn Ranks, path: &Path) -> Result<(ChunkedMatrix, Vec<rows::GivenEntry>), CaseError> {
    let opened = ChunkedFile::open(path).and_then(|file| Ok((ChunkedMatrix::open(&file)?, file)));
    let (matrix, file) = agree(ranks, opened.map_err(CaseError::from))?;
    let facts = [matrix.rows() as u64, matrix.columns() as u64];
    let piece = FilePiece::read(ranks, &file, (matrix.start(), matrix.before()), &facts)?;
    let entries = agree(ranks, matrix.entries(&piece.lines, piece.before).map_err(CaseError::from))?;
    agree(ranks, matrix.check(&file, piece.total.items).map_err(CaseError::from))?;
    Ok((matrix, entries))
}

/// The right-hand sides of this rank's rows.
fn read_rhs(ranks: &dyn Ranks, path: &Path, rows: NumberBlocks, count: usize) -> Result<Vec<f64>, CaseError> {
    let opened = ChunkedFile::open(path).and_then(|file| Ok((ChunkedRhs::open(&file, count)?, file)));
    let (rhs, file) = agree(ranks, opened.map_err(CaseError::from))?;
    let piece = FilePiece::read(ranks, &file, (rhs.start(), rhs.before()), &[])?;
    let numbers = agree(ranks, rhs.numbers(&piece.lines, piece.before).map_err(CaseError::from))?;
    agree(ranks, rhs.check(&file, piece.total.items).map_err(CaseError::from))?;
    let mut post = Outbox::default();
    for (row, number) in (piece.before.items as u64..).zip(numbers) {
        post.to(rows.holder(row)).push(number.to_bits());
    }
    // Who comes first has read the rows that come first.
    Ok(post.send(ranks).into_iter().flat_map(|message| message.words).map(real).collect())
}

/// The prescribed DOFs of this rank's columns.
fn read_prescribed(
    ranks: &dyn Ranks,
    path: &Path,
    dofs: NumberBlocks,
    columns: usize,
) -> Result<Vec<(usize, f64)>, CaseError> {
    let file = agree(ranks, ChunkedFile::open(path).map_err(CaseError::from))?;
    let piece = FilePiece::read(ranks, &file, Default::default(), &[])?;
    let given = agree(ranks, chunk::prescribed_lines(&piece.lines, piece.before, columns).map_err(CaseError::from))?;
    let mut post = Outbox::default();
    for PrescribedLine { column, value, line } in given {
        let holder = dofs.holder(column as u64 - 1);
        post.to(holder).extend([column as u64, value.to_bits(), line as u64]);
    }
    let came = post.send(ranks);
    let words = came.iter().flat_map(|message| message.words.chunks_exact(3));
    let given =
        words.map(|w| PrescribedLine { column: w[0] as usize, value: real(w[1]), line: w[2] as usize }).collect();
    agree(ranks, chunk::merge_prescribed(path, given).map_err(CaseError::from))
}

/// Checks that there is one label for each row or column.
fn count_labels(ranks: &dyn Ranks, path: Option<&Path>, expected: usize, each: &'static str) -> Result<(), CaseError> {
    let Some(path) = path else { return Ok(()) };
    let file = agree(ranks, ChunkedFile::open(path).map_err(CaseError::from))?;
    let piece = FilePiece::read(ranks, &file, Default::default(), &[])?;
    let last = piece.lines.last_filled();
    let mut last = [if last > 0 { (piece.before.lines + last) as u64 } else { 0 }];
    ranks.max(&mut last);
    let counted: Result<(), ReadError> =
        chunk::check_labels(path, (piece.total.lines, last[0] as usize), expected, each);
    agree(ranks, counted.map_err(CaseError::from))
}

impl Case {
    /// What this rank gives to [`analyse`](crate::analyse).
    pub fn share(&self) -> &Share {
        &self.share
    }

    /// The files that it was read from.
    pub fn files(&self) -> &CaseFiles {
        &self.files
    }

    /// Rows of the whole.
    pub fn rows(&self) -> u64 {
        self.counts[0]
    }

    /// Columns of the whole.
    pub fn dofs(&self) -> u64 {
        self.counts[1]
    }

    /// Coefficients of the whole that are not zero.
    pub fn coefficients(&self) -> u64 {
        self.counts[2]
    }

    /// Prescribed DOFs of the whole.
    pub fn prescribed(&self) -> u64 {
        self.counts[3]
    }
}
