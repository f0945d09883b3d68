//! The pivot rows as `[R1 R2]`.

use super::eliminate::GaussElimination;
use crate::Csr;
use crate::factor::backend::{BackendError, Factor};

impl GaussElimination {
    pub(super) fn into_factor(mut self) -> Result<Factor, BackendError> {
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
            r.append(row.iter().map(|entry| (place[entry.col as usize], entry.value)));
            self.ledger.free(row);
        }
        Ok(r)
    }
}
