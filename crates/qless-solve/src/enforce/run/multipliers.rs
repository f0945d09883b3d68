//! The equations themselves: a multiplier for each that is not eliminated. What is right here is right, however stiff or soft a spring is.
//!
//! Augmented equations come to this anyway, step by step. Penalties are solved from here ([`super::penalties`]).

use super::super::EnforceError;
use super::super::equations::Settled;
use super::super::method::Method;
use super::support::supported;
use super::{Found, Part, Prepared};

/// In balance and to the accuracy asked for, or refused.
pub fn solved(part: &Part, accuracy: f64) -> Result<Found, EnforceError> {
    let (mut exact, growth) = supported(part)?;
    let mut settled = exact.settled(accuracy)?;
    if settled.share > 1.0
        && settled.row >= part.dofs.len()
        && let Some(other) = eliminated(part, accuracy)
    {
        (exact, settled) = other;
    }
    let rounding = match exact.rounding(&settled, growth) {
        Some(rounding) if settled.share <= 1.0 && rounding.share < 1.0 => rounding,
        _ => return Err(refused(part, &settled, accuracy)),
    };
    if part.methods.iter().any(|method| matches!(method, Method::Penalty { .. })) {
        return exact.penalised(&settled.x, &rounding, accuracy);
    }
    let stated = exact.rounded(&settled.x, &rounding);
    found(part, settled, stated, accuracy)
}

/// By elimination, where that meets equations that multipliers leave open: terms that are zero are zero in T, and rounding in factors.
fn eliminated<'a>(part: &'a Part<'a>, accuracy: f64) -> Option<(Prepared<'a>, Settled)> {
    let mut prepared = Prepared::new(part, vec![Method::Elimination; part.methods.len()], 0.0).ok()?;
    let settled = prepared.settled(accuracy).ok().filter(|settled| settled.share <= 1.0)?;
    Some((prepared, settled))
}

/// A solution of which `stated` may be wrong: less than the whole, or refused.
pub fn found(part: &Part, settled: Settled, stated: f64, accuracy: f64) -> Result<Found, EnforceError> {
    if stated.is_nan() || stated >= 1.0 {
        return Err(refused(part, &settled, accuracy));
    }
    let Settled { x, imbalance, .. } = settled;
    Ok(Found { x, imbalance, accuracy: stated })
}

/// What rounding leaves is too much: of a row, or of an equation that was to be met to less.
fn refused(part: &Part, settled: &Settled, tolerance: f64) -> EnforceError {
    let (n, left) = (part.dofs.len(), settled.imbalance);
    match settled.row.checked_sub(n).map(|row| part.methods[row]) {
        Some(Method::Augmented { .. }) if settled.share > 1.0 => EnforceError::NoConvergence { left, tolerance },
        _ => EnforceError::OutOfBalance { row: part.name(settled.row), imbalance: left },
    }
}
