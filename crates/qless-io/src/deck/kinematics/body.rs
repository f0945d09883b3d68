//! Rigid motion of a grid point: `u = (t + w x r, w)` along the point's own axes, where r is the arm from the origin
//! of the motion.
//!
//! A motion is six numbers: translation t and rotation w about the global axes. Component i of a point is a row of
//! six: `(e, r x e)` for 1 to 3, along its axis e, and `(0, e)` for 4 to 6, about it.

use super::vector::{Vector, largest, minus};

/// Row of one component. Its product with a motion is the component's value.
pub type MotionRow = [f64; 6];

/// Position and axes of a grid point, in global coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub position: Vector,
    pub axes: [Vector; 3],
}

impl Pose {
    /// The row of component 1 to 6 for motions about `origin`.
    pub fn row(&self, component: u8, origin: Vector) -> MotionRow {
        if component > 3 {
            let [x, y, z] = self.axes[usize::from(component) - 4];
            return [0.0, 0.0, 0.0, x, y, z];
        }
        let [x, y, z] = self.axes[usize::from(component) - 1];
        let [p, q, r] = minus(self.position, origin);
        let turning = |a: [f64; 2], b: [f64; 2]| product(&a, &b);
        [x, y, z, turning([q, -r], [z, y]), turning([r, -p], [x, z]), turning([p, -q], [y, x])]
    }

    /// This point in the axes of another one, with that point as origin. The rows are then in terms of the other
    /// point's components.
    pub fn seen_from(&self, other: &Self) -> Self {
        let arm = minus(self.position, other.position);
        let rounding = 8.0 * f64::EPSILON * (largest(self.position) + largest(other.position));
        let along = |axis: Vector| product(&axis, &arm);
        let position = other.axes.map(along).map(|x| if x.abs() <= rounding { 0.0 } else { x });
        let axes = self.axes.map(|own| other.axes.map(|axis| product(&axis, &own)));
        Self { position, axes }
    }
}

/// Scalar product; 0 if it is only a rounding error, so that perpendicular directions stay uncoupled.
pub fn product(a: &[f64], b: &[f64]) -> f64 {
    let largest = |v: &[f64]| v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    clean(a.iter().zip(b).map(|(x, y)| x * y).sum(), largest(a) * largest(b))
}

/// `sum`, or 0 if it is only a rounding error of terms of this size.
pub fn clean(sum: f64, size: f64) -> f64 {
    const ROUNDING: f64 = 64.0 * f64::EPSILON;
    if sum.is_finite() && sum.abs() <= ROUNDING * size { 0.0 } else { sum }
}

#[cfg(test)]
mod tests {
    use super::super::axes::BASIC_AXES;
    use super::*;

    #[test]
    fn a_turn_about_the_third_axis_moves_points_around_it() {
        let turn = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        let point = Pose { position: [2.0, 1.0, 5.0], axes: BASIC_AXES };
        let moved: Vec<f64> = (1..=6).map(|c| product(&point.row(c, [1.0, 1.0, 0.0]), &turn)).collect();
        assert_eq!(moved, [0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        let turned = Pose { axes: [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], ..point };
        let moved: Vec<f64> = (1..=6).map(|c| product(&turned.row(c, [1.0, 1.0, 0.0]), &turn)).collect();
        assert_eq!(moved, [1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn a_point_seen_from_itself_has_unit_rows() {
        let point = Pose { position: [2.0, 1.0, 5.0], axes: [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]] };
        for component in 1..=6 {
            let row = point.seen_from(&point).row(component, [0.0; 3]);
            for (k, value) in row.into_iter().enumerate() {
                let expected = if k + 1 == usize::from(component) { 1.0 } else { 0.0 };
                assert!((value - expected).abs() < 1e-15, "{component} {k} {value}");
                assert!(expected != 0.0 || value == 0.0, "rounding is left in {component} {k}");
            }
        }
    }
}
