//! Replaces rows of a sparse matrix in place.

use std::ops::Range;

use super::csr::fits;
use super::{Csr, SystemError};

/// Consecutive entries that are kept: their old range and their new start.
type ReplacedRun = (Range<usize>, usize);

impl Csr {
    /// Replaces each range of rows by the rows of the matrix given with it. Ranges ascend; each matrix has n columns. Later rows move.
    ///
    /// Each array is moved once for all ranges; entries before the first range that changes its number of entries stay in place.
    ///
    /// ```
    /// use qless::Csr;
    /// let mut a = Csr::from_parts(2, vec![0, 1, 2, 4], vec![0, 1, 0, 1], vec![1.0, 2.0, 3.0, 4.0])?;
    /// let both = Csr::from_parts(2, vec![0, 2, 3], vec![0, 1, 0], vec![5.0, 6.0, 7.0])?;
    /// a.replace_rows(&[(0..1, both), (2..2, Csr::empty(2))])?;
    /// assert_eq!((a.starts(), a.values()), ([0, 2, 3, 4, 6].as_slice(), [5.0, 6.0, 7.0, 2.0, 3.0, 4.0].as_slice()));
    /// # Ok::<(), qless::SystemError>(())
    /// ```
    ///
    /// # Errors
    /// [`SystemError::BadStarts`] with the index of a range that starts before the previous range ends, ends before it starts, or ends
    /// beyond the rows; [`SystemError::WrongLength`] for another number of columns; [`SystemError::TooLarge`].
    /// The matrix is unchanged after an error.
    pub fn replace_rows(&mut self, edits: &[(Range<usize>, Self)]) -> Result<(), SystemError> {
        let mut before = 0;
        for (index, (rows, new)) in edits.iter().enumerate() {
            if rows.start < before || rows.end < rows.start || rows.end > self.rows() {
                return Err(SystemError::BadStarts { index, value: rows.start });
            }
            if new.cols != self.cols {
                let what = "the list of columns";
                return Err(SystemError::WrongLength { what, found: new.cols, expected: self.cols });
            }
            before = rows.end;
        }
        let (gone, come) = edits.iter().fold((0, 0), |(a, b), (rows, new)| (a + rows.len(), b + new.rows()));
        fits("the number of rows", self.rows() - gone + come)?;
        self.replace_checked(edits);
        Ok(())
    }

    fn replace_checked(&mut self, edits: &[(Range<usize>, Self)]) {
        let of_rows = |range: &Range<usize>| self.start[range.start]..self.start[range.end];
        let (entries, length) = runs(self.nnz(), edits.iter().map(|(rows, new)| (of_rows(rows), new.nnz())));
        let (ends, count) = runs(self.rows(), edits.iter().map(|(rows, new)| (rows.clone(), new.rows())));
        shift(&mut self.col, &entries, length);
        shift(&mut self.val, &entries, length);
        // The list holds row ends now, which move with their rows. Each end is then corrected by the distance that the entries of its row
        // moved.
        self.start.remove(0);
        shift(&mut self.start, &ends, count);
        self.start.insert(0, 0);
        for ((rows, to), (from, target)) in ends.iter().zip(&entries) {
            if from.start != *target {
                let moved = &mut self.start[to + 1..][..rows.len()];
                moved.iter_mut().for_each(|end| *end = *end - from.start + target);
            }
        }
        for (((rows, to), (from, target)), (_, new)) in ends.iter().zip(&entries).zip(edits) {
            let (row, entry) = (to + rows.len(), target + from.len());
            self.col[entry..][..new.nnz()].copy_from_slice(&new.col);
            self.val[entry..][..new.nnz()].copy_from_slice(&new.val);
            (0..new.rows()).for_each(|k| self.start[row + 1 + k] = entry + new.start[k + 1]);
        }
    }
}

/// The kept runs between the replaced ranges (one more than there are ranges), and the new length. `replaced` has each range and the length
/// of its replacement.
fn runs(length: usize, replaced: impl Iterator<Item = (Range<usize>, usize)>) -> (Vec<ReplacedRun>, usize) {
    let (mut all, mut from, mut to) = (Vec::new(), 0, 0);
    for (range, count) in replaced {
        all.push((from..range.start, to));
        to += range.start - from + count;
        from = range.end;
    }
    all.push((from..length, to));
    (all, to + length - from)
}

/// Moves the runs: first those that move towards the start, in ascending order, then those that move towards the end, in descending order.
/// So no run overwrites one that has yet to move.
fn shift<T: Copy + Default>(all: &mut Vec<T>, runs: &[ReplacedRun], length: usize) {
    all.resize(all.len().max(length), T::default());
    runs.iter().filter(|(from, to)| *to < from.start).for_each(|(from, to)| all.copy_within(from.clone(), *to));
    runs.iter().rev().filter(|(from, to)| *to > from.start).for_each(|(from, to)| all.copy_within(from.clone(), *to));
    all.truncate(length);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(seed: usize) -> Vec<(usize, f64)> {
        (0..seed * 7 % 5).map(|k| (2 * k, (seed + k) as f64)).collect()
    }

    fn matrix(rows: &[usize]) -> Csr {
        let mut all = Csr::empty(9);
        rows.iter().for_each(|&seed| all.push_row(row(seed)).expect("ascending"));
        all
    }

    /// Compares with a matrix built from the final rows: longer, shorter, empty and many replacements.
    #[test]
    fn rows_are_those_of_a_new_matrix() {
        for seed in 0..500_usize {
            let count = seed % 23;
            let mut rows: Vec<usize> = (0..count).map(|k| seed + 3 * k).collect();
            let mut found = matrix(&rows);
            let (mut edits, mut at) = (Vec::new(), seed % 3);
            while at <= count {
                let end = (at + (seed + at) % 4).min(count);
                let new: Vec<usize> = (0..(seed / 3 + at) % 5).map(|k| 1000 + seed * k + at).collect();
                edits.push((at..end, new));
                at = end + (seed / 7) % 6 + usize::from(at == end);
            }
            let given: Vec<_> = edits.iter().map(|(range, new)| (range.clone(), matrix(new))).collect();
            found.replace_rows(&given).expect("ascending");
            for (range, new) in edits.into_iter().rev() {
                rows.splice(range, new);
            }
            assert_eq!(found, matrix(&rows), "seed {seed}");
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let (mut a, whole) = (matrix(&[1, 2, 3]), matrix(&[1, 2, 3]));
        let empty = || Csr::empty(9);
        assert!(a.replace_rows(&[(1..2, empty()), (0..1, empty())]).is_err());
        assert!(a.replace_rows(&[(2..4, empty())]).is_err());
        assert!(a.replace_rows(&[(0..1, Csr::empty(8))]).is_err());
        assert_eq!(a, whole);
    }
}
