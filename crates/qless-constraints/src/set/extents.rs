//! How large a DOF is, in the unit of the model: what its last place is counted from.

use super::ConstraintSet;

impl ConstraintSet {
    /// Size of each DOF at u, in the unit of the model: `max(|u_j|, |at|)` with the largest coordinate of the nodes that DOF j moves; at least 1 rad for rotations.
    pub fn extents(&self, u: &[f64]) -> Vec<f64> {
        let at = self.stated.largest().iter().map(|size| size.node.number()).chain(std::iter::repeat(0.0));
        let mut sizes: Vec<f64> = u.iter().zip(at).map(|(u, at)| u.abs().max(at)).collect();
        self.blocks.all.iter().for_each(|block| {
            block.rotation_vectors(&mut |dofs, places| {
                let rotations = places.iter().flat_map(|&k| &dofs[k..k + 3]);
                rotations.for_each(|&j| sizes[j as usize] = sizes[j as usize].max(1.0));
            });
        });
        sizes
    }

    /// Whether DOF j is a displacement of a node.
    pub fn is_displacement(&self, dof: usize) -> bool {
        self.stated.largest().get(dof).is_some_and(|sizes| sizes.node.is_something())
    }
}
