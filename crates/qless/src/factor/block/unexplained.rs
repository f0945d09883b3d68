//! Dropped rows that are no combinations of the kept ones, coefficient by coefficient.
//!
//! ```text
//! e_k = max_j |row_kj - sum y_i row_ij| / (|row_kj| + sum |y_i row_ij|)
//! y <- y + (R^T R)^-1 C_k (row_k - sum y_i row_i)       while e_k is above 1e-3
//! ```
//!
//! A factorization compares what is left of a row with its largest coefficients, so it may drop a row for which small ones decide. A row
//! is no combination if more than 1e-3 of the parts of a coefficient is left, the limit of presolve for pivots; rounding leaves less.
//! Cost: the coefficients of the rows of each certificate; where certificates are computed late, of the dropped rows.

use super::dependent::Rows;
use super::gathered::Block;
use super::triangle::Triangle;
use crate::input::scale::ldexp;
use crate::presolve::basis::BlockCertificate;
use crate::presolve::eliminate::SUSPECT;

/// A product with a vector of the null space is rounding up to this part of its terms.
const NOISE: f64 = 64.0 * f64::EPSILON;
/// Most refinements of a certificate.
const REFINEMENTS: usize = 2;
/// Coefficients of a certificate below this part of the largest may be rounding; the certificate counts without them if that is better.
const ROUNDING: [f64; 3] = [0.0, 1e-13, 1e-11];

/// What a certificate leaves of its row.
struct Rest {
    left: Vec<f64>,
    size: Vec<f64>,
    touched: Vec<usize>,
}

impl Rest {
    fn new(dofs: usize) -> Self {
        Self { left: vec![0.0; dofs], size: vec![0.0; dofs], touched: Vec::new() }
    }

    fn clear(&mut self) {
        for j in self.touched.drain(..) {
            (self.left[j], self.size[j]) = (0.0, 0.0);
        }
    }

    fn subtract(&mut self, block: &Block, row: usize, y: f64) {
        for (j, v) in block.matrix.row(row) {
            if self.size[j] == 0.0 {
                self.touched.push(j);
            }
            self.left[j] -= y * v;
            self.size[j] += (y * v).abs();
        }
    }

    /// e of row k for a certificate.
    fn error(&mut self, block: &Block, k: usize, certificate: &[(usize, f64)]) -> f64 {
        self.clear();
        self.subtract(block, k, -1.0);
        certificate.iter().for_each(|&(i, y)| self.subtract(block, i, y));
        let parts = self.touched.iter().filter(|&&j| self.left[j] != 0.0);
        parts.map(|&j| self.left[j].abs() / self.size[j]).fold(0.0, f64::max)
    }
}

/// `|row_k u| / sum_j |row_kj u_j|` for vectors u of the null space of the kept rows: 0 for a combination of them, apart from rounding.
fn moved(block: &Block, k: usize, moves: &[Vec<f64>; 2]) -> f64 {
    let of = |u: &Vec<f64>| {
        let parts = block.matrix.row(k).map(|(j, v)| v * u[j]);
        let (sum, size) = parts.fold((0.0, 0.0), |(sum, size), part| (sum + part, size + part.abs()));
        if sum == 0.0 { 0.0 } else { sum.abs() / size }
    };
    moves.iter().map(of).fold(0.0, f64::max)
}

/// Refines certificates that leave more than [`SUSPECT`] of their row; what they leave then counts as dropped. Returns the number of rows
/// of which more is left.
pub(super) fn unexplained(block: &Block, rows: &mut Rows, moves: &[Vec<f64>; 2]) -> usize {
    let mut rest = Rest::new(block.matrix.cols);
    let mut count = 0;
    let Rows { dependent, triangle, left, .. } = rows;
    for d in dependent {
        let Ok(k) = block.rows.binary_search(&d.row) else { continue };
        if let BlockCertificate::Late(..) = d.because {
            let ratio = moved(block, k, moves);
            if ratio > NOISE {
                d.dropped = d.dropped.max(*left);
            }
            if ratio <= SUSPECT {
                continue;
            }
        }
        let own = |&(row, y): &(u32, f64)| {
            let i = block.rows.binary_search(&row).ok()?;
            Some((i, ldexp(y, block.exponents[k] - block.exponents[i])))
        };
        let best: Vec<(usize, f64)> = d.because.terms().iter().filter_map(own).collect();
        let error = rest.error(block, k, &best);
        if error <= SUSPECT {
            continue;
        }
        let (best, error) = refined(block, triangle, &mut rest, k, best, error);
        let largest = best.iter().fold(0.0, |most: f64, (_, y)| most.max(y.abs()));
        let error_of_y = d.units * best.len() as f64 * f64::EPSILON * largest;
        let mut mismatch = block.effective[k];
        for &(i, y) in &best {
            mismatch.subtract(y, block.effective[i]);
            mismatch.error += error_of_y * block.effective[i].size;
        }
        d.mismatch = mismatch.scaled(-block.exponents[k]);
        let mut because: Vec<_> =
            best.iter().map(|&(i, y)| (block.rows[i], ldexp(y, block.exponents[i] - block.exponents[k]))).collect();
        because.sort_unstable_by_key(|&(row, _)| row);
        d.because = BlockCertificate::Known(because);
        if error > SUSPECT {
            d.dropped = d.dropped.max(error);
            count += 1;
        }
    }
    count
}

/// A certificate of row k with a smaller error, if there is one.
fn refined(
    block: &Block,
    triangle: &Triangle,
    rest: &mut Rest,
    k: usize,
    mut best: Vec<(usize, f64)>,
    mut error: f64,
) -> (Vec<(usize, f64)>, f64) {
    for _ in 0..REFINEMENTS {
        rest.error(block, k, &best);
        let step = triangle.projected(block, &rest.left);
        let mut y = vec![0.0; block.matrix.rows()];
        best.iter().for_each(|&(i, v)| y[i] = v);
        triangle.rows.iter().zip(step).for_each(|(&i, step)| y[i] += step);
        let largest = y.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
        let before = error;
        for part in ROUNDING {
            let large = y.iter().copied().enumerate().filter(|(_, v)| v.abs() > part * largest);
            let candidate: Vec<_> = large.collect();
            let found = rest.error(block, k, &candidate);
            if found < error {
                (error, best) = (found, candidate);
            }
        }
        if error <= SUSPECT || error >= before {
            break;
        }
    }
    (best, error)
}
