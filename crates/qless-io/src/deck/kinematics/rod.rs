//! `RROD`: a rod of constant length, `n . (u_b - u_a) = 0`, where n is its direction.

use super::body::product;
use super::row::{Poses, Row};
use super::vector::{minus, unit};
use crate::deck::{CardFault, Dof, Problem};

/// A rigid rod between two grid points; `dependent` is one of their translations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rod {
    pub ends: [u32; 2],
    pub dependent: Dof,
}

impl Rod {
    /// The equation, divided by the coefficient of the dependent component.
    pub fn rows(&self, poses: &impl Poses) -> Result<Vec<Row>, Problem> {
        let [a, b] = self.ends;
        let (pose_a, pose_b) = (poses.pose(a)?, poses.pose(b)?);
        let along = unit(minus(pose_b.position, pose_a.position)).ok_or_else(|| no_length(a, b))?;
        let ends = [(a, pose_a, -1.0), (b, pose_b, 1.0)];
        let terms: Vec<(Dof, f64)> = ends
            .iter()
            .flat_map(|&(node, pose, sign)| {
                (1..=3)
                    .zip(pose.axes)
                    .map(move |(component, axis)| (Dof { node, component }, sign * product(&axis, &along)))
            })
            .collect();
        self.solved(&terms).map(|row| vec![row])
    }

    fn solved(&self, terms: &[(Dof, f64)]) -> Result<Row, Problem> {
        let Dof { node, component } = self.dependent;
        let pivot = terms.iter().find(|(at, _)| *at == self.dependent).map_or(0.0, |&(_, value)| value);
        if pivot == 0.0 {
            return Err(CardFault::AcrossRod { node, component }.into());
        }
        let others = terms.iter().filter(|(at, _)| *at != self.dependent);
        Ok(Row::new(self.dependent, others.map(|&(at, value)| (at, -value / pivot))))
    }
}

fn no_length(a: u32, b: u32) -> Problem {
    Problem::Degenerate { what: format!("the ends {a} and {b} of the rod are at the same place") }
}

#[cfg(test)]
mod tests {
    use super::super::axes::BASIC_AXES;
    use super::super::body::Pose;
    use super::super::row::samples::{Irregular, rigid_residual};
    use super::*;

    struct RodPlane;

    impl Poses for RodPlane {
        fn pose(&self, node: u32) -> Result<Pose, Problem> {
            let position = if node == 1 { [0.0; 3] } else { [3.0, 4.0, 0.0] };
            Ok(Pose { position, axes: BASIC_AXES })
        }
    }

    #[test]
    fn a_rod_in_a_plane() {
        let rows = Rod { ends: [1, 2], dependent: Dof { node: 2, component: 1 } }.rows(&RodPlane).expect("a row");
        let terms: Vec<_> = rows[0].terms.iter().map(|&(at, value)| (at.node, at.component, value)).collect();
        for (found, expected) in terms.iter().zip([(2, 1, 1.0), (1, 1, -1.0), (1, 2, -4.0 / 3.0), (2, 2, 4.0 / 3.0)]) {
            assert_eq!((found.0, found.1), (expected.0, expected.1));
            assert!((found.2 - expected.2).abs() < 1e-15);
        }
        assert_eq!(terms.len(), 4);
    }

    #[test]
    fn rigid_motions_leave_no_residual() {
        let rows = Rod { ends: [7, 8], dependent: Dof { node: 7, component: 2 } }.rows(&Irregular).expect("a row");
        assert!(rigid_residual(&rows, &Irregular) < 1e-12);
    }

    #[test]
    fn rods_that_cannot_be_solved_are_refused() {
        let rod = |a, b, component| Rod { ends: [a, b], dependent: Dof { node: b, component } }.rows(&RodPlane);
        assert_eq!(rod(2, 3, 1), Err(no_length(2, 3)));
        assert_eq!(rod(1, 2, 3), Err(CardFault::AcrossRod { node: 2, component: 3 }.into()));
        assert_eq!(rod(1, 2, 4), Err(CardFault::AcrossRod { node: 2, component: 4 }.into()));
    }
}
