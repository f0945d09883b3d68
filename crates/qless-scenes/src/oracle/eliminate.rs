//! `row_k -= (a_kc / a_rc) row_r`: rank by sparse elimination on residues.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Row;
use super::field::Field;

/// Rank of the matrix with these rows and `cols` columns.
pub(super) fn rank<F: Field>(rows: Vec<Row>, cols: usize) -> usize {
    let mut work = Work::new(rows, cols);
    let mut rank = 0;
    while let Some((row, col)) = work.pivot() {
        work.eliminate::<F>(row, col);
        rank += 1;
    }
    rank
}

struct Work {
    /// Remaining rows; a row that served as pivot is empty.
    rows: Vec<Row>,
    /// Rows that hold or once held each column.
    holders: Vec<Vec<u32>>,
    /// Number of remaining rows that hold each column.
    count: Vec<u32>,
    /// Columns that were down to one row when noted.
    singletons: Vec<u32>,
    /// `(length, row)` as of when noted, shortest first.
    short: BinaryHeap<Reverse<(usize, u32)>>,
}

impl Work {
    fn new(rows: Vec<Row>, cols: usize) -> Self {
        let mut holders = vec![Vec::new(); cols];
        for (i, row) in rows.iter().enumerate() {
            for &(j, _) in row {
                holders[j as usize].push(i as u32);
            }
        }
        let count: Vec<u32> = holders.iter().map(|rows| rows.len() as u32).collect();
        let singletons = (0..cols as u32).filter(|&j| count[j as usize] == 1).collect();
        let short = rows.iter().enumerate().map(|(i, row)| Reverse((row.len(), i as u32))).collect();
        Self { rows, holders, count, singletons, short }
    }

    /// A column in one row, else the rarest column of the shortest row; none when all rows are empty.
    fn pivot(&mut self) -> Option<(usize, u32)> {
        while let Some(col) = self.singletons.pop() {
            if self.count[col as usize] == 1 {
                let holder = self.holders[col as usize].iter().find(|&&i| self.entry(i, col).is_some());
                return holder.map(|&i| (i as usize, col));
            }
        }
        while let Some(Reverse((length, row))) = self.short.pop() {
            let row = row as usize;
            if length > 0 && self.rows[row].len() == length {
                let rarest = self.rows[row].iter().min_by_key(|&&(j, _)| self.count[j as usize]);
                return rarest.map(|&(col, _)| (row, col));
            }
        }
        None
    }

    fn entry(&self, row: u32, col: u32) -> Option<u64> {
        let row = &self.rows[row as usize];
        row.binary_search_by_key(&col, |&(j, _)| j).ok().map(|k| row[k].1)
    }

    /// Removes the pivot row and its column from the matrix.
    fn eliminate<F: Field>(&mut self, row: usize, col: u32) {
        let pivot_value = self.entry(row as u32, col).expect("the pivot was chosen from this row");
        let pivot = std::mem::take(&mut self.rows[row]);
        for &(j, _) in &pivot {
            self.release(j);
        }
        let inverse = F::inverse(pivot_value);
        for other in std::mem::take(&mut self.holders[col as usize]) {
            if let Some(value) = self.entry(other, col) {
                let factor = F::negative(F::mul(value, inverse));
                self.add_multiple::<F>(other, factor, &pivot, col);
            }
        }
    }

    /// `rows[target] += factor pivot`, in which column `col` cancels.
    fn add_multiple<F: Field>(&mut self, target: u32, factor: u64, pivot: &[(u32, u64)], col: u32) {
        let old = std::mem::take(&mut self.rows[target as usize]);
        let mut sum = Row::with_capacity(old.len() + pivot.len());
        let mut left = old.iter().peekable();
        for &(j, v) in pivot {
            while let Some(&entry) = left.next_if(|&&(k, _)| k < j) {
                sum.push(entry);
            }
            let (own, change) = (left.next_if(|&&(k, _)| k == j), F::mul(factor, v));
            let value = if j == col { 0 } else { own.map_or(change, |&(_, a)| F::add(a, change)) };
            match (own, value) {
                (Some(_), 0) => self.release(j),
                (None, _) => self.hold(j, target),
                _ => {}
            }
            sum.extend(Some((j, value)).filter(|_| value != 0));
        }
        sum.extend(left);
        self.short.push(Reverse((sum.len(), target)));
        self.rows[target as usize] = sum;
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
    }
}
