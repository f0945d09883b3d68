//! How sure the rank is: what was kept, what was dropped, and the gap between them.

use crate::ConstraintSystem;
use crate::basis::Kept;
use crate::classify::Dependent;

/// Kept equations that a change of one coefficient by less than this makes dependent are near dependence, whatever the tolerance.
pub(crate) const NEAR: f64 = 3e-6;
/// A mismatch of the right-hand sides below this, relative to its parts, might be meant as none.
const SMALL_MISMATCH: f64 = 1e-6;

/// How sure the rank is, relative to the equilibrated equations.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Confidence {
    /// Estimate of the smallest singular value of the kept equations, 1 where it is more: of the rows of each block by its factors,
    /// of those that presolve kept by the columns of their slaves.
    pub sigma_kept: f64,
    /// Largest remainder, beyond rounding, that was treated as zero.
    pub sigma_dropped: f64,
    /// Their ratio; infinite (`null` in JSON) where nothing beyond rounding was dropped.
    #[serde(serialize_with = "finite_or_null")]
    pub gap: f64,
    /// Whether another tolerance might give another rank or another verdict.
    pub ambiguous: bool,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde calls")]
fn finite_or_null<S: serde::Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if value.is_finite() { serializer.serialize_f64(*value) } else { serializer.serialize_none() }
}

impl Confidence {
    /// `presolved` is sigma of what presolve kept, and `parted` says that two ways to the rank parted.
    pub(crate) fn new(
        solved: &[Kept],
        presolved: f64,
        parted: bool,
        dependent: &[Dependent],
        system: &ConstraintSystem,
    ) -> Self {
        let sigma_kept = solved.iter().map(|block| block.nearness.sigma).fold(presolved, f64::min);
        let sigma_dropped = dependent.iter().map(|d| d.dropped).fold(0.0, f64::max);
        let largest_rhs = system.rhs().iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let doubtful = |d: &Dependent| {
            let small = d.relative_mismatch > 0.0 && d.relative_mismatch < SMALL_MISMATCH;
            // `0 = b` has no parts to be relative to but the other right-hand sides.
            let empty = system.matrix().row(d.row).len() == 0;
            small || (empty && d.mismatch != 0.0 && d.mismatch.abs() < SMALL_MISMATCH * largest_rhs)
        };
        let near = solved.iter().any(|block| block.nearness.distance < NEAR);
        let ambiguous = near || parted || sigma_dropped > 0.0 || dependent.iter().any(doubtful);
        Self { sigma_kept, sigma_dropped, gap: sigma_kept / sigma_dropped, ambiguous }
    }

    /// In view of another confidence in the same system: no more than that, and ambiguous where the two answers differ.
    pub(crate) fn or_less(self, other: Self, differ: bool) -> Self {
        let sigma_kept = self.sigma_kept.min(other.sigma_kept);
        let sigma_dropped = self.sigma_dropped.max(other.sigma_dropped);
        let ambiguous = self.ambiguous || other.ambiguous || differ;
        Self { sigma_kept, sigma_dropped, gap: sigma_kept / sigma_dropped, ambiguous }
    }
}
