//! Groups of rows for threads of their own.

use crate::input::components::components;
use crate::input::numbering::Local;

/// Fewer rows than this are not worth a thread of their own.
const WORTH_A_GROUP: usize = 1 << 14;
/// Most groups: each looks at all DOFs once.
const MOST_GROUPS: usize = 16;

/// Rows in groups that share no free DOF, for threads of their own: whole components, in order.
pub fn groups(local: Local, rows: Vec<u32>) -> Vec<Vec<u32>> {
    let count = (rows.len() / WORTH_A_GROUP).min(MOST_GROUPS);
    if count < 2 {
        return vec![rows];
    }
    let free = |i: u32| local.parts(i as usize).0.iter().copied().filter(|&j| local.free()[j as usize]);
    let each = rows.len().div_ceil(count);
    let mut groups: Vec<Vec<u32>> = vec![Vec::new()];
    for part in components(&rows, local.dofs(), free) {
        if groups.last().is_some_and(|group| group.len() >= each) {
            groups.push(Vec::new());
        }
        groups.last_mut().into_iter().for_each(|group| group.extend(&part));
    }
    // Rows of a group are taken in their own order, whatever their components.
    groups.iter_mut().for_each(|group| group.sort_unstable());
    groups
}
