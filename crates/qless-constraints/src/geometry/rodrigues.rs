//! The factors of Rodrigues' formula, `a = sin t / t` and `b = (1 - cos t) / t^2`, as functions of `y = t^2` with two derivatives; t is the
//! angle of rotation.
//!
//! With Stumpff's functions `c_k = sum_i (-y)^i / (2 i + k)!`: `a = c_1`, `b = c_2`, `c_k = 1 / k! - y c_(k+2)` and
//! `dc_k/dy = (k c_(k+2) - c_(k+1)) / 2`. The two series of `c_5` and `c_6` give a, b and their derivatives. Nothing is divided by y, so
//! that the results are exact at y = 0.

/// `a = sin t / t` and `b = (1 - cos t) / t^2`, each with its first two derivatives in `y = t^2`.
#[inline]
pub fn factors(y: f64) -> [[f64; 3]; 2] {
    if y < 4.0 { series(y) } else { closed(y) }
}

#[inline]
fn series(y: f64) -> [[f64; 3]; 2] {
    // Short series for small rotations, which are common. The first term left out is below 1e-20 for y < 0.05, and
    // below 1e-17 for y < 5.
    from_highest(y, highest(y, if y < 0.05 { 6 } else { 12 }))
}

/// a, a', a'' and b, b', b'' from Stumpff's functions `c_5` and `c_6`.
fn from_highest(y: f64, [c5, c6]: [f64; 2]) -> [[f64; 3]; 2] {
    let (c3, c4) = (1.0 / 6.0 - y * c5, 1.0 / 24.0 - y * c6);
    let (c1, c2) = (1.0 - y * c3, 0.5 - y * c4);
    let of_a = [c1, 0.5 * (c3 - c2), 0.25 * (c3 - 3.0 * (c4 - c5))];
    [of_a, [c2, c4 - 0.5 * c3, 2.0 * c6 - 1.25 * c5 + 0.25 * c4]]
}

/// Stumpff's functions `c_5(y)` and `c_6(y)` by Horner's rule.
fn highest(y: f64, terms: usize) -> [f64; 2] {
    INVERSE_FACTORIALS[..terms].iter().rev().fold([0.0; 2], |sums, term| [term[0] - y * sums[0], term[1] - y * sums[1]])
}

/// The factors a and b and their derivatives in closed form, for y >= 4. They follow from `d(cos t)/dy = -a / 2` with `y = t^2`.
fn closed(y: f64) -> [[f64; 3]; 2] {
    let t = y.sqrt();
    let (sin, cos) = t.sin_cos();
    let half = (0.5 * t).sin();
    let (a, b) = (sin / t, 2.0 * half * half / y);
    let (slope_a, slope_b) = ((cos - a) / (2.0 * y), (a - 2.0 * b) / (2.0 * y));
    let curves = [(-0.5 * a - 3.0 * slope_a) / (2.0 * y), (slope_a - 4.0 * slope_b) / (2.0 * y)];
    [[a, slope_a, curves[0]], [b, slope_b, curves[1]]]
}

/// `1 / (2 i + 5)!` and `1 / (2 i + 6)!`.
const INVERSE_FACTORIALS: [[f64; 2]; 12] = {
    let mut all = [[0.0; 2]; 12];
    let (mut i, mut c) = (0, 1.0 / 120.0);
    while i < 12 {
        let next = c / (2 * i + 6) as f64;
        all[i] = [c, next];
        c = next / (2 * i + 7) as f64;
        i += 1;
    }
    all
};

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_same(x: [[f64; 3]; 2], y: [[f64; 3]; 2], tolerance: f64, at: f64) {
        for (a, b) in x.iter().flatten().zip(y.iter().flatten()) {
            assert!((a - b).abs() < tolerance * b.abs(), "y = {at}: {a}, {b}");
        }
    }

    /// Closed forms and series agree at the switch. For smaller y the closed forms lose digits to cancellation.
    #[test]
    fn series_and_closed_forms_agree() {
        [4.0, 4.5, 5.0].into_iter().for_each(|y| assert_same(series(y), closed(y), 1e-14, y));
    }

    /// The series agree with the power series, summed term by term, for both numbers of terms.
    #[test]
    fn series_are_the_power_series() {
        for y in [0.0, 1e-8, 0.01, 0.049_999, 0.050_001, 0.5, 1.0] {
            let truth = [1_u32, 2].map(|first| {
                let mut sums = [0.0; 3];
                for i in (0..20_i32).rev() {
                    let factorial: f64 = (1..=2 * i as u32 + first).map(f64::from).product();
                    let term = |order: i32| {
                        let falling: f64 = (0..order).map(|k| f64::from(i - k)).product();
                        if i < order {
                            0.0
                        } else {
                            falling * y_power(y, i - order) * f64::from(1 - 2 * (i % 2)) / factorial
                        }
                    };
                    (0..3).for_each(|order| sums[order as usize] += term(order));
                }
                sums
            });
            assert_same(series(y), truth, 4e-15, y);
        }
    }

    fn y_power(y: f64, k: i32) -> f64 {
        if k == 0 { 1.0 } else { y.powi(k) }
    }
}
