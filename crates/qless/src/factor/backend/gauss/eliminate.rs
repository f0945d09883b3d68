//! Steps 3 and 4 of Figure 7: triangular form; dependent rows leave.

use super::ledger::Ledger;
use super::queue::Queue;
use super::row::WaitingRows;
use super::row::{GaussEntry, Pivot, largest};
use crate::Csr;
use crate::factor::backend::BackendError;

/// The augmented block `[A B]` (the paper's Step 1): A by sparse rows, B dense.
pub(super) struct GaussElimination {
    pub ledger: Ledger,
    /// Waiting rows; pivot rows, which are rows of R; empty once dropped.
    pub rows: Vec<Vec<GaussEntry>>,
    pub columns: WaitingRows,
    pub queue: Queue,
    pub right: Right,
    /// The pivots' rows and columns.
    pub pivots: Vec<(u32, u32)>,
    /// Sum of the squares of what was treated as zero in dropped rows.
    pub dropped: f64,
    /// The column read last: which waiting rows hold it, and where in the row.
    pub column: Vec<(u32, u32)>,
    /// Sum of the squares of what cancelled in each row.
    cancelled: Vec<f64>,
    pivot: Pivot,
}

/// B by rows, and the sums of squares of its dropped rows.
pub(super) struct Right {
    pub width: usize,
    pub values: Vec<f64>,
    pub rest: Vec<f64>,
}

impl GaussElimination {
    pub fn new(columns: &Csr, rhs: &[f64], mut ledger: Ledger) -> Result<Self, BackendError> {
        let (m, n) = (columns.cols, columns.rows());
        if m.max(n) >= u32::MAX as usize {
            return Err(BackendError::TooLarge { backend: "gauss", rows: m, cols: n });
        }
        let rows = rows(columns, &mut ledger)?;
        let mut queue = Queue::new(m, n, &mut ledger)?;
        // The first rows come first where lengths are equal.
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
            pivot: Pivot::new(n, &mut ledger)?,
            ledger,
        })
    }

    /// A row whose entries are all at most the tolerance goes to the bottom of the block, where rows below it still change it:
    /// it comes back if it grows, and what is left of it in the end was treated as zero.
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

    fn drop_row(&mut self, i: usize) {
        self.queue.remove(i as u32);
        let row = std::mem::take(&mut self.rows[i]);
        row.iter().for_each(|entry| self.columns.forget(entry.col));
        self.dropped += self.cancelled[i] + row.iter().map(|entry| entry.value.powi(2)).sum::<f64>();
        self.ledger.free(row);
        self.right.drop_row(i);
    }

    /// Takes the column, which has been read, out of all other waiting rows.
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

    /// `row i <- row i - factor row`, without the pivot's column.
    fn subtract(&mut self, i: u32, factor: f64, row: u32) -> Result<(), BackendError> {
        let target = &mut self.rows[i as usize];
        let cancelled = self.pivot.subtract_from(target, factor, i, &mut self.columns, &mut self.ledger)?;
        self.cancelled[i as usize] += cancelled;
        self.queue.set(i, target.len());
        self.right.subtract(i as usize, factor, row as usize);
        Ok(())
    }
}

/// A by rows.
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
