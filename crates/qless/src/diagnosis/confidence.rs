//! How sure the rank is: what was kept, what was dropped, and the gap between them.

use crate::ConstraintSystem;
use crate::diagnosis::classify::Dependent;
use crate::presolve::basis::Kept;

/// A mismatch of the right-hand sides up to this, relative to its parts, is none: sums of rounded numbers part so.
const NO_MISMATCH: f64 = 1e-12;
/// A mismatch below this might be meant as none.
const SMALL_MISMATCH: f64 = 1e-6;

/// How sure the rank is, relative to the equilibrated equations.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Confidence {
    /// Estimate of the smallest singular value of the kept equations, 1 where it is more: of the rows of each block by its factors,
    /// of those that presolve kept by the columns of their slaves.
    pub sigma_kept: f64,
    /// Largest remainder, beyond rounding, that was treated as zero.
    pub sigma_dropped: f64,
    /// Their ratio; infinite (`null` in JSON) where nothing beyond rounding was dropped.
    #[cfg_attr(feature = "serde", serde(serialize_with = "finite_or_null"))]
    pub gap: f64,
    /// Estimate of the smallest d such that changes `|E_ij| <= d |c_ij|` make the kept equations dependent, within a factor of their
    /// number: 1 where they are triangular, and without [`crate::Options::check`]. d has no unit; the estimate can differ where other units
    /// lead to other kept equations. In JSON `digits_kept`, which is `-log10 d`: the rank stands unless coefficients are wrong in a digit
    /// before this one. It does not decide what is ambiguous.
    #[cfg_attr(feature = "serde", serde(rename = "digits_kept", serialize_with = "digits"))]
    pub distance: f64,
    /// Whether another tolerance might give another rank or another verdict.
    pub ambiguous: bool,
}

#[cfg(feature = "serde")]
#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde calls")]
fn digits<S: serde::Serializer>(distance: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    finite_or_null(&(0.0 - distance.log10()), serializer)
}

#[cfg(feature = "serde")]
#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde calls")]
fn finite_or_null<S: serde::Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if value.is_finite() { serializer.serialize_f64(*value) } else { serializer.serialize_none() }
}

impl Confidence {
    /// `presolved` is sigma of what presolve kept, and `doubted` are equations of components whose rank or verdict is in doubt.
    pub(crate) fn new(solved: &[Kept], presolved: f64, dependent: &[Dependent], doubted: &[usize]) -> Self {
        let sigma_kept = solved.iter().map(|block| block.nearness.sigma).fold(presolved, f64::min);
        let sigma_dropped = dependent.iter().map(|d| d.dropped).fold(0.0, f64::max);
        Self::of(sigma_kept, sigma_dropped, !doubted.is_empty())
    }

    /// From its parts, for what puts several analyses together: the gap is their ratio, the distance 1.
    pub fn of(sigma_kept: f64, sigma_dropped: f64, ambiguous: bool) -> Self {
        Self { sigma_kept, sigma_dropped, gap: sigma_kept / sigma_dropped, distance: 1.0, ambiguous }
    }

    /// The same with another distance from dependence.
    ///
    /// ```
    /// assert_eq!(qless::Confidence::of(0.5, 0.0, false).with_distance(0.1).distance, 0.1);
    /// ```
    #[must_use]
    pub fn with_distance(self, distance: f64) -> Self {
        Self { distance, ..self }
    }

    /// Together with another of the same system that is in doubt: no more than that.
    pub(crate) fn or_less(self, other: Self) -> Self {
        let sigma_kept = self.sigma_kept.min(other.sigma_kept);
        let sigma_dropped = self.sigma_dropped.max(other.sigma_dropped);
        let distance = self.distance.min(other.distance);
        Self::of(sigma_kept, sigma_dropped, self.ambiguous || other.ambiguous).with_distance(distance)
    }
}

/// Dependent equations that another tolerance might call otherwise.
pub(crate) fn doubted<'a>(
    dependent: &'a [Dependent],
    system: &'a ConstraintSystem,
) -> impl Iterator<Item = usize> + 'a {
    let largest_rhs = system.rhs().iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let is_doubtful = move |d: &&Dependent| {
        let small = d.relative_mismatch > NO_MISMATCH && d.relative_mismatch < SMALL_MISMATCH;
        // `0 = b` has no parts and no unit of its own: it is the one equation that is compared with those beside it.
        let empty = system.matrix().row(d.row).len() == 0;
        d.dropped > 0.0 || small || (empty && d.mismatch != 0.0 && d.mismatch.abs() < SMALL_MISMATCH * largest_rhs)
    };
    dependent.iter().filter(is_doubtful).map(|d| d.row)
}
