//! Rows with a DOF of their own are far from all others, and are left out.

use crate::input::numbering::Local;
use crate::input::scale::Scaling;

/// A coefficient of an own DOF counts from here on, relative to the largest of its row.
const LARGE: f64 = 0.25;
/// Times that rows are left out for DOFs which only rows left out before had shared: each costs accuracy.
const TIMES: usize = 3;

/// Those of some rows that have no large coefficient on a DOF of their own, ascending.
///
/// In a combination with difference d such a row has a factor of at most `|d| / 0.25`: what was said of the other rows holds without it.
pub(super) fn without_own(system: Local, mut rows: Vec<u32>, scaling: &Scaling) -> Vec<u32> {
    let free = |i: u32| system.row(i as usize).filter(|&(j, _)| system.free()[j]);
    let mut count = vec![0_u32; system.dofs()];
    rows.iter().for_each(|&i| free(i).for_each(|(j, _)| count[j] += 1));
    for _ in 0..TIMES {
        let size = |i: u32, (j, v): (usize, f64)| scaling.entry(i as usize, j, v).abs();
        let has_own = |i: u32| {
            let largest = free(i).map(|entry| size(i, entry)).fold(0.0, f64::max);
            free(i).any(|entry| count[entry.0] == 1 && size(i, entry) >= LARGE * largest)
        };
        let (left_out, others): (Vec<u32>, Vec<u32>) = rows.into_iter().partition(|&i| has_own(i));
        left_out.iter().for_each(|&i| free(i).for_each(|(j, _)| count[j] -= 1));
        rows = others;
    }
    rows
}
