//! Fronts: consecutive columns whose rows of R have nearly one pattern, and the tree that they form.
//!
//! Columns j, j + 1 with `parent(j) = j + 1` and `c_j = c_{j+1} + 1` share a pattern. A front joins its parent when the
//! zeros so added to R stay below a share of the joined trapezoid that falls with its size (Ashcraft, Grimes 1989).

use crate::pattern::{Lists, NONE};

/// Up to so many pivotal columns a front may hold so large a share of zeros.
const RELAXED: [(usize, f64); 3] = [(8, 0.8), (24, 0.25), (64, 0.1)];
const SHARE: f64 = 0.05;
/// Fronts this narrow are joined whatever the zeros.
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
        let first = super::counts::first_descendants(&above);
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

/// First columns of the runs of equal pattern.
fn fundamental(parent: &[u32], count: &[u32]) -> Vec<usize> {
    let continues = |j: usize| j > 0 && parent[j - 1] == j as u32 && count[j - 1] == count[j] + 1;
    (0..parent.len()).filter(|&j| !continues(j)).collect()
}

/// A group of runs that became one front.
#[derive(Clone, Copy)]
struct Group {
    start: usize,
    pivots: usize,
    width: usize,
    zeros: f64,
}

/// First columns of the fronts. From the last run down, each is joined with the group that follows it if its parent is
/// in that group.
fn joined(starts: &[usize], parent: &[u32], count: &[u32]) -> Vec<usize> {
    let mut groups: Vec<Group> = Vec::with_capacity(starts.len());
    let mut end = parent.len();
    for &start in starts.iter().rev() {
        let mut group = Group { start, pivots: end - start, width: count[start] as usize, zeros: 0.0 };
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

fn join(child: Group, next: Group) -> Option<Group> {
    let (pivots, width) = (child.pivots + next.pivots, child.pivots + next.width);
    let zeros = child.zeros + next.zeros + child.pivots as f64 * (width - child.width) as f64;
    let size = 0.5 * pivots as f64 * (pivots + 1) as f64 + pivots as f64 * (width - pivots) as f64;
    let share = RELAXED.iter().find(|&&(most, _)| pivots <= most).map_or(SHARE, |&(_, share)| share);
    let accepted = zeros == 0.0 || pivots <= TINY || zeros < share * size;
    accepted.then_some(Group { start: child.start, pivots, width, zeros })
}
