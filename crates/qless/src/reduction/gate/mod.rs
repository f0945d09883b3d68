//! The gate: `C T' = 0`, `C G' = -C_p` and `C g' = b`, before a reduction leaves the library.
//!
//! With random u_q and u_p, T, G and g are each expanded on their own and put into the user's equations. The residual of an equation is
//! relative to its coefficients and to the largest sum of the sizes of the parts that make a DOF of its component, each DOF in its
//! unit. One pass over C, T and G; components are looked for only where an equation does not meet its own parts.

mod drawn;
mod expanded;
mod sums;

use std::cmp::Ordering;

use super::{Reduction, ReductionError};
use crate::diagnosis::samples::Keys;
use crate::input::components::Labels;
use crate::input::numbering::Local;
use crate::input::scale::Scaling;

use expanded::{Expanded, Given, Part};

/// Largest relative residual with which a reduction may leave.
pub(crate) const LIMIT: f64 = 1e-10;

/// A residual of an equation up to this, relative to its own parts, needs no second look.
const FINE: f64 = 1e-13;

/// Residuals up to this part of what is fine are so whatever numbers are drawn.
const NEARLY: f64 = 0.1;

/// The residuals of the independent equations.
pub(crate) struct Found {
    /// The largest, ...
    pub worst: f64,
    /// ... of this equation.
    pub row: usize,
    /// Equations above what was asked for, ascending, with their residuals.
    pub above: Vec<(usize, f64)>,
}

/// Residuals, with the equations above `above` listed.
pub(crate) fn residuals(
    local: Local,
    reduction: &Reduction,
    independent: &[bool],
    scaling: &Scaling,
    above: f64,
) -> Found {
    let has_constant = || local.rhs().iter().any(|&b| b != 0.0) || reduction.g.iter().any(|&g| g != 0.0);
    let parts = [
        Some(Part::Free),
        (!local.prescribed().is_empty()).then_some(Part::Prescribed),
        has_constant().then_some(Part::Constant),
    ];
    judge(parts.into_iter().flatten(), (local, reduction), independent, scaling, above)
}

/// The same of g alone, where T and G have passed before.
pub(crate) fn residuals_of_g(local: Local, reduction: &Reduction, independent: &[bool], scaling: &Scaling) -> Found {
    judge([Part::Constant].into_iter(), (local, reduction), independent, scaling, f64::INFINITY)
}

fn judge(
    parts: impl Iterator<Item = Part>,
    (local, reduction): (Local, &Reduction),
    independent: &[bool],
    scaling: &Scaling,
    above: f64,
) -> Found {
    let mut found = Found { worst: 0.0, row: 0, above: Vec::new() };
    for part in parts {
        let of_part = Given { part, local, reduction, scaling };
        let mut expanded = Expanded::new(of_part, None);
        let mut own = expanded.residuals(local, independent);
        let is_fine = |own: &[f64]| own.iter().all(|&residual| residual <= FINE);
        if !own.iter().all(|&residual| residual <= NEARLY * FINE) {
            // Something may hang on how numbers were drawn: once more by places within the components.
            let keys = Keys::within(&Labels::of(local), local);
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
pub(crate) fn pass(found: &Found, reduction: &Reduction) -> Result<(), ReductionError> {
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
