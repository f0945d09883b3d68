//! The pass over C that numbers its DOFs. For a very large C, two threads number the DOFs of one half of the equations each.
//!
//! Each half numbers its DOFs by first appearance. DOFs of the second half get numbers after those of the first, unless the first half
//! contains them too. The result equals that of one pass over all equations.

use std::hint::black_box;
use std::ops::Range;

use rayon::prelude::*;

use super::{Column, Exponents};
use crate::Csr;
use crate::common::pool::gather;
use crate::common::prefetch::{BATCH, IN_CACHE};

/// With fewer equations the second thread gains nothing, as measured at 3e5 and 1e6.
const WORTH_HALVES: usize = 1 << 20;

/// The lists of DOFs grow to this many places more than the next row needs. Memory that is reserved beyond these places is never touched.
const ROOM: usize = 1 << 10;

/// Marks a DOF without a number.
const NONE: u32 = u32::MAX;

/// The result of a pass over some equations.
pub(super) struct Pass {
    /// Local number of each of the user's DOFs.
    local: Vec<u32>,
    /// For the second half of the equations: the number of each of the user's DOFs within this half, and the final number of each DOF of
    /// this half.
    later: Option<(Vec<u32>, Vec<u32>)>,
    /// The user's number of each local DOF.
    pub dofs: Vec<u32>,
    /// The equations of each local DOF.
    pub columns: Vec<Column>,
    /// The range of exponents of each equation's coefficients.
    pub exponents: Vec<Exponents>,
}

/// The local DOF of each entry of C, and the result of the pass.
pub(super) fn number(c: &Csr) -> (Vec<u32>, Pass) {
    let mut entries = vec![0; c.nnz()];
    let pass = if c.rows() < WORTH_HALVES || rayon::current_num_threads() == 1 {
        Pass::over(c, 0..c.rows(), &mut entries)
    } else {
        in_halves(c, &mut entries)
    };
    (entries, pass)
}

fn in_halves(c: &Csr, entries: &mut [u32]) -> Pass {
    let half = c.rows() / 2;
    let (first, second) = entries.split_at_mut(c.start[half]);
    let (mut pass, later) = rayon::join(|| Pass::over(c, 0..half, first), || Pass::over(c, half..c.rows(), second));
    let numbers = pass.append(later);
    second.par_iter_mut().for_each(|entry| *entry = numbers[*entry as usize]);
    pass
}

impl Pass {
    /// Writes the local DOF of each entry to `entries`. The same pass counts the rows of each DOF and finds each row's range of exponents.
    fn over(c: &Csr, rows: Range<usize>, entries: &mut [u32]) -> Self {
        let mut local = vec![NONE; c.cols];
        // One place more than there are DOFs: each entry writes to the next free place without a branch, which would be unpredictable.
        let most = c.cols.min(entries.len()) + 1;
        let (mut dofs, mut columns) = (Vec::with_capacity(most), Vec::with_capacity(most));
        let mut count = 0;
        let mut exponents = Vec::with_capacity(rows.len());
        let (first, end) = (c.start[rows.start], c.start[rows.end]);
        let mut asked = if c.cols > IN_CACHE { first } else { end };
        for i in rows {
            let range = c.start[i]..c.start[i + 1];
            if range.end > asked {
                let ahead = asked..(range.end + BATCH).min(end);
                asked = ahead.end;
                black_box(c.col[ahead].iter().fold(0, |all, &j| all ^ local[j as usize]));
            }
            let mut of_row = Exponents::NONE;
            let needed = count as usize + range.len() + 1;
            if needed > dofs.len() && dofs.len() < most {
                let length = (needed + ROOM).min(most);
                dofs.resize(length, 0);
                columns.resize(length, Column::default());
            }
            let of_entries = &mut entries[range.start - first..range.end - first];
            for ((entry, &j), &v) in of_entries.iter_mut().zip(&c.col[range.clone()]).zip(&c.val[range]) {
                let known = local[j as usize];
                let is_new = known == NONE;
                let l = if is_new { count } else { known };
                local[j as usize] = l;
                dofs[count as usize] = j;
                count += u32::from(is_new);
                columns[l as usize].enter(i as u32);
                *entry = l;
                of_row = of_row.with(v);
            }
            exponents.push(of_row);
        }
        dofs.truncate(count as usize);
        columns.truncate(count as usize);
        Self { local, later: None, dofs, columns, exponents }
    }

    /// The local number of a DOF, if the equations contain it.
    pub fn find(&self, j: usize) -> Option<u32> {
        let of_later = |(local, numbers): &(Vec<u32>, Vec<u32>)| numbers.get(local[j] as usize).copied();
        Some(self.local[j]).filter(|&l| l != NONE).or_else(|| self.later.as_ref().and_then(of_later))
    }

    /// Appends the pass over the following equations; returns the final local number of each DOF of this second pass.
    fn append(&mut self, later: Self) -> &[u32] {
        let mut numbers = gather(&self.local, &later.dofs);
        for ((number, j), column) in numbers.iter_mut().zip(later.dofs).zip(later.columns) {
            if *number == NONE {
                *number = self.dofs.len() as u32;
                self.dofs.push(j);
                self.columns.push(column);
            } else {
                self.columns[*number as usize].join(column);
            }
        }
        self.exponents.extend(later.exponents);
        &self.later.insert((later.local, numbers)).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `rows` equations of three DOFs out of `cols`, in an irregular order.
    fn mixed(rows: usize, cols: u32) -> Csr {
        let mut c = Csr::empty(cols as usize);
        for i in 0..rows as u32 {
            let mut row = [7, 31, 101].map(|k| (k * i + i * i + k) % cols).to_vec();
            row.sort_unstable();
            row.dedup();
            c.append(row.into_iter().map(|j| (j as usize, f64::from(i + j + 1))));
        }
        c
    }

    #[test]
    fn two_halves_number_as_one_pass() {
        for (rows, cols) in [(2, 9), (3, 5), (60, 400), (500, 37), (501, 5000)] {
            let c = mixed(rows, cols);
            let [mut one, mut two] = [(); 2].map(|()| vec![0; c.nnz()]);
            let (whole, halves) = (Pass::over(&c, 0..rows, &mut one), in_halves(&c, &mut two));
            let columns = |pass: &Pass| pass.columns.iter().map(|c| (c.count, c.rows)).collect::<Vec<_>>();
            let exponents = |pass: &Pass| pass.exponents.iter().map(|e| (e.least, e.most)).collect::<Vec<_>>();
            assert_eq!((one, &whole.dofs), (two, &halves.dofs), "{rows} x {cols}");
            assert_eq!((columns(&whole), exponents(&whole)), (columns(&halves), exponents(&halves)));
            let of_all = |pass: &Pass| (0..cols as usize).map(|j| pass.find(j)).collect::<Vec<_>>();
            assert_eq!(of_all(&whole), of_all(&halves));
            assert_eq!(of_all(&whole).iter().flatten().count(), whole.dofs.len());
        }
    }
}
