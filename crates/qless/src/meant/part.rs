//! One connected part: a QR of `C^T` that drops rows nearer than [`NEAR`] to others, and the gap between those and the rest.

use rayon::prelude::*;

use super::NearDependent;
use super::combination::{Combination, explain, in_order};
use crate::Csr;
use crate::local::Local;
use crate::qr::{Backend, BackendError, Factor, largest_place, norm};
use crate::scale::{Scaling, exponent, ldexp};

/// Rows of which so little remains are candidates: what three decimals leave of two coefficients of 1 at most.
const NEAR: f64 = 1e-2;
/// What is kept must be so many times farther from dependence than what is not.
const GAP: f64 = 30.0;

/// Rows of one size over DOFs of their own.
pub(super) struct Part {
    /// Row of the user of each, ascending.
    pub rows: Vec<u32>,
    /// The power of two by which each was multiplied.
    pub exponents: Vec<i32>,
    pub matrix: Csr,
}

impl Part {
    /// `number` has a place for each DOF, none of which belongs to another part.
    pub fn new(system: Local, rows: Vec<u32>, scaling: &Scaling, number: &mut [u32]) -> Self {
        let mut entries = Vec::new();
        let (mut starts, mut exponents) = (vec![0], Vec::new());
        let mut dofs = 0;
        for &row in &rows {
            let i = row as usize;
            let first = entries.len();
            for (j, v) in system.row(i).filter(|&(j, _)| system.free()[j]) {
                if number[j] == u32::MAX {
                    number[j] = dofs;
                    dofs += 1;
                }
                entries.push((number[j] as usize, scaling.entry(i, j, v)));
            }
            let own = &mut entries[first..];
            let shift = -exponent(own.iter().fold(f64::MIN_POSITIVE, |a, (_, v)| a.max(v.abs())));
            own.iter_mut().for_each(|(_, v)| *v = ldexp(*v, shift));
            own.sort_unstable_by_key(|&(j, _)| j);
            exponents.push(scaling.row[i] + shift);
            starts.push(entries.len());
        }
        let mut matrix = Csr::empty(dofs as usize);
        starts.windows(2).for_each(|pair| matrix.push_row(entries[pair[0]..pair[1]].iter().copied()));
        Self { rows, exponents, matrix }
    }

    /// The equations nearly dependent on others, or none without a clear gap.
    pub fn near(&self, backend: &dyn Backend) -> Result<Vec<NearDependent>, BackendError> {
        let factor = backend.factor(&self.matrix, &[], NEAR)?;
        let (mut kept, dropped) = split(&factor, |k| k);
        let mut found = self.combinations(&factor, &kept, &dropped);
        let mut measured = self.distance(&factor, &kept);
        // A chain loses rows by the length of what remains, though no coefficient of it is near anything.
        let mut limit = NEAR;
        for _ in 0..2 {
            if found.iter().any(|c| !c.is_near(self, limit)) {
                let (near, far): (Vec<_>, Vec<_>) = found.into_iter().partition(|c| c.is_near(self, limit));
                if near.is_empty() {
                    return Ok(Vec::new());
                }
                kept.extend(far.iter().map(|c| c.row));
                kept.sort_unstable();
                let factor = backend.factor(&self.select(&kept), &[], 0.0)?;
                kept = split(&factor, |k| kept[k]).0;
                found = self.combinations(&factor, &kept, &near.iter().map(|c| c.row).collect::<Vec<_>>());
                measured = self.distance(&factor, &kept);
            }
            let largest = found.iter().map(|c| c.distance).fold(0.0, f64::max);
            if found.is_empty() || measured >= GAP * largest {
                break;
            }
            limit = widest(&found);
        }
        let largest = found.iter().map(|c| c.distance).fold(0.0, f64::max);
        if found.is_empty() || measured < GAP * largest {
            return Ok(Vec::new());
        }
        in_order(self, &mut found);
        Ok(found.into_iter().map(|c| explain(self, c)).collect())
    }

    fn select(&self, rows: &[usize]) -> Csr {
        let mut selected = Csr::empty(self.matrix.cols);
        rows.iter().for_each(|&i| selected.push_row(self.matrix.row(i)));
        selected
    }

    /// Least squares of some rows over the kept ones, whose factor is given.
    fn combinations(&self, factor: &Factor, kept: &[usize], rows: &[usize]) -> Vec<Combination> {
        let columns = self.select(kept);
        rows.par_iter().map(|&row| Combination::fit(self, factor, &columns, kept, row)).collect()
    }

    /// About the smallest change of one coefficient that makes the kept rows dependent.
    fn distance(&self, factor: &Factor, kept: &[usize]) -> f64 {
        let (sigma, y) = factor.smallest_singular_value();
        let Some(place) = largest_place(&y) else { return sigma };
        let mut v = vec![0.0; self.matrix.cols];
        for (&i, y) in kept.iter().zip(&y) {
            self.matrix.row(i).for_each(|(j, c)| v[j] += y * c);
        }
        let largest = v.iter().fold(f64::MIN_POSITIVE, |a, v| a.max(v.abs()));
        sigma * (norm(&v) / largest).max(1.0) / y[place].abs()
    }
}

/// Kept and dropped rows of a factor, by their names.
fn split(factor: &Factor, name: impl Fn(usize) -> usize) -> (Vec<usize>, Vec<usize>) {
    let names: Vec<usize> = factor.order.iter().map(|&k| name(k)).collect();
    (names[..factor.rank].to_vec(), names[factor.rank..].to_vec())
}

/// A limit in the widest gap between distances.
fn widest(found: &[Combination]) -> f64 {
    let mut distances: Vec<f64> = found.iter().map(|c| c.distance.max(f64::MIN_POSITIVE)).collect();
    distances.sort_unstable_by(f64::total_cmp);
    let ratio = |pair: &&[f64]| pair[1] / pair[0];
    let widest = distances.windows(2).max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
    widest.map_or(0.0, |pair| (pair[0] * pair[1]).sqrt())
}
