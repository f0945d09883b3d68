//! Every reduction is checked against the user's equations before it is returned: `C_S T = -C_M`, `C_S G = -C_p`, `C_S g = b`. C_S, C_M and
//! C_p are the columns of slaves, masters and prescribed DOFs.
//!
//! The terms T u_q, G u_p and g are expanded separately, with random u_q and u_p, and inserted into the equations. A residual is relative
//! to the coefficients of the equation times the largest DOF of the part. The size of a DOF is the sum of the magnitudes of its terms, in
//! the unit of the DOF. For g, the residual of an equation with a right-hand side is relative to the terms of this equation. The check
//! takes one pass over C, T and G. The connected parts are found only if a residual is not small relative to the terms of its equation.

mod expanded;

use std::cmp::Ordering;

use super::{Reduction, ReductionError};
use crate::diagnosis::nullspace_probe::RandomKeys;
use crate::input::components::Labels;
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, balanced_where, ldexp};
use expanded::{Expanded, ExpansionInput, ReductionTerm, each};

/// Largest relative residual of a reduction that is returned.
pub(crate) const LIMIT: f64 = 1e-10;

/// A residual up to this, relative to the terms of its own equation, is accepted; above it T, G and g are computed again or refined.
pub(crate) const FINE: f64 = 1e-13;

/// If no residual exceeds this fraction of [`FINE`], the verdict does not depend on the random numbers.
const NEARLY: f64 = 0.1;

/// The residuals of the independent equations.
#[derive(Default)]
pub(crate) struct Residuals {
    /// The largest residual.
    pub worst: f64,
    /// The equation with the largest residual.
    pub row: usize,
    /// Equations whose residual relative to their own terms is above [`FINE`], ascending, with these residuals.
    pub above: Vec<(usize, f64)>,
}

/// The residuals of T and G, which depend on C only.
pub(crate) fn residuals_of_matrices(
    local: LocalSystem,
    reduction: &Reduction,
    independent: &[bool],
    scaling: &Scaling,
) -> Residuals {
    let prescribed = (!local.prescribed().is_empty()).then_some(ReductionTerm::Prescribed);
    let terms = [Some(ReductionTerm::Free), prescribed].into_iter().flatten();
    residuals_of(terms, (local, reduction), independent, scaling)
}

/// The residuals of g.
pub(crate) fn residuals_of_g(
    local: LocalSystem,
    reduction: &Reduction,
    independent: &[bool],
    scaling: &Scaling,
) -> Residuals {
    let has_constant = local.rhs().iter().any(|&b| b != 0.0) || reduction.g.iter().any(|&g| g != 0.0);
    let terms = has_constant.then_some(ReductionTerm::Constant);
    residuals_of(terms.into_iter(), (local, reduction), independent, scaling)
}

fn residuals_of(
    terms: impl Iterator<Item = ReductionTerm>,
    (local, reduction): (LocalSystem, &Reduction),
    independent: &[bool],
    scaling: &Scaling,
) -> Residuals {
    let mut found = Residuals::default();
    // Residuals are computed in the user's units and, if these mix, in balanced units too: in either of them alone, other DOFs may be so
    // large that they hide the residual of an equation.
    let is_mixed = |i: usize| local.row(i).any(|(j, _)| scaling.col(j) != 0);
    let balanced = if scaling.col.is_empty() { Scaling::none(0) } else { balanced_where(local, is_mixed) };
    let units = [Some((scaling, false)), (!balanced.col.is_empty()).then_some((&balanced, true))];
    let each = terms.flat_map(|term| units.into_iter().flatten().map(move |units| (term, units)));
    for (term, (scaling, is_balanced)) in each {
        let input = ExpansionInput { term, local, reduction, scaling, is_balanced };
        let mut expanded = Expanded::new(input, None);
        let mut own = expanded.residuals(local, independent);
        let is_fine = |own: &[f64]| own.iter().all(|&residual| residual <= FINE);
        if !own.iter().all(|&residual| residual <= NEARLY * FINE) {
            // The verdict may depend on the random numbers. Numbers by position within the part make it independent of other parts.
            let keys = RandomKeys::within_components(&Labels::of(local), local);
            expanded = Expanded::new(input, Some(&keys));
            own = expanded.residuals(local, independent);
            if !is_fine(&own) {
                expanded.measure(input, &keys);
                own = expanded.residuals(local, independent);
            }
        }
        found.above.extend(own.iter().copied().enumerate().filter(|&(_, residual)| residual > FINE));
        if !is_fine(&own) {
            expanded.relative_to_components(local, scaling, &mut own);
        }
        for (i, &residual) in own.iter().enumerate() {
            if residual > found.worst {
                (found.worst, found.row) = (residual, i);
            }
        }
    }
    found.above.sort_unstable_by(|a, b| (a.0, b.1).partial_cmp(&(b.0, a.1)).unwrap_or(Ordering::Equal));
    found.above.dedup_by_key(|(i, _)| *i);
    found
}

impl Residuals {
    /// Returns `self` or `other`, the one with the larger worst residual.
    pub fn worse(self, other: Self) -> Self {
        if other.worst > self.worst { other } else { self }
    }
}

/// Returns an error if the largest residual of a reduction is above the limit.
pub(crate) fn pass(found: &Residuals, reduction: &Reduction) -> Result<(), ReductionError> {
    if found.worst <= LIMIT {
        return Ok(());
    }
    let is_finite = |&i: &usize| {
        let mut entries = reduction.t.row(i).chain(reduction.g_matrix.row(i));
        reduction.g[i].is_finite() && entries.all(|(_, v)| v.is_finite())
    };
    match (0..reduction.slaves.len()).find(|i| !is_finite(i)) {
        Some(i) => Err(ReductionError::NotFinite { dof: reduction.slaves[i] }),
        None => Err(ReductionError::Residual { row: found.row, residual: found.worst }),
    }
}

impl Expanded {
    /// The residual of each equation relative to its own terms.
    pub fn residuals(&self, local: LocalSystem, independent: &[bool]) -> Vec<f64> {
        let sizes = self.sizes.as_ref().unwrap_or(&self.u);
        each(local.equations(), |i| {
            if !independent[i] {
                return 0.0;
            }
            let (sum, size) = self.sums(local, i, 1.0, sizes);
            // If a sum overflows, the sums are computed again in a larger unit.
            let (sum, size) = if size.is_finite() { (sum, size) } else { self.sums(local, i, 1e-100, sizes) };
            relative(sum, size)
        })
    }

    /// Replaces residuals above [`FINE`] by those relative to the largest DOF of their part.
    pub fn relative_to_components(&self, local: LocalSystem, scaling: &Scaling, out: &mut [f64]) {
        let labels = Labels::of(local);
        let mut largest = vec![0.0_f64; labels.count];
        for (i, &label) in labels.of_row.iter().enumerate() {
            let free = local.row(i).filter(|&(j, _)| local.free()[j]);
            let sizes = free.map(|(j, _)| ldexp(self.size(j), -scaling.col(j)));
            largest[label as usize] = sizes.fold(largest[label as usize], f64::max);
        }
        for (i, out) in out.iter_mut().enumerate().filter(|(_, out)| **out > FINE) {
            let b = self.rhs(local, i);
            // If b is not zero, the residual stays relative to the terms of the equation: large DOFs elsewhere do not excuse that g misses
            // b.
            if b != 0.0 {
                continue;
            }
            let sum = local.row(i).fold(-b, |sum, (j, v)| sum + v * self.u[j]);
            // Prescribed DOFs may have any unit, so they count by their term in the equation, as b does.
            let largest = largest[labels.of_row[i] as usize];
            let parts = local.row(i).map(|(j, v)| {
                if local.free()[j] { ldexp(v.abs(), scaling.col(j)) * largest } else { (v * self.u[j]).abs() }
            });
            *out = relative(sum, parts.sum::<f64>() + b.abs());
        }
    }

    /// `C_i u - b_i` of equation i and the sum of the magnitudes of its terms, both times `unit`. For each DOF, `sizes` has the sum of the
    /// magnitudes of its terms.
    #[inline]
    fn sums(&self, local: LocalSystem, i: usize, unit: f64, sizes: &[f64]) -> (f64, f64) {
        let b = self.rhs(local, i) * unit;
        let (dofs, values) = local.parts(i);
        dofs.iter().zip(values).fold((-b, b.abs()), |(sum, size), (&j, v)| {
            (sum + v * (self.u[j as usize] * unit), size + (v * (sizes[j as usize] * unit)).abs())
        })
    }

    fn rhs(&self, local: LocalSystem, i: usize) -> f64 {
        if self.with_rhs { local.rhs()[i] } else { 0.0 }
    }
}

/// `|sum| / size`; infinite if it is not a finite number, so that NaN and overflow are never small.
fn relative(sum: f64, size: f64) -> f64 {
    match sum.abs() / size {
        _ if sum == 0.0 => 0.0,
        residual if residual.is_finite() && size.is_finite() => residual,
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::relative;

    #[test]
    fn nan_and_overflow_are_not_small() {
        assert_eq!((relative(0.0, 0.0), relative(1.0, 4.0)), (0.0, 0.25));
        for (sum, size) in [(1e300, f64::INFINITY), (f64::NAN, 1.0), (f64::INFINITY, f64::INFINITY), (1.0, 0.0)] {
            assert_eq!(relative(sum, size), f64::INFINITY);
        }
    }
}
