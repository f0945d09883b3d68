//! Counts equations without arithmetic: those with a DOF that occurs in no other equation, and those with one unknown DOF.
//!
//! Whether an equation counts depends only on which coefficients are zero. No nonzero coefficient has the residue 0, so all primes share
//! one count.

use crate::Csr;

/// What remains of `C_f` (the columns of free DOFs), and the equations that were removed.
pub(super) struct Peeled {
    /// Equations with a DOF that occurs in no remaining equation: independent, whatever their coefficients are.
    pub(super) rows: Vec<u32>,
    /// Equations that fix a DOF, as `(equation, DOF)`. All other DOFs of the equation are prescribed, or fixed by an earlier equation of
    /// this list.
    pub(super) fixing: Vec<(u32, u32)>,
    /// The remaining equations.
    pub(super) rest: Vec<u32>,
    /// For each DOF, true if it is still unknown: neither prescribed nor fixed.
    pub(super) unknown: Vec<bool>,
}

/// Removes equations with a DOF in no other equation (column singletons), or else equations with one unknown DOF (row singletons), until
/// there are none.
pub(super) fn peel(matrix: &Csr, free: &[bool]) -> Peeled {
    let mut work = PeelWork::new(matrix, free);
    loop {
        if let Some(dof) = work.columns.pop() {
            work.take_holder(dof);
        } else if let Some(row) = work.rows.pop() {
            work.fix(row);
        } else {
            return work.done();
        }
    }
}

struct PeelWork<'a> {
    matrix: &'a Csr,
    /// The rows of each column: `holder[start[j]..start[j + 1]]`.
    start: Vec<usize>,
    holder: Vec<u32>,
    /// For each DOF, the number of remaining rows that contain it. The next field is the number of unknown DOFs of each row.
    holders: Vec<u32>,
    length: Vec<u32>,
    taken: Vec<bool>,
    unknown: Vec<bool>,
    /// Columns that were singletons when they were added here. The next field lists rows that were singletons when they were added.
    columns: Vec<u32>,
    rows: Vec<u32>,
    peeled: Vec<u32>,
    fixing: Vec<(u32, u32)>,
}

impl<'a> PeelWork<'a> {
    fn new(matrix: &'a Csr, free: &[bool]) -> Self {
        let (start, holder) = pattern(matrix);
        let holders: Vec<u32> = start.windows(2).map(|range| (range[1] - range[0]) as u32).collect();
        let unknown_of = |i: usize| matrix.row(i).filter(|&(j, _)| free[j]).count() as u32;
        let length: Vec<u32> = (0..matrix.rows()).map(unknown_of).collect();
        let columns = (0..matrix.cols as u32).filter(|&j| free[j as usize] && holders[j as usize] == 1).collect();
        let rows = (0..matrix.rows() as u32).filter(|&i| length[i as usize] == 1).collect();
        let (taken, unknown) = (vec![false; matrix.rows()], free.to_vec());
        let (peeled, fixing) = (Vec::new(), Vec::new());
        Self { matrix, start, holder, holders, length, taken, unknown, columns, rows, peeled, fixing }
    }

    fn take_holder(&mut self, dof: u32) {
        let j = dof as usize;
        if self.unknown[j] && self.holders[j] == 1 {
            let mut rows = self.holder[self.start[j]..self.start[j + 1]].iter();
            let Some(&row) = rows.find(|&&i| !self.taken[i as usize]) else { return };
            self.peeled.push(row);
            self.take(row);
        }
    }

    fn fix(&mut self, row: u32) {
        let i = row as usize;
        if self.taken[i] || self.length[i] != 1 {
            return;
        }
        let Some((dof, _)) = self.matrix.row(i).find(|&(j, _)| self.unknown[j]) else { return };
        self.fixing.push((row, dof as u32));
        self.take(row);
        self.unknown[dof] = false;
        for &other in &self.holder[self.start[dof]..self.start[dof + 1]] {
            self.length[other as usize] -= 1;
            if self.length[other as usize] == 1 && !self.taken[other as usize] {
                self.rows.push(other);
            }
        }
    }

    fn take(&mut self, row: u32) {
        self.taken[row as usize] = true;
        for (j, _) in self.matrix.row(row as usize) {
            self.holders[j] -= 1;
            if self.holders[j] == 1 && self.unknown[j] {
                self.columns.push(j as u32);
            }
        }
    }

    fn done(self) -> Peeled {
        let rest = (0..self.matrix.rows() as u32).filter(|&i| !self.taken[i as usize]).collect();
        Peeled { rows: self.peeled, fixing: self.fixing, rest, unknown: self.unknown }
    }
}

/// The rows of each column.
fn pattern(matrix: &Csr) -> (Vec<usize>, Vec<u32>) {
    let mut start = vec![0; matrix.cols + 1];
    matrix.col.iter().for_each(|&j| start[j as usize + 1] += 1);
    (0..matrix.cols).for_each(|j| start[j + 1] += start[j]);
    let (mut next, mut holder) = (start.clone(), vec![0; matrix.nnz()]);
    for i in 0..matrix.rows() {
        for &j in &matrix.col[matrix.start[i]..matrix.start[i + 1]] {
            holder[next[j as usize]] = i as u32;
            next[j as usize] += 1;
        }
    }
    (start, holder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(cols: usize, rows: &[&[usize]]) -> Csr {
        let mut matrix = Csr::empty(cols);
        rows.iter().for_each(|row| matrix.append(row.iter().map(|&j| (j, 1.0))));
        matrix
    }

    #[test]
    fn a_path_is_peeled_from_its_ends_and_a_ring_is_left() {
        let path = matrix(4, &[&[0, 1], &[1, 2], &[2, 3]]);
        let peeled = peel(&path, &[true; 4]);
        assert_eq!((peeled.rows.len(), peeled.rest.len()), (3, 0));
        let ring = matrix(3, &[&[0, 1], &[1, 2], &[0, 2]]);
        let peeled = peel(&ring, &[true; 3]);
        assert_eq!((peeled.rows.len(), peeled.fixing.len(), peeled.rest), (0, 0, vec![0, 1, 2]));
    }

    #[test]
    fn one_prescribed_dof_of_a_ring_fixes_the_others_and_leaves_an_empty_row() {
        let ring = matrix(3, &[&[0, 1], &[1, 2], &[0, 2]]);
        let peeled = peel(&ring, &[false, true, true]);
        assert_eq!((peeled.rows.len(), peeled.fixing.len(), peeled.rest.len()), (0, 2, 1));
        assert_eq!(peeled.unknown, [false; 3]);
    }

    /// Rows without an unknown DOF remain.
    #[test]
    fn rows_without_free_dofs_are_left() {
        assert_eq!(peel(&matrix(2, &[&[], &[0]]), &[false; 2]).rest, [0, 1]);
    }
}
