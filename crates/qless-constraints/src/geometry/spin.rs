//! Spin: the angular velocity in space of a body, `w = L(u) du/dt`, and moments, which are conjugate to it.
//!
//! The power of a moment M is `M . w`, so that its generalised force on the rotation DOFs u is `L^T M`. For a rotation vector, L is
//! `T(theta) = I + b [theta]x + c [theta]x^2` with `b = (1 - cos t) / t^2`, `c = (t - sin t) / t^3` and `t = |theta|`. For Euler parameters
//! `p = (e0, e)`, `w = 2 (e0 e' - e0' e + e x e')` with the time derivatives e0' and e'.

use super::rotation::{factors, third_factor};
use crate::scalar::vector::{Vector, add, axis, cross, dot, lift, scale, sub};
use crate::scalar::{Dual, Scalar};

/// `T(theta) = I + ((1 - cos t) / t^2) [theta]x + ((t - sin t) / t^3) [theta]x^2` with `t = |theta|`: the rows of the matrix that maps the
/// rate of a rotation vector, in radians, to the angular velocity in space.
///
/// The generalised force of a moment M in space is `T^T M`. T is singular at whole turns, `t = 2 pi k`.
///
/// ```
/// let t = qless_constraints::rotation_tangent([0.0, 0.0, 0.5]);
/// // A faster turn about z is a faster turn about z; a change of the axis is seen from half-way.
/// assert_eq!(t[2], [0.0, 0.0, 1.0]);
/// assert!((t[0][0] - 0.5_f64.sin() / 0.5).abs() < 1e-15);
/// ```
pub fn rotation_tangent(theta: [f64; 3]) -> [[f64; 3]; 3] {
    // Row i of T is T^T applied to the i-th unit vector.
    std::array::from_fn(|i| of_vector(theta, axis(i)))
}

/// `T^T m = m - b theta x m + c theta x (theta x m)` with `b = (1 - cos t) / t^2`, `c = (t - sin t) / t^3` and `t = |theta|`.
fn of_vector<S: Scalar>(theta: Vector<S>, m: Vector<f64>) -> Vector<S> {
    let y = dot(theta, theta);
    let ((_, b), c) = (factors(y), third_factor(y));
    let once = cross(theta, lift(m));
    add(sub(lift(m), scale(b, once)), scale(c, cross(theta, once)))
}

/// The generalised force `L^T m` of a moment m on the rotation DOFs u, where `w = L du/dt` is the angular velocity. `u` holds a rotation
/// vector or four Euler parameters; for a rotation vector, the fourth entry of the result is zero.
pub fn generalised<S: Scalar>(u: &[S], m: Vector<f64>) -> [S; 4] {
    if let &[e0, x, y, z] = u {
        let (e0, e, two, m) = (S::from(1.0) + e0, [x, y, z], S::from(2.0), lift(m));
        let [x, y, z] = scale(two, sub(scale(e0, m), cross(e, m)));
        return [-(two * dot(e, m)), x, y, z];
    }
    let [x, y, z] = of_vector([u[0], u[1], u[2]], m);
    [x, y, z, S::from(0.0)]
}

/// `d (L^T m)_i / du_j` at `[i][j]`, where `L^T m` is the generalised force of a moment m ([`generalised`]).
pub fn stiffness(u: &[f64], m: Vector<f64>) -> [[f64; 4]; 4] {
    let variables: Vec<Dual<4, f64>> = u.iter().enumerate().map(|(j, &x)| Dual::variable(x, j)).collect();
    generalised(&variables, m).map(|x| x.slope)
}

/// The moment M that has the generalised force `q = L^T M` on the rotation DOFs u. At whole turns of a rotation vector it is not finite,
/// since q does not determine it.
pub fn moment(u: &[f64], q: &[f64]) -> Vector<f64> {
    if let (&[e0, x, y, z], &[q0, a, b, c]) = (u, q) {
        let (e0, e, q) = (1.0 + e0, [x, y, z], [a, b, c]);
        // For Euler parameters p, `L L^T = 4 |p|^2 I`, so that `M = L q / (4 |p|^2)`.
        let image = add(sub(scale(e0, q), scale(q0, e)), cross(e, q));
        return scale(0.5 / (e0 * e0 + dot(e, e)), image);
    }
    let t = rotation_tangent([u[0], u[1], u[2]]);
    // The rows of T^T are the columns of T; the inverse of a matrix with rows a, b, c has columns b x c, c x a, a x b.
    let [a, b, c] = std::array::from_fn(|j| [t[0][j], t[1][j], t[2][j]]);
    let columns = [cross(b, c), cross(c, a), cross(a, b)];
    let sum = (0..3).fold([0.0; 3], |sum, k| add(sum, scale(q[k], columns[k])));
    scale(1.0 / dot(a, columns[0]), sum)
}

#[cfg(test)]
mod tests {
    use super::super::rotation::{by_euler, by_vector};
    use super::*;
    use crate::scalar::vector::norm;

    /// `L^T m` has the power `m . w` for both parametrisations; differences of rotated vectors give the angular velocity w. [`moment`]
    /// returns m from `L^T m`, and [`stiffness`] agrees with differences.
    #[test]
    fn generalised_forces_have_the_power_of_the_moment() {
        let (m, du, step) = ([0.4, -1.3, 0.7], [0.3, 0.5, -0.2, 0.1], 1e-6);
        for size in [1e-9, 0.2, 0.6, 2.0, 4.0] {
            let theta = [0.6 * size, 0.0, -0.8 * size];
            let quaternion = [(0.5 * size).cos() - 1.0, 0.6 * (0.5 * size).sin(), 0.0, -0.8 * (0.5 * size).sin()];
            for u in [&theta[..], &quaternion[..]] {
                let turned = |sign: f64, k: usize| {
                    let x: Vec<f64> = u.iter().zip(du).map(|(u, du)| u + sign * step * du).collect();
                    if x.len() == 3 {
                        by_vector([x[0], x[1], x[2]], axis(k))
                    } else {
                        let p = [1.0 + x[0], x[1], x[2], x[3]];
                        scale(1.0 / p.iter().map(|p| p * p).sum::<f64>(), by_euler(p, axis(k)))
                    }
                };
                // The angular velocity is `w = sum_k r_k x r_k' / 2`, where `r_k` is the rotated k-th axis.
                let rate = |k: usize| scale(0.5 / step, sub(turned(1.0, k), turned(-1.0, k)));
                let spin = (0..3).fold([0.0; 3], |w, k| add(w, scale(0.5, cross(turned(0.0, k), rate(k)))));
                let q = generalised(u, m);
                let power: f64 = q.iter().zip(du).take(u.len()).map(|(q, du)| q * du).sum();
                assert!((power - dot(m, spin)).abs() < 1e-8, "{size}, {}: {power}", u.len());
                assert!(norm(sub(moment(u, &q[..u.len()]), m)) < 1e-13, "{size}, {}", u.len());
                let slopes = stiffness(u, m);
                for (i, slopes) in slopes.iter().enumerate().take(u.len()) {
                    let along: f64 = slopes.iter().zip(du).map(|(s, du)| s * du).sum();
                    let at = |sign: f64| {
                        let x: Vec<f64> = u.iter().zip(du).map(|(u, du)| u + sign * step * du).collect();
                        generalised(&x, m)[i]
                    };
                    assert!((along - 0.5 * (at(1.0) - at(-1.0)) / step).abs() < 1e-8, "{size}");
                }
            }
        }
    }
}
