//! By what random numbers are drawn.

use crate::input::components::Labels;
use crate::input::numbering::Local;

/// By what random numbers are drawn: places within the component, so that they are the same whatever stands beside it, or, where
/// nothing hangs on them, places in the whole.
#[derive(Default)]
pub(crate) struct Keys {
    rows: Vec<u32>,
    dofs: Vec<u32>,
}

impl Keys {
    /// Places within components.
    pub fn within(labels: &Labels, system: Local) -> Self {
        let (mut next_row, mut next_dof) = (vec![0; labels.count], vec![0; labels.count]);
        let mut rows = Vec::with_capacity(labels.of_row.len());
        let mut dofs = vec![u32::MAX; system.dofs()];
        let draw = |next: &mut u32| {
            *next += 1;
            *next - 1
        };
        for (i, &label) in labels.of_row.iter().enumerate() {
            rows.push(draw(&mut next_row[label as usize]));
            for &j in system.parts(i).0.iter().filter(|&&j| system.free()[j as usize]) {
                if dofs[j as usize] == u32::MAX {
                    dofs[j as usize] = draw(&mut next_dof[label as usize]);
                }
            }
        }
        Self { rows, dofs }
    }

    pub fn are_within(&self) -> bool {
        !self.rows.is_empty()
    }

    #[inline]
    pub fn row(&self, i: u32) -> u64 {
        u64::from(self.rows.get(i as usize).copied().unwrap_or(i))
    }

    #[inline]
    pub fn dof(&self, j: usize) -> u64 {
        self.dofs.get(j).map_or(j as u64, |&key| u64::from(key))
    }
}
