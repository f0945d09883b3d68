//! The cores of the kept equations, which remain after triangular parts are removed: elimination can cancel only there.
//!
//! An equation is triangular if it has a single DOF, or a DOF that occurs in no other equation. Its coefficients do not affect the distance
//! from dependence. Triangular equations, and DOFs that a single equation fixes, are removed until none is left. O(nnz).

use crate::common::DisjointSets;
use crate::input::numbering::LocalSystem;

/// Connected equations, each of whose remaining DOFs occurs in at least two of them.
pub struct Core {
    /// The equations, ascending.
    pub rows: Vec<u32>,
    /// For each equation, its remaining DOFs and their coefficients.
    pub entries: Vec<Vec<(u32, f64)>>,
}

/// The state of the removal: the rows and DOFs that remain, with the length of each row and the number of rows of each DOF.
struct Peeling<'a> {
    system: LocalSystem<'a>,
    /// The equations. The next two fields say whether each of them remains, and how many of its DOFs remain.
    rows: &'a [u32],
    stays: Vec<bool>,
    length: Vec<u32>,
    /// For each DOF, the places of its equations. The next two fields say how many of these equations remain, and whether the DOF remains.
    holders: Vec<Vec<u32>>,
    count: Vec<u32>,
    is_left: Vec<bool>,
    ready: Vec<Removal>,
}

/// A row or a DOF to be removed.
#[derive(Clone, Copy)]
enum Removal {
    Row(u32),
    Dof(u32),
}

/// The cores of some equations, sorted by the first row of each.
pub fn cores(system: LocalSystem, rows: &[u32]) -> Vec<Core> {
    let mut place = vec![u32::MAX; system.dofs()];
    let mut holders: Vec<Vec<u32>> = Vec::new();
    let mut length = vec![0; rows.len()];
    for (&i, at) in rows.iter().zip(0..) {
        for &j in system.parts(i as usize).0.iter().filter(|&&j| system.free()[j as usize]) {
            if place[j as usize] == u32::MAX {
                place[j as usize] = holders.len() as u32;
                holders.push(Vec::new());
            }
            holders[place[j as usize] as usize].push(at);
            length[at as usize] += 1;
        }
    }
    let count: Vec<u32> = holders.iter().map(|holders| holders.len() as u32).collect();
    let single_rows = length.iter().zip(0..).filter(|&(&length, _)| length == 1).map(|(_, at)| Removal::Row(at));
    let single_dofs = count.iter().zip(0..).filter(|&(&count, _)| count == 1).map(|(_, j)| Removal::Dof(j));
    let ready = single_rows.chain(single_dofs).collect();
    let is_left = vec![true; holders.len()];
    let mut work = Peeling { system, rows, stays: vec![true; rows.len()], length, holders, count, is_left, ready };
    while let Some(removal) = work.ready.pop() {
        work.remove(removal, &place);
    }
    work.gathered(&place)
}

impl Peeling<'_> {
    /// The remaining DOFs of an equation.
    fn left<'b>(&'b self, at: u32, place: &'b [u32]) -> impl Iterator<Item = (u32, f64)> + 'b {
        let row = self.system.row(self.rows[at as usize] as usize);
        let places = row.map(|(j, v)| (place[j], v)).filter(|&(j, _)| j != u32::MAX);
        places.filter(|&(j, _)| self.is_left[j as usize])
    }

    fn remove(&mut self, removal: Removal, place: &[u32]) {
        match removal {
            Removal::Row(at) if self.stays[at as usize] => {
                let dof = self.left(at, place).next();
                self.stays[at as usize] = false;
                dof.into_iter().for_each(|(j, _)| self.leave(j));
            }
            Removal::Dof(j) if self.is_left[j as usize] && self.count[j as usize] == 1 => {
                let holder = self.holders[j as usize].iter().copied().find(|&at| self.stays[at as usize]);
                let Some(at) = holder else { return };
                self.stays[at as usize] = false;
                let dofs: Vec<u32> = self.left(at, place).map(|(j, _)| j).collect();
                for j in dofs {
                    self.count[j as usize] -= 1;
                    if self.count[j as usize] == 1 {
                        self.ready.push(Removal::Dof(j));
                    }
                }
            }
            _ => {}
        }
    }

    /// Removes DOF j, whose value one equation fixes, from the other equations.
    fn leave(&mut self, j: u32) {
        self.is_left[j as usize] = false;
        for &at in self.holders[j as usize].iter().filter(|&&at| self.stays[at as usize]) {
            self.length[at as usize] -= 1;
            if self.length[at as usize] == 1 {
                self.ready.push(Removal::Row(at));
            }
        }
    }

    fn gathered(&self, place: &[u32]) -> Vec<Core> {
        let stays = |&at: &u32| self.stays[at as usize];
        let mut sets = DisjointSets::new(self.rows.len());
        for holders in (0..self.holders.len()).filter(|&j| self.is_left[j]).map(|j| &self.holders[j]) {
            let mut left = holders.iter().copied().filter(stays);
            if let Some(first) = left.next() {
                left.for_each(|at| sets.join(first as usize, at as usize));
            }
        }
        let (labels, count) = sets.numbered();
        let mut cores: Vec<Core> = (0..count).map(|_| Core { rows: Vec::new(), entries: Vec::new() }).collect();
        for at in (0..self.rows.len() as u32).filter(stays) {
            let core = &mut cores[labels[at as usize] as usize];
            core.rows.push(self.rows[at as usize]);
            let row = self.system.row(self.rows[at as usize] as usize).filter(|&(j, _)| place[j] != u32::MAX);
            let left = row.filter(|&(j, _)| self.is_left[place[j] as usize]);
            core.entries.push(left.map(|(j, v)| (j as u32, v)).collect());
        }
        cores.retain(|core| !core.rows.is_empty());
        cores
    }
}
