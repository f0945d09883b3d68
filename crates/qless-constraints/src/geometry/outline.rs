//! What a facet is seen as: an interval of a line or a convex polygon of a plane; intersection, size, and Gauss points in it.

use super::clip::{Flat, area, clip, is_convex, perimeter, quadrature};

/// An outline. Points of a line are `[s, 0]`.
pub enum Outline {
    /// From and to.
    Interval(f64, f64),
    /// Corners, counter-clockwise.
    Polygon(Vec<Flat>),
}

impl Outline {
    /// From the ends of a line or the corners of a face, in either direction.
    pub fn new(mut corners: Vec<Flat>) -> Self {
        if let [a, b] = corners.as_slice() {
            return Self::Interval(a[0].min(b[0]), a[0].max(b[0]));
        }
        if area(&corners) < 0.0 {
            corners.reverse();
        }
        Self::Polygon(corners)
    }

    /// Length or area.
    pub fn size(&self) -> f64 {
        match self {
            Self::Interval(from, to) => to - from,
            Self::Polygon(corners) => area(corners),
        }
    }

    /// The size of a border, per width of it: the number of ends, or the perimeter.
    pub fn border(&self) -> f64 {
        match self {
            Self::Interval(..) => 2.0,
            Self::Polygon(corners) => perimeter(corners),
        }
    }

    pub fn is_convex(&self) -> bool {
        match self {
            Self::Interval(from, to) => to > from,
            Self::Polygon(corners) => is_convex(corners),
        }
    }

    /// What two outlines have in common; nothing if one is a line and the other is not.
    pub fn common(self, window: &Self) -> Option<Self> {
        match (self, window) {
            (Self::Interval(a, b), &Self::Interval(c, d)) => Some(Self::Interval(a.max(c), b.min(d))),
            (Self::Polygon(corners), Self::Polygon(window)) => Some(Self::Polygon(clip(corners, window))),
            _ => None,
        }
    }

    /// Points and weights whose sum is the integral, exact for polynomials up to degree five.
    pub fn quadrature(&self) -> Vec<(Flat, f64)> {
        match *self {
            Self::Interval(from, to) => {
                let (middle, half) = (f64::midpoint(from, to), (to - from) / 2.0);
                let gauss = [(-0.6_f64.sqrt(), 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.6_f64.sqrt(), 5.0 / 9.0)];
                gauss.map(|(xi, weight)| ([middle + xi * half, 0.0], weight * half)).to_vec()
            }
            Self::Polygon(ref corners) => quadrature(corners).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `int x^p dx = (b^(p + 1) - a^(p + 1)) / (p + 1)`.
    #[test]
    fn rule_of_lines_is_exact_up_to_degree_five() {
        let line = Outline::new(vec![[1.5, 0.0], [-0.25, 0.0]]);
        assert_eq!((line.size(), line.border()), (1.75, 2.0));
        for p in 0..=5 {
            let sum: f64 = line.quadrature().iter().map(|([x, _], weight)| weight * x.powi(p)).sum();
            let truth = (1.5_f64.powi(p + 1) - (-0.25_f64).powi(p + 1)) / f64::from(p + 1);
            assert!((sum - truth).abs() < 1e-15 * 8.0, "x^{p}: {sum}, {truth}");
        }
        let apart = Outline::Interval(2.0, 3.0).common(&line).expect("both are lines");
        assert!(apart.size() < 0.0);
    }
}
