//! A by rows in their new order: peeled rows, then by first column, so that each front's rows are consecutive.

use super::fronts::Fronts;
use crate::pattern::Lists;

/// A by rows in their new order.
pub(super) struct Permuted {
    pub row_order: Vec<u32>,
    pub pattern: Lists,
    pub entry: Vec<u32>,
}

impl Permuted {
    pub fn new(columns: &Lists, row_count: usize, peeled: &[(u32, u32)], order: &[u32]) -> Self {
        let row_order = row_order(columns, row_count, peeled, order);
        let mut start = vec![0; row_count + 1];
        let mut place = vec![0; row_count];
        row_order.iter().enumerate().for_each(|(at, &i)| place[i as usize] = at);
        columns.index.iter().for_each(|&i| start[place[i as usize] + 1] += 1);
        (0..row_count).for_each(|i| start[i + 1] += start[i]);
        let (mut next, mut index) = (start.clone(), vec![0; columns.index.len()]);
        let mut entry = vec![0; columns.index.len()];
        for (position, &column) in order.iter().enumerate() {
            let column = column as usize;
            for at in columns.start[column]..columns.start[column + 1] {
                let slot = &mut next[place[columns.index[at] as usize]];
                (index[*slot], entry[*slot]) = (position as u32, at as u32);
                *slot += 1;
            }
        }
        Self { row_order, pattern: Lists { start, index }, entry }
    }

    /// Rows of S with columns counted from the first that was not peeled.
    pub fn rest(&self, peeled: usize) -> Lists {
        let from = self.pattern.start[peeled];
        let start: Vec<usize> = self.pattern.start[peeled..].iter().map(|at| at - from).collect();
        Lists { start, index: self.pattern.index[from..].iter().map(|&j| j - peeled as u32).collect() }
    }

    pub fn front_rows(&self, fronts: &Fronts, peeled: usize) -> Vec<u32> {
        let mut at = peeled;
        let mut row = Vec::with_capacity(fronts.len() + 1);
        row.push(at as u32);
        for f in 0..fronts.len() {
            let end = fronts.pivot[f + 1];
            while at < self.pattern.len() && self.pattern.list(at).first().is_some_and(|&j| j < end) {
                at += 1;
            }
            row.push(at as u32);
        }
        row
    }
}

/// Peeled rows, then the others by their first column, empty ones last.
fn row_order(columns: &Lists, row_count: usize, peeled: &[(u32, u32)], order: &[u32]) -> Vec<u32> {
    let mut seen = vec![false; row_count];
    let mut row_order: Vec<u32> = peeled.iter().map(|&(_, row)| row).collect();
    row_order.reserve_exact(row_count - peeled.len());
    row_order.iter().for_each(|&row| seen[row as usize] = true);
    for &column in &order[peeled.len()..] {
        for &row in columns.list(column as usize) {
            if !std::mem::replace(&mut seen[row as usize], true) {
                row_order.push(row);
            }
        }
    }
    row_order.extend((0..row_count as u32).filter(|&row| !seen[row as usize]));
    row_order
}
