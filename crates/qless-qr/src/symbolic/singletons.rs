//! `P_r A P_c = [R11 R12; 0 S]`: singleton columns become rows of R at no cost (Davis 2011, Sec. 2.1).
//!
//! A singleton is a column with one entry among the remaining rows. Peeling it removes its row too, which may make
//! singletons of other columns; a queue holds them. R11 is upper triangular in the order of peeling.

use super::fronts::{Fronts, outer_columns};
use super::{Forecast, Symbolic, tree};
use crate::lists::{Lists, NONE};
use crate::matrix::Gather;

/// Pairs (column, row) of the singletons, in the order of peeling. A column is peeled only if `may` accepts its remaining entry: every
/// entry if only the pattern is analysed, those above the tolerance if values are known.
pub(super) fn peel(columns: &Lists, rows: &Lists, may: &dyn Fn(usize) -> bool) -> Vec<(u32, u32)> {
    let mut remaining: Vec<u32> = (0..columns.len()).map(|j| columns.list(j).len() as u32).collect();
    let mut taken = vec![false; rows.len()];
    let mut queue: Vec<u32> = (0..columns.len() as u32).filter(|&j| remaining[j as usize] == 1).collect();
    let mut pairs = Vec::new();
    let mut at = 0;
    while at < queue.len() {
        let column = queue[at];
        at += 1;
        let range = columns.start[column as usize]..columns.start[column as usize + 1];
        let entry = range.into_iter().find(|&entry| !taken[columns.index[entry] as usize]);
        let Some(entry) = entry.filter(|&entry| may(entry)) else { continue };
        let row = columns.index[entry];
        taken[row as usize] = true;
        pairs.push((column, row));
        for &other in rows.list(row as usize) {
            remaining[other as usize] -= 1;
            if remaining[other as usize] == 1 {
                queue.push(other);
            }
        }
    }
    pairs
}

/// S, the matrix without its peeled rows and columns.
pub(super) struct UnpeeledMatrix {
    /// Number of rows of S.
    pub rows: usize,
    /// Pattern of S by columns, with renumbered rows.
    pub columns: Lists,
    /// For each column of S, the same column of A.
    column: Vec<u32>,
    /// Columns of A whose entries all lie in peeled rows; the pattern alone makes them dependent.
    void: Vec<u32>,
}

impl UnpeeledMatrix {
    pub fn new(columns: &Lists, rows: &Lists, peeled: &[(u32, u32)]) -> Self {
        let mut number = vec![0; rows.len()];
        let mut kept = vec![true; columns.len()];
        for &(column, row) in peeled {
            kept[column as usize] = false;
            number[row as usize] = NONE;
        }
        let mut count = 0;
        for at in number.iter_mut().filter(|at| **at != NONE) {
            *at = count;
            count += 1;
        }
        let (mut remaining, mut column, mut void) = (Lists::new(), Vec::new(), Vec::new());
        for j in (0..columns.len()).filter(|&j| kept[j]) {
            let before = remaining.index.len();
            remaining.index.extend(columns.list(j).iter().map(|&i| number[i as usize]).filter(|&i| i != NONE));
            if remaining.index.len() == before {
                void.push(j as u32);
            } else {
                column.push(j as u32);
                remaining.close();
            }
        }
        Self { rows: count as usize, columns: remaining, column, void }
    }

    /// The analysis for a column order of S, the matrix without peeled rows and columns. The columns are then sorted into a postorder of
    /// their elimination tree.
    pub fn symbolic(&self, columns: &Lists, row_count: usize, peeled: &[(u32, u32)], order: &[u32]) -> Symbolic {
        let parent = tree::parents(&self.columns, self.rows, order);
        let post = tree::postorder(&parent);
        let parent = tree::renumbered(&parent, &post);
        let head = peeled.iter().map(|&(column, _)| column);
        let tail = post.iter().map(|&k| self.column[order[k as usize] as usize]);
        let order: Vec<u32> = head.chain(tail).chain(self.void.iter().copied()).collect();
        let permuted = Permuted::new(columns, row_count, peeled, &order);
        let count = tree::row_counts(&parent, &permuted.rest(peeled.len()));
        let fronts = Fronts::new(&parent, &count, peeled.len());
        let row = permuted.front_rows(&fronts, peeled.len());
        let outer = outer_columns(&fronts, &permuted.pattern, &row, columns.len());
        let (forecast, gather) = (Forecast::default(), Gather::default());
        let Permuted { row_order, pattern, entry } = permuted;
        let (rows, cols, peeled) = (row_count, columns.len(), peeled.len());
        let mut symbolic =
            Symbolic { rows, cols, order, peeled, row_order, pattern, entry, fronts, row, outer, forecast, gather };
        symbolic.forecast = Forecast::new(&symbolic);
        symbolic
    }
}

/// A by rows, permuted: peeled rows, then by first column, so that the rows of each front are consecutive.
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

    /// Rows of S, the matrix without peeled rows and columns; its columns are counted from the first that was not peeled.
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

/// The order of the rows: peeled rows, then the others by first column, empty rows last.
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
