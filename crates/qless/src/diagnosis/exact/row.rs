//! A sparse row of residues, to which a multiple of a short row is added without a copy of the row.

use std::cmp::Ordering;

use super::field::Field;

/// An entry of a row, as `(column, residue)`.
pub(in crate::diagnosis) type ModularEntry = (u32, u64);

/// If a row is this many times longer than the row added to it, a binary search for each added column is cheaper than merging both rows.
const LONG: usize = 8;

/// A change of the pattern of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::diagnosis) enum Change {
    Appeared,
    Vanished,
}

/// A sparse row. Cancelled coefficients stay as zeros, and new ones are stored separately, until there are many of either.
#[derive(Clone, Debug, Default)]
pub(in crate::diagnosis) struct ModularRow {
    /// Older coefficients, ascending by column; zeros are cancelled ones.
    entries: Vec<ModularEntry>,
    /// Newer coefficients, ascending by column; their columns are not in `entries`.
    late: Vec<ModularEntry>,
    /// Number of coefficients that are not zero.
    live: usize,
}

impl ModularRow {
    /// A row with these entries, which must ascend by column and must not be 0.
    pub(in crate::diagnosis) fn new(entries: Vec<ModularEntry>) -> Self {
        Self { live: entries.len(), entries, late: Vec::new() }
    }

    /// Number of coefficients that are not zero.
    pub(in crate::diagnosis) fn len(&self) -> usize {
        self.live
    }

    /// Number of entries for which memory is allocated.
    pub(in crate::diagnosis) fn room(&self) -> usize {
        self.entries.capacity() + self.late.capacity()
    }

    /// The columns of coefficients that are not zero.
    pub(in crate::diagnosis) fn columns(&self) -> impl Iterator<Item = u32> + '_ {
        self.entries.iter().chain(&self.late).filter(|entry| entry.1 != 0).map(|entry| entry.0)
    }

    /// The coefficient of a column, if it is not zero.
    pub(in crate::diagnosis) fn get(&self, col: u32) -> Option<u64> {
        let find = |list: &[ModularEntry]| list.binary_search_by_key(&col, |entry| entry.0).ok().map(|k| list[k].1);
        find(&self.entries).or_else(|| find(&self.late)).filter(|&value| value != 0)
    }

    /// The row as one list, ascending by column.
    pub(in crate::diagnosis) fn into_entries(mut self) -> Vec<ModularEntry> {
        self.settle();
        self.entries
    }

    /// Adds `factor pivot` to the row; calls `changed` for coefficients that appear or vanish.
    pub(in crate::diagnosis) fn add(
        &mut self,
        field: &Field,
        factor: u64,
        pivot: &[ModularEntry],
        mut changed: impl FnMut(u32, Change),
    ) {
        if pivot.len() * LONG < self.entries.len() {
            for &(col, value) in pivot {
                self.add_one(field, col, field.mul(factor, value), &mut changed);
            }
            let zeros = self.entries.len() + self.late.len() - self.live;
            if self.late.len() * self.late.len() > 16 * self.entries.len() || 2 * zeros > self.entries.len() {
                self.settle();
            }
        } else {
            self.merge(field, factor, pivot, &mut changed);
        }
    }

    fn add_one(&mut self, field: &Field, col: u32, change: u64, changed: &mut impl FnMut(u32, Change)) {
        let list = match self.entries.binary_search_by_key(&col, |entry| entry.0) {
            Ok(k) => &mut self.entries[k].1,
            Err(_) => match self.late.binary_search_by_key(&col, |entry| entry.0) {
                Ok(k) => &mut self.late[k].1,
                Err(k) => {
                    self.late.insert(k, (col, 0));
                    &mut self.late[k].1
                }
            },
        };
        let before = std::mem::replace(list, field.add(*list, change));
        match (before, *list) {
            (0, _) => (self.live += 1, changed(col, Change::Appeared)).1,
            (_, 0) => (self.live -= 1, changed(col, Change::Vanished)).1,
            _ => {}
        }
    }

    fn merge(&mut self, field: &Field, factor: u64, pivot: &[ModularEntry], changed: &mut impl FnMut(u32, Change)) {
        self.settle();
        let old = std::mem::take(&mut self.entries);
        let mut sum = Vec::with_capacity(old.len() + pivot.len());
        let mut left = old.iter().peekable();
        for &(col, value) in pivot {
            while let Some(&entry) = left.next_if(|entry| entry.0 < col) {
                sum.push(entry);
            }
            let change = field.mul(factor, value);
            match left.next_if(|entry| entry.0 == col).map(|entry| field.add(entry.1, change)) {
                None => (sum.push((col, change)), changed(col, Change::Appeared)).1,
                Some(0) => changed(col, Change::Vanished),
                Some(value) => sum.push((col, value)),
            }
        }
        sum.extend(left);
        *self = Self::new(sum);
    }

    /// Drops zeros and puts all entries in one list.
    fn settle(&mut self) {
        if self.live == self.entries.len() && self.late.is_empty() {
            return;
        }
        let mut all = Vec::with_capacity(self.live);
        let mut late = std::mem::take(&mut self.late).into_iter().filter(|entry| entry.1 != 0).peekable();
        for &entry in self.entries.iter().filter(|entry| entry.1 != 0) {
            while let Some(before) = late.next_if(|other| other.0.cmp(&entry.0) == Ordering::Less) {
                all.push(before);
            }
            all.push(entry);
        }
        all.extend(late);
        self.entries = all;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::common::random::randoms;
    use crate::diagnosis::exact::prime;

    /// Adds short and long rows in random order, and compares with a map.
    #[test]
    fn sums_are_those_of_a_map() {
        let field = Field::new(prime::two(1)[0]);
        let mut random = randoms(8).map(|x| ((x - 0.5) * 1e9) as usize);
        let mut below = move |n: usize| random.next().expect("endless") % n;
        for _ in 0..40 {
            let (mut row, mut map) = (ModularRow::default(), BTreeMap::new());
            for _ in 0..200 {
                let length = if below(10) == 0 { 300 } else { 1 + below(6) };
                // Few values, so that sums cancel often.
                let pivot: BTreeMap<u32, u64> =
                    (0..length).map(|_| (below(500) as u32, field.of(1 + below(2) as u64))).collect();
                let pivot: Vec<ModularEntry> = pivot.into_iter().collect();
                let factor = [field.of(1), field.negative(field.of(1))][below(2)];
                let (before, mut changes) = (row.len() as isize, 0);
                row.add(&field, factor, &pivot, |_, change| changes += if change == Change::Appeared { 1 } else { -1 });
                for (col, value) in pivot {
                    let sum = field.add(map.remove(&col).unwrap_or(0), field.mul(factor, value));
                    if sum != 0 {
                        map.insert(col, sum);
                    }
                }
                assert_eq!((row.len(), row.len() as isize), (map.len(), before + changes));
                assert!(map.iter().all(|(&col, &value)| row.get(col) == Some(value)));
                assert!(row.room() >= row.len());
            }
            assert_eq!(row.columns().count(), map.len());
            assert_eq!(row.into_entries(), map.into_iter().collect::<Vec<_>>());
        }
    }
}
