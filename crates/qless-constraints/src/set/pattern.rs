//! The pattern of a sparse matrix from those of its segments, each in its own part of the arrays, in parallel.

use qless::{Csr, SystemError};
use rayon::prelude::*;

/// The arrays of the rows of one segment.
pub(super) struct Part<'a> {
    /// Entries of the rows before.
    pub first: usize,
    /// Where each row ends.
    pub end: &'a mut [usize],
    pub col: &'a mut [u32],
    /// Zeros.
    pub val: &'a mut [f64],
}

/// A matrix of n columns from segments of so many `(rows, entries)`, each written by `write`.
pub(super) fn write<S: Sync>(
    cols: usize,
    segments: &[S],
    size: impl Fn(&S) -> (usize, usize),
    write: impl Fn(&S, Part) + Sync,
) -> Result<Csr, SystemError> {
    let sum = |(rows, entries), segment| (rows + size(segment).0, entries + size(segment).1);
    let (rows, entries) = segments.iter().fold((0, 0), sum);
    let (mut start, mut col, mut val) = (vec![0; rows + 1], vec![0; entries], vec![0.0; entries]);
    let mut rest = (&mut start[1..], col.as_mut_slice(), val.as_mut_slice());
    let mut first = 0;
    let mut parts = Vec::with_capacity(segments.len());
    for segment in segments {
        let (rows, entries) = size(segment);
        let (end, own_col, own_val);
        (end, rest.0) = rest.0.split_at_mut(rows);
        (own_col, rest.1) = rest.1.split_at_mut(entries);
        (own_val, rest.2) = rest.2.split_at_mut(entries);
        parts.push((segment, Part { first, end, col: own_col, val: own_val }));
        first += entries;
    }
    parts.into_par_iter().for_each(|(segment, part)| write(segment, part));
    Csr::from_parts(cols, start, col, val)
}
