//! Removes triangular equations: those with a DOF that occurs in no other equation, and those with one unknown DOF.
//!
//! Whether an equation is removed depends only on which coefficients are zero, so its coefficients affect neither the rank nor the distance
//! from dependence, and no nonzero coefficient has the residue 0, so all primes share one result. O(nnz).

/// What remains of some equations and their DOFs, and the equations that were removed.
pub(super) struct Peeled {
    /// Equations with a DOF that occurs in no remaining equation: independent, whatever their coefficients are.
    pub rows: Vec<u32>,
    /// Equations that fix a DOF, as `(equation, DOF)`. All other DOFs of the equation are prescribed, or fixed by an earlier equation of
    /// this list.
    pub fixing: Vec<(u32, u32)>,
    /// The remaining equations, ascending.
    pub rest: Vec<u32>,
    /// For each DOF, true if it is still unknown: neither prescribed nor fixed.
    pub unknown: Vec<bool>,
}

/// Removes equations with a DOF in no other equation (column singletons), or else equations with one unknown DOF (row singletons), until
/// there are none. `dofs` gives the DOFs of each of `count` equations, and `free` says for each DOF whether it is not prescribed.
pub(super) fn peel<'a>(count: usize, dofs: impl Fn(usize) -> &'a [u32], free: &[bool]) -> Peeled {
    let mut work = PeelWork::new(count, dofs, free);
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

struct PeelWork<F> {
    dofs: F,
    /// The equations of each DOF: `holder[start[j]..start[j + 1]]`.
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

impl<'a, F: Fn(usize) -> &'a [u32]> PeelWork<F> {
    fn new(count: usize, dofs: F, free: &[bool]) -> Self {
        let (start, holder) = transposed(count, &dofs, free.len());
        let holders: Vec<u32> = start.windows(2).map(|range| (range[1] - range[0]) as u32).collect();
        let unknown_of = |i: usize| dofs(i).iter().filter(|&&j| free[j as usize]).count() as u32;
        let length: Vec<u32> = (0..count).map(unknown_of).collect();
        let columns = (0..free.len() as u32).filter(|&j| free[j as usize] && holders[j as usize] == 1).collect();
        let rows = (0..count as u32).filter(|&i| length[i as usize] == 1).collect();
        let (taken, unknown) = (vec![false; count], free.to_vec());
        let (peeled, fixing) = (Vec::new(), Vec::new());
        Self { dofs, start, holder, holders, length, taken, unknown, columns, rows, peeled, fixing }
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
        let Some(&dof) = (self.dofs)(i).iter().find(|&&j| self.unknown[j as usize]) else { return };
        self.fixing.push((row, dof));
        self.take(row);
        let dof = dof as usize;
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
        for &j in (self.dofs)(row as usize) {
            self.holders[j as usize] -= 1;
            if self.holders[j as usize] == 1 && self.unknown[j as usize] {
                self.columns.push(j);
            }
        }
    }

    fn done(self) -> Peeled {
        let rest = (0..self.taken.len() as u32).filter(|&i| !self.taken[i as usize]).collect();
        Peeled { rows: self.peeled, fixing: self.fixing, rest, unknown: self.unknown }
    }
}

/// The equations of each DOF j, `holder[start[j]..start[j + 1]]`, ascending.
fn transposed<'a>(count: usize, dofs: impl Fn(usize) -> &'a [u32], cols: usize) -> (Vec<usize>, Vec<u32>) {
    let mut start = vec![0; cols + 1];
    (0..count).flat_map(&dofs).for_each(|&j| start[j as usize + 1] += 1);
    (0..cols).for_each(|j| start[j + 1] += start[j]);
    let (mut next, mut holder) = (start.clone(), vec![0; start[cols]]);
    for i in 0..count {
        for &j in dofs(i) {
            holder[next[j as usize]] = i as u32;
            next[j as usize] += 1;
        }
    }
    (start, holder)
}

#[cfg(test)]
mod tests {
    use super::{Peeled, peel};

    fn peeled(rows: &[&[u32]], free: &[bool]) -> Peeled {
        peel(rows.len(), |i| rows[i], free)
    }

    #[test]
    fn a_path_is_peeled_from_its_ends_and_a_ring_is_left() {
        let path = peeled(&[&[0, 1], &[1, 2], &[2, 3]], &[true; 4]);
        assert_eq!((path.rows.len(), path.rest.len()), (3, 0));
        let ring = peeled(&[&[0, 1], &[1, 2], &[0, 2]], &[true; 3]);
        assert_eq!((ring.rows.len(), ring.fixing.len(), ring.rest), (0, 0, vec![0, 1, 2]));
    }

    #[test]
    fn one_prescribed_dof_of_a_ring_fixes_the_others_and_leaves_an_empty_row() {
        let ring = peeled(&[&[0, 1], &[1, 2], &[0, 2]], &[false, true, true]);
        assert_eq!((ring.rows.len(), ring.fixing.len(), ring.rest.len()), (0, 2, 1));
        assert_eq!(ring.unknown, [false; 3]);
    }

    /// Rows without an unknown DOF remain.
    #[test]
    fn rows_without_free_dofs_are_left() {
        assert_eq!(peeled(&[&[], &[0]], &[false; 2]).rest, [0, 1]);
    }
}
