//! The cores of the kept equations, which remain after triangular equations are removed: elimination can cancel only there.

use super::peel::{Peeled, peel};
use crate::input::components::components;
use crate::input::numbering::LocalSystem;

/// Connected equations, each of whose remaining DOFs occurs in at least two of them.
pub struct Core {
    /// The equations, ascending.
    pub rows: Vec<u32>,
    /// For each equation, its remaining DOFs and their coefficients.
    pub entries: Vec<Vec<(u32, f64)>>,
}

/// The cores of some equations, sorted by the first row of each. O(nnz).
pub fn cores(system: LocalSystem, rows: &[u32]) -> Vec<Core> {
    let dofs = |at: usize| system.parts(rows[at] as usize).0;
    let Peeled { rest, unknown, .. } = peel(rows.len(), dofs, system.free());
    let rest: Vec<u32> = rest.into_iter().map(|at| rows[at as usize]).collect();
    let entries = |row: u32| system.row(row as usize).map(|(j, v)| (j as u32, v)).filter(|&(j, _)| unknown[j as usize]);
    let connected = components(&rest, system.dofs(), |row| entries(row).map(|(j, _)| j));
    let core = |rows: Vec<u32>| Core { entries: rows.iter().map(|&row| entries(row).collect()).collect(), rows };
    connected.into_iter().map(core).collect()
}
