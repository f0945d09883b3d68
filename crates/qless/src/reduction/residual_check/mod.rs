//! The gate: `C T' = 0`, `C G' = -C_p` and `C g' = b`, before a reduction leaves the library.
//!
//! With random u_q and u_p, T, G and g are each expanded on their own and put into the user's equations. The residual of an equation is
//! relative to its coefficients and to the largest sum of the sizes of the parts that make a DOF of its component, each DOF in its
//! unit. One pass over C, T and G; components are looked for only where an equation does not meet its own parts.

mod expanded;

use std::cmp::Ordering;

use super::{Reduction, ReductionError};
use crate::diagnosis::nullspace_probe::RandomKeys;
use crate::input::components::Labels;
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, ldexp};
use expanded::{Expanded, Given, Part, each};

/// Largest relative residual with which a reduction may leave.
pub(crate) const LIMIT: f64 = 1e-10;

/// A residual of an equation up to this, relative to its own parts, needs no second look.
const FINE: f64 = 1e-13;

/// Residuals up to this part of what is fine are so whatever numbers are drawn.
const NEARLY: f64 = 0.1;

/// The residuals of the independent equations.
pub(crate) struct Residuals {
    /// The largest, ...
    pub worst: f64,
    /// ... of this equation.
    pub row: usize,
    /// Equations above what was asked for, ascending, with their residuals.
    pub above: Vec<(usize, f64)>,
}

/// Residuals, with the equations above `above` listed.
pub(crate) fn residuals(
    local: LocalSystem,
    reduction: &Reduction,
    independent: &[bool],
    scaling: &Scaling,
    above: f64,
) -> Residuals {
    let has_constant = || local.rhs().iter().any(|&b| b != 0.0) || reduction.g.iter().any(|&g| g != 0.0);
    let parts = [
        Some(Part::Free),
        (!local.prescribed().is_empty()).then_some(Part::Prescribed),
        has_constant().then_some(Part::Constant),
    ];
    judge(parts.into_iter().flatten(), (local, reduction), independent, scaling, above)
}

/// The same of g alone, where T and G have passed before.
pub(crate) fn residuals_of_g(
    local: LocalSystem,
    reduction: &Reduction,
    independent: &[bool],
    scaling: &Scaling,
) -> Residuals {
    judge([Part::Constant].into_iter(), (local, reduction), independent, scaling, f64::INFINITY)
}

fn judge(
    parts: impl Iterator<Item = Part>,
    (local, reduction): (LocalSystem, &Reduction),
    independent: &[bool],
    scaling: &Scaling,
    above: f64,
) -> Residuals {
    let mut found = Residuals { worst: 0.0, row: 0, above: Vec::new() };
    for part in parts {
        let of_part = Given { part, local, reduction, scaling };
        let mut expanded = Expanded::new(of_part, None);
        let mut own = expanded.residuals(local, independent);
        let is_fine = |own: &[f64]| own.iter().all(|&residual| residual <= FINE);
        if !own.iter().all(|&residual| residual <= NEARLY * FINE) {
            // Something may hang on how numbers were drawn: once more by places within the components.
            let keys = RandomKeys::within_components(&Labels::of(local), local);
            expanded = Expanded::new(of_part, Some(&keys));
            own = expanded.residuals(local, independent);
            if !is_fine(&own) {
                expanded.measure(of_part, &keys);
                own = expanded.residuals(local, independent);
            }
        }
        if !is_fine(&own) {
            expanded.relative_to_components(local, scaling, &mut own);
        }
        for (i, &residual) in own.iter().enumerate() {
            if residual > found.worst {
                (found.worst, found.row) = (residual, i);
            }
            found.above.extend((residual > above).then_some((i, residual)));
        }
    }
    found.above.sort_unstable_by(|a, b| (a.0, b.1).partial_cmp(&(b.0, a.1)).unwrap_or(Ordering::Equal));
    found.above.dedup_by_key(|(i, _)| *i);
    found
}

/// Refuses what is not within the limit.
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
    /// Relative to the equations' own parts.
    pub fn residuals(&self, local: LocalSystem, independent: &[bool]) -> Vec<f64> {
        let sizes = self.sizes.as_ref().unwrap_or(&self.u);
        each(local.equations(), |i| {
            if !independent[i] {
                return 0.0;
            }
            let (sum, size) = self.sums(local, i, 1.0, sizes);
            // Near the end of the range of doubles the same is asked in another unit.
            let (sum, size) = if size.is_finite() { (sum, size) } else { self.sums(local, i, 1e-100, sizes) };
            relative(sum, size)
        })
    }

    /// Those that are not fine relative to the largest parts of their components.
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
            let sum = local.row(i).fold(-b, |sum, (j, v)| sum + v * self.u[j]);
            // Prescribed DOFs are in no unit that others share: they count by what they bring into the equation, as b does.
            let largest = largest[labels.of_row[i] as usize];
            let parts = local.row(i).map(|(j, v)| {
                if local.free()[j] { ldexp(v.abs(), scaling.col(j)) * largest } else { (v * self.u[j]).abs() }
            });
            *out = relative(sum, parts.sum::<f64>() + b.abs());
        }
    }

    /// `C_i u - b_i` and the sum of the sizes of its parts, in a unit; `sizes` are those of the DOFs.
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

/// A sum that is no number, or parts beyond the range of doubles, must not pass for small.
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
    fn what_cannot_be_compared_is_not_small() {
        assert_eq!((relative(0.0, 0.0), relative(1.0, 4.0)), (0.0, 0.25));
        for (sum, size) in [(1e300, f64::INFINITY), (f64::NAN, 1.0), (f64::INFINITY, f64::INFINITY), (1.0, 0.0)] {
            assert_eq!(relative(sum, size), f64::INFINITY);
        }
    }
}
