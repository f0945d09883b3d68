//! Triangular solves with the factor `[R1 R2]` of the independent and the dependent columns of a block.

use rayon::prelude::*;

use super::Factor;
use super::many::{Slab, WIDTH};
use crate::common::argument::long;
use crate::{ArgumentError, Csr};

impl Factor {
    /// The product `R1^-1 z`, where R1 is the triangular factor of the independent columns.
    ///
    /// # Errors
    /// [`ArgumentError::WrongLength`] unless z has length r and R has r rows and at least r columns.
    pub fn solve(&self, z: &[f64]) -> Result<Vec<f64>, ArgumentError> {
        self.check()?;
        long("z", z.len(), self.rank)?;
        Ok(self.solved(z))
    }

    /// The coefficients `R1^-1 R2` of the n - r dependent columns over the r independent ones, from the factor `R = [R1 R2]`.
    ///
    /// # Errors
    /// [`ArgumentError::WrongLength`] unless R has r rows and at least r columns.
    pub fn coefficients(&self) -> Result<Vec<Vec<f64>>, ArgumentError> {
        self.check()?;
        Ok(self.all_coefficients())
    }

    /// The fields are public, so the shape of R is checked.
    fn check(&self) -> Result<(), ArgumentError> {
        long("the list of rows of R", self.r.rows(), self.rank)?;
        long("the list of columns of R1", self.r.cols().min(self.rank), self.rank)
    }

    /// The product `R1^-1 z` with the triangular factor R1, for z of length r; lengths are not checked.
    pub(crate) fn solved(&self, z: &[f64]) -> Vec<f64> {
        let mut x: Slab<1> = z.iter().map(|&z| [z]).collect();
        self.solve_slab(&mut x);
        x.into_flattened()
    }

    /// The product `R1^-T z` with the triangular factor R1, for z of length r; lengths are not checked.
    pub(crate) fn solve_transposed(&self, z: &[f64]) -> Vec<f64> {
        let mut x: Slab<1> = z.iter().map(|&z| [z]).collect();
        self.solve_slab_transposed(&mut x);
        x.into_flattened()
    }

    /// [`Factor::coefficients`] without the check, for factors made by a backend.
    pub(crate) fn all_coefficients(&self) -> Vec<Vec<f64>> {
        self.each_coefficients(|_, some| some).into_iter().flatten().collect()
    }

    /// Splits the dependent columns into slabs of up to [`WIDTH`] columns. Calls `job` for each slab, in parallel, with the number of its
    /// first column and the vectors `R1^-1 R2_k` of its columns k, from the factor `[R1 R2]`.
    pub(crate) fn each_coefficients<T: Send>(&self, job: impl Fn(usize, Vec<Vec<f64>>) -> T + Sync) -> Vec<T> {
        let mut behind = Csr::empty(self.r.cols - self.rank);
        let entries = |i: usize| self.r.row(i).skip_while(|&(j, _)| j < self.rank).map(|(j, v)| (j - self.rank, v));
        if behind.cols > 0 {
            (0..self.rank).for_each(|i| behind.append(entries(i)));
        }
        let columns = behind.transposed();
        let slab = |first: usize| {
            let count = WIDTH.min(columns.rows() - first);
            let mut slab = vec![[0.0; WIDTH]; self.rank];
            (0..count).for_each(|c| columns.row(first + c).for_each(|(i, v)| slab[i][c] = v));
            self.solve_slab(&mut slab);
            job(first, (0..count).map(|c| slab.iter().map(|row| row[c]).collect()).collect())
        };
        let first: Vec<usize> = (0..columns.rows()).step_by(WIDTH).collect();
        first.into_par_iter().map(slab).collect()
    }

    /// An upper estimate of the smallest singular value of the triangular factor R1, and its right singular vector, by five steps of
    /// inverse iteration with `R1^T R1`. Each step takes two triangular solves. Returns 1 and an empty vector if the rank is 0.
    pub(crate) fn smallest_singular_value(&self) -> (f64, Vec<f64>) {
        self.after_first_estimate(self.first_estimate().1)
    }

    /// The estimate of the first step of [`Factor::smallest_singular_value`], with the vector from which the other steps go on.
    pub(crate) fn first_estimate(&self) -> (f64, Vec<f64>) {
        let mut x = (0..self.rank).map(|i| 1.0 + 0.1 * (i % 7) as f64).collect();
        (self.inverse_iteration(&mut x), x)
    }

    /// The result of [`Factor::smallest_singular_value`], from the vector of [`Factor::first_estimate`].
    pub(crate) fn after_first_estimate(&self, mut x: Vec<f64>) -> (f64, Vec<f64>) {
        if self.rank == 0 {
            return (1.0, x);
        }
        let sigma = (1..STEPS).fold(0.0, |_, _| self.inverse_iteration(&mut x));
        normalize(&mut x);
        (if sigma.is_finite() { sigma } else { 0.0 }, x)
    }

    /// A step `x <- R1^-1 R1^-T x` of inverse iteration; returns its estimate `1 / |R1^-T x|` for an x of norm 1.
    fn inverse_iteration(&self, x: &mut Vec<f64>) -> f64 {
        normalize(x);
        let mut half = self.solve_transposed(x);
        let sigma = 1.0 / norm(&half);
        normalize(&mut half);
        *x = self.solved(&half);
        sigma
    }
}

/// Steps of inverse iteration.
const STEPS: usize = 5;

/// The 2-norm, without overflow of intermediate results.
pub(crate) fn norm(x: &[f64]) -> f64 {
    let largest = x.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest * x.iter().map(|v| (v / largest).powi(2)).sum::<f64>().sqrt()
}

fn normalize(x: &mut [f64]) {
    let norm = norm(x);
    x.iter_mut().for_each(|v| *v /= norm);
}

/// The largest magnitude in x relative to its 2-norm, `max |x_i| / |x|`; 1 if x is zero or empty.
pub(crate) fn part_of_largest(x: &[f64]) -> f64 {
    let largest = x.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
    if largest > 0.0 { largest / norm(x) } else { 1.0 }
}

/// The index of the entry of largest magnitude, the first one among equals.
pub(crate) fn largest_place(x: &[f64]) -> Option<usize> {
    (0..x.len()).max_by(|&a, &b| x[a].abs().total_cmp(&x[b].abs()).then(b.cmp(&a)))
}
