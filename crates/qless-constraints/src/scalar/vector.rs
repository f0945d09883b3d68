//! Vectors with three components: `a + b`, `a . b`, `a x b`.

#![expect(clippy::inline_always, reason = "in functions with wider instructions nothing else gets them")]

use super::{Arithmetic, Scalar};

/// Three components.
pub type Vector<S> = [S; 3];

/// Converts a constant vector.
#[inline(always)]
pub fn lift<S: Arithmetic>(a: Vector<f64>) -> Vector<S> {
    a.map(S::from)
}

/// `a + b`.
#[inline(always)]
pub fn add<S: Arithmetic>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a - b`.
#[inline(always)]
pub fn sub<S: Arithmetic>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `f a`.
#[inline(always)]
pub fn scale<S: Arithmetic>(f: S, a: Vector<S>) -> Vector<S> {
    [f * a[0], f * a[1], f * a[2]]
}

/// `a . b`.
#[inline(always)]
pub fn dot<S: Arithmetic>(a: Vector<S>, b: Vector<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a x b`.
#[inline(always)]
pub fn cross<S: Arithmetic>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `|a|`.
pub fn norm<S: Scalar>(a: Vector<S>) -> S {
    dot(a, a).sqrt()
}

/// `|a|` without squares, which may overflow.
pub fn hypot(a: Vector<f64>) -> f64 {
    a[0].hypot(a[1]).hypot(a[2])
}

/// The unit vector along a coordinate axis.
pub fn axis(k: usize) -> Vector<f64> {
    std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 })
}

/// `a / |a|`; `None` if the length is zero or not finite.
///
/// ```
/// use qless_constraints::scalar::vector::unit;
/// assert_eq!(unit([0.0, 3.0, 4.0]), Some([0.0, 0.6, 0.8]));
/// assert_eq!(unit([0.0; 3]), None);
/// ```
pub fn unit(a: Vector<f64>) -> Option<Vector<f64>> {
    let largest = a.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let sound = a.iter().all(|x| x.is_finite()) && largest > 0.0;
    let scaled = a.map(|x| x / largest);
    sound.then(|| scaled.map(|x| x / norm(scaled)))
}

/// Two unit vectors perpendicular to the unit vector `a` and to each other.
pub fn perpendicular(a: Vector<f64>) -> [Vector<f64>; 2] {
    let smallest = (0..3).min_by(|&i, &j| a[i].abs().total_cmp(&a[j].abs())).unwrap_or(0);
    let mut other = [0.0; 3];
    other[smallest] = 1.0;
    let across = cross(a, other);
    let across = scale(1.0 / norm(across), across);
    [across, cross(a, across)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn perpendicular_vectors_are_a_frame() {
        for a in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [1.0, 2.0, 3.0], [-1.0, 1.0, 1.0]] {
            let a = unit(a).expect("not zero");
            let [b, c] = perpendicular(a);
            for (x, y, truth) in [(a, b, 0.0), (a, c, 0.0), (b, c, 0.0), (b, b, 1.0), (c, c, 1.0)] {
                assert!((dot(x, y) - truth).abs() < 1e-15);
            }
        }
    }
}
