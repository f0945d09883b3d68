//! Sends matrix entries to the ranks that hold their rows, and assembles the equations.

use std::ops::Range;

use qless_io::chunk::CaseFiles;

use super::CaseError;
use super::blocks::NumberBlocks;
use crate::ranks::{Outbox, Ranks, real};
use crate::share::Share;

/// An entry of the file: row, column, value.
pub(super) type FileEntry = (usize, usize, f64);

/// An entry of the matrix: row, DOF, value.
type MatrixTriplet = (u64, u64, f64);

/// Sends each entry to the rank that holds its row. Returns the entries of this rank's rows, sorted by row; within a row, in the order of
/// the file. Collective.
pub(super) fn distribute(ranks: &dyn Ranks, rows: NumberBlocks, entries: Vec<FileEntry>) -> Vec<MatrixTriplet> {
    let mut post = Outbox::default();
    for (row, dof, value) in entries {
        post.to(rows.holder(row as u64)).extend([row as u64, dof as u64, value.to_bits()]);
    }
    let mut entries: Vec<_> = post.send_records(ranks).map(|(_, [row, dof, bits])| (row, dof, real(bits))).collect();
    if !entries.is_sorted_by_key(|entry| entry.0) {
        entries.sort_by_key(|entry| entry.0);
    }
    entries
}

/// Adds the equations of `rows` to the share.
pub(super) fn fill(share: &mut Share, rows: Range<u64>, entries: &[MatrixTriplet], rhs: &[f64]) {
    let mut rest = entries;
    for (row, &b) in rows.zip(rhs) {
        let (of_row, others) = rest.split_at(rest.iter().take_while(|entry| entry.0 == row).count());
        share.equation(row, of_row.iter().map(|&(_, dof, value)| (dof, value)), b);
        rest = others;
    }
}

/// Checks the sums of repeated entries; the reader has checked all other numbers.
pub(super) fn check_sums(files: &CaseFiles, share: &Share) -> Result<(), CaseError> {
    let rows = &share.rows;
    let mut all = (0..rows.len()).flat_map(|i| rows.row(i).map(move |(dof, value)| (i, dof, value)));
    let Some((i, dof, sum)) = all.find(|(_, _, value)| !value.is_finite()) else { return Ok(()) };
    // If no lines of the file explain the sum, the analysis reports it.
    files.sum_not_finite(rows.numbers[i] as usize, dof as usize, sum)?.map_or(Ok(()), |error| Err(error.into()))
}
