//! Sparse rows, `row <- row - factor pivot`, and the lists of rows by column.

use super::ledger::Ledger;
use crate::Csr;
use crate::factor::backend::BackendError;

/// An entry of at most `2^-50` (8.9e-16) times the largest term of its sum is rounding.
const ROUNDING_BITS: u32 = 50;
const ABSENT: u32 = u32::MAX;

/// One entry of a row; the entries of a row are not sorted.
#[derive(Clone, Copy, Debug)]
pub(super) struct GaussEntry {
    pub col: u32,
    /// Biased exponent, as f64 stores it, of the largest term that was added to `value`.
    peak: u32,
    pub value: f64,
}

impl GaussEntry {
    pub fn new(col: u32, value: f64) -> Self {
        Self { col, peak: exponent(value), value }
    }

    fn subtract(&mut self, part: f64) {
        self.peak = self.peak.max(exponent(part));
        self.value -= part;
    }

    fn is_rounding(&self) -> bool {
        self.value == 0.0 || exponent(self.value) + ROUNDING_BITS <= self.peak
    }
}

/// `floor(log2(abs(value))) + 1023`; 0 for subnormal numbers.
fn exponent(value: f64) -> u32 {
    (value.to_bits() >> 52) as u32 & 0x7ff
}

/// Size of the largest entry of a row.
pub(super) fn largest(row: &[GaussEntry]) -> f64 {
    row.iter().fold(0.0, |most, entry| most.max(entry.value.abs()))
}

/// The pivot row with the position of each column in it.
pub(super) struct PivotRow {
    pub entries: Vec<GaussEntry>,
    place: Vec<u32>,
    /// For each position in `entries`, true if the row that is being updated has an entry in the same column.
    met: Vec<bool>,
}

impl PivotRow {
    pub fn new(cols: usize, ledger: &mut Ledger) -> Result<Self, BackendError> {
        Ok(Self { entries: Vec::new(), place: ledger.filled(ABSENT, cols)?, met: ledger.filled(false, cols)? })
    }

    pub fn load(&mut self, entries: Vec<GaussEntry>) {
        entries.iter().zip(0..).for_each(|(entry, k)| self.place[entry.col as usize] = k);
        self.entries = entries;
    }

    pub fn unload(&mut self) -> Vec<GaussEntry> {
        self.entries.iter().for_each(|entry| self.place[entry.col as usize] = ABSENT);
        std::mem::take(&mut self.entries)
    }

    /// `row i <- row i - factor pivot`; returns the sum of the squares of the entries that cancelled.
    pub fn subtract_from(
        &mut self,
        row: &mut Vec<GaussEntry>,
        factor: f64,
        i: u32,
        columns: &mut WaitingRows,
        ledger: &mut Ledger,
    ) -> Result<f64, BackendError> {
        let (mut k, mut common, mut cancelled) = (0, 0, 0.0);
        while let Some(entry) = row.get_mut(k) {
            k += 1;
            let place = self.place[entry.col as usize];
            if place == ABSENT {
                continue;
            }
            common += 1;
            self.met[place as usize] = true;
            entry.subtract(factor * self.entries[place as usize].value);
            if entry.is_rounding() {
                k -= 1;
                let entry = row.swap_remove(k);
                columns.forget(entry.col);
                cancelled += entry.value.powi(2);
            }
        }
        self.fill(row, factor, i, self.entries.len() - common, columns, ledger)?;
        Ok(cancelled)
    }

    /// Appends `-factor pivot` in the `count` columns in which the row has no entry.
    fn fill(
        &mut self,
        row: &mut Vec<GaussEntry>,
        factor: f64,
        i: u32,
        count: usize,
        columns: &mut WaitingRows,
        ledger: &mut Ledger,
    ) -> Result<(), BackendError> {
        ledger.reserve(row, count)?;
        for (entry, met) in self.entries.iter().zip(&mut self.met) {
            let fill = GaussEntry::new(entry.col, -factor * entry.value);
            // A product that underflows to zero is not stored.
            if !std::mem::take(met) && fill.value != 0.0 {
                columns.add(fill.col, i, ledger)?;
                row.push(fill);
            }
        }
        Ok(())
    }
}

/// For each column the waiting rows that have an entry in it. A list may include rows that no longer have one; the count is exact.
pub(super) struct WaitingRows {
    lists: Vec<Vec<u32>>,
    count: Vec<u32>,
}

impl WaitingRows {
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

    /// Number of waiting rows with an entry in the column.
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

    /// Counts one row less in the column: the row lost its entry or no longer waits. [`WaitingRows::read`] removes such rows from the list
    /// later.
    pub fn forget(&mut self, col: u32) {
        self.count[col as usize] -= 1;
    }

    pub fn free(&mut self, col: u32, ledger: &mut Ledger) {
        ledger.free(std::mem::take(&mut self.lists[col as usize]));
    }

    /// Fills `found` with the rows that still wait and have an entry in column `col`, ascending, each with the position of that entry in
    /// the row.
    pub fn read(
        &mut self,
        col: u32,
        rows: &[Vec<GaussEntry>],
        waits: impl Fn(u32) -> bool,
        found: &mut Vec<(u32, u32)>,
    ) {
        let list = &mut self.lists[col as usize];
        list.sort_unstable();
        list.dedup();
        found.clear();
        list.retain(|&i| {
            let place = || rows[i as usize].iter().position(|entry| entry.col == col);
            let place = if waits(i) { place() } else { None };
            found.extend(place.map(|place| (i, place as u32)));
            place.is_some()
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Csr;

    fn row(entries: &[(u32, f64)]) -> Vec<GaussEntry> {
        entries.iter().map(|&(j, v)| GaussEntry::new(j, v)).collect()
    }

    #[test]
    fn entries_that_cancel_are_removed_and_the_others_stay() -> Result<(), BackendError> {
        let mut a = Csr::empty(1);
        [0.3, 1.0, 0.0, 1e100].iter().for_each(|&v| a.append([(0, v)]));
        let mut ledger = Ledger::new(&a, usize::MAX);
        let (mut columns, mut pivot) = (WaitingRows::new(&a, &mut ledger)?, PivotRow::new(4, &mut ledger)?);
        pivot.load(row(&[(0, 0.1), (1, (1.0 - 1e-14) / 3.0), (2, 2.0)]));
        let mut target = row(&[(0, 0.3), (1, 1.0), (3, 1e100)]);
        let cancelled = pivot.subtract_from(&mut target, 3.0, 0, &mut columns, &mut ledger)?;
        // Column 0: 0.3 - 3 * 0.1 is -5.6e-17 and cancels. Column 1: 1 - (1 - 1e-14) leaves a number with two digits. Column 2 fills in.
        // Column 3 is not in the pivot row.
        assert!(cancelled > 0.0 && cancelled < 1e-32, "{cancelled:e}");
        let mut left: Vec<_> = target.iter().map(|entry| (entry.col, entry.value)).collect();
        left.sort_unstable_by_key(|entry| entry.0);
        assert!((left[0].1 - 1e-14).abs() < 2e-16, "{left:?}");
        assert_eq!(left[1..], [(2, -6.0), (3, 1e100)]);
        assert_eq!([0, 1, 2, 3].map(|j| columns.count(j)), [0, 1, 1, 1]);
        Ok(())
    }

    #[test]
    fn rounding_is_measured_by_the_largest_term() -> Result<(), BackendError> {
        let mut a = Csr::empty(1);
        a.append([(0, 1.0)]);
        let mut ledger = Ledger::new(&a, usize::MAX);
        let (mut columns, mut pivot) = (WaitingRows::new(&a, &mut ledger)?, PivotRow::new(1, &mut ledger)?);
        let mut target = row(&[(0, 1.0)]);
        pivot.load(row(&[(0, 1.0)]));
        pivot.subtract_from(&mut target, 1.0 - 1e-12, 0, &mut columns, &mut ledger)?;
        assert_eq!(target.len(), 1);
        // 1e-12 has an error of 1e-16, so the 1e-16 that remains of it is rounding.
        let left = target[0].value;
        pivot.subtract_from(&mut target, left - 1e-16, 0, &mut columns, &mut ledger)?;
        assert!(target.is_empty(), "{target:?}");
        Ok(())
    }
}
