//! The gate: `C T' = 0`, `C G' = -C_p` and `C g' = b`, before a reduction leaves the library.
//!
//! With random u_q and u_p, T, G and g are each expanded on their own and put into the user's equations. The residual of an equation is
//! relative to its coefficients and to the largest sum of the sizes of the parts that make a DOF of its component, each DOF in its
//! unit. One pass over C, T and G; components are looked for only where an equation does not meet its own parts.

use super::{Reduction, ReductionError};
use crate::components::Labels;
use crate::local::Local;
use crate::random::randoms;
use crate::scale::{Scaling, ldexp};

/// Largest relative residual with which a reduction may leave.
pub(crate) const LIMIT: f64 = 1e-10;
/// A residual of an equation up to this, relative to its own parts, needs no second look.
const FINE: f64 = 1e-13;

/// The residuals of the independent equations.
pub(crate) struct Found {
    /// The largest, ...
    pub worst: f64,
    /// ... of this equation.
    pub row: usize,
    /// Equations above what was asked for.
    pub above: Vec<usize>,
}

/// All DOFs for one part of the reduction, and the sizes of what makes them.
struct Expanded {
    u: Vec<f64>,
    size: Vec<f64>,
    /// Whether b belongs to this part.
    with_rhs: bool,
}

/// Residuals, with the equations above `above` listed.
pub(crate) fn residuals(
    local: Local,
    reduction: &Reduction,
    independent: &[bool],
    scaling: &Scaling,
    above: f64,
) -> Found {
    judge(&parts(local, reduction), local, independent, scaling, above)
}

/// The same of g alone, where T and G have passed before.
pub(crate) fn residuals_of_g(local: Local, reduction: &Reduction, independent: &[bool], scaling: &Scaling) -> Found {
    judge(&[expand(local, reduction, &[], &[], true)], local, independent, scaling, f64::INFINITY)
}

fn judge(parts: &[Expanded], local: Local, independent: &[bool], scaling: &Scaling, above: f64) -> Found {
    let mut found = Found { worst: 0.0, row: 0, above: Vec::new() };
    let mut own = vec![0.0; local.equations()];
    for part in parts {
        let is_fine = part.residuals(local, independent, &mut own);
        if !is_fine {
            part.relative_to_components(local, scaling, &mut own);
        }
        for (i, &residual) in own.iter().enumerate() {
            if residual > found.worst {
                (found.worst, found.row) = (residual, i);
            }
            found.above.extend((residual > above).then_some(i));
        }
    }
    found.above.sort_unstable();
    found.above.dedup();
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

/// T alone, G alone, g alone; only what is there.
fn parts(local: Local, reduction: &Reduction) -> Vec<Expanded> {
    let mut random = randoms(1);
    let mut some = |count: usize| random.by_ref().take(count).collect::<Vec<f64>>();
    let (masters, prescribed) = (some(reduction.masters.len()), some(reduction.prescribed.len()));
    let mut parts = vec![expand(local, reduction, &masters, &[], false)];
    if !local.prescribed().is_empty() {
        parts.push(expand(local, reduction, &[], &prescribed, false));
    }
    if local.rhs().iter().any(|&b| b != 0.0) || reduction.g.iter().any(|&g| g != 0.0) {
        parts.push(expand(local, reduction, &[], &[], true));
    }
    parts
}

fn expand(local: Local, reduction: &Reduction, masters: &[f64], prescribed: &[f64], with_rhs: bool) -> Expanded {
    let length = reduction.slaves.len() + reduction.masters.len() + reduction.prescribed.len();
    let mut users = vec![(0.0, 0.0); length];
    reduction.masters.iter().zip(masters).for_each(|(&j, &v)| users[j] = (v, v));
    reduction.prescribed.iter().zip(prescribed).for_each(|(&j, &v)| users[j] = (v, v));
    let of = |row: &mut dyn Iterator<Item = (usize, f64)>, x: &[f64]| {
        row.fold((0.0, 0.0), |(sum, size): (f64, f64), (j, v)| (sum + v * x[j], size + (v * x[j]).abs()))
    };
    for (i, &slave) in reduction.slaves.iter().enumerate() {
        users[slave] = match (masters, prescribed) {
            ([], []) if with_rhs => (reduction.g[i], reduction.g[i].abs()),
            ([], []) => (0.0, 0.0),
            ([], prescribed) => of(&mut reduction.g_matrix.row(i), prescribed),
            (masters, _) => of(&mut reduction.t.row(i), masters),
        };
    }
    let (u, size) = local.numbering.dofs.iter().map(|&j| users[j as usize]).unzip();
    Expanded { u, size, with_rhs }
}

impl Expanded {
    fn rhs(&self, local: Local, i: usize) -> f64 {
        if self.with_rhs { local.rhs()[i] } else { 0.0 }
    }

    /// Relative to the equations' own parts; whether all are fine.
    fn residuals(&self, local: Local, independent: &[bool], out: &mut [f64]) -> bool {
        let mut is_fine = true;
        for (i, out) in out.iter_mut().enumerate() {
            *out = 0.0;
            if !independent[i] {
                continue;
            }
            let b = self.rhs(local, i);
            let (sum, size) = local
                .row(i)
                .fold((-b, b.abs()), |(sum, size), (j, v)| (sum + v * self.u[j], size + v.abs() * self.size[j]));
            // A sum that is no number must not pass for a small one.
            let residual = if sum == 0.0 { 0.0 } else { sum.abs() / size };
            *out = if residual.is_nan() { f64::INFINITY } else { residual };
            is_fine &= *out <= FINE;
        }
        is_fine
    }

    /// Those that are not fine relative to the largest parts of their components.
    fn relative_to_components(&self, local: Local, scaling: &Scaling, out: &mut [f64]) {
        let labels = Labels::of(local);
        let mut largest = vec![0.0_f64; labels.count];
        for (i, &label) in labels.of_row.iter().enumerate() {
            let sizes = local.row(i).map(|(j, _)| ldexp(self.size[j], -scaling.col(j)));
            largest[label as usize] = sizes.fold(largest[label as usize], f64::max);
        }
        for (i, out) in out.iter_mut().enumerate().filter(|(_, out)| **out > FINE) {
            let b = self.rhs(local, i);
            let sum = local.row(i).fold(-b, |sum, (j, v)| sum + v * self.u[j]);
            let weight: f64 = local.row(i).map(|(j, v)| ldexp(v.abs(), scaling.col(j))).sum();
            let residual = sum.abs() / (weight * largest[labels.of_row[i] as usize] + b.abs());
            *out = if residual.is_nan() { f64::INFINITY } else { residual };
        }
    }
}
