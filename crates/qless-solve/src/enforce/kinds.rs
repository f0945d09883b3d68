//! Which DOFs have units that can be compared.
//!
//! ```text
//! s_i K_ij s_j = 1        u_j / s_j has no unit
//! ```
//!
//! A number on the diagonal says what the unit of its DOF is, and those of all that are joined with it. Where a connected part of K has none, as
//! `[0 K_01; K_10 0]`, the unit of one DOF may be anything if that of another is its inverse: each of them is a kind of its own.

use super::matrix::{Matrix, entries};
use super::scale::parts;

/// The kind of each DOF.
pub struct Kinds {
    of: Vec<u32>,
    count: usize,
}

/// All whose units are known.
const KNOWN: u32 = 0;

impl Kinds {
    pub fn new(k: &Matrix, c: &Matrix) -> Self {
        let n = k.ncols();
        let real = || entries(k).filter(|&(_, _, v)| v != 0.0);
        let part = parts(n, real().map(|(i, j, _)| (i, j)));
        // Without any stiffness, equations alone say what is comparable.
        let (mut known, mut is_stiff) = (vec![false; n], false);
        real().for_each(|(i, j, _)| (known[part[j]], is_stiff) = (known[part[j]] || i == j, true));
        let mut known: Vec<bool> = (0..n).map(|j| !is_stiff || known[part[j]]).collect();
        let mut alone = vec![true; n];
        real().for_each(|(i, j, _)| (alone[i], alone[j]) = (false, false));
        if known.contains(&false) {
            spread(c, &alone, &mut known);
        }
        let mut count = 1;
        let mut own = || {
            count += 1;
            count - 1
        };
        let of = known.into_iter().map(|known| if known { KNOWN } else { own() }).collect();
        Self { of, count: count as usize }
    }

    /// `(kind, DOF)` of all.
    pub fn of_dofs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.of.iter().enumerate().map(|(j, &kind)| (kind as usize, j))
    }

    /// Whether the units of a DOF are known.
    pub fn is_known(&self, dof: usize) -> bool {
        self.of[dof] == KNOWN
    }

    /// Whether there is more than one kind.
    pub fn are_many(&self) -> bool {
        self.count > 1
    }

    /// The largest number of each kind, of one for each DOF.
    pub fn largest(&self, numbers: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut largest = vec![0.0_f64; self.count];
        for (&kind, number) in self.of.iter().zip(numbers) {
            largest[kind as usize] = largest[kind as usize].max(number.abs());
        }
        largest
    }

    /// The same for loads, which are no measure but where stiffness has a unit.
    pub fn largest_load(&self, loads: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut largest = self.largest(loads);
        largest[1..].fill(0.0);
        largest
    }
}

/// DOFs that K does not know have the units of an equation of which a DOF has one, and so on along equations.
fn spread(c: &Matrix, alone: &[bool], known: &mut [bool]) {
    let n = known.len();
    let terms = || entries(c).filter(|&(_, _, v)| v != 0.0).map(|(i, j, _)| (n + i, j));
    let part = parts(n + c.nrows(), terms().filter(|&(_, j)| alone[j]));
    let mut has_one = vec![false; part.len()];
    terms().filter(|&(_, j)| known[j]).for_each(|(i, _)| has_one[part[i]] = true);
    (0..n).filter(|&j| alone[j]).for_each(|j| known[j] |= has_one[part[j]]);
}
