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
        let difference = difference(a[k], b[k]);
        if difference.is_finite() && difference.abs() <= rounding { 0.0 } else { difference }
    })
}

/// A difference below this share of its terms has lost two digits, and is computed from the decimals as typed.
const CLOSE: f64 = 0.01;

/// `a - b`, rounded once if both were typed: `1234617.1 - 1234567.1` is 50, and 1e-10 more in doubles.
fn difference(a: f64, b: f64) -> f64 {
    let plain = a - b;
    let is_close = plain != 0.0 && plain.abs() < CLOSE * a.abs().max(b.abs());
    if is_close { difference_as_typed(a, b).unwrap_or(plain) } else { plain }
}

fn difference_as_typed(a: f64, b: f64) -> Option<f64> {
    let (a, b) = (decimal(a)?, decimal(b)?);
    let power = a.1.min(b.1);
    let whole = |(digits, own): (i128, i32)| digits.checked_mul(10_i128.checked_pow((own - power) as u32)?);
    let difference = whole(a)?.checked_sub(whole(b)?)?;
    format!("{difference}e{power}").parse().ok()
}

/// A number as `digits * 10^power`, if it has at most the 15 digits that survive in a double: longer numbers were computed.
fn decimal(x: f64) -> Option<(i128, i32)> {
    let text = format!("{x:e}");
    let (digits, power) = text.split_once('e')?;
    let behind = digits.split_once('.').map_or(0, |(_, behind)| behind.len());
    let whole: i128 = digits.replace('.', "").parse().ok()?;
    let power = power.parse::<i32>().ok()? - behind as i32;
    (whole.unsigned_abs() < 10_u128.pow(15)).then_some((whole, power))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_typed_numbers_are_rounded_once() {
        for (a, b, expected) in [
            (1_234_617.1, 1_234_567.1, 50.0),
            (12345.7, 12345.6, 0.1),
            (-1e6, -1_000_000.25, 0.25),
            (1e300, 1e-300, 1e300),
            (0.1, 0.3, 0.1 - 0.3),
        ] {
            assert_eq!(difference(a, b), expected, "{a} - {b}");
        }
        // Coordinates that were computed keep their difference in doubles.
        let computed = 1_234_567.1 * (1.0 + f64::EPSILON);
        assert_eq!(difference(computed, 1_234_567.1), computed - 1_234_567.1);
        assert_eq!(minus([1.0, 2.0, 1e9], [1.0, 1.5, 1e9 + 1e-5]), [0.0, 0.5, 0.0]);
    }
}
