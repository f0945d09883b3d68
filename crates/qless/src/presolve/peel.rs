//! Column singletons: a DOF that occurs in one remaining row becomes that row's slave.
//!
//! Removing the row makes further DOFs singletons, so whole models peel away from their rims without a single
//! change of a coefficient. Such a row is independent of all others and stands in nobody's certificate.
//! Cost O(nnz). The slave's coefficient must be the largest of its row, so that peeling adds nothing to growth; what
//! that leaves, [`super::eliminate`] takes with weaker thresholds.

use std::collections::VecDeque;

use crate::ConstraintSystem;
use crate::scale::{Scaling, ldexp};

/// Rows that found their slave, in the order found: a slave occurs in no later row.
pub(crate) struct Peeled {
    pub pivots: Vec<(u32, u32)>,
    /// Rows that remain.
    pub remaining: Vec<bool>,
}

struct Columns {
    /// Remaining rows that hold the DOF.
    count: Vec<u32>,
    /// Exclusive or of those rows: where the count is 1, the row itself.
    rows: Vec<u32>,
}

/// Rows of `held` stay, with every row that shares a DOF with them.
pub(crate) fn peel(system: &ConstraintSystem, is_free: &[bool], scaling: &Scaling, held: &[bool]) -> Peeled {
    let mut columns = count(system, is_free, held);
    let mut peeled = Peeled { pivots: Vec::new(), remaining: vec![true; system.equations()] };
    let mut ready: VecDeque<u32> = (0..system.dofs() as u32).filter(|&j| columns.count[j as usize] == 1).collect();
    while let Some(dof) = ready.pop_front() {
        if columns.count[dof as usize] != 1 {
            continue;
        }
        let row = columns.rows[dof as usize];
        let (own, largest) = sizes(system, is_free, scaling, row as usize, dof as usize);
        if own >= largest {
            peeled.pivots.push((row, dof));
            remove(system, is_free, row, &mut columns, &mut ready);
            peeled.remaining[row as usize] = false;
        }
    }
    peeled
}

fn count(system: &ConstraintSystem, is_free: &[bool], held: &[bool]) -> Columns {
    let c = system.matrix();
    let mut columns = Columns { count: vec![0; c.cols], rows: vec![0; c.cols] };
    for i in (0..c.rows()).filter(|&i| !held[i]) {
        for (j, _) in c.row(i).filter(|&(j, _)| is_free[j]) {
            columns.count[j] += 1;
            columns.rows[j] ^= i as u32;
        }
    }
    columns
}

/// Scaled size of the DOF's coefficient, and of the row's largest.
fn sizes(system: &ConstraintSystem, is_free: &[bool], scaling: &Scaling, row: usize, dof: usize) -> (f64, f64) {
    let mut own = 0.0;
    let mut largest = 0.0_f64;
    for (j, v) in system.matrix().row(row).filter(|&(j, _)| is_free[j]) {
        let size = ldexp(v.abs(), scaling.row[row] + scaling.col(j));
        largest = largest.max(size);
        if j == dof {
            own = size;
        }
    }
    (own, largest)
}

fn remove(system: &ConstraintSystem, is_free: &[bool], row: u32, columns: &mut Columns, ready: &mut VecDeque<u32>) {
    for (j, _) in system.matrix().row(row as usize).filter(|&(j, _)| is_free[j]) {
        columns.count[j] -= 1;
        columns.rows[j] ^= row;
        if columns.count[j] == 1 {
            ready.push_back(j as u32);
        }
    }
}
