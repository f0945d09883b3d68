//! Reads a case with all ranks: each parses the lines that start in its block of the bytes, and sends the entries to the ranks that hold
//! their rows.

mod blocks;
mod error;
mod gather;
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
pub use gather::{Equation, Facts, GatheredFindings};

/// The portion of a case on one rank: a block of rows, and the prescribed DOFs of a block of columns.
#[derive(Debug)]
pub struct Case {
    share: Share,
    files: CaseFiles,
    rows: NumberBlocks,
    dofs: NumberBlocks,
    /// Rows, columns, nonzero coefficients and prescribed DOFs of the whole case.
    counts: [u64; 4],
}

/// Reads the same case as [`qless_io::read_case`], distributed over the ranks. Collective.
///
/// A rank reads one block of each file, and then keeps one block of rows. Labels are only counted. Equations are numbered by row and DOFs
/// by column, from 0.
///
/// ```
/// use qless_mpi::{read_case, on_threads};
/// # let place = tempfile::tempdir()?;
/// # let folder = place.path();
/// std::fs::write(folder.join("C.mtx"), "%%MatrixMarket matrix coordinate real general\n2 2 3\n2 1 2\n1 1 1\n1 2 -1\n")?;
/// let rows = on_threads(2, |ranks| read_case(ranks, folder, None, None).map(|case| case.share().numbers().to_vec()));
/// assert_eq!(rows, [Ok(vec![0]), Ok(vec![1])]);
///
/// std::fs::write(folder.join("C.mtx"), "%%MatrixMarket matrix coordinate real general\n2 2 2\n2 1 2\n1 1 inf\n")?;
/// let errors = on_threads(2, |ranks| read_case(ranks, folder, None, None).unwrap_err().to_string());
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
    let entries = rows::distribute(ranks, rows, entries);
    let values = match &files.rhs {
        Some(path) => read_rhs(ranks, path, rows, matrix.rows())?,
        None => vec![0.0; (own.end - own.start) as usize],
    };
    let prescribed = match &files.prescribed {
        Some(path) => read_prescribed(ranks, path, dofs, matrix.columns())?,
        None => Vec::new(),
    };
    count_labels(ranks, files.rows.as_deref(), matrix.rows(), "row")?;
    count_labels(ranks, files.columns.as_deref(), matrix.columns(), "column")?;
    let mut share = Share::new(dofs.of(ranks.rank()));
    rows::fill(&mut share, own, &entries, &values);
    prescribed.iter().for_each(|&(dof, value)| share.prescribe(dof as u64, value));
    agree(ranks, rows::check_sums(&files, &share))?;
    let mut of_all = [share.rows.dofs.len() as u64, prescribed.len() as u64];
    ranks.sum(&mut of_all);
    let counts = [counts[0], counts[1], of_all[0], of_all[1]];
    Ok(Case { share, files, rows, dofs, counts })
}

fn read_matrix(ranks: &dyn Ranks, path: &Path) -> Result<(ChunkedMatrix, Vec<rows::FileEntry>), CaseError> {
    let opened = ChunkedFile::open(path).and_then(|file| Ok((ChunkedMatrix::open(&file)?, file)));
    let (matrix, file) = agree(ranks, opened.map_err(CaseError::from))?;
    let facts = [matrix.rows() as u64, matrix.columns() as u64];
    let piece = FilePiece::read(ranks, &file, (matrix.start(), matrix.before()), &facts)?;
    let entries = agree(ranks, matrix.entries(&piece.lines, piece.before).map_err(CaseError::from))?;
    agree(ranks, matrix.check(&file, piece.total.items).map_err(CaseError::from))?;
    Ok((matrix, entries))
}

/// Reads the right-hand sides of this rank's rows.
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
    // Messages ascend by rank, and ranks read consecutive rows, so the values are in the order of the rows.
    Ok(post.send_records(ranks).map(|(_, [bits])| real(bits)).collect())
}

/// Reads the prescribed DOFs among this rank's columns.
fn read_prescribed(
    ranks: &dyn Ranks,
    path: &Path,
    dofs: NumberBlocks,
    columns: usize,
) -> Result<Vec<(usize, f64)>, CaseError> {
    let file = agree(ranks, ChunkedFile::open(path).map_err(CaseError::from))?;
    let piece = FilePiece::read(ranks, &file, Default::default(), &[])?;
    let lines = agree(ranks, chunk::prescribed_lines(&piece.lines, piece.before, columns).map_err(CaseError::from))?;
    let mut post = Outbox::default();
    for PrescribedLine { column, value, line } in lines {
        let holder = dofs.holder(column as u64 - 1);
        post.to(holder).extend([column as u64, value.to_bits(), line as u64]);
    }
    let line = |(_, [column, bits, line]): (usize, [u64; 3])| PrescribedLine {
        column: column as usize,
        value: real(bits),
        line: line as usize,
    };
    let lines = post.send_records(ranks).map(line).collect();
    agree(ranks, chunk::merge_prescribed(path, lines).map_err(CaseError::from))
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
    /// The share of this rank, for [`analyse`](crate::analyse).
    pub fn share(&self) -> &Share {
        &self.share
    }

    /// The files of the case.
    pub fn files(&self) -> &CaseFiles {
        &self.files
    }

    /// Number of rows of the whole case.
    pub fn rows(&self) -> u64 {
        self.counts[0]
    }

    /// Number of columns of the whole case.
    pub fn dofs(&self) -> u64 {
        self.counts[1]
    }

    /// Number of nonzero coefficients of the whole case.
    pub fn coefficients(&self) -> u64 {
        self.counts[2]
    }

    /// Number of prescribed DOFs of the whole case.
    pub fn prescribed(&self) -> u64 {
        self.counts[3]
    }
}
