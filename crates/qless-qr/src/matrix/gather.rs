//! The pattern by columns, rows ascending, each place once, and where each given value goes in it: two counting sorts.

use std::borrow::Cow;

use super::{Index, Matrix};
use crate::pattern::Lists;

/// Where the given values go; `None` if they stand there already.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Gather(Option<Vec<u32>>);

impl Gather {
    /// How many values are given for so many places.
    pub fn given(&self, places: usize) -> usize {
        self.0.as_ref().map_or(places, Vec::len)
    }

    /// The values at their places; those of one place are added in the order in which they are given.
    pub fn of<'a>(&self, values: &'a [f64], places: usize) -> Cow<'a, [f64]> {
        let Some(slot) = &self.0 else { return Cow::Borrowed(values) };
        let mut gathered = vec![0.0; places];
        slot.iter().zip(values).for_each(|(&at, v)| gathered[at as usize] += v);
        Cow::Owned(gathered)
    }
}

impl<P: Index, I: Index> Matrix<'_, P, I> {
    pub(super) fn by_ascending_columns(&self) -> (Lists, Gather) {
        if !self.is_by_rows && self.ascends() {
            let start = self.start.iter().map(|at| at.position()).collect();
            let index = self.index.iter().map(|i| i.position() as u32).collect();
            return (Lists { start, index }, Gather(None));
        }
        let (row, column) = self.places();
        let by_row = if self.is_by_rows {
            (0..row.len() as u32).collect()
        } else {
            sorted(&row, self.rows, 0..row.len() as u32)
        };
        let order = sorted(&column, self.cols, by_row.into_iter());
        let (mut lists, mut slot) = (Lists::new(), vec![0; row.len()]);
        let mut last = None;
        for entry in order.into_iter().map(|entry| entry as usize) {
            while lists.len() < column[entry] as usize {
                lists.close();
            }
            if last != Some((row[entry], column[entry])) {
                last = Some((row[entry], column[entry]));
                lists.index.push(row[entry]);
            }
            slot[entry] = lists.index.len() as u32 - 1;
        }
        while lists.len() < self.cols {
            lists.close();
        }
        (lists, Gather(Some(slot)))
    }

    /// Whether no list has two entries of one place or out of order.
    fn ascends(&self) -> bool {
        let ascends = |list: &[I]| list.windows(2).all(|pair| pair[0].position() < pair[1].position());
        (0..self.lists()).all(|k| ascends(&self.index[self.list(k)]))
    }

    /// Row and column of each entry.
    fn places(&self) -> (Vec<u32>, Vec<u32>) {
        let minor = self.index.iter().map(|i| i.position() as u32).collect();
        let major = (0..self.lists()).flat_map(|k| self.list(k).map(move |_| k as u32)).collect();
        if self.is_by_rows { (major, minor) } else { (minor, major) }
    }
}

/// Entries in the order of their keys, equal ones as they come.
fn sorted(key: &[u32], keys: usize, entries: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut next = vec![0_usize; keys + 1];
    key.iter().for_each(|&k| next[k as usize + 1] += 1);
    (0..keys).for_each(|k| next[k + 1] += next[k]);
    let mut order = vec![0; key.len()];
    for entry in entries {
        let at = &mut next[key[entry as usize] as usize];
        order[*at] = entry;
        *at += 1;
    }
    order
}
