//! Chooses slaves locally: groups of equations that can be solved for DOFs that occur in no other remaining equation.
//!
//! Each step takes the DOF with the fewest remaining equations. These equations are a group. If the group can be solved for DOFs that occur
//! only in the group, the other equations do not change. In a chain of bodies the groups are the equations of one body after the other,
//! from an end of the chain, and `C_S` is a narrow band. The rows of the factor L that belong to masters, which would fill, are never
//! formed.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::Csr;

/// Maximum number of equations in a group.
const GROUP: usize = 8;
/// Lower bound of the pivot of a slave, relative to the largest coefficient of its equation.
const LEAST: f64 = 0.25;

/// The DOFs that may be slaves: the slaves of the groups that were solved, and all DOFs of the equations that are in no such group.
pub(super) fn candidates(equations: &Csr) -> Vec<bool> {
    let mut work = GroupSearch::new(equations);
    let mut waiting: BinaryHeap<_> = work.count.iter().enumerate().map(|(j, &count)| Reverse((count, j))).collect();
    while let Some(Reverse((count, j))) = waiting.pop() {
        if count != work.count[j] || count > GROUP {
            continue;
        }
        let group = work.group(j);
        if let Some(slaves) = work.solve(&group) {
            slaves.into_iter().for_each(|slave| work.may[slave] = true);
            waiting.extend(work.remove(&group).into_iter().map(|j| Reverse((work.count[j], j))));
        }
    }
    for i in (0..equations.rows()).filter(|&i| !work.done[i]) {
        equations.row(i).for_each(|(j, _)| work.may[j] = true);
    }
    work.may
}

struct GroupSearch<'a> {
    equations: &'a Csr,
    /// For each DOF, the equations that contain it.
    columns: Csr,
    done: Vec<bool>,
    /// Number of remaining equations of each DOF.
    count: Vec<usize>,
    may: Vec<bool>,
}

impl<'a> GroupSearch<'a> {
    fn new(equations: &'a Csr) -> Self {
        let columns = equations.transposed();
        let count = (0..equations.cols).map(|j| columns.row(j).len()).collect();
        Self { equations, columns, done: vec![false; equations.rows()], count, may: vec![false; equations.cols] }
    }

    /// The remaining equations of a DOF.
    fn group(&self, dof: usize) -> Vec<usize> {
        self.columns.row(dof).map(|(i, _)| i).filter(|&i| !self.done[i]).collect()
    }

    /// A slave for each equation of a group, among the DOFs that occur only in the group; None if a pivot would be too small.
    fn solve(&self, group: &[usize]) -> Option<Vec<usize>> {
        let mut all: Vec<usize> = group.iter().flat_map(|&i| self.equations.row(i)).map(|(j, _)| j).collect();
        all.sort_unstable();
        let ends = all.chunk_by(|a, b| a == b).filter(|same| self.count[same[0]] == same.len());
        let dofs: Vec<usize> = ends.map(|same| same[0]).collect();
        if dofs.len() < group.len() {
            return None;
        }
        let mut rows = vec![vec![0.0; dofs.len()]; group.len()];
        for (row, &i) in rows.iter_mut().zip(group) {
            let own = self.equations.row(i).filter_map(|(j, v)| dofs.binary_search(&j).ok().map(|k| (k, v)));
            let largest = self.equations.row(i).fold(0.0, |most: f64, (_, v)| most.max(v.abs()));
            own.for_each(|(k, v)| row[k] = v / largest);
        }
        Some(pivots(rows)?.into_iter().map(|k| dofs[k]).collect())
    }

    /// Removes a group; returns the DOFs that lost an equation.
    fn remove(&mut self, group: &[usize]) -> Vec<usize> {
        let mut touched = Vec::new();
        for &i in group {
            self.done[i] = true;
            for (j, _) in self.equations.row(i) {
                self.count[j] -= 1;
                touched.push(j);
            }
        }
        touched
    }
}

/// Pivot columns by elimination with complete pivoting. In each row, the largest coefficient of the whole equation is scaled to 1. None if
/// a pivot is below [`LEAST`].
fn pivots(mut rows: Vec<Vec<f64>>) -> Option<Vec<usize>> {
    let mut chosen = Vec::with_capacity(rows.len());
    while !rows.is_empty() {
        let places =
            rows.iter().enumerate().flat_map(|(i, row)| row.iter().enumerate().map(move |(k, v)| (i, k, v.abs())));
        let (i, k, size) = places.max_by(|a, b| a.2.total_cmp(&b.2))?;
        // NaN and infinity are not pivots either.
        if size.total_cmp(&LEAST).is_lt() || !size.is_finite() {
            return None;
        }
        let pivot = rows.swap_remove(i);
        for row in &mut rows {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(&pivot).for_each(|(v, p)| *v -= factor * p);
            row[k] = 0.0;
        }
        chosen.push(k);
    }
    Some(chosen)
}

#[cfg(test)]
mod tests {
    use super::candidates;
    use crate::Csr;

    /// A chain in which each link has two DOFs, one of them shared with the next link.
    #[test]
    fn chains_are_solved_from_their_end() {
        let mut rows = Csr::empty(8);
        (0..3).for_each(|i| rows.append([(2 * i, 1.0), (2 * i + 1, 0.5), (2 * i + 2, -1.0)]));
        let may = candidates(&rows);
        assert_eq!(may.iter().filter(|may| **may).count(), 3, "{may:?}");
    }

    /// Equations with equal coefficients on their own DOFs cannot be solved for these.
    #[test]
    fn an_unsolvable_group_is_skipped() {
        let mut rows = Csr::empty(4);
        rows.append([(0, 1.0), (1, 1.0), (2, 1.0)]);
        rows.append([(0, 1.0), (1, 1.0), (2, 2.0)]);
        rows.append([(2, 1.0), (3, 1e-9)]);
        let may = candidates(&rows);
        assert!(may[..3].iter().all(|may| *may), "{may:?}");
    }
}
