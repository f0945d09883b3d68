//! Sparse elimination on residues, `row_k -= (a_kc / a_rc) row_r`. The pivot is in the shortest row r and its rarest column c (Markowitz
//! 1957).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::ExactError;
use super::field::Field;
use super::row::{Change, ModularEntry, ModularRow};

/// The result of an elimination, as row numbers in the given order.
pub(in crate::diagnosis) struct Eliminated {
    /// Rows that served as pivots: as many as the rank.
    pub(in crate::diagnosis) pivots: Vec<u32>,
    /// Rows that become `0 = c` with a nonzero c.
    pub(in crate::diagnosis) contradicting: Vec<u32>,
}

/// Eliminates `cols` columns of rows with right-hand sides. The rows may hold at most `limit` coefficients at a time.
pub(in crate::diagnosis) fn eliminate(
    field: Field,
    rows: Vec<Vec<ModularEntry>>,
    rhs: Vec<u64>,
    cols: usize,
    limit: usize,
) -> Result<Eliminated, ExactError> {
    let mut work = EliminateWork::new(field, rows, rhs, cols, limit);
    let mut is_pivot = vec![false; work.rows.len()];
    let mut pivots = Vec::new();
    work.check_fill()?;
    while let Some((row, col)) = work.pivot() {
        work.eliminate(row, col)?;
        is_pivot[row as usize] = true;
        pivots.push(row);
    }
    let contradicts = |&i: &u32| !is_pivot[i as usize] && work.rhs[i as usize] != 0;
    let contradicting = (0..work.rows.len() as u32).filter(contradicts).collect();
    Ok(Eliminated { pivots, contradicting })
}

struct EliminateWork {
    field: Field,
    /// Remaining rows; a row that served as pivot is empty.
    rows: Vec<ModularRow>,
    rhs: Vec<u64>,
    /// For each column, the rows that hold or once held it.
    holders: Vec<Vec<u32>>,
    /// Number of remaining rows that hold each column.
    count: Vec<u32>,
    /// Columns that had one row when they were added here.
    singletons: Vec<u32>,
    /// Rows with their lengths when they were added here, as `(length, row)`, shortest first.
    short: BinaryHeap<Reverse<(usize, u32)>>,
    /// Number of entries for which the rows have capacity. The next field is the number of entries in `holders`.
    room: usize,
    listed: usize,
    limit: usize,
}

impl EliminateWork {
    fn new(field: Field, rows: Vec<Vec<ModularEntry>>, rhs: Vec<u64>, cols: usize, limit: usize) -> Self {
        let mut holders = vec![Vec::new(); cols];
        for (i, row) in rows.iter().enumerate() {
            row.iter().for_each(|&(j, _)| holders[j as usize].push(i as u32));
        }
        let count: Vec<u32> = holders.iter().map(|rows| rows.len() as u32).collect();
        let singletons = (0..cols as u32).filter(|&j| count[j as usize] == 1).collect();
        let short = rows.iter().enumerate().map(|(i, row)| Reverse((row.len(), i as u32))).collect();
        let rows: Vec<ModularRow> = rows.into_iter().map(ModularRow::new).collect();
        let room = rows.iter().map(ModularRow::room).sum();
        let listed = holders.iter().map(Vec::len).sum();
        Self { field, rows, rhs, holders, count, singletons, short, room, listed, limit }
    }

    /// A column with one row, else the rarest column of the shortest row; None if all rows are empty.
    fn pivot(&mut self) -> Option<(u32, u32)> {
        while let Some(col) = self.singletons.pop() {
            if self.count[col as usize] == 1 {
                let holds = |&&i: &&u32| self.rows[i as usize].get(col).is_some();
                return self.holders[col as usize].iter().find(holds).map(|&row| (row, col));
            }
        }
        while let Some(Reverse((length, row))) = self.short.pop() {
            let entries = &self.rows[row as usize];
            if length > 0 && entries.len() == length {
                let rarest = entries.columns().min_by_key(|&j| (self.count[j as usize], j));
                return rarest.map(|col| (row, col));
            }
        }
        None
    }

    /// Eliminates the column from all other rows, and removes the pivot row.
    fn eliminate(&mut self, row: u32, col: u32) -> Result<(), ExactError> {
        let Some(value) = self.rows[row as usize].get(col) else { return Ok(()) };
        let pivot = std::mem::take(&mut self.rows[row as usize]);
        self.room -= pivot.room();
        let pivot = pivot.into_entries();
        for &(j, _) in &pivot {
            self.release(j);
        }
        let holders = std::mem::take(&mut self.holders[col as usize]);
        self.listed -= holders.len();
        if self.count[col as usize] == 0 {
            return Ok(());
        }
        let inverse = self.field.inverse(value);
        for other in holders {
            if let Some(value) = self.rows[other as usize].get(col) {
                let factor = self.field.negative(self.field.mul(value, inverse));
                self.add_multiple(other, factor, &pivot, row);
                self.check_fill()?;
            }
        }
        Ok(())
    }

    /// Adds `factor pivot` to row `target`, with the right-hand side of the pivot row.
    fn add_multiple(&mut self, target: u32, factor: u64, pivot: &[ModularEntry], pivot_row: u32) {
        let mut sum = std::mem::take(&mut self.rows[target as usize]);
        self.room -= sum.room();
        let field = self.field;
        sum.add(&field, factor, pivot, |col, change| match change {
            Change::Appeared => self.hold(col, target),
            Change::Vanished => self.release(col),
        });
        self.room += sum.room();
        self.short.push(Reverse((sum.len(), target)));
        self.rows[target as usize] = sum;
        let change = field.mul(factor, self.rhs[pivot_row as usize]);
        self.rhs[target as usize] = field.add(self.rhs[target as usize], change);
    }

    fn release(&mut self, col: u32) {
        self.count[col as usize] -= 1;
        if self.count[col as usize] == 1 {
            self.singletons.push(col);
        }
    }

    fn hold(&mut self, col: u32, row: u32) {
        self.count[col as usize] += 1;
        self.holders[col as usize].push(row);
        self.listed += 1;
    }

    fn check_fill(&self) -> Result<(), ExactError> {
        let fill = self.room.max(self.listed);
        let refused = ExactError::Fill { rows: self.rows.len(), fill, limit: self.limit };
        if fill > self.limit { Err(refused) } else { Ok(()) }
    }
}
