//! Rows that presolve must leave alone, because what it kept of them is nearly dependent.

use std::collections::BTreeSet;

use crate::Csr;
use crate::local::Local;

/// Blocks of nearly dependent rows up to this size go to the backend whole.
const HOLD: usize = 4000;

/// Holds back from presolve all rows connected with a DOF; false if they are already, or too many.
pub(crate) fn hold_component(system: Local, dof: u32, held: &mut [bool]) -> bool {
    let columns = holders(system);
    let (mut rows, mut dofs) = (BTreeSet::new(), vec![dof as usize]);
    let mut seen = vec![false; system.dofs()];
    while let Some(j) = dofs.pop().filter(|_| rows.len() <= HOLD) {
        for (i, _) in columns.row(j) {
            if rows.insert(i) {
                let free = system.row(i).map(|(j, _)| j).filter(|&j| system.free()[j]);
                dofs.extend(free.filter(|&j| !std::mem::replace(&mut seen[j], true)));
            }
        }
    }
    let useful = rows.len() <= HOLD && rows.iter().any(|&i| !held[i]);
    if useful {
        rows.iter().for_each(|&i| held[i] = true);
    }
    useful
}

/// `C^T` in local numbers: the rows that hold each DOF.
fn holders(system: Local) -> Csr {
    let mut c = Csr::empty(system.dofs());
    (0..system.equations()).for_each(|i| c.push_row(system.row(i)));
    c.transpose()
}
