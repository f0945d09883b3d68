//! Computes the exact rank: peels equations, eliminates the other ones modulo each of two primes, and combines the ranks of the parts.

use super::eliminate::eliminate;
use super::field::Field;
use super::row::ModularEntry;
use super::{ExactError, ExactRank, PartRank, Settings, prime};
use crate::ConstraintSystem;
use crate::diagnosis::peel::{Peeled, peel};
use crate::input::components::Labels;
use crate::input::reading::Number;

/// Computes the ranks of `C_f` and `[C_f | b - C_p u_p]` for [`super::rank()`]. `C_f` and `C_p` are the columns of free and prescribed
/// DOFs.
pub(super) fn rank(system: &ConstraintSystem, settings: Settings) -> Result<ExactRank, ExactError> {
    let mut free = vec![true; system.dofs()];
    system.prescribed().iter().for_each(|&(dof, _)| free[dof] = false);
    let matrix = system.matrix();
    let dofs = |i: usize| &matrix.col[matrix.start[i]..matrix.start[i + 1]];
    // An equation without a free DOF is a part of its own.
    let free_dofs = |i: usize| dofs(i).iter().copied().filter(|&j| free[j as usize]);
    let part_of = Labels::new(matrix.rows(), matrix.cols, free_dofs).of_row;
    let peeled = peel(matrix.rows(), dofs, &free);
    let rest = ExactRemainder { system, settings, peeled: &peeled, part_of: &part_of };
    let primes = prime::two(settings.seed);
    let (first, second) = rayon::join(|| rest.counts(primes[0]), || rest.counts(primes[1]));
    let parts = united(&part_of, &[first?, second?]);
    let rank = parts.iter().map(|part| part.rank).sum();
    let unsolvable = parts.iter().any(|part| !part.solvable);
    let augmented_rank = rank + usize::from(unsolvable);
    Ok(ExactRank { reading: settings.reading, rank, augmented_rank, primes, part_of, parts })
}

/// For each part, its rank modulo one prime, and the increase of this rank by the column `b - C_p u_p`: 0 or 1.
type ExactCounts = Vec<(usize, usize)>;

/// Combines the ranks modulo two primes. A rank modulo a prime is never above the exact rank, so the larger one is used.
fn united(part_of: &[u32], counts: &[ExactCounts; 2]) -> Vec<PartRank> {
    let both = counts[0].iter().zip(&counts[1]);
    let mut parts: Vec<PartRank> = both
        .map(|(&(rank, more), &(other, more_there))| {
            let (larger, augmented) = (rank.max(other), (rank + more).max(other + more_there));
            PartRank { equations: 0, rank: larger, solvable: augmented == larger }
        })
        .collect();
    part_of.iter().for_each(|&part| parts[part as usize].equations += 1);
    parts
}

/// The result of peeling: the remaining equations of the system, and the peeled ones.
struct ExactRemainder<'a> {
    system: &'a ConstraintSystem,
    settings: Settings,
    peeled: &'a Peeled,
    part_of: &'a [u32],
}

impl ExactRemainder<'_> {
    fn counts(&self, prime: u64) -> Result<ExactCounts, ExactError> {
        let count = self.part_of.iter().max().map_or(0, |&last| last as usize + 1);
        let mut counts = vec![(0, 0); count];
        let mut add = |row: u32, rank: usize| counts[self.part_of[row as usize] as usize].0 += rank;
        self.peeled.rows.iter().for_each(|&row| add(row, 1));
        self.peeled.fixing.iter().for_each(|&(row, _)| add(row, 1));
        if self.peeled.rest.is_empty() {
            return Ok(counts);
        }
        let field = Field::new(prime);
        let values = self.values(&field);
        let rhs = self.peeled.rest.iter().map(|&row| self.right_hand_side(&field, row, &values)).collect();
        let (rows, cols) = self.rows(&field);
        let done = eliminate(field, rows, rhs, cols, self.settings.fill)?;
        done.pivots.iter().for_each(|&k| add(self.peeled.rest[k as usize], 1));
        for &k in &done.contradicting {
            counts[self.part_of[self.peeled.rest[k as usize] as usize] as usize].1 = 1;
        }
        Ok(counts)
    }

    fn residue(&self, field: &Field, value: f64) -> u64 {
        field.residue(Number::read(value, self.settings.reading))
    }

    /// The values of prescribed and of fixed DOFs; 0 for the others.
    fn values(&self, field: &Field) -> Vec<u64> {
        let mut values = vec![0; self.system.dofs()];
        for &(dof, value) in self.system.prescribed() {
            values[dof] = self.residue(field, value);
        }
        for &(row, dof) in &self.peeled.fixing {
            let rest = self.right_hand_side(field, row, &values);
            let own = self.system.matrix().row(row as usize).find(|&(j, _)| j == dof as usize).map_or(1.0, |(_, v)| v);
            values[dof as usize] = field.mul(rest, field.inverse(self.residue(field, own)));
        }
        values
    }

    /// The right-hand side of equation i without the terms of DOFs with known values: `b_i - sum_j c_ij u_j`.
    fn right_hand_side(&self, field: &Field, row: u32, values: &[u64]) -> u64 {
        let matrix = self.system.matrix().row(row as usize);
        let known = matrix.filter(|&(j, _)| values[j] != 0);
        let own = self.residue(field, self.system.rhs()[row as usize]);
        known.fold(own, |rest, (j, v)| field.sub(rest, field.mul(self.residue(field, v), values[j])))
    }

    /// The coefficients of unknown DOFs in the remaining rows, and the number of such DOFs.
    fn rows(&self, field: &Field) -> (Vec<Vec<ModularEntry>>, usize) {
        let unknown = |&(j, _): &(usize, f64)| self.peeled.unknown[j];
        let entries = |row: u32| self.system.matrix().row(row as usize).filter(unknown);
        let mut number = vec![0; self.system.dofs()];
        for &row in &self.peeled.rest {
            entries(row).for_each(|(j, _)| number[j] = 1);
        }
        let mut cols = 0;
        for used in number.iter_mut().filter(|used| **used == 1) {
            *used = cols;
            cols += 1;
        }
        let row = |&row: &u32| {
            // Exact capacity, because unused capacity counts as fill.
            let mut list = Vec::with_capacity(entries(row).count());
            list.extend(entries(row).map(|(j, v)| (number[j], self.residue(field, v))));
            list
        };
        (self.peeled.rest.iter().map(row).collect(), cols as usize)
    }
}
