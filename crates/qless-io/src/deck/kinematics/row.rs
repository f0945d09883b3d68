//! Equations between components: `sum a u = 0`, dependent component first.

use super::body::Pose;
use crate::deck::{Dof, Problem};

/// An equation without zero coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub terms: Vec<(Dof, f64)>,
}

impl Row {
    /// `u_dependent - sum a u = 0`.
    pub fn new(dependent: Dof, others: impl IntoIterator<Item = (Dof, f64)>) -> Self {
        let others = others.into_iter().filter(|&(_, value)| value != 0.0).map(|(at, value)| (at, -value));
        Self { terms: std::iter::once((dependent, 1.0)).chain(others).collect() }
    }
}

/// Finds the position and axes of grid points; fails for an undefined one.
pub trait Poses {
    fn pose(&self, node: u32) -> Result<Pose, Problem>;
}

/// Test data: grid points with irregular positions and axes.
#[cfg(test)]
pub mod samples {
    use super::super::axes::{Frame, Kind};
    use super::*;

    /// A different pose for each node.
    pub struct Irregular;

    impl Poses for Irregular {
        fn pose(&self, node: u32) -> Result<Pose, Problem> {
            let x = |k: u32| f64::from((node * 7919 + k * 104_729) % 1009) / 100.0 - 5.0;
            let frame = Frame::through(Kind::Spherical, [0.1, 0.2, 0.3], [x(1), x(2), x(3)], [x(4), x(5), x(6)]);
            let position = [x(7), x(8), x(9)];
            Ok(Pose { position, axes: frame.expect("a frame").axes_at(position) })
        }
    }

    /// Largest residual of the rows under the six rigid motions, relative to the size of the terms.
    pub fn rigid_residual(rows: &[Row], poses: &impl Poses) -> f64 {
        let mut worst = 0.0_f64;
        for row in rows {
            for motion in 0..6 {
                let value = |&(at, a): &(Dof, f64)| {
                    a * poses.pose(at.node).expect("a pose").row(at.component, [3.0, -2.0, 1.0])[motion]
                };
                let sum: f64 = row.terms.iter().map(value).sum();
                let size: f64 = row.terms.iter().map(|term| value(term).abs()).sum();
                worst = worst.max(sum.abs() / size.max(1.0));
            }
        }
        worst
    }
}
