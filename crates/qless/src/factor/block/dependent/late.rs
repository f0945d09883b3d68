//! Many dependent rows of one block: all are classified at once, but each certificate is computed only when it is read.
//!
//! ```text
//! x = C_k^+ b                           mismatch_k = b_k - row_k x              one solve for all
//! |c * s|_2 ~ rms over random signs g   of row_k C_k^+ (g * s)                  sizes and errors of the mismatches
//! y = R1^-1 R2_k                        the certificate of row k                one triangular solve for each
//! ```
//!
//! C_k^+ is the pseudoinverse of the kept rows, c the certificate of the dropped row k, s the sizes or the errors of the right-hand sides,
//! and `*` the product entry by entry.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::certificate::{CERTIFICATE_UNITS, Choice, NOISE, ROUNDING, Rows, small_row};
use crate::Csr;
use crate::common::random::signed;
use crate::factor::backend::Factor;
use crate::factor::block::gathered::Block;
use crate::factor::block::triangle::Triangle;
use crate::factor::solver::NOISE as ROUNDED;
use crate::input::scale::ldexp;
use crate::presolve::basis::{BlockCertificate, BlockDependent as Dependent, LateTerms};
use crate::presolve::eliminated::Mismatch;

/// Number of right-hand sides that are solved together.
const LANES: usize = 8;
/// Seed of the random signs.
const SEED: u64 = 0x6a09_e667;
/// Safety factor of an estimate: the root mean square over eight random signs is seldom below a quarter of the norm.
const SURE: f64 = 4.0;

/// Data from which the certificates of a block are computed.
#[derive(Debug)]
struct LateCertificates {
    factor: Arc<Factor>,
    /// The factor `[R1 R2]` of the kept and the dropped rows by columns, built when the first certificate is read.
    columns: OnceLock<Csr>,
    /// For each column of R1, the name (number) of its kept row, and the exponent of the power of two by which the block scales this row.
    rows: Vec<(u32, i32)>,
    /// The columns of R1, sorted by the names (numbers) of their kept rows.
    by_name: Vec<usize>,
    /// For each dropped row, the exponent by which the block scales it.
    exponents: Vec<i32>,
    /// Coefficients of a certificate below this fraction of its largest one are rounding.
    noise: f64,
}

impl LateCertificates {
    fn new(block: &Block, triangle: &Triangle, noise: f64) -> Self {
        let rank = triangle.rows.len();
        let rows: Vec<(u32, i32)> = triangle.rows.iter().map(|&i| (block.rows[i], block.exponents[i])).collect();
        let mut by_name: Vec<usize> = (0..rank).collect();
        by_name.sort_unstable_by_key(|&k| rows[k].0);
        let exponents = triangle.dropped.iter().map(|&k| block.exponents[k]).collect();
        let factor = Arc::clone(&triangle.factor);
        Self { factor, columns: OnceLock::new(), rows, by_name, exponents, noise }
    }
}

impl LateCertificates {
    /// Solves `R1 y = R2_k` for the certificate y of dropped row k, from the last row of R1 up. Entries that are only rounding are set to
    /// zero, so that they cost nothing in the rows above.
    fn solved(&self, k: usize) -> Vec<f64> {
        let rank = self.rows.len();
        let columns = self.columns.get_or_init(|| self.factor.r.transposed());
        let mut y = vec![0.0; rank];
        columns.row(rank + k).for_each(|(i, v)| y[i] = v);
        let mut largest = y.iter().fold(0.0, |most: f64, z| most.max(z.abs()));
        for j in (0..rank).rev() {
            if y[j] == 0.0 {
                continue;
            }
            let range = columns.start[j]..columns.start[j + 1];
            let (rows, values) = (&columns.col[range.clone()], &columns.val[range]);
            let Some((diagonal, above)) = values.split_last() else { continue };
            let value = y[j] / diagonal;
            if value.abs() <= ROUNDED * largest {
                y[j] = 0.0;
                continue;
            }
            (y[j], largest) = (value, largest.max(value.abs()));
            rows.iter().zip(above).for_each(|(&i, v)| y[i as usize] -= v * value);
        }
        y
    }
}

impl LateTerms for LateCertificates {
    fn terms(&self, k: usize) -> Vec<(u32, f64)> {
        let y = self.solved(k);
        let largest = y.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
        let large = self.by_name.iter().filter(|&&i| y[i].abs() > self.noise * largest);
        large.map(|&i| (self.rows[i].0, ldexp(y[i], self.rows[i].1 - self.exponents[k]))).collect()
    }
}

/// The result of [`super::certificate::rows`], but with certificates that are computed when they are read. The factorization decides which
/// of equivalent equations is kept.
pub(super) fn late(block: &Block, left: f64, choice: Choice, order: Vec<usize>) -> Rows {
    let Choice { near: nearness, triangle, .. } = choice;
    let noise = (ROUNDING * f64::EPSILON / nearness.sigma).max(NOISE);
    let certificates: Arc<dyn LateTerms> = Arc::new(LateCertificates::new(block, &triangle, noise));
    let units = CERTIFICATE_UNITS / nearness.sigma.min(1.0);
    let of_sides = |sides: &Vec<Mismatch>| mismatches(block, sides, &triangle, nearness.sigma);
    let mismatches: Vec<Vec<Mismatch>> = block.effective.iter().map(of_sides).collect();
    let make = |(k, &row): (usize, &usize)| Dependent {
        row: block.rows[row],
        because: BlockCertificate::Late(Arc::clone(&certificates), k),
        units,
        dropped: small_row(block, row, 0.0),
        mismatches: mismatches.iter().map(|all| all[k].scaled(-block.exponents[row])).collect(),
    };
    let dependent = triangle.dropped.iter().enumerate().map(make).collect();
    let mut kept = triangle.rows.clone();
    kept.sort_unstable();
    Rows { kept, order, dependent, nearness, triangle, left }
}

/// The mismatches `b_k - sum c_i b_i` of the dropped rows k.
fn mismatches(block: &Block, given: &[Mismatch], triangle: &Triangle, sigma: f64) -> Vec<Mismatch> {
    let signs = |lane: usize, i: usize| signed(SEED + lane as u64, i as u64).signum();
    let size = |lane: usize, i: usize| match lane {
        0 => given[i].value,
        _ => signs(lane, i) * given[i].size,
    };
    let sides = |of: &dyn Fn(usize, usize) -> f64| -> Vec<[f64; LANES]> {
        triangle.rows.iter().map(|&i| std::array::from_fn(|lane| of(lane, i))).collect()
    };
    let x = triangle.shortest(block, &sides(&size));
    let parts = |i: usize| block.matrix.row(i).map(|(j, v)| (v * x[j][0]).abs()).sum::<f64>();
    let rounding = |i: usize| f64::EPSILON * parts(i) + given[i].error;
    let errors = sides(&|lane, i| signs(lane, i) * rounding(i));
    let errors = triangle.nearly_shortest(block, &errors, triangle.is_accurate(block, sigma));
    let product =
        |x: &[[f64; LANES]], k: usize, lane: usize| block.matrix.row(k).map(|(j, v)| v * x[j][lane]).sum::<f64>();
    let rms = |x: &[[f64; LANES]], k: usize, first: usize| {
        let sum: f64 = (first..LANES).map(|lane| product(x, k, lane).powi(2)).sum();
        (sum / (LANES - first) as f64).sqrt()
    };
    let of = |&k: &usize| {
        let own = given[k];
        let size = own.size.max(rms(&x, k, 1));
        Mismatch { value: own.value - product(&x, k, 0), size, error: rounding(k) + SURE * rms(&errors, k, 0) }
    };
    triangle.dropped.par_iter().map(of).collect()
}
