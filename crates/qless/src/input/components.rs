//! Connected components of the graph of equations and free DOFs. They are independent: a result for one does not depend on the others
//! (section 3.1 of the paper).

use crate::common::DisjointSets;
use crate::input::numbering::LocalSystem;

/// The rows of each component, ascending; components in the order of their first rows. `dofs` gives the free DOFs of a row, which are below
/// `count`.
pub(crate) fn components<D: Iterator<Item = u32>>(
    rows: &[u32],
    count: usize,
    dofs: impl Fn(u32) -> D,
) -> Vec<Vec<u32>> {
    let labels = Labels::new(rows.len(), count, |k| dofs(rows[k]));
    let mut parts = vec![Vec::new(); labels.count];
    rows.iter().zip(&labels.of_row).for_each(|(&i, &part)| parts[part as usize].push(i));
    parts
}

/// The component of each row; components are numbered in the order of their first rows.
pub(crate) struct Labels {
    pub of_row: Vec<u32>,
    pub count: usize,
}

impl Labels {
    /// The components of all equations of a system.
    pub fn of(system: LocalSystem) -> Self {
        let free = system.free();
        let dofs = |i: usize| system.parts(i).0.iter().copied().filter(|&j| free[j as usize]);
        Self::new(system.equations(), system.dofs(), dofs)
    }

    /// The components of rows 0 to `rows` - 1. `dofs` gives the free DOFs of a row, which are below `count`.
    pub fn new<D: Iterator<Item = u32>>(rows: usize, count: usize, dofs: impl Fn(usize) -> D) -> Self {
        let mut owner = vec![u32::MAX; count];
        let mut sets = DisjointSets::new(rows);
        for k in 0..rows {
            for j in dofs(k) {
                match owner[j as usize] {
                    u32::MAX => owner[j as usize] = k as u32,
                    other => sets.join(other as usize, k),
                }
            }
        }
        let (of_row, count) = sets.numbered();
        Self { of_row, count }
    }

    /// Marks all rows in the components of the given rows.
    pub fn mark(&self, rows: &[usize], marked: &mut [bool]) {
        let mut of_label = vec![false; self.count];
        rows.iter().for_each(|&i| of_label[self.of_row[i] as usize] = true);
        marked.iter_mut().zip(&self.of_row).for_each(|(marked, &label)| *marked |= of_label[label as usize]);
    }
}

#[cfg(test)]
mod tests {
    use super::Labels;

    #[test]
    fn parts_are_joined_by_free_dofs_only() {
        let rows: [&[u32]; 6] = [&[0, 1], &[4, 5], &[3], &[1, 3, 6], &[3, 7], &[5, 6]];
        let labels = |prescribed: &[u32]| {
            let dofs = |i: usize| rows[i].iter().copied().filter(|j| !prescribed.contains(j));
            Labels::new(rows.len(), 8, dofs).of_row
        };
        assert_eq!(labels(&[3]), [0, 0, 1, 0, 2, 0]);
        assert_eq!(labels(&[3, 6]), [0, 1, 2, 0, 3, 1]);
    }
}
