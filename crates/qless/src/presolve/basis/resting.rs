//! The motions of DOFs that seem to rest, from the rows that the moving DOFs miss.
//!
//! ```text
//! C_R m_R = -C_M m_M +- e     M moves, R seems to rest, e bounds the errors of C_M m_M
//! ```
//!
//! Gauss-Jordan elimination with the rows relative to their errors: the pivot is the coefficient `a_ij` with the least `e_i / |a_ij|`, so
//! that each DOF is taken from the row that determines it best. A row k then receives the error `|a_kj| e_i / |a_ij| <= e_k`: a step at
//! most doubles an error, and no row spoils a better one. Rows without moving DOFs have no error and come first.

use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap, HashMap};

use crate::Csr;

/// A difference below this, relative to its larger term, is rounding.
const NOISE: f64 = 1e-14;

/// Sets the motions that kept rows need: in `moves`, zeros are DOFs that seem to rest, and the errors of all motions are at most `error`.
/// Only DOFs are examined that rows connect, through such DOFs, with a row that the moving DOFs miss by more than the error. Returns false
/// if a row without such DOFs is missed: then the errors are larger.
pub(super) fn set_needed(matrix: &Csr, kept: &[usize], moves: &mut [f64], error: f64) -> bool {
    let row = |&i: &usize| RestingRow::new(matrix.row(i), moves, error);
    let missed: Vec<usize> = kept.iter().copied().filter(|i| row(i).is_missed()).collect();
    if missed.is_empty() {
        return true;
    }
    if missed.iter().any(|i| row(i).entries.is_empty()) {
        return false;
    }
    let mut rows: Vec<RestingRow> = reached(matrix, kept, moves, missed).iter().map(row).collect();
    for (j, motion) in solve(&mut rows) {
        moves[j] = motion;
    }
    true
}

/// A kept row without its moving DOFs.
#[derive(Default)]
struct RestingRow {
    /// The coefficients of the DOFs that seem to rest.
    entries: BTreeMap<usize, f64>,
    /// The sum of the other terms.
    sum: f64,
    /// Bound of the error of `sum`.
    error: f64,
    /// The pivot, if the row is solved for a DOF.
    pivot: Option<usize>,
}

impl RestingRow {
    fn new(row: impl Iterator<Item = (usize, f64)>, moves: &[f64], error: f64) -> Self {
        let mut new = Self { entries: BTreeMap::new(), sum: 0.0, error: 0.0, pivot: None };
        for (j, v) in row.filter(|&(_, v)| v != 0.0) {
            if moves[j] == 0.0 {
                new.entries.insert(j, v);
            } else {
                (new.sum, new.error) = (new.sum + v * moves[j], new.error + v.abs() * error);
            }
        }
        new
    }

    fn is_missed(&self) -> bool {
        self.sum.abs() > self.error
    }

    /// How well the row determines a DOF, without units: rows without errors first, then `|a_ij| / e_i`; the largest such DOF.
    fn best(&self) -> Option<(bool, f64, usize)> {
        let largest = self.entries.iter().map(|(&j, v)| (v.abs(), j)).reduce(|a, b| if b.0 > a.0 { b } else { a });
        largest.filter(|_| self.pivot.is_none()).map(|(v, j)| (self.error == 0.0, v / self.error, j))
    }

    /// Subtracts `factor` times the row that is solved for DOF j, so that DOF j vanishes.
    fn eliminate(&mut self, j: usize, factor: f64, solved: &Self) {
        for (&l, v) in &solved.entries {
            let (old, part) = (self.entries.get(&l).copied().unwrap_or(0.0), factor * v);
            let is_zero = l == j || (old - part).abs() <= NOISE * old.abs().max(part.abs());
            if is_zero {
                self.entries.remove(&l)
            } else {
                self.entries.insert(l, old - part)
            };
        }
        self.sum -= factor * solved.sum;
        self.error += (factor * solved.error).abs() + f64::EPSILON * (factor * solved.sum).abs();
    }
}

/// The kept rows that are connected with the rows in `queue` through DOFs that seem to rest, ascending.
fn reached(matrix: &Csr, kept: &[usize], moves: &[f64], mut queue: Vec<usize>) -> Vec<usize> {
    let rows_of_dofs = matrix.transposed();
    let mut is_waiting = vec![false; matrix.rows()];
    kept.iter().for_each(|&i| is_waiting[i] = true);
    queue.iter().for_each(|&i| is_waiting[i] = false);
    let mut found = Vec::new();
    while let Some(i) = queue.pop() {
        found.push(i);
        for (j, _) in matrix.row(i).filter(|&(j, v)| v != 0.0 && moves[j] == 0.0) {
            let new = rows_of_dofs.row(j).map(|(k, _)| k).filter(|&k| std::mem::take(&mut is_waiting[k]));
            queue.extend(new);
        }
    }
    found.sort_unstable();
    found
}

/// How well a row determines a DOF, for a queue with the best first. It is out of date if the row has changed since.
#[derive(PartialEq)]
struct PivotCandidate {
    is_exact: bool,
    size: f64,
    row: usize,
    dof: usize,
}

impl Eq for PivotCandidate {}

impl Ord for PivotCandidate {
    fn cmp(&self, other: &Self) -> Ordering {
        let size = || self.size.total_cmp(&other.size);
        self.is_exact.cmp(&other.is_exact).then_with(size).then_with(|| other.row.cmp(&self.row))
    }
}

impl PartialOrd for PivotCandidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The DOFs that the rows move, with their motions.
fn solve(rows: &mut [RestingRow]) -> Vec<(usize, f64)> {
    // The rows that had a DOF at some time.
    let mut rows_of: HashMap<usize, BTreeSet<usize>> = HashMap::new();
    for (i, row) in rows.iter().enumerate() {
        row.entries.keys().for_each(|&j| _ = rows_of.entry(j).or_default().insert(i));
    }
    let candidate = |row: usize, rows: &[RestingRow]| {
        rows[row].best().map(|(is_exact, size, dof)| PivotCandidate { is_exact, size, row, dof })
    };
    let mut queue: BinaryHeap<PivotCandidate> = (0..rows.len()).filter_map(|i| candidate(i, rows)).collect();
    while let Some(found) = queue.pop() {
        let PivotCandidate { row: i, dof: j, .. } = found;
        if candidate(i, rows) != Some(found) {
            continue;
        }
        let mut solved = std::mem::take(&mut rows[i]);
        solved.pivot = Some(j);
        let holders: Vec<usize> = rows_of[&j].iter().copied().filter(|&k| rows[k].entries.contains_key(&j)).collect();
        for k in holders {
            let factor = rows[k].entries[&j] / solved.entries[&j];
            rows[k].eliminate(j, factor, &solved);
            solved.entries.keys().for_each(|&l| _ = rows_of.entry(l).or_default().insert(k));
            queue.extend(candidate(k, rows));
        }
        rows[i] = solved;
    }
    let motion = |row: &RestingRow| {
        let j = row.pivot.filter(|_| row.is_missed())?;
        Some((j, -row.sum / row.entries[&j]))
    };
    rows.iter().filter_map(motion).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::SplitMix64;

    /// Rows of DOFs that move by about 1, and of DOFs whose motions are too small to be told from rounding but follow from the rows.
    #[test]
    fn rows_hold_with_the_motions_that_they_need() {
        let (mut random, mut set) = (SplitMix64::new(5), 0);
        for case in 0..500 {
            let mut next = |most: f64| (2.0 * (random.next() >> 11) as f64 / (1_u64 << 53) as f64 - 1.0) * most;
            let (rows, resting, moving) = (1 + case % 7, 1 + case % 5, 2 + case % 3);
            let mut moves: Vec<f64> =
                (0..resting + moving).map(|j| if j < resting { 0.0 } else { 2.0 + next(1.0) }).collect();
            let small: Vec<f64> = (0..resting).map(|_| 1e-9 * next(1.0)).collect();
            let mut matrix = Csr::empty(resting + moving);
            for _ in 0..rows {
                let mut row: Vec<f64> =
                    (0..resting + moving).map(|_| if next(1.0) < 0.0 { 0.0 } else { next(1.0) }).collect();
                let sum: f64 = (0..resting + moving - 1).map(|j| row[j] * small.get(j).unwrap_or(&moves[j])).sum();
                row[resting + moving - 1] = -sum / moves[resting + moving - 1];
                matrix.append(row.into_iter().enumerate().filter(|&(_, v)| v != 0.0));
            }
            let kept: Vec<usize> = (0..rows).collect();
            let error = 1e-15;
            let missed = |moves: &[f64], bound: f64| {
                let gap = |i: &usize| matrix.row(*i).map(|(j, v)| v * moves[j]).sum::<f64>().abs();
                kept.iter().filter(|i| gap(i) > bound).count()
            };
            set += missed(&moves, 1e-12);
            assert!(set_needed(&matrix, &kept, &mut moves, error), "{case}");
            assert_eq!(missed(&moves, 1e-13), 0, "{case}: {moves:?}");
        }
        assert!(set > 500, "{set}");
    }
}
