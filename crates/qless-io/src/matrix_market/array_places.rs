//! The rows and columns of the values of an array file, and the triangle that a symmetric file stores.

use super::header::Symmetry;
use crate::ReadError;
use crate::fault::TextFault;
use crate::lines::TextLine;
use crate::number::whole;

impl Symmetry {
    /// The first row of a column that the file stores.
    fn first_row(self, column: usize) -> usize {
        match self {
            Self::General => 0,
            Self::Symmetric => column,
            Self::Skew => column + 1,
        }
    }

    /// Number of values that an array file with these sizes stores. `None` if a size is no number, or if the result overflows.
    pub(super) fn stored(self, rows: &[u8], columns: &[u8]) -> Option<usize> {
        let (rows, columns) = (whole(rows)?, whole(columns)?);
        match self {
            Self::General => rows.checked_mul(columns),
            Self::Symmetric => Some(rows.checked_mul(rows.checked_add(1)?)? / 2),
            Self::Skew => Some(rows.checked_mul(rows.saturating_sub(1))? / 2),
        }
    }

    /// Refuses an entry outside of the stored triangle. It would be unclear whether it is the mirror image of another entry or a separate
    /// one.
    pub(super) fn check(self, line: &TextLine, row: usize, column: usize) -> Result<(), ReadError> {
        if row < self.first_row(column) {
            return Err(line.fault(TextFault::OtherTriangle { row: row + 1, column: column + 1 }));
        }
        Ok(())
    }
}

/// The rows and columns of the values of an array file, one column after the other.
#[derive(Debug)]
pub(super) struct Positions {
    rows: usize,
    symmetry: Symmetry,
    row: usize,
    column: usize,
}

impl Positions {
    /// The positions of the values that follow the first `count` values.
    pub fn after(count: usize, rows: usize, symmetry: Symmetry) -> Self {
        let mut positions = Self { rows, symmetry, row: symmetry.first_row(0), column: 0 };
        let mut left = count;
        while rows > positions.row && left >= rows - positions.row {
            left -= rows - positions.row;
            positions.column += 1;
            positions.row = symmetry.first_row(positions.column);
        }
        positions.row += left;
        positions
    }

    /// The row and column of the next value.
    pub fn next_place(&mut self) -> (usize, usize) {
        let place = (self.row, self.column);
        self.row += 1;
        if self.row >= self.rows {
            self.column += 1;
            self.row = self.symmetry.first_row(self.column);
        }
        place
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_after_any_number_are_those_of_counting() {
        for symmetry in [Symmetry::General, Symmetry::Symmetric, Symmetry::Skew] {
            for rows in 1..6_usize {
                let all: Vec<_> = (0..rows)
                    .flat_map(|column| (symmetry.first_row(column)..rows).map(move |row| (row, column)))
                    .collect();
                let size = rows.to_string();
                assert_eq!(symmetry.stored(size.as_bytes(), size.as_bytes()), Some(all.len()));
                for before in 0..all.len() {
                    let mut positions = Positions::after(before, rows, symmetry);
                    let rest: Vec<_> = (before..all.len()).map(|_| positions.next_place()).collect();
                    assert_eq!(rest, all[before..], "{symmetry:?}, {rows} rows after {before}");
                }
            }
        }
    }
}
