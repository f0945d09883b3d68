//! `row_k ~ sum_i c_i row_i`: equations that are independent as typed, but so nearly dependent that they may be meant as dependent.
//!
//! The rank of an analysis is that of the numbers as given. Equations that were typed a second time with six digits, or cosines with
//! four digits, are independent only because of rounding. A part of the system gets a second reading if its equations fall into two
//! groups: most of them far from dependence and some near it, with a clear gap between them.

mod combination;
mod equations;

use super::certificate::CertificateTerm;
use crate::factor::backend::dense_or_sparse::DenseOrSparse;
use crate::factor::backend::{Backend, BackendError, Factor, largest_place, norm};
use crate::input::components::components;
use crate::{Analysis, Kind};
use combination::{NearCombination, explain, in_order};
use equations::{ScaledEquations, without_own};
use rayon::prelude::*;

/// A second reading of a system: as it is probably meant.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct NearDependence {
    /// Rank if the nearly dependent equations are meant as combinations of others; [`Analysis::rank`] is the rank as typed.
    pub rank: usize,
    /// The equations that are meant as combinations of others, and so are redundant or conflicting; ascending by row, at least one.
    pub equations: Vec<NearDependent>,
}

/// An equation that is nearly a combination of others, none of which is in [`NearDependence::equations`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct NearDependent {
    /// The equation, 0-based.
    pub row: usize,
    /// Decimals to which the equation and the combination agree: `floor(-log10 max_j |c_kj - sum_i y_i c_ij| / p_j)`. Here `p_j` is the
    /// largest term of the difference at DOF j or, if only one equation contains DOF j, the largest term of this equation at any DOF.
    pub digits: u32,
    /// About the smallest change of one coefficient that makes the equation a combination, relative to its largest coefficient (within a
    /// factor of 2): `|d|^2 / max |d_j|` for the difference d.
    pub distance: f64,
    /// The combination, ascending by row.
    pub because: Vec<CertificateTerm>,
}

/// Largest size m n (equations times DOFs) of a part that is always factored densely. Sparse QR does not pivot columns by size, so it
/// easily misses near dependence.
const SMALL: usize = 1 << 20;

/// Rows with a remainder below this are candidates; rounding two coefficients of 1 to three decimals leaves less.
const NEAR: f64 = 1e-2;
/// The distance of the kept rows from dependence must be at least this many times that of the other rows.
const GAP: f64 = 30.0;

impl NearDependence {
    /// Decimals to which all of the equations agree with their combinations.
    pub fn digits(&self) -> u32 {
        self.equations.iter().map(|equation| equation.digits).min().unwrap_or(0)
    }
}

impl Analysis {
    /// Equations that are independent as typed but may be meant as combinations of others; None if no such reading stands
    /// out, as in a long chain, whose singular values decrease without a gap.
    ///
    /// Cost: at most three factorizations for each connected part, for any number of nearly dependent equations. Of equations that
    /// nearly repeat each other, the earlier ones are kept.
    ///
    /// ```
    /// use qless::{Options, SystemBuilder, analyse};
    /// // The last is the first with six digits.
    /// let mut builder = SystemBuilder::new(3);
    /// builder.equation([(0, 0.123_456_789), (1, -0.987_654_321)], 0.0);
    /// builder.equation([(1, 1.0), (2, 2.0)], 0.0);
    /// builder.equation([(0, 0.123_457), (1, -0.987_654)], 0.0);
    /// let system = builder.build()?;
    /// let analysis = analyse(&system, &Options::default())?;
    /// let near = analysis.near_dependence()?.expect("a second reading");
    /// assert_eq!((analysis.rank(), near.rank), (3, 2));
    /// let last = &near.equations[0];
    /// assert_eq!((last.row, last.digits, last.because[0].row), (2, 5, 0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BackendError`] if a part is too large for the memory allowed.
    pub fn near_dependence(&self) -> Result<Option<NearDependence>, BackendError> {
        let local = self.local();
        let rows = (0..self.kinds.len() as u32).filter(|&i| self.kinds[i as usize] == Kind::Independent).collect();
        let rows = without_own(local, rows, &self.scaling);
        let free = |i: u32| local.parts(i as usize).0.iter().copied().filter(|&j| local.free()[j as usize]);
        let backend = DenseOrSparse { memory: self.options.memory, small: SMALL };
        let mut number = vec![u32::MAX; local.dofs()];
        let mut equations = Vec::new();
        for rows in components(&rows, local.dofs(), free) {
            if rows.len() > 1 {
                let part = ScaledEquations::new(local, rows, &self.scaling, &mut number);
                equations.extend(part.near(&backend)?);
            }
        }
        equations.sort_unstable_by_key(|equation: &NearDependent| equation.row);
        let rank = self.rank() - equations.len();
        Ok((!equations.is_empty()).then_some(NearDependence { rank, equations }))
    }
}

/// Kept rows, rows near them, and the distance of the kept ones from dependence.
struct SplitEquations {
    kept: Vec<usize>,
    near: Vec<NearCombination>,
    distance: f64,
}

impl SplitEquations {
    fn is_clear(&self) -> bool {
        let largest = self.near.iter().map(|c| c.distance).fold(0.0, f64::max);
        !self.near.is_empty() && self.distance >= GAP * largest
    }
}

impl ScaledEquations {
    /// The equations that nearly depend on others; empty without a clear gap.
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

    /// Moves rows back to the kept ones if they are farther from their combinations than `limit`. The factorization drops a row if the
    /// 2-norm of its remainder is small. In a chain this norm can be small although the row is not near its combination
    /// ([`NearCombination::is_near`]).
    fn within(
        &self,
        reading: SplitEquations,
        limit: f64,
        backend: &dyn Backend,
    ) -> Result<SplitEquations, BackendError> {
        let (near, far): (Vec<_>, Vec<_>) = reading.near.into_iter().partition(|c| c.is_near(self, limit));
        if near.is_empty() || far.is_empty() {
            return Ok(SplitEquations { near, ..reading });
        }
        let mut kept = reading.kept;
        kept.extend(far.iter().map(|c| c.row));
        kept.sort_unstable();
        let factor = backend.factor(&self.select(&kept), &[], 0.0)?;
        let kept = factor.order[..factor.rank].iter().map(|&k| kept[k]).collect();
        Ok(self.read(&factor, kept, &near.iter().map(|c| c.row).collect::<Vec<_>>()))
    }

    /// Least-squares fits of some rows by the kept ones, whose factor is given.
    fn read(&self, factor: &Factor, kept: Vec<usize>, rows: &[usize]) -> SplitEquations {
        let columns = self.select(&kept);
        let fit = |&row: &usize| NearCombination::fit(self, factor, &columns, &kept, row);
        let near: Vec<_> = rows.par_iter().map(fit).collect();
        SplitEquations { distance: if near.is_empty() { 0.0 } else { self.distance(factor, &kept) }, kept, near }
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

/// A limit in the middle of the widest gap between distances.
fn widest(found: &[NearCombination]) -> f64 {
    let mut distances: Vec<f64> = found.iter().map(|c| c.distance.max(f64::MIN_POSITIVE)).collect();
    distances.sort_unstable_by(f64::total_cmp);
    let ratio = |pair: &&[f64]| pair[1] / pair[0];
    let widest = distances.windows(2).max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
    widest.map_or(0.0, |pair| (pair[0] * pair[1]).sqrt())
}
