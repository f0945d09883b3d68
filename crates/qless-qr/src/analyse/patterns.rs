//! `pattern(f) = pivots(f) + union of its rows and of its children's outer columns`: what R holds whatever the values.

use super::fronts::Fronts;
use crate::pattern::Lists;

/// The outer (not pivotal) columns of every front, ascending.
///
/// `rows` are those of the fronts, front f's being `row[f]..row[f + 1]`.
pub(super) fn outer(fronts: &Fronts, rows: &Lists, row: &[u32], cols: usize) -> Lists {
    let mut outer = Lists::new();
    let mut seen = vec![u32::MAX; cols];
    for f in 0..fronts.len() {
        let end = fronts.pivot[f + 1];
        let from = outer.index.len();
        let mut add = |outer: &mut Vec<u32>, column: u32| {
            if column >= end && seen[column as usize] != f as u32 {
                seen[column as usize] = f as u32;
                outer.push(column);
            }
        };
        for i in row[f] as usize..row[f + 1] as usize {
            rows.list(i).iter().for_each(|&column| add(&mut outer.index, column));
        }
        for &child in fronts.children.list(f) {
            for at in outer.start[child as usize]..outer.start[child as usize + 1] {
                let column = outer.index[at];
                add(&mut outer.index, column);
            }
        }
        outer.index[from..].sort_unstable();
        outer.close();
    }
    outer
}
