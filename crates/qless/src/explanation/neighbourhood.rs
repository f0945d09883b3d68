//! Expresses a vector of free DOFs, such as a dependent equation, by few equations: elimination in a growing neighbourhood of the vector.
//!
//! The neighbourhood grows by levels. A level has the equations that share a free DOF with the neighbourhood, those with the fewest new
//! DOFs first. An equation is kept if it is no combination of earlier ones. As soon as the vector is a combination of the kept equations,
//! the coefficients of this combination are unique, so the explanation by all equations with nonzero coefficients is irreducible.

use std::collections::{HashMap, HashSet};

use super::candidates::Candidates;
use crate::input::scale::ldexp;

/// Largest number of equations of a neighbourhood: one elimination is about 128^2 * 512 operations, which take some milliseconds.
pub(super) const MOST: usize = 128;
/// Largest number of DOFs of a neighbourhood: longer equations are not local.
const MOST_DOFS: usize = 512;
/// A sum that cancels to this fraction of its terms is zero.
const NOISE: f64 = 1e-11;

/// What remains of an equation while others are subtracted: values, and the sizes of the terms that went into them.
#[derive(Clone, Default)]
struct Remainder {
    values: Vec<f64>,
    sizes: Vec<f64>,
}

impl Remainder {
    fn add(&mut self, k: usize, part: f64) {
        if self.values.len() <= k {
            self.values.resize(k + 1, 0.0);
            self.sizes.resize(k + 1, 0.0);
        }
        self.values[k] += part;
        self.sizes[k] += part.abs();
    }

    /// Value k, or zero if it is rounding.
    fn get(&self, k: usize, noise: f64) -> f64 {
        match (self.values.get(k), self.sizes.get(k)) {
            (Some(&value), Some(&size)) if value.abs() > noise * size => value,
            _ => 0.0,
        }
    }

    /// All values, with zero in place of those that are rounding.
    fn cleaned(&self, noise: f64) -> Vec<f64> {
        (0..self.values.len()).map(|k| self.get(k, noise)).collect()
    }

    fn subtract(&mut self, factor: f64, other: &[f64]) {
        for (k, &value) in other.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            self.add(k, -factor * value);
        }
    }
}

/// A kept equation: its remainder, its pivot, and its factors over the kept equations (by place in the list of kept ones).
struct Pivot {
    values: Vec<f64>,
    column: usize,
    made_of: Vec<f64>,
}

/// The neighbourhood, its elimination, and the remainder of the vector.
struct Neighbourhood<'a> {
    candidates: &'a Candidates<'a>,
    columns: HashMap<u32, usize>,
    taken: HashSet<u32>,
    kept: Vec<u32>,
    pivots: Vec<Pivot>,
    left: Remainder,
    made_of: Remainder,
    tolerance: f64,
    effort: usize,
}

/// Expresses a vector of free DOFs by equations near it, as `(row, factor)`; also returns the number of multiplications.
pub(super) fn near(candidates: &Candidates, vector: &[(u32, f64)], tolerance: f64) -> (Option<Vec<(u32, f64)>>, usize) {
    let mut near = Neighbourhood {
        candidates,
        columns: HashMap::new(),
        taken: HashSet::new(),
        kept: Vec::new(),
        pivots: Vec::new(),
        left: Remainder::default(),
        made_of: Remainder::default(),
        tolerance,
        effort: 0,
    };
    for &(dof, value) in vector {
        let k = near.column(dof);
        near.left.add(k, ldexp(value, candidates.scaling.col(dof as usize)));
    }
    let found = near.grow(vector.iter().map(|&(dof, _)| dof).collect());
    (found.then(|| near.factors()), near.effort)
}

impl Neighbourhood<'_> {
    fn column(&mut self, dof: u32) -> usize {
        let next = self.columns.len();
        *self.columns.entry(dof).or_insert(next)
    }

    /// Adds level after level until the vector is a combination; returns false if the bounds are reached first.
    fn grow(&mut self, mut dofs: Vec<u32>) -> bool {
        while !dofs.is_empty() {
            let level = self.level(&dofs);
            dofs.clear();
            for row in level {
                if self.taken.len() >= MOST || self.columns.len() >= MOST_DOFS {
                    return false;
                }
                self.taken.insert(row);
                let new = self.candidates.free(row).map(|(j, _)| j).filter(|j| !self.columns.contains_key(j));
                dofs.extend(new.collect::<Vec<_>>());
                self.take(row);
            }
            if self.is_explained() {
                return true;
            }
        }
        false
    }

    /// Equations that contain one of these DOFs and are not in the neighbourhood yet, those with the fewest new DOFs first.
    fn level(&self, dofs: &[u32]) -> Vec<u32> {
        // A neighbourhood has at most MOST equations. Only 8 MOST equations of each DOF are examined, to bound the work; some of them are
        // not allowed or already taken.
        let beside = dofs.iter().flat_map(|&dof| self.candidates.rows(dof).iter().copied().take(8 * MOST));
        let mut level: Vec<u32> =
            beside.filter(|&row| self.candidates.is_allowed(row) && !self.taken.contains(&row)).collect();
        level.sort_unstable();
        level.dedup();
        let unknown = |row: u32| self.candidates.free(row).filter(|(j, _)| !self.columns.contains_key(j)).count();
        level.sort_by_cached_key(|&row| unknown(row));
        level
    }

    /// Subtracts the pivots from an equation, and keeps it if the remainder is not zero.
    fn take(&mut self, row: u32) {
        let (mut rest, mut made_of) = (Remainder::default(), Remainder::default());
        for (dof, value) in self.candidates.free(row).collect::<Vec<_>>() {
            let k = self.column(dof);
            rest.add(k, self.candidates.scaling.entry(row as usize, dof as usize, value));
        }
        self.effort += eliminate(&self.pivots, 0, &mut rest, &mut made_of);
        let values = rest.cleaned(self.tolerance);
        let largest = values.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let Some((column, _)) = largest.filter(|(_, value)| **value != 0.0) else { return };
        made_of.add(self.kept.len(), 1.0);
        self.kept.push(row);
        self.pivots.push(Pivot { values, column, made_of: made_of.cleaned(NOISE) });
        let last = self.pivots.len() - 1;
        self.effort += eliminate(&self.pivots, last, &mut self.left, &mut self.made_of);
    }

    fn is_explained(&self) -> bool {
        (0..self.left.values.len()).all(|k| self.left.get(k, self.tolerance) == 0.0)
    }

    /// `(row, c)` for each kept equation with nonzero c, in the user's units: the vector is the sum of c times these equations. `made_of`
    /// holds `-c` for the scaled equations.
    fn factors(&self) -> Vec<(u32, f64)> {
        let factor = |(k, &row): (usize, &u32)| {
            (row, -ldexp(self.made_of.get(k, NOISE), self.candidates.scaling.row[row as usize]))
        };
        self.kept.iter().enumerate().map(factor).filter(|&(_, factor)| factor != 0.0).collect()
    }
}

/// Subtracts the pivots from `first` on; returns the number of multiplications.
fn eliminate(pivots: &[Pivot], first: usize, rest: &mut Remainder, made_of: &mut Remainder) -> usize {
    let mut effort = 0;
    for pivot in &pivots[first..] {
        let factor = rest.get(pivot.column, NOISE) / pivot.values[pivot.column];
        if factor != 0.0 {
            rest.subtract(factor, &pivot.values);
            rest.values[pivot.column] = 0.0;
            made_of.subtract(factor, &pivot.made_of);
            effort += pivot.values.len() + pivot.made_of.len();
        }
    }
    effort
}
