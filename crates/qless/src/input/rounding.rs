//! Coefficients that are rounding of their equation: searches and integrations leave them where zero is meant.
//!
//! With rows and columns scaled until the largest number of each is 1 (Ruiz 2001), `|a_ij|` below `2^-46` (1.4e-14) is rounding: row i
//! and DOF j have numbers that count, so that no unit explains it. Left in, such numbers become all that is left of an equation
//! said twice, and are scaled up into an equation of their own. Nothing is concluded from them, and they are listed.

use std::collections::HashSet;

use crate::input::components::Labels;
use crate::input::numbering::{Exponents, LocalSystem};
use crate::input::scale::{ROUNDING, equilibrated, free};

/// A coefficient from which nothing was concluded: below 1.4e-14 of the largest of its equation and of its DOF, each in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Ignored {
    /// The equation, 0-based.
    pub row: usize,
    /// The DOF, 0-based.
    pub dof: usize,
    /// The coefficient.
    pub coefficient: f64,
}

/// Whether a row spans so much that rounding may be in it.
fn may_hold(of_row: Exponents) -> bool {
    of_row.least < of_row.most && i32::from(of_row.least) - i32::from(of_row.most) <= ROUNDING
}

/// What is rounding, ascending by row and DOF; in components with a row that spans so much, whatever stands beside them. O(m) where
/// there are none.
pub(crate) fn find(system: LocalSystem, exponents: &[Exponents]) -> Vec<Ignored> {
    let spanning: Vec<usize> = (0..exponents.len()).filter(|&i| may_hold(exponents[i])).collect();
    if spanning.is_empty() {
        return Vec::new();
    }
    let mut is_looked_at = vec![false; system.equations()];
    Labels::of(system).mark(&spanning, &mut is_looked_at);
    let (row, col) = equilibrated(system, vec![0.0; system.equations()], vec![0.0; system.dofs()]);
    let mut found = Vec::new();
    for i in (0..system.equations()).filter(|&i| is_looked_at[i]) {
        let rounding = |&(j, v): &(usize, f64)| v.abs().log2() + row[i] + col[j] <= f64::from(ROUNDING);
        let named = |(j, coefficient)| Ignored { row: i, dof: system.numbering.dofs[j] as usize, coefficient };
        found.extend(free(system, i).filter(rounding).map(named));
    }
    found
}

/// Which entries those are, in local numbers.
pub(crate) fn places(ignored: &[Ignored], system: LocalSystem) -> HashSet<(u32, u32)> {
    let rows: HashSet<usize> = ignored.iter().map(|entry| entry.row).collect();
    let users: HashSet<(usize, usize)> = ignored.iter().map(|entry| (entry.row, entry.dof)).collect();
    let name = |j: u32| system.numbering.dofs[j as usize] as usize;
    let of_row = |&i: &usize| system.parts(i).0.iter().map(move |&j| (i, j)).collect::<Vec<_>>();
    let all = rows.iter().flat_map(of_row).filter(|&(i, j)| users.contains(&(i, name(j))));
    all.map(|(i, j)| (i as u32, j)).collect()
}
