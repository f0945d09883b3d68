//! Rigid motion of a point: the coefficients of `q = (u_r, theta)` in `d . (u_r + theta x r)`, with the arm
//! `r = X - X_r`.

use crate::scalar::vector::{Vector, cross};

/// `x - origin`. Components that are only rounding of the coordinates are zero: a difference below two units in the
/// last place of rounded numbers has no meaning.
pub fn arm(x: Vector<f64>, origin: Vector<f64>) -> Vector<f64> {
    std::array::from_fn(|k| {
        let (difference, rounding) = (x[k] - origin[k], 2.0 * f64::EPSILON * x[k].abs().max(origin[k].abs()));
        // Written so that NaN stays NaN.
        if difference.abs() <= rounding { 0.0 } else { difference }
    })
}

/// The coefficients of `(u_r, theta)` in `e . (u_r + theta x r) = e . u_r + (r x e) . theta`.
pub fn along(e: Vector<f64>, r: Vector<f64>) -> [f64; 6] {
    let turn = cross(r, e);
    [e[0], e[1], e[2], turn[0], turn[1], turn[2]]
}

/// The coefficients of `(u_r, theta)` in `e . theta`.
pub fn about(e: Vector<f64>) -> [f64; 6] {
    [0.0, 0.0, 0.0, e[0], e[1], e[2]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::vector::axis;

    #[test]
    fn differences_of_rounded_coordinates_are_zero() {
        assert_eq!(arm([0.1 + 0.2, 1.0, -1e6], [0.3, 0.25, -1e6 - 1e-10]), [0.0, 0.75, 0.0]);
        assert!(arm([f64::NAN, 0.0, f64::INFINITY], [0.0; 3])[0].is_nan());
    }

    /// The rows agree with the definition, `theta x r`.
    #[test]
    fn rows_are_those_of_a_rigid_motion() {
        let (r, theta, shift) = ([2.0, -3.0, 5.0], [0.5, 0.25, -1.0], [1.0, 2.0, 3.0]);
        let turned = cross(theta, r);
        for k in 0..6 {
            let row = if k < 3 { along(axis(k), r) } else { about(axis(k - 3)) };
            let found: f64 = (0..3).map(|i| row[i] * shift[i] + row[3 + i] * theta[i]).sum();
            let truth = if k < 3 { shift[k] + turned[k] } else { theta[k - 3] };
            assert_eq!(found, truth, "{k}");
        }
    }
}
