//! The pivot rows as `[R1 R2]`.

use super::eliminate::Elimination;
use crate::Csr;
use crate::qr::{BackendError, Factor};

impl Elimination {
    pub(super) fn into_factor(mut self) -> Result<Factor, BackendError> {
        let (m, n, rank) = (self.rows.len(), self.columns.len(), self.pivots.len());
        let mut place = self.ledger.filled(usize::MAX, n)?;
        self.pivots.iter().zip(0..).for_each(|(&(_, col), k)| place[col as usize] = k);
        let mut order: Vec<usize> = self.pivots.iter().map(|&(_, col)| col as usize).collect();
        for j in (0..n).filter(|&j| place[j] == usize::MAX).collect::<Vec<_>>() {
            place[j] = order.len();
            order.push(j);
        }
        let r = self.rows_of_r(&place)?;
        let width = self.right.width;
        let rows = || self.pivots.iter().map(|&(i, _)| i as usize);
        debug_assert!(rank <= m.min(n));
        Ok(Factor {
            rank,
            order,
            r,
            rhs: (0..width).flat_map(|c| rows().map(move |i| (i, c))).map(|(i, c)| self.right.values[i * width + c]).collect(),
            rest: self.right.rest.iter().map(|squares| squares.sqrt()).collect(),
            dropped: self.dropped.sqrt(),
        })
    }

    /// Column j goes to `place[j]`; each row is freed as it is copied.
    fn rows_of_r(&mut self, place: &[usize]) -> Result<Csr, BackendError> {
        let entries = self.pivots.iter().map(|&(i, _)| self.rows[i as usize].len()).sum();
        let mut r = Csr::empty(place.len());
        self.ledger.reserve(&mut r.col, entries)?;
        self.ledger.reserve(&mut r.val, entries)?;
        self.ledger.reserve(&mut r.start, self.pivots.len())?;
        for k in 0..self.pivots.len() {
            let mut row = std::mem::take(&mut self.rows[self.pivots[k].0 as usize]);
            row.sort_unstable_by_key(|entry| place[entry.col as usize]);
            r.push_row(row.iter().map(|entry| (place[entry.col as usize], entry.value)));
            self.ledger.free(row);
        }
        Ok(r)
    }
}
