//! Which of the waiting rows hold each column.

use super::ledger::Ledger;
use super::queue::Queue;
use super::row::Entry;
use crate::Csr;
use crate::factor::backend::BackendError;

/// Lists of rows by column, which may name too many, and how many rows are right.
pub(super) struct Columns {
    lists: Vec<Vec<u32>>,
    count: Vec<u32>,
}

impl Columns {
    pub fn new(columns: &Csr, ledger: &mut Ledger) -> Result<Self, BackendError> {
        let n = columns.rows();
        let mut all = Self { lists: ledger.filled(Vec::new(), n)?, count: ledger.filled(0, n)? };
        for j in 0..n {
            let rows = columns.row(j).filter(|&(_, v)| v != 0.0);
            ledger.reserve(&mut all.lists[j], rows.clone().count())?;
            all.lists[j].extend(rows.map(|(i, _)| i as u32));
            all.count[j] = all.lists[j].len() as u32;
        }
        Ok(all)
    }

    pub fn len(&self) -> usize {
        self.lists.len()
    }

    /// How many waiting rows hold the column.
    pub fn count(&self, col: u32) -> u32 {
        self.count[col as usize]
    }

    pub fn add(&mut self, col: u32, row: u32, ledger: &mut Ledger) -> Result<(), BackendError> {
        let list = &mut self.lists[col as usize];
        ledger.reserve(list, 1)?;
        list.push(row);
        self.count[col as usize] += 1;
        Ok(())
    }

    /// A row no longer holds the column or no longer waits; its name stays in the list until that is read.
    pub fn forget(&mut self, col: u32) {
        self.count[col as usize] -= 1;
    }

    pub fn free(&mut self, col: u32, ledger: &mut Ledger) {
        ledger.free(std::mem::take(&mut self.lists[col as usize]));
    }

    /// The waiting rows that hold the column and where in the row it stands, by ascending row.
    pub fn read(&mut self, col: u32, rows: &[Vec<Entry>], queue: &Queue, found: &mut Vec<(u32, u32)>) {
        let list = &mut self.lists[col as usize];
        list.sort_unstable();
        list.dedup();
        found.clear();
        list.retain(|&i| {
            let place = || rows[i as usize].iter().position(|entry| entry.col == col);
            let place = if queue.waits(i) { place() } else { None };
            found.extend(place.map(|place| (i, place as u32)));
            place.is_some()
        });
    }
}
