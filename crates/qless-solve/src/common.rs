//! Shared by the modules of this crate: sparse matrices, and random numbers that are the same in every run.

use faer::sparse::SparseColMat;
use qless::common::SplitMix64;

/// A sparse matrix by columns.
pub type SparseMatrix = SparseColMat<usize, f64>;

/// After cancellation, a sum above this fraction of its terms still has at least half of the digits of a double.
pub const HALF_DIGITS: f64 = 1e-8;

/// Relative rounding of an entry of a matrix, which is the result of about 16 operations.
pub const ENTRY_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// `y += A x`.
pub fn add_product(a: &SparseMatrix, x: &[f64], y: &mut [f64]) {
    for (j, x) in x.iter().enumerate() {
        a.symbolic().row_idx_of_col(j).zip(a.val_of_col(j)).for_each(|(i, v)| y[i] += v * x);
    }
}

/// `A x`.
pub fn times(a: &SparseMatrix, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; a.nrows()];
    add_product(a, x, &mut y);
    y
}

/// A number in [-1, -1/4] or [1/4, 1] for each seed, the same on every machine.
pub fn random(seed: u64) -> f64 {
    let bits = SplitMix64::new(seed.wrapping_mul(GOLDEN)).next();
    let unit = (bits >> 11) as f64 / (1_u64 << 53) as f64;
    if unit < 0.5 { -0.25 - 1.5 * unit } else { 1.5 * unit - 0.5 }
}

/// The increment of SplitMix64: consecutive seeds are consecutive numbers of one stream.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// A stream of numbers in [1/2, 1] or [-1, -1/2]. Forces of size 1 with random signs could cancel exactly in small models, so the sizes are
/// random too.
pub struct RandomForces(SplitMix64);

impl Default for RandomForces {
    fn default() -> Self {
        Self(SplitMix64::new(GOLDEN))
    }
}

impl RandomForces {
    pub fn next(&mut self) -> f64 {
        let bits = self.0.next();
        let size = 0.5 + (bits >> 12) as f64 / (1_u64 << 53) as f64;
        if bits & 1 == 0 { size } else { -size }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Neither tiny nor larger than one, of both signs, and near all ends of their ranges.
    #[test]
    fn random_numbers_fill_their_ranges() {
        let mut forces = RandomForces::default();
        let of_forces: Vec<f64> = (0..1000).map(|_| forces.next()).collect();
        for (numbers, least) in [((0..1000).map(random).collect::<Vec<_>>(), 0.25), (of_forces, 0.5)] {
            assert!(numbers.iter().all(|x| (least..=1.0).contains(&x.abs())));
            for near in [-1.0, -least, least, 1.0] {
                assert!(numbers.iter().any(|x| (x - near).abs() < 0.01), "none near {near}");
            }
        }
    }
}
