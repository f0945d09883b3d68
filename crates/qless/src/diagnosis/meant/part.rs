//! One connected part: a QR of `C^T` that drops rows nearer than [`NEAR`] to others, and the gap between those and the rest.

use rayon::prelude::*;

use super::NearDependent;
use super::combination::{Combination, explain, in_order};
use crate::Csr;
use crate::factor::backend::{Backend, BackendError, Factor, largest_place, norm};
use crate::input::numbering::Local;
use crate::input::scale::{Scaling, exponent, ldexp};

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

/// Rows kept, rows near to them, and how far the kept ones are from dependence.
struct Reading {
    kept: Vec<usize>,
    near: Vec<Combination>,
    distance: f64,
}

impl Reading {
    fn is_clear(&self) -> bool {
        let largest = self.near.iter().map(|c| c.distance).fold(0.0, f64::max);
        !self.near.is_empty() && self.distance >= GAP * largest
    }
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
        starts.windows(2).for_each(|pair| matrix.append(entries[pair[0]..pair[1]].iter().copied()));
        Self { rows, exponents, matrix }
    }

    /// The equations nearly dependent on others, or none without a clear gap.
    pub fn near(&self, backend: &dyn Backend) -> Result<Vec<NearDependent>, BackendError> {
        let factor = backend.factor(&self.matrix, &[], NEAR)?;
        let (kept, dropped) = factor.order.split_at(factor.rank);
        let mut reading = self.read(&factor, kept.to_vec(), dropped);
        let mut limit = NEAR;
        for _ in 0..2 {
            reading = self.within(reading, limit, backend)?;
            if reading.near.is_empty() || reading.is_clear() {
                break;
            }
            limit = widest(&reading.near);
        }
        if !reading.is_clear() {
            return Ok(Vec::new());
        }
        in_order(self, &mut reading.near);
        Ok(reading.near.iter().map(|c| explain(self, c)).collect())
    }

    /// Takes back what is farther than the limit: a chain loses rows by the length of what remains of them, though no coefficient
    /// of that is small.
    fn within(&self, reading: Reading, limit: f64, backend: &dyn Backend) -> Result<Reading, BackendError> {
        let (near, far): (Vec<_>, Vec<_>) = reading.near.into_iter().partition(|c| c.is_near(self, limit));
        if near.is_empty() || far.is_empty() {
            return Ok(Reading { near, ..reading });
        }
        let mut kept = reading.kept;
        kept.extend(far.iter().map(|c| c.row));
        kept.sort_unstable();
        let factor = backend.factor(&self.select(&kept), &[], 0.0)?;
        let kept = factor.order[..factor.rank].iter().map(|&k| kept[k]).collect();
        Ok(self.read(&factor, kept, &near.iter().map(|c| c.row).collect::<Vec<_>>()))
    }

    /// Least squares of some rows over the kept ones, whose factor is given.
    fn read(&self, factor: &Factor, kept: Vec<usize>, rows: &[usize]) -> Reading {
        let columns = self.select(&kept);
        let fit = |&row: &usize| Combination::fit(self, factor, &columns, &kept, row);
        let near: Vec<_> = rows.par_iter().map(fit).collect();
        Reading { distance: if near.is_empty() { 0.0 } else { self.distance(factor, &kept) }, kept, near }
    }

    fn select(&self, rows: &[usize]) -> Csr {
        let mut selected = Csr::empty(self.matrix.cols);
        rows.iter().for_each(|&i| selected.append(self.matrix.row(i)));
        selected
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

/// A limit in the widest gap between distances.
fn widest(found: &[Combination]) -> f64 {
    let mut distances: Vec<f64> = found.iter().map(|c| c.distance.max(f64::MIN_POSITIVE)).collect();
    distances.sort_unstable_by(f64::total_cmp);
    let ratio = |pair: &&[f64]| pair[1] / pair[0];
    let widest = distances.windows(2).max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
    widest.map_or(0.0, |pair| (pair[0] * pair[1]).sqrt())
}
