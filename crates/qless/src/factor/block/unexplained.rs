//! Finds dropped rows that are no combination of the kept ones, coefficient by coefficient.
//!
//! ```text
//! e_k = max_j |row_kj - sum y_i row_ij| / (|row_kj| + sum |y_i row_ij|)
//! y <- y + (R^T R)^-1 C_k (row_k - sum y_i row_i)       while e_k is above 1e-3
//! ```
//!
//! C_k holds the kept rows, R is their triangular factor and sigma their smallest singular value; u is the rounding unit.
//!
//! A factorization compares the remainder of a row with its largest coefficients, so it may drop a row that is independent only because of
//! its small coefficients. A row is no combination if more than 1e-3 of the terms of a coefficient is left; this is also the limit of
//! presolve for pivots, and rounding leaves less. A coefficient y_i below `u |y| / (1e-3 sigma)` has itself a relative error of more than
//! 1e-3. If only such y_i contribute to a DOF, and the row has no coefficient there, the remainder at that DOF is their rounding error.
//! Certificates whose coefficients decay along a chain are therefore accepted.
//!
//! Cost for each dropped row: the coefficients of the rows of its certificate. If certificates are computed late: the coefficients of the
//! dropped row itself.

use rayon::prelude::*;

use super::dependent::{Rows, noise_of};
use super::gathered::Block;
use super::triangle::Triangle;
use crate::factor::backend::many::{Slab, WIDTH};
use crate::input::scale::ldexp;
use crate::presolve::basis::{BlockCertificate, BlockDependent};
use crate::presolve::eliminate::SUSPECT;
use crate::presolve::eliminated::Mismatch;
use crate::presolve::rows::MORE_THAN_ROUNDING;

/// A product of a row with a null-space vector counts as rounding up to this fraction of its terms.
const NOISE: f64 = 64.0 * f64::EPSILON;
/// Largest number of refinements of a certificate.
const REFINEMENTS: usize = 2;
/// Coefficients of a certificate below one of these fractions of the largest may be rounding; they are left out if that reduces the error.
const ROUNDING: [f64; 3] = [0.0, 1e-13, 1e-11];

/// The remainder of a row after subtracting its certificate.
struct Rest {
    left: Vec<f64>,
    size: Vec<f64>,
    /// For each DOF, true if one of the terms of its remainder is known to three digits.
    is_known: Vec<bool>,
    touched: Vec<usize>,
    /// Coefficients of certificates up to this fraction of the largest are not known to three digits.
    uncertain: f64,
}

impl Rest {
    fn new(dofs: usize, sigma: f64) -> Self {
        let uncertain = (f64::EPSILON / (SUSPECT * sigma)).min(ROUNDING[2]);
        Self {
            left: vec![0.0; dofs],
            size: vec![0.0; dofs],
            is_known: vec![false; dofs],
            touched: Vec::new(),
            uncertain,
        }
    }

    fn clear(&mut self) {
        for j in self.touched.drain(..) {
            (self.left[j], self.size[j], self.is_known[j]) = (0.0, 0.0, false);
        }
    }

    fn subtract(&mut self, block: &Block, row: usize, y: f64, is_known: bool) {
        for (j, v) in block.matrix.row(row) {
            self.is_known[j] |= is_known;
            if self.size[j] == 0.0 {
                self.touched.push(j);
            }
            self.left[j] -= y * v;
            self.size[j] += (y * v).abs();
        }
    }

    /// The error `e_k` of row k with this certificate: the largest remainder of a coefficient, relative to its terms.
    fn error(&mut self, block: &Block, k: usize, certificate: &[(usize, f64)]) -> f64 {
        self.clear();
        self.subtract(block, k, -1.0, true);
        let largest = certificate.iter().fold(0.0, |most: f64, (_, y)| most.max(y.abs()));
        let known = self.uncertain * largest;
        certificate.iter().for_each(|&(i, y)| self.subtract(block, i, y, y.abs() > known));
        let parts = self.touched.iter().filter(|&&j| self.left[j] != 0.0 && self.is_known[j]);
        parts.map(|&j| self.left[j].abs() / self.size[j]).fold(0.0, f64::max)
    }
}

/// `|row_k u| / sum_j |row_kj u_j|` for vectors u of the null space of the kept rows: rounding if row k is a combination of the kept rows.
fn moved(block: &Block, k: usize, moves: &[Vec<f64>; 2]) -> f64 {
    let of = |u: &Vec<f64>| {
        let parts = block.matrix.row(k).map(|(j, v)| v * u[j]);
        let (sum, size) = parts.fold((0.0, 0.0), |(sum, size), part| (sum + part, size + part.abs()));
        if sum == 0.0 { 0.0 } else { sum.abs() / size }
    };
    moves.iter().map(of).fold(0.0, f64::max)
}

/// A dropped row whose certificate has an error `e_k` above [`SUSPECT`].
struct Unexplained {
    /// The place of the row among the dependent rows.
    place: usize,
    /// The place of the row in the block.
    k: usize,
    /// Terms of the certificate: rows of the block with their coefficients.
    certificate: Vec<(usize, f64)>,
    error: f64,
    /// True if another refinement may help.
    is_open: bool,
}

/// How well the dropped rows are combinations of the kept ones.
pub(super) struct Explained {
    /// Number of dropped rows that are no combination: their error `e_k` is above [`SUSPECT`].
    pub unexplained: usize,
    /// True if the errors of all known certificates are rounding errors of the terms at each DOF.
    pub is_exact: bool,
}

/// Refines certificates with an error `e_k` above [`SUSPECT`]. If the error stays above, it becomes the `dropped` remainder of the row.
pub(super) fn unexplained(block: &Block, rows: &mut Rows, moves: &[Vec<f64>; 2]) -> Explained {
    let Rows { dependent, triangle, left, nearness, .. } = rows;
    let rounding = rounding_at_a_dof(block);
    let new = || Rest::new(block.matrix.cols, nearness.sigma);
    let found = dependent.par_iter_mut().enumerate().map_init(new, |rest, (place, d)| {
        let k = block.rows.binary_search(&d.row).ok()?;
        if let BlockCertificate::Late(..) = d.because {
            let ratio = moved(block, k, moves);
            if ratio > NOISE {
                d.dropped = d.dropped.max(*left);
            }
            if ratio <= SUSPECT {
                return None;
            }
        }
        let certificate = certificate(block, k, d);
        let error = rest.error(block, k, &certificate);
        let unexplained = (error > SUSPECT).then_some(Unexplained { place, k, certificate, error, is_open: true });
        (error > rounding).then_some(unexplained)
    });
    let inexact: Vec<Option<Unexplained>> = found.flatten().collect();
    let is_exact = inexact.is_empty();
    let mut found: Vec<Unexplained> = inexact.into_iter().flatten().collect();
    found.par_chunks_mut(WIDTH).for_each_init(new, |rest, some| refine(block, triangle, rest, some));
    found.iter().for_each(|row| write(block, &mut dependent[row.place], row));
    Explained { unexplained: found.iter().filter(|row| row.error > SUSPECT).count(), is_exact }
}

/// The remainder at a DOF counts as rounding up to this fraction of its terms. Certificates of large blocks have larger errors.
fn rounding_at_a_dof(block: &Block) -> f64 {
    NOISE.max(noise_of(block))
}

/// The terms of the certificate of row k: rows of the block with their coefficients.
fn certificate(block: &Block, k: usize, d: &BlockDependent) -> Vec<(usize, f64)> {
    let own = |&(row, y): &(u32, f64)| {
        let i = block.rows.binary_search(&row).ok()?;
        Some((i, ldexp(y, block.exponents[k] - block.exponents[i])))
    };
    d.because.terms().iter().filter_map(own).collect()
}

/// Returns true if in the units of this block a dropped row with a known certificate leaves more than rounding, and more than the errors of
/// its coefficients.
pub(super) fn leaves_more_than_rounding(block: &Block, rows: &Rows) -> bool {
    let new = || Rest::new(block.matrix.cols, rows.nearness.sigma);
    let leaves = |rest: &mut Rest, d: &BlockDependent| {
        let Ok(k) = block.rows.binary_search(&d.row) else { return false };
        let certificate = certificate(block, k, d);
        rest.error(block, k, &certificate);
        let largest = certificate.iter().fold(1.0, |most: f64, (_, y)| most.max(y.abs()));
        let members = certificate.iter().map(|&(i, _)| i).chain([k]);
        let relative =
            rounding_at_a_dof(block).max(MORE_THAN_ROUNDING * members.map(|i| block.errors[i]).fold(0.0, f64::max));
        rest.touched.iter().any(|&j| {
            let left = rest.left[j].abs();
            left > noise_of(block) * largest && left > relative * rest.size[j]
        })
    };
    let known = rows.dependent.par_iter().filter(|d| matches!(d.because, BlockCertificate::Known(_)));
    known.map_init(new, leaves).any(|leaves| leaves)
}

/// Writes a refined certificate, its mismatches and its remainder.
fn write(block: &Block, d: &mut BlockDependent, Unexplained { k, certificate, error, .. }: &Unexplained) {
    let largest = certificate.iter().fold(0.0, |most: f64, (_, y)| most.max(y.abs()));
    let error_of_y = d.units * certificate.len() as f64 * f64::EPSILON * largest;
    let mismatch = |sides: &Vec<Mismatch>| {
        let mut rest = sides[*k];
        for &(i, y) in certificate {
            rest.subtract(y, sides[i]);
            rest.error += error_of_y * sides[i].size;
        }
        rest.scaled(-block.exponents[*k])
    };
    d.mismatches = block.effective.iter().map(mismatch).collect();
    let of_user = |&(i, y): &(usize, f64)| (block.rows[i], ldexp(y, block.exponents[i] - block.exponents[*k]));
    let mut because: Vec<_> = certificate.iter().map(of_user).collect();
    because.sort_unstable_by_key(|&(row, _)| row);
    d.because = BlockCertificate::Known(because);
    if *error > SUSPECT {
        d.dropped = d.dropped.max(*error);
    }
}

/// Refines certificates as long as that reduces their error; at most [`WIDTH`] at a time.
fn refine(block: &Block, triangle: &Triangle, rest: &mut Rest, some: &mut [Unexplained]) {
    for _ in 0..REFINEMENTS {
        let mut left: Slab = vec![[0.0; WIDTH]; block.matrix.cols];
        for (c, row) in some.iter().enumerate().filter(|(_, row)| row.is_open) {
            rest.error(block, row.k, &row.certificate);
            left.iter_mut().zip(&rest.left).for_each(|(left, &own)| left[c] = own);
        }
        let steps = triangle.projected(block, &left);
        for (c, row) in some.iter_mut().enumerate().filter(|(_, row)| row.is_open) {
            let before = row.error;
            improve(block, triangle, rest, row, |i| steps[i][c]);
            // If a step does not halve the error, a second step will not bring it below the limit.
            row.is_open = row.error > SUSPECT && row.error < before / 2.0;
        }
        if !some.iter().any(|row| row.is_open) {
            break;
        }
    }
}

/// Applies a step, with or without the coefficients that may be rounding, if that reduces the error.
fn improve(block: &Block, triangle: &Triangle, rest: &mut Rest, row: &mut Unexplained, step: impl Fn(usize) -> f64) {
    let mut y = vec![0.0; block.matrix.rows()];
    row.certificate.iter().for_each(|&(i, v)| y[i] = v);
    triangle.rows.iter().enumerate().for_each(|(place, &i)| y[i] += step(place));
    let largest = y.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
    for part in ROUNDING {
        let large = y.iter().copied().enumerate().filter(|(_, v)| v.abs() > part * largest);
        let candidate: Vec<_> = large.collect();
        let error = rest.error(block, row.k, &candidate);
        if error < row.error {
            (row.error, row.certificate) = (error, candidate);
        }
    }
}
