//! Rigid motion of a grid point, `u = (t + w x r, w)` along the point's own axes, and equations between components.
//!
//! A motion is six numbers: the translation t and the rotation w, along and about the global axes. r is the arm from the origin of the
//! motion to the point. A component of the point is the product of the motion with a row of six numbers: `(e, r x e)` for components 1 to
//! 3, along axis e of the point, and `(0, e)` for components 4 to 6, about that axis.

use super::vector::{Vector, length, minus, plus, rounding_between, scaled};
use crate::deck::{Dof, Problem};

/// Six coefficients of a component. Their product with a motion (translation and rotation) is the value of the component.
pub type MotionRow = [f64; 6];

/// Position and axes of a grid point, in global coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub position: Vector,
    pub axes: [Vector; 3],
}

impl Pose {
    /// The row of component 1 to 6 of the point, for motions about `origin`.
    pub fn row(&self, component: u8, origin: Vector) -> MotionRow {
        if component > 3 {
            let [x, y, z] = self.axes[usize::from(component) - 4];
            return [0.0, 0.0, 0.0, x, y, z];
        }
        let [x, y, z] = self.axes[usize::from(component) - 1];
        let [p, q, r] = minus(self.position, origin);
        [x, y, z, product(&[q, -r], &[z, y]), product(&[r, -p], &[x, z]), product(&[p, -q], &[y, x])]
    }

    /// Expresses this pose in the frame of `other`, whose position is the origin. Then a row about the origin holds the coefficients of the
    /// six components of `other`.
    pub fn relative_to(&self, other: &Self) -> Self {
        let arm = minus(self.position, other.position);
        let rounding = rounding_between(self.position, other.position);
        let along = |axis: Vector| product(&axis, &arm);
        let position = other.axes.map(along).map(|x| if x.abs() <= rounding { 0.0 } else { x });
        let axes = self.axes.map(|own| other.axes.map(|axis| product(&axis, &own)));
        Self { position, axes }
    }
}

/// Gives the position and axes of grid points.
pub trait Poses {
    /// # Errors
    /// The node is undefined, or its pose is unknown.
    fn pose(&self, node: u32) -> Result<Pose, Problem>;
}

/// The equation `sum a u = 0`, where each component u has a coefficient a. The dependent component comes first, and no coefficient is 0.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingEquation {
    pub terms: Vec<(Dof, f64)>,
}

impl CouplingEquation {
    /// The equation `u_dependent - sum a u = 0`, where `others` holds the components u and the coefficients a.
    pub fn new(dependent: Dof, others: impl IntoIterator<Item = (Dof, f64)>) -> Self {
        let others = others.into_iter().filter(|&(_, value)| value != 0.0).map(|(at, value)| (at, -value));
        Self { terms: std::iter::once((dependent, 1.0)).chain(others).collect() }
    }
}

/// The mean of the positions, and the largest distance from the mean, or 1 if that distance is 0. The distance serves to convert rotations
/// to lengths.
pub fn centre_and_size(positions: impl ExactSizeIterator<Item = Vector> + Clone) -> (Vector, f64) {
    let share = 1.0 / positions.len() as f64;
    let centre = positions.clone().fold([0.0; 3], |sum, position| plus(sum, scaled(position, share)));
    let farthest = positions.map(|position| length(minus(position, centre))).fold(0.0, f64::max);
    (centre, if farthest > 0.0 { farthest } else { 1.0 })
}

/// The scalar product of a and b. It is 0 if it would be only a rounding error, so that perpendicular directions stay uncoupled.
pub fn product(a: &[f64], b: &[f64]) -> f64 {
    let largest = |v: &[f64]| v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    clean(a.iter().zip(b).map(|(x, y)| x * y).sum(), largest(a) * largest(b))
}

/// Returns `sum`, or 0 if `sum` is only a rounding error of terms of this size.
pub fn clean(sum: f64, size: f64) -> f64 {
    const ROUNDING: f64 = 64.0 * f64::EPSILON;
    if sum.is_finite() && sum.abs() <= ROUNDING * size { 0.0 } else { sum }
}

/// Data for tests: grid points with irregular positions and axes.
#[cfg(test)]
pub mod samples {
    use super::*;
    use crate::deck::kinematics::axes::{Frame, FrameKind};

    /// A different pose for each node.
    pub struct Irregular;

    impl Poses for Irregular {
        fn pose(&self, node: u32) -> Result<Pose, Problem> {
            let x = |k: u32| f64::from((node * 7919 + k * 104_729) % 1009) / 100.0 - 5.0;
            let frame = Frame::through(FrameKind::Spherical, [0.1, 0.2, 0.3], [x(1), x(2), x(3)], [x(4), x(5), x(6)]);
            let position = [x(7), x(8), x(9)];
            Ok(Pose { position, axes: frame.expect("a frame").axes_at(position) })
        }
    }

    /// Largest residual of the equations under the six rigid motions, relative to the size of the terms.
    pub fn rigid_residual(equations: &[CouplingEquation], poses: &impl Poses) -> f64 {
        let mut worst = 0.0_f64;
        for equation in equations {
            for motion in 0..6 {
                let value = |&(at, a): &(Dof, f64)| {
                    a * poses.pose(at.node).expect("a pose").row(at.component, [3.0, -2.0, 1.0])[motion]
                };
                let sum: f64 = equation.terms.iter().map(value).sum();
                let size: f64 = equation.terms.iter().map(|term| value(term).abs()).sum();
                worst = worst.max(sum.abs() / size.max(1.0));
            }
        }
        worst
    }
}

#[cfg(test)]
mod tests {
    use super::super::axes::BASIC_AXES;
    use super::*;

    #[test]
    fn a_rotation_about_the_third_axis_moves_points_around_it() {
        let rotation = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        let point = Pose { position: [2.0, 1.0, 5.0], axes: BASIC_AXES };
        let moved: Vec<f64> = (1..=6).map(|c| product(&point.row(c, [1.0, 1.0, 0.0]), &rotation)).collect();
        assert_eq!(moved, [0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        let rotated = Pose { axes: [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], ..point };
        let moved: Vec<f64> = (1..=6).map(|c| product(&rotated.row(c, [1.0, 1.0, 0.0]), &rotation)).collect();
        assert_eq!(moved, [1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn a_pose_relative_to_itself_has_unit_rows() {
        let point = Pose { position: [2.0, 1.0, 5.0], axes: [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]] };
        for component in 1..=6 {
            let row = point.relative_to(&point).row(component, [0.0; 3]);
            for (k, value) in row.into_iter().enumerate() {
                let expected = if k + 1 == usize::from(component) { 1.0 } else { 0.0 };
                assert!((value - expected).abs() < 1e-15, "{component} {k} {value}");
                assert!(expected != 0.0 || value == 0.0, "{component} {k} keeps a rounding error");
            }
        }
    }
}
