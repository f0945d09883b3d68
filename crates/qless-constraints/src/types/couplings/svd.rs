//! `A = U S V^T` of a matrix with six columns, by one-sided Jacobi rotations. Small singular values are accurate.
//!
//! Demmel and Veselic, SIAM J. Matrix Anal. Appl., 1992. Columns that are already orthogonal are not changed. The
//! result does not depend on threads.

type Row6 = [f64; 6];

/// Maximum number of sweeps; about eight suffice for any matrix.
const MAX_SWEEPS: usize = 40;

/// The factors of `A = U S V^T`. The columns of `scaled` are those of `U S`.
pub struct JacobiSvd {
    pub scaled: Vec<Row6>,
    pub values: Row6,
    pub v: [Row6; 6],
}

/// Computes the factors of a matrix with m rows. Cost: O(m).
pub fn svd(rows: Vec<Row6>) -> JacobiSvd {
    let mut scaled = rows;
    let mut v: [Row6; 6] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let pairs = || (0..6).flat_map(|i| (i + 1..6).map(move |j| (i, j)));
    for _ in 0..MAX_SWEEPS {
        let turned = pairs().filter(|&pair| orthogonalise(&mut scaled, &mut v, pair)).count();
        if turned == 0 {
            break;
        }
    }
    let values = std::array::from_fn(|j| product(&scaled, j, j).sqrt());
    JacobiSvd { scaled, values, v }
}

fn product(rows: &[Row6], i: usize, j: usize) -> f64 {
    rows.iter().map(|row| row[i] * row[j]).sum()
}

/// Makes two columns orthogonal. Returns whether they changed.
fn orthogonalise(scaled: &mut [Row6], v: &mut [Row6; 6], (i, j): (usize, usize)) -> bool {
    let (a, b, both) = (product(scaled, i, i), product(scaled, j, j), product(scaled, i, j));
    // Written so that NaN is left alone.
    let oblique = both.abs() > 4.0 * f64::EPSILON * a.sqrt() * b.sqrt();
    if oblique {
        let zeta = (b - a) / (2.0 * both);
        let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
        let cosine = 1.0 / tangent.hypot(1.0);
        let sine = cosine * tangent;
        for row in scaled.iter_mut().chain(v.iter_mut()) {
            (row[i], row[j]) = (cosine * row[i] - sine * row[j], sine * row[i] + cosine * row[j]);
        }
    }
    oblique
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `U S V^T = A`, V is orthogonal, and so are the columns of `U S`; columns scaled by 1e-9 do no harm.
    #[test]
    fn factors_are_those_of_the_matrix() {
        let random = |k: u64| {
            let z = (k + 3).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29).wrapping_mul(0xD6E8_FEB8_6659_FD93);
            (z >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let size = [1.0, 1e-9, 1.0, 1e3, 1.0, 0.5];
        let a: Vec<Row6> = (0..40).map(|i| std::array::from_fn(|j| size[j] * random(6 * i + j as u64))).collect();
        let f = svd(a.clone());
        for (i, row) in a.iter().enumerate() {
            for j in 0..6 {
                let found: f64 = (0..6).map(|k| f.scaled[i][k] * f.v[j][k]).sum();
                assert!((found - row[j]).abs() < 1e-12, "{found} {}", row[j]);
            }
        }
        for (i, j) in (0..6).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let cosine = product(&f.scaled, i, j) / (f.values[i] * f.values[j]);
            assert!(cosine.abs() < 1e-14 && product(&f.v, i, j).abs() < 1e-14);
        }
        let least = f.values.iter().copied().fold(9.0, f64::min);
        assert!(least > 1e-10 && least < 1e-8, "{least}");
    }
}
