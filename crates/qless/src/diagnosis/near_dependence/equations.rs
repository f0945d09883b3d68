//! The equations of one connected part, scaled to the same size, and the choice of equations that matter for near dependence.

use crate::Csr;
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, exponent, ldexp};

/// Rows over the DOFs of their part, each scaled to a largest coefficient in `[1, 2)`.
pub(super) struct ScaledEquations {
    /// For each row of `matrix`, its number in the user's system; ascending.
    pub rows: Vec<u32>,
    /// For each row, the exponent of the power of two that multiplies the row.
    pub exponents: Vec<i32>,
    pub matrix: Csr,
}

impl ScaledEquations {
    /// Scales rows and numbers their DOFs. `number` has an entry for each DOF of the system; no DOF of these rows belongs to another part.
    pub fn new(system: LocalSystem, rows: Vec<u32>, scaling: &Scaling, number: &mut [u32]) -> Self {
        let mut entries = Vec::new();
        let (mut starts, mut exponents) = (vec![0], Vec::new());
        let mut dofs = 0;
        for &row in &rows {
            let i = row as usize;
            let first = entries.len();
            for (j, v) in system.row(i).filter(|&(j, _)| system.free()[j]) {
                if number[j] == u32::MAX {
                    number[j] = dofs;
                    dofs += 1;
                }
                entries.push((number[j] as usize, scaling.entry(i, j, v)));
            }
            let own = &mut entries[first..];
            let shift = -exponent(own.iter().fold(f64::MIN_POSITIVE, |a, (_, v)| a.max(v.abs())));
            own.iter_mut().for_each(|(_, v)| *v = ldexp(*v, shift));
            own.sort_unstable_by_key(|&(j, _)| j);
            exponents.push(scaling.row[i] + shift);
            starts.push(entries.len());
        }
        let mut matrix = Csr::empty(dofs as usize);
        starts.windows(2).for_each(|pair| matrix.append(entries[pair[0]..pair[1]].iter().copied()));
        Self { rows, exponents, matrix }
    }

    pub fn select(&self, rows: &[usize]) -> Csr {
        let mut selected = Csr::empty(self.matrix.cols);
        rows.iter().for_each(|&i| selected.append(self.matrix.row(i)));
        selected
    }
}

/// A row is left out if a DOF that occurs in no other row has at least this fraction of the largest coefficient of the row.
const LARGE: f64 = 0.25;
/// Number of rounds in which rows are left out. After each round, more DOFs may occur in one row only. Each round also costs accuracy.
const TIMES: usize = 3;

/// The rows without a large coefficient on a DOF that occurs in no other row, ascending.
///
/// In a combination with difference d, a row with a large coefficient on such a DOF has a factor of at most `|d| / 0.25`, so it can be left
/// out.
pub(super) fn without_own(system: LocalSystem, mut rows: Vec<u32>, scaling: &Scaling) -> Vec<u32> {
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
