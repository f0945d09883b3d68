//! Integrals `D_ij = int phi_i phi_j dx` and `M_ik = int phi_i psi_k dx` of the hat functions of two meshes of a line.
//!
//! The functions phi belong to n equally spaced nodes of an interval with n - 1 cells of length 1, psi to m nodes of the
//! same interval. Between neighbouring nodes of both meshes a product is a parabola, so the two-point Gauss rule is exact
//! except for rounding.

/// Band matrix: row i holds its pairs `(column, integral)` with nonzero integrals, columns ascending.
pub(super) type HatIntegrals = Vec<Vec<(usize, f64)>>;

/// Integrals of the products of n hats (rows) and m hats (columns).
pub(super) fn products(n: usize, m: usize) -> HatIntegrals {
    let mut rows: HatIntegrals = vec![Vec::new(); n];
    let cuts = cuts(n, m);
    for piece in cuts.windows(2) {
        let scale = (m - 1) as f64;
        let (a, b) = (piece[0] as f64 / scale, piece[1] as f64 / scale);
        let (near, far) = (piece[0] / (m - 1), piece[0] / (n - 1));
        for i in [near, near + 1] {
            for k in [far, far + 1] {
                let at = |x: f64| hat(x, i, 1.0) * hat(x, k, (n - 1) as f64 / scale);
                add(&mut rows[i], k, gauss(a, b, at));
            }
        }
    }
    rows
}

/// Nodes of two meshes of one interval, with n and m nodes, in ascending order. The unit is 1 / (m - 1) of a cell of the first mesh, so
/// that all coordinates are whole numbers.
fn cuts(n: usize, m: usize) -> Vec<usize> {
    let mut cuts: Vec<usize> = (0..n).map(|i| i * (m - 1)).chain((0..m).map(|k| k * (n - 1))).collect();
    cuts.sort_unstable();
    cuts.dedup();
    cuts
}

/// The hat function of node i on cells of the given length.
fn hat(x: f64, i: usize, length: f64) -> f64 {
    1.0 - (x / length - i as f64).abs()
}

fn gauss(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let offset = half / 3.0_f64.sqrt();
    half * (f(middle - offset) + f(middle + offset))
}

fn add(row: &mut Vec<(usize, f64)>, column: usize, value: f64) {
    match row.binary_search_by_key(&column, |&(k, _)| k) {
        Ok(at) => row[at].1 += value,
        Err(at) => row.insert(at, (column, value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mass_matrix_of_one_mesh() {
        let mass = products(4, 4);
        let close = |row: &[(usize, f64)], expected: &[f64]| {
            row.len() == expected.len() && row.iter().zip(expected).all(|(&(_, a), b)| (a - b).abs() < 1e-15)
        };
        assert!(close(&mass[0], &[1.0 / 3.0, 1.0 / 6.0]));
        assert!(close(&mass[1], &[1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0]));
    }

    #[test]
    fn a_linear_function_has_equal_moments_in_both_meshes() {
        let (n, m) = (9, 5);
        let (near, far) = (products(n, n), products(n, m));
        let ratio = (n - 1) as f64 / (m - 1) as f64;
        for i in 0..n {
            let moment = |row: &[(usize, f64)], step: f64| row.iter().map(|&(k, v)| v * k as f64 * step).sum::<f64>();
            assert!((moment(&near[i], 1.0) - moment(&far[i], ratio)).abs() < 1e-14);
        }
    }
}
