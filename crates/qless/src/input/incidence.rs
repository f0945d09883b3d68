//! The equations of each DOF: the pattern of C by columns.

use super::numbering::LocalSystem;

/// The rows of each local DOF, ascending. O(nnz) time, 4 (nnz + n) bytes.
pub(crate) struct Incidence {
    start: Vec<u32>,
    rows: Vec<u32>,
}

impl Incidence {
    pub fn new(system: LocalSystem) -> Self {
        let mut start = vec![0_u32; system.dofs() + 1];
        let dofs = |i: usize| system.parts(i).0.iter().map(|&j| j as usize);
        (0..system.equations()).flat_map(dofs).for_each(|j| start[j + 1] += 1);
        for j in 0..system.dofs() {
            start[j + 1] += start[j];
        }
        let mut next = start.clone();
        let mut rows = vec![0; start[system.dofs()] as usize];
        for i in 0..system.equations() {
            for j in dofs(i) {
                rows[next[j] as usize] = i as u32;
                next[j] += 1;
            }
        }
        Self { start, rows }
    }

    /// The equations that contain a DOF.
    pub fn rows(&self, dof: u32) -> &[u32] {
        let j = dof as usize;
        &self.rows[self.start[j] as usize..self.start[j + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SystemBuilder;
    use crate::input::numbering::Numbering;

    #[test]
    fn rows_of_each_dof_ascend() {
        let mut builder = SystemBuilder::new(9);
        builder.equation([(7, 1.0), (2, -1.0)], 0.0);
        builder.equation([(2, 1.0), (5, -1.0)], 0.0);
        builder.equation([(5, 1.0), (7, -1.0)], 0.0);
        let system = builder.build().expect("valid");
        let numbering = Numbering::new(&system).0;
        let incidence = Incidence::new(numbering.view(&system, system.rhs()));
        let of = |dof: u32| incidence.rows(numbering.dofs.iter().position(|&j| j == dof).expect("it occurs") as u32);
        assert_eq!((of(2), of(5), of(7)), (&[0, 1][..], &[1, 2][..], &[0, 2][..]));
    }
}
