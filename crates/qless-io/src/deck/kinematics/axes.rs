//! Coordinate frames. A point lies at `x = origin + e1 a + e2 b + e3 c`, where e1, e2, e3 are the axes of the frame, and `(a, b, c)` are
//! functions of the point's coordinates in the frame:
//!
//! | kind        | coordinates   | (a, b, c)                                        |
//! | ----------- | ------------- | ------------------------------------------------ |
//! | rectangular | x, y, z       | x, y, z                                          |
//! | cylindrical | r, theta, z   | r cos theta, r sin theta, z                      |
//! | spherical   | r, theta, phi | r sin theta cos phi, r sin theta sin phi, r cos theta |
//!
//! Angles are in degrees. The angle theta of a spherical frame is measured from its third axis.

use super::vector::{Vector, cross, dot, length, minus, plus, scaled, unit};

/// The kind of a frame's coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameKind {
    Rectangular,
    Cylindrical,
    Spherical,
}

/// A coordinate frame: its origin, and its orthonormal axes as rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    pub kind: FrameKind,
    pub origin: Vector,
    pub axes: [Vector; 3],
}

/// Axes of the global frame.
pub const BASIC_AXES: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Frame {
    pub const BASIC: Self = Self { kind: FrameKind::Rectangular, origin: [0.0; 3], axes: BASIC_AXES };

    /// The frame with origin a and third axis along `b - a`, such that c lies in the plane of the first and third axes. `None` if the
    /// points are on a line.
    pub fn through(kind: FrameKind, a: Vector, b: Vector, c: Vector) -> Option<Self> {
        const LEAST_SINE: f64 = 1e-10;
        let third = unit(minus(b, a))?;
        let towards = unit(minus(c, a))?;
        let second = cross(third, towards);
        if length(second) < LEAST_SINE {
            return None;
        }
        let second = unit(second)?;
        Some(Self { kind, origin: a, axes: [cross(second, third), second, third] })
    }

    /// The global position of the point with these coordinates in the frame.
    pub fn point(&self, coordinates: Vector) -> Vector {
        let [p, q, r] = coordinates;
        let local = match self.kind {
            FrameKind::Rectangular => coordinates,
            FrameKind::Cylindrical => [p * cosine(q), p * sine(q), r],
            FrameKind::Spherical => [p * sine(q) * cosine(r), p * sine(q) * sine(r), p * cosine(q)],
        };
        (0..3).fold(self.origin, |sum, k| plus(sum, scaled(self.axes[k], local[k])))
    }

    /// The local axes at a point. The point and the axes are in global coordinates.
    pub fn axes_at(&self, point: Vector) -> [Vector; 3] {
        let from = minus(point, self.origin);
        let local = self.axes.map(|axis| dot(axis, from));
        let size = from.iter().zip(point).fold(0.0, |m: f64, (x, y)| m.max(x.abs()).max(y.abs()));
        match self.kind {
            FrameKind::Rectangular => self.axes,
            FrameKind::Cylindrical => self.global(cylindrical(local, size)),
            FrameKind::Spherical => self.global(spherical(local, size)),
        }
    }

    /// Converts directions from components along this frame's axes to global components.
    fn global(&self, directions: [Vector; 3]) -> [Vector; 3] {
        directions.map(|d| (0..3).fold([0.0; 3], |sum, k| plus(sum, scaled(self.axes[k], d[k]))))
    }
}

/// The radial, tangential and axial directions at a point. On the axis, the angle counts as 0.
fn cylindrical([a, b, _]: Vector, size: f64) -> [Vector; 3] {
    let [cos, sin] = direction(a, b, size);
    [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]
}

/// The directions in which r, theta and phi increase.
fn spherical([a, b, c]: Vector, size: f64) -> [Vector; 3] {
    let [cos_phi, sin_phi] = direction(a, b, size);
    let [cos, sin] = direction(c, a.hypot(b), size);
    [[sin * cos_phi, sin * sin_phi, cos], [cos * cos_phi, cos * sin_phi, -sin], [-sin_phi, cos_phi, 0.0]]
}

/// The vector `(a, b)` scaled to length 1. If a and b are no more than rounding errors of coordinates of this `size`, returns `(1, 0)`.
fn direction(a: f64, b: f64, size: f64) -> [f64; 2] {
    let radius = a.hypot(b);
    if radius <= 16.0 * f64::EPSILON * size { [1.0, 0.0] } else { [a / radius, b / radius] }
}

/// Sine of an angle in degrees; exact at multiples of 90.
pub fn sine(degrees: f64) -> f64 {
    let angle = degrees % 360.0;
    match angle.abs() {
        0.0 | 180.0 => 0.0,
        90.0 => angle.signum(),
        270.0 => -angle.signum(),
        _ => angle.to_radians().sin(),
    }
}

fn cosine(degrees: f64) -> f64 {
    match (degrees % 360.0).abs() {
        90.0 | 270.0 => 0.0,
        0.0 => 1.0,
        180.0 => -1.0,
        angle => angle.to_radians().cos(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Vector, b: Vector) {
        assert!(length(minus(a, b)) < 1e-14, "{a:?} {b:?}");
    }

    #[test]
    fn points_in_every_kind_of_frame() {
        let at = |kind| Frame::through(kind, [1.0, 0.0, 0.0], [1.0, 0.0, 2.0], [3.0, 0.0, 1.0]).expect("a frame");
        near(at(FrameKind::Rectangular).point([1.0, 2.0, 3.0]), [2.0, 2.0, 3.0]);
        near(at(FrameKind::Cylindrical).point([2.0, 90.0, 3.0]), [1.0, 2.0, 3.0]);
        near(at(FrameKind::Spherical).point([2.0, 90.0, 180.0]), [-1.0, 0.0, 0.0]);
        near(at(FrameKind::Spherical).point([2.0, 0.0, 17.0]), [1.0, 0.0, 2.0]);
    }

    #[test]
    fn directions_follow_the_point() {
        let frame =
            Frame::through(FrameKind::Cylindrical, [0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]).expect("a frame");
        let [radial, tangential, axial] = frame.axes_at([0.0, 5.0, 2.0]);
        near(radial, [0.0, 1.0, 0.0]);
        near(tangential, [-1.0, 0.0, 0.0]);
        near(axial, [0.0, 0.0, 1.0]);
        assert_eq!(frame.axes_at([0.0, 0.0, 2.0]), BASIC_AXES);
        let ball = Frame { kind: FrameKind::Spherical, ..frame };
        let [radial, theta, phi] = ball.axes_at([0.0, 3.0, 0.0]);
        near(radial, [0.0, 1.0, 0.0]);
        near(theta, [0.0, 0.0, -1.0]);
        near(phi, [-1.0, 0.0, 0.0]);
    }

    #[test]
    fn axes_are_orthonormal_and_right_handed() {
        let frame =
            Frame::through(FrameKind::Rectangular, [1.0, 2.0, 3.0], [4.0, 1.0, 9.0], [0.3, 7.0, 2.0]).expect("a frame");
        for kind in [FrameKind::Rectangular, FrameKind::Cylindrical, FrameKind::Spherical] {
            let [a, b, c] = Frame { kind, ..frame }.axes_at([5.0, -6.0, 7.0]);
            near(cross(a, b), c);
            near(cross(b, c), a);
        }
    }

    #[test]
    fn three_points_in_line_make_no_frame() {
        let make = |b, c| Frame::through(FrameKind::Rectangular, [1.0, 1.0, 1.0], b, c);
        assert!(make([1.0, 1.0, 1.0], [2.0, 1.0, 1.0]).is_none());
        assert!(make([2.0, 2.0, 2.0], [-3.0, -3.0, -3.0]).is_none());
        assert!(make([2.0, 2.0, 2.0], [f64::INFINITY, 0.0, 0.0]).is_none());
        assert!(make([2.0, 2.0, 2.0], [2.0, 2.0, 2.1]).is_some());
    }
}
