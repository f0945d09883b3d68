//! Fronts: runs of consecutive columns whose rows of R have nearly the same pattern, and the tree that they form.
//!
//! Columns j and j + 1 share a pattern if `parent(j) = j + 1` and `c_j = c_{j+1} + 1`, where c_j is the number of entries in row j of R. A
//! front is merged with its parent if the zeros that this adds to R are a small share of the merged trapezoid; the larger the trapezoid,
//! the smaller the share may be (Ashcraft, Grimes 1989).

use super::tree::first_descendants;
use crate::lists::{Lists, NONE};

/// Pairs (number of pivotal columns, largest share of zeros) for merged fronts of up to that number of pivotal columns.
const RELAXED: [(usize, f64); 3] = [(8, 0.8), (24, 0.25), (64, 0.1)];
/// Largest share of zeros for merged fronts with even more pivotal columns.
const SHARE: f64 = 0.05;
/// Merged fronts with at most this many pivotal columns may have any number of zeros.
const TINY: usize = 4;

/// The assembly tree in postorder; front f eliminates the columns `pivot[f]..pivot[f + 1]`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fronts {
    pub pivot: Vec<u32>,
    pub parent: Vec<u32>,
    pub children: Lists,
    /// First front of each subtree: the subtree is `first[f]..=f`.
    pub first: Vec<u32>,
}

impl Fronts {
    pub fn len(&self) -> usize {
        self.parent.len()
    }

    pub fn new(parent: &[u32], count: &[u32], offset: usize) -> Self {
        let starts = joined(&fundamental(parent, count), parent, count);
        let front = front_of(&starts, parent.len());
        let ends = starts.iter().skip(1).copied().chain([parent.len()]);
        let above = ends.map(|end| parent[end - 1]).map(|p| if p == NONE { NONE } else { front[p as usize] });
        let above: Vec<u32> = above.take(starts.len()).collect();
        let pivot = starts.iter().chain([&parent.len()]).map(|&at| (at + offset) as u32).collect();
        let first = first_descendants(&above);
        Self { pivot, children: children(&above), parent: above, first }
    }
}

fn children(parent: &[u32]) -> Lists {
    let mut lists = Lists::new();
    for &above in parent {
        if above != NONE {
            lists.index.push(above);
        }
        lists.close();
    }
    lists.transposed(parent.len())
}

fn front_of(starts: &[usize], n: usize) -> Vec<u32> {
    let mut front = vec![0; n];
    for (f, &start) in starts.iter().enumerate() {
        front[start..].iter_mut().take(starts.get(f + 1).unwrap_or(&n) - start).for_each(|at| *at = f as u32);
    }
    front
}

/// First column of each run of columns with the same pattern.
fn fundamental(parent: &[u32], count: &[u32]) -> Vec<usize> {
    let continues = |j: usize| j > 0 && parent[j - 1] == j as u32 && count[j - 1] == count[j] + 1;
    (0..parent.len()).filter(|&j| !continues(j)).collect()
}

/// Runs that are merged to one front: first column, number of pivotal columns, number of columns, and zeros that merging adds to R.
#[derive(Clone, Copy)]
struct FrontGroup {
    start: usize,
    pivots: usize,
    width: usize,
    zeros: f64,
}

/// First column of each front. From the last run to the first, a run is merged with the group behind it if its parent is in that group and
/// the merged front has few zeros.
fn joined(starts: &[usize], parent: &[u32], count: &[u32]) -> Vec<usize> {
    let mut groups: Vec<FrontGroup> = Vec::with_capacity(starts.len());
    let mut end = parent.len();
    for &start in starts.iter().rev() {
        let mut group = FrontGroup { start, pivots: end - start, width: count[start] as usize, zeros: 0.0 };
        let above = parent[end - 1] as usize;
        if let Some(join) =
            groups.last().filter(|next| above < next.start + next.pivots).and_then(|next| join(group, *next))
        {
            groups.pop();
            group = join;
        }
        groups.push(group);
        end = start;
    }
    groups.iter().rev().map(|group| group.start).collect()
}

fn join(child: FrontGroup, next: FrontGroup) -> Option<FrontGroup> {
    let (pivots, width) = (child.pivots + next.pivots, child.pivots + next.width);
    let zeros = child.zeros + next.zeros + child.pivots as f64 * (width - child.width) as f64;
    let size = 0.5 * pivots as f64 * (pivots + 1) as f64 + pivots as f64 * (width - pivots) as f64;
    let share = RELAXED.iter().find(|&&(most, _)| pivots <= most).map_or(SHARE, |&(_, share)| share);
    let accepted = zeros == 0.0 || pivots <= TINY || zeros < share * size;
    accepted.then_some(FrontGroup { start: child.start, pivots, width, zeros })
}

/// The outer (not pivotal) columns of each front, ascending: an upper bound of the pattern of R for any values.
///
/// `pattern(f) = pivots(f) + union of the columns of its rows and of its children's outer columns`. Front f has the rows
/// `row[f]..row[f + 1]`.
pub(super) fn outer_columns(fronts: &Fronts, rows: &Lists, row: &[u32], cols: usize) -> Lists {
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
