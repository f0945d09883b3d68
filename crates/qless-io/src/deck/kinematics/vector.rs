//! Vectors in space.

pub type Vector = [f64; 3];

pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn scaled(a: Vector, factor: f64) -> Vector {
    a.map(|x| x * factor)
}

pub fn plus(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Relative error of a coordinate with 14 digits: half of the last one. The widest field of Nastran has no room for more, and coordinates in
/// turned axes are computed from such numbers.
const TYPED: f64 = 5e-14;

/// The difference of two points. A component that is only a rounding error becomes 0, so that points of a plane `x_k = const` stay in it.
pub fn minus(a: Vector, b: Vector) -> Vector {
    let rounding = rounding_between(a, b);
    std::array::from_fn(|k| {
        let difference = a[k] - b[k];
        if difference.is_finite() && difference.abs() <= rounding { 0.0 } else { difference }
    })
}

/// Bound of the rounding in a component of the arm between two points: an arm may be far shorter than the coordinates.
pub fn rounding_between(a: Vector, b: Vector) -> f64 {
    TYPED * (largest(a) + largest(b))
}

/// The largest absolute component of a vector.
pub fn largest(a: Vector) -> f64 {
    a.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// The length |a|, without overflow.
pub fn length(a: Vector) -> f64 {
    a[0].hypot(a[1]).hypot(a[2])
}

/// Unit vector `a / |a|`; `None` if a is zero or not finite.
pub fn unit(a: Vector) -> Option<Vector> {
    let largest = largest(a);
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let a = a.map(|x| x / largest);
    Some(scaled(a, 1.0 / length(a)))
}
