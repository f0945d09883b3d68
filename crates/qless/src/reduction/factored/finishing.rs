//! Slaves from equation to equation: groups of equations that are the last ones of enough DOFs to be solved for them.
//!
//! A DOF with fewest equations left, those equations, and the DOFs that occur in none of the others: if the equations can be solved for
//! some of these, nothing of what is left is changed by it. Along a chain of bodies that is one body after the other, from its end,
//! and `C_S` is a narrow band; what else fills, which is the part of L on masters, is never formed.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::Csr;

/// Most equations of a group.
const GROUP: usize = 8;
/// What is left of a slave's coefficient is at least this part of the largest one of its equation.
const LEAST: f64 = 0.25;

/// Which DOFs may be slaves: those of groups that are solved, and all in the equations that are left.
pub(super) fn candidates(equations: &Csr) -> Vec<bool> {
    let mut work = FinishingWork::new(equations);
    let mut waiting: BinaryHeap<_> = work.count.iter().enumerate().map(|(j, &count)| Reverse((count, j))).collect();
    while let Some(Reverse((count, j))) = waiting.pop() {
        if count == 0 || count != work.count[j] || count > GROUP {
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

struct FinishingWork<'a> {
    equations: &'a Csr,
    /// By DOF.
    columns: Csr,
    done: Vec<bool>,
    /// Equations that are left of each DOF.
    count: Vec<usize>,
    may: Vec<bool>,
}

impl<'a> FinishingWork<'a> {
    fn new(equations: &'a Csr) -> Self {
        let columns = equations.transposed();
        let count = (0..equations.cols).map(|j| columns.row(j).len()).collect();
        Self { equations, columns, done: vec![false; equations.rows()], count, may: vec![false; equations.cols] }
    }

    /// The equations that are left of a DOF.
    fn group(&self, dof: usize) -> Vec<usize> {
        self.columns.row(dof).map(|(i, _)| i).filter(|&i| !self.done[i]).collect()
    }

    /// A slave for each equation of a group, among the DOFs that occur in no other; none if that cannot be done well.
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

    /// Takes a group out; the DOFs of which fewer equations are left.
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

/// Columns of the pivots of all rows, each the largest number that is left; rows are in units of their largest coefficients.
fn pivots(mut rows: Vec<Vec<f64>>) -> Option<Vec<usize>> {
    let mut chosen = Vec::with_capacity(rows.len());
    while !rows.is_empty() {
        let places =
            rows.iter().enumerate().flat_map(|(i, row)| row.iter().enumerate().map(move |(k, v)| (i, k, v.abs())));
        let (i, k, size) = places.max_by(|a, b| a.2.total_cmp(&b.2))?;
        // What is not a number is no pivot either.
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

    /// A chain in which each link has two DOFs, one of its own and one that the next one shares.
    #[test]
    fn chains_are_solved_from_their_end() {
        let mut rows = Csr::empty(8);
        (0..3).for_each(|i| rows.append([(2 * i, 1.0), (2 * i + 1, 0.5), (2 * i + 2, -1.0)]));
        let may = candidates(&rows);
        assert_eq!(may.iter().filter(|may| **may).count(), 3, "{may:?}");
    }

    /// Equations that are alike on all that they have for themselves are left to others.
    #[test]
    fn what_cannot_be_solved_is_left() {
        let mut rows = Csr::empty(4);
        rows.append([(0, 1.0), (1, 1.0), (2, 1.0)]);
        rows.append([(0, 1.0), (1, 1.0), (2, 2.0)]);
        rows.append([(2, 1.0), (3, 1e-9)]);
        let may = candidates(&rows);
        assert!(may[..3].iter().all(|may| *may), "{may:?}");
    }
}
