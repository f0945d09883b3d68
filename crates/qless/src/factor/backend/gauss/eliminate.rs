//! Steps 3 and 4 of Figure 7 of the paper: the elimination to triangular form, and the removal of dependent rows.
//!
//! A pivot is at least half the largest entry of its row, so that R is dominated by its diagonal and `R1^-1` stays small. It is at least
//! a tenth of the largest entry of its column, so that no multiplier exceeds ten. Among the entries of a row that are large enough, the
//! one in the column with the fewest waiting rows is the pivot. If the columns of the first few candidates hold much larger entries, the
//! search continues in the row of one of those: a row that became small by cancellation waits, because its relative rounding errors
//! are large.
//!
//! Measured on mortar ties and on a band of 1e5 rows: with a tenth for rows too, R1 of the band has a smallest singular value of 1e-18
//! instead of 1e-2; with 0.7 for rows, R has 1.5 times as many entries; with a hundredth for columns, ranks of ties are wrong.

use super::ledger::Ledger;
use super::queue::Queue;
use super::row::{GaussEntry, PivotRow, WaitingRows, largest};
use crate::Csr;
use crate::factor::backend::{BackendError, Factor};

/// A pivot is at least this fraction of the largest entry of its row.
const OF_ROW: f64 = 0.5;
/// A pivot is at least this fraction of the largest entry of its column.
const OF_COLUMN: f64 = 0.1;
/// Largest number of entries of a row that are tried as pivots.
const TRIED: usize = 4;

/// The order in which entries are tried as pivots: fewest waiting rows in the column first, then the larger entry, then the earlier column.
type PivotRank = (u32, u64, u32);

/// The augmented matrix `[A B]` (the paper's Step 1): the block A by sparse rows, and its right-hand sides B as a dense matrix.
pub(super) struct GaussElimination {
    ledger: Ledger,
    /// Waiting rows, and pivot rows, which are rows of the triangular factor R; a dropped row is empty.
    rows: Vec<Vec<GaussEntry>>,
    columns: WaitingRows,
    queue: Queue,
    right: Right,
    /// Row and column of each pivot.
    pivots: Vec<(u32, u32)>,
    /// Sum of the squares of the entries of dropped rows that were treated as zero.
    dropped: f64,
    /// The column that was read last: its waiting rows, and in each of them the position of the entry in this column.
    column: Vec<(u32, u32)>,
    /// For each row, the sum of the squares of the entries that cancelled.
    cancelled: Vec<f64>,
    pivot: PivotRow,
}

impl GaussElimination {
    pub fn new(columns: &Csr, rhs: &[f64], mut ledger: Ledger) -> Result<Self, BackendError> {
        let (m, n) = (columns.cols, columns.rows());
        if m.max(n) >= u32::MAX as usize {
            return Err(BackendError::TooLarge { backend: "gauss", rows: m, cols: n });
        }
        let rows = rows(columns, &mut ledger)?;
        let mut queue = Queue::new(m, n, &mut ledger)?;
        // Among rows of the same length, the queue returns the row that was added last. So rows are added in reverse order.
        (0..m).rev().for_each(|i| queue.set(i as u32, rows[i].len()));
        Ok(Self {
            rows,
            queue,
            column: ledger.empty(m)?,
            columns: WaitingRows::new(columns, &mut ledger)?,
            right: Right::new(m, rhs, &mut ledger)?,
            pivots: ledger.empty(m.min(n))?,
            dropped: 0.0,
            cancelled: ledger.filled(0.0, m)?,
            pivot: PivotRow::new(n, &mut ledger)?,
            ledger,
        })
    }

    /// A row without an entry above the tolerance moves to the bottom of the block. Later pivots still change it: it moves up again if
    /// its length changes, and is dropped if it is still small when it comes first.
    pub fn triangularize(&mut self, tolerance: f64) -> Result<(), BackendError> {
        while let Some(row) = self.queue.first() {
            if largest(&self.rows[row as usize]) > tolerance.max(0.0) {
                let (row, col) = self.choose(row);
                self.eliminate(row, col)?;
            } else if self.queue.is_last(row) {
                self.drop_row(row as usize);
            } else {
                self.queue.set_last(row);
            }
        }
        Ok(())
    }

    /// Row and column of the next pivot; the search starts in a row that is not zero. Afterwards `self.column` is the pivot's column.
    ///
    /// The loop ends because the largest entry of the row grows in every iteration.
    fn choose(&mut self, mut row: u32) -> (u32, u32) {
        loop {
            match self.choose_in(row) {
                Ok(col) => return (row, col),
                Err(other) => row = other,
            }
        }
    }

    /// A pivot column for this row, or the row to search instead: the shortest one with a much larger entry in one of the tried columns.
    fn choose_in(&mut self, row: u32) -> Result<u32, u32> {
        let bound = OF_ROW * largest(&self.rows[row as usize]);
        let (mut last, mut elsewhere) = (None, None);
        for _ in 0..TRIED {
            let Some((rank, entry)) = self.best_after(last, row, bound) else { break };
            let (most, holder) = self.largest_in(entry.col);
            if entry.value.abs() >= OF_COLUMN * most {
                return Ok(entry.col);
            }
            let other = (self.rows[holder as usize].len(), holder);
            elsewhere = Some(elsewhere.map_or(other, |best: (usize, u32)| best.min(other)));
            last = Some(rank);
        }
        Err(elsewhere.map_or(row, |(_, holder)| holder))
    }

    /// The best entry of a row that is at least `bound` and ranks after `last`.
    fn best_after(&self, last: Option<PivotRank>, row: u32, bound: f64) -> Option<(PivotRank, GaussEntry)> {
        let large = self.rows[row as usize].iter().filter(|entry| entry.value.abs() >= bound);
        let ranked = large.map(|&entry| {
            let holders = self.columns.count(entry.col);
            ((holders, !entry.value.abs().to_bits(), entry.col), entry)
        });
        ranked.filter(|(rank, _)| last.is_none_or(|last| *rank > last)).min_by_key(|&(rank, _)| rank)
    }

    /// Reads a column into `self.column`; returns the size of its largest entry and the row of that entry.
    fn largest_in(&mut self, col: u32) -> (f64, u32) {
        self.columns.read(col, &self.rows, |row| self.queue.waits(row), &mut self.column);
        let size = |&(i, place): &(u32, u32)| (self.rows[i as usize][place as usize].value.abs(), i);
        self.column.iter().map(size).fold((0.0, 0), |most, next| if next.0 > most.0 { next } else { most })
    }

    fn drop_row(&mut self, i: usize) {
        self.queue.remove(i as u32);
        let row = std::mem::take(&mut self.rows[i]);
        row.iter().for_each(|entry| self.columns.forget(entry.col));
        self.dropped += self.cancelled[i] + row.iter().map(|entry| entry.value.powi(2)).sum::<f64>();
        self.ledger.free(row);
        self.right.drop_row(i);
    }

    /// Eliminates the column that was read last from all other waiting rows.
    fn eliminate(&mut self, row: u32, col: u32) -> Result<(), BackendError> {
        self.queue.remove(row);
        self.pivots.push((row, col));
        let mut entries = std::mem::take(&mut self.rows[row as usize]);
        entries.iter().for_each(|entry| self.columns.forget(entry.col));
        let own = entries.iter().position(|entry| entry.col == col).expect("the column was chosen from this row");
        let pivot = entries.swap_remove(own);
        self.pivot.load(entries);
        let column = std::mem::take(&mut self.column);
        for &(i, place) in column.iter().filter(|&&(i, _)| i != row) {
            let factor = self.rows[i as usize].swap_remove(place as usize).value / pivot.value;
            self.subtract(i, factor, row)?;
        }
        self.column = column;
        entries = self.pivot.unload();
        entries.push(pivot);
        self.ledger.shrink(&mut entries);
        self.rows[row as usize] = entries;
        self.columns.free(col, &mut self.ledger);
        Ok(())
    }

    /// Subtracts `factor` times the pivot row from row i; the entry in the pivot's column was removed before.
    fn subtract(&mut self, i: u32, factor: f64, row: u32) -> Result<(), BackendError> {
        let target = &mut self.rows[i as usize];
        let cancelled = self.pivot.subtract_from(target, factor, i, &mut self.columns, &mut self.ledger)?;
        self.cancelled[i as usize] += cancelled;
        self.queue.set(i, target.len());
        self.right.subtract(i as usize, factor, row as usize);
        Ok(())
    }

    /// The pivot rows as the triangular factor `[R1 R2]` of the independent and the dependent columns.
    pub fn into_factor(mut self) -> Result<Factor, BackendError> {
        let (n, width) = (self.columns.len(), self.right.width);
        let mut place = self.ledger.filled(usize::MAX, n)?;
        let mut order = self.ledger.empty(n)?;
        order.extend(self.pivots.iter().map(|&(_, col)| col as usize));
        order.iter().zip(0..).for_each(|(&j, k)| place[j] = k);
        for j in 0..n {
            if place[j] == usize::MAX {
                place[j] = order.len();
                order.push(j);
            }
        }
        let r = self.rows_of_r(&place)?;
        let mut rhs = self.ledger.empty(self.pivots.len() * width)?;
        for c in 0..width {
            rhs.extend(self.pivots.iter().map(|&(i, _)| self.right.values[i as usize * width + c]));
        }
        let rest = self.right.rest.iter().map(|squares| squares.sqrt()).collect();
        Ok(Factor { rank: self.pivots.len(), order, r, rhs, rest, dropped: self.dropped.sqrt() })
    }

    /// The pivot rows as rows of the triangular factor R: column j of the block is column `place[j]` of R. Each row is freed after it is
    /// copied.
    fn rows_of_r(&mut self, place: &[usize]) -> Result<Csr, BackendError> {
        let entries = self.pivots.iter().map(|&(i, _)| self.rows[i as usize].len()).sum();
        let mut r = Csr::empty(place.len());
        self.ledger.reserve(&mut r.col, entries)?;
        self.ledger.reserve(&mut r.val, entries)?;
        self.ledger.reserve(&mut r.start, self.pivots.len())?;
        for k in 0..self.pivots.len() {
            let mut row = std::mem::take(&mut self.rows[self.pivots[k].0 as usize]);
            row.sort_unstable_by_key(|entry| place[entry.col as usize]);
            r.append(row.iter().map(|entry| (place[entry.col as usize], entry.value)));
            self.ledger.free(row);
        }
        Ok(r)
    }
}

/// The block A by rows.
fn rows(columns: &Csr, ledger: &mut Ledger) -> Result<Vec<Vec<GaussEntry>>, BackendError> {
    let mut rows: Vec<Vec<GaussEntry>> = ledger.filled(Vec::new(), columns.cols)?;
    let mut lengths = ledger.filled(0, columns.cols)?;
    columns.col.iter().for_each(|&i| lengths[i as usize] += 1);
    for (row, &length) in rows.iter_mut().zip(&lengths) {
        ledger.reserve(row, length)?;
    }
    for j in 0..columns.rows() {
        let entries = columns.row(j).filter(|&(_, v)| v != 0.0);
        entries.for_each(|(i, v)| rows[i].push(GaussEntry::new(j as u32, v)));
    }
    ledger.free(lengths);
    Ok(rows)
}

/// The right-hand sides B by rows, and for each right-hand side the sum of the squares of its entries in dropped rows.
struct Right {
    width: usize,
    values: Vec<f64>,
    rest: Vec<f64>,
}

impl Right {
    fn new(m: usize, rhs: &[f64], ledger: &mut Ledger) -> Result<Self, BackendError> {
        let width = rhs.len().checked_div(m).unwrap_or(0);
        let mut values = ledger.filled(0.0, m * width)?;
        for (c, column) in rhs.chunks_exact(m.max(1)).enumerate() {
            column.iter().enumerate().for_each(|(i, &v)| values[i * width + c] = v);
        }
        Ok(Self { width, values, rest: vec![0.0; width] })
    }

    fn subtract(&mut self, i: usize, factor: f64, pivot: usize) {
        for c in 0..self.width {
            self.values[i * self.width + c] -= factor * self.values[pivot * self.width + c];
        }
    }

    fn drop_row(&mut self, i: usize) {
        let row = &self.values[i * self.width..(i + 1) * self.width];
        self.rest.iter_mut().zip(row).for_each(|(rest, v)| *rest += v * v);
    }
}
