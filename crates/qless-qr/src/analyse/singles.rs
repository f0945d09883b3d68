//! `P A Q = [R11 R12; 0 S]`: a column with one entry among the remaining rows is a row of R, without any work.
//!
//! Peeled by a queue: taking column j with its only row i may leave other columns of row i with one entry (Davis 2011,
//! Sec. 2.1). R11 is upper triangular in the order of peeling. Whether its diagonal is above the tolerance is known only
//! when there are values; then `may` says which entries of A can be diagonal.

use crate::pattern::Lists;

/// Pairs (column, row) in the order of peeling.
pub(super) fn peel(columns: &Lists, rows: &Lists, may: &dyn Fn(usize) -> bool) -> Vec<(u32, u32)> {
    let mut left: Vec<u32> = (0..columns.len()).map(|j| columns.list(j).len() as u32).collect();
    let mut taken = vec![false; rows.len()];
    let mut queue: Vec<u32> = (0..columns.len() as u32).filter(|&j| left[j as usize] == 1).collect();
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
            left[other as usize] -= 1;
            if left[other as usize] == 1 {
                queue.push(other);
            }
        }
    }
    pairs
}
