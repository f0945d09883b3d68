//! The certainty of a verdict, in digits: the distance of the kept equations from dependence, and the agreement of the dropped ones.

use crate::Tolerance;
use crate::diagnosis::certificate::History;
use crate::diagnosis::classify::{Dependent, Kind, MismatchRule};
use crate::input::noise::{TYPED, is_typed, last_digit, typed_precision};
use crate::input::numbering::LocalSystem;

/// The kept equations are in doubt if relative changes of coefficients smaller than this make them dependent: computed coefficients may be
/// wrong in their 8th digit.
pub(super) const NEAR: f64 = 1e-7;
/// A mismatch of the right-hand sides up to this, relative to its terms, is zero: rounding of the terms can cause it.
pub(super) const NO_MISMATCH: f64 = 1e-12;
/// A nonzero mismatch below this may stand for zero.
pub(super) const SMALL_MISMATCH: f64 = 1e-6;
/// A term of a certificate below this fraction of the largest one may be rounding. Certificates are accurate to `1e-11 / d`, where d is the
/// distance of the kept equations from dependence.
pub(super) const ACCURACY: f64 = 1e-11;
/// A relative mismatch above this is larger than the error of any certificate with `d >= NEAR`, where d is the distance of the kept
/// equations from dependence. If `d < NEAR`, the kept equations are in doubt anyway.
pub(super) const CLEAR_MISMATCH: f64 = ACCURACY / NEAR;

/// Why a verdict is in doubt.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Doubt {
    /// Kept equations become dependent if coefficients change in their 8th digit or later, or in the last digit with which they were typed.
    Near,
    /// Dropped equations have remainders above rounding, so they are no exact combinations of the kept ones.
    NoGap,
    /// Right-hand sides of dependent equations differ by so little that they may be meant as equal.
    Mismatch,
    /// Coefficients that may be rounding decide the result: another reading of them gives another rank or verdict.
    Noise,
    /// A second elimination, which would verify the rank, needs more memory than is allowed.
    Elimination,
    /// The verdict on some equation has no proof.
    Unproved,
    /// Exact arithmetic finds another rank, or another answer to the question whether the equations have a solution.
    Exact,
}

/// The certainty of a verdict, in relative changes of coefficients; it does not depend on the units of equations and DOFs.
///
/// ```text
/// distance   smallest d such that changes |E_ij| <= d |c_ij| make the kept equations dependent      1 for triangular ones
/// error      largest e_k = max_j |row_kj - sum c_i row_ij| / (|row_kj| + sum |c_i row_ij|) of the dropped ones
/// ```
///
/// Both are estimates on the free DOFs, d within a factor of the number of equations. If other units lead to other kept equations, the
/// estimate of d can differ by a digit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Confidence {
    /// The distance d of the kept equations from dependence, between 0 and 1.
    pub distance: f64,
    /// The error e of the certificates of dropped equations; 0 if every remainder is within rounding.
    pub error: f64,
    /// True if there is a doubt: the rank or a verdict may be wrong.
    pub ambiguous: bool,
    /// The reason, if the verdict is ambiguous.
    pub doubt: Option<Doubt>,
}

#[cfg(feature = "serde")]
impl serde::Serialize for Confidence {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeStruct;
        let mut fields = serializer.serialize_struct("Confidence", 4)?;
        fields.serialize_field("digits_kept", &self.digits_kept())?;
        fields.serialize_field("digits_dropped", &self.digits_dropped())?;
        fields.serialize_field("ambiguous", &self.ambiguous)?;
        fields.serialize_field("doubt", &self.doubt)?;
        fields.end()
    }
}

impl Confidence {
    /// Makes a confidence from the distance d and the error e; `other` is a doubt from another check, used if d and e raise none. With a
    /// tolerance other than the default, e raises no doubt, and d raises one only if it is below the tolerance or is rounding.
    ///
    /// ```
    /// use qless::{Confidence, Tolerance};
    /// let of = |distance, error, tolerance| Confidence::of(distance, error, Tolerance::Relative(tolerance), None);
    /// assert!(!of(0.1, 0.0, 1e-10).ambiguous);
    /// assert!(of(1e-9, 0.0, 1e-10).ambiguous && of(0.1, 1e-12, 1e-10).ambiguous);
    /// assert!(!of(1e-7, 1e-9, 1e-8).ambiguous && of(1e-9, 0.0, 1e-8).ambiguous);
    /// ```
    pub fn of(distance: f64, error: f64, tolerance: Tolerance, other: Option<Doubt>) -> Self {
        let (is_near, has_no_gap) = match tolerance.stated() {
            Some(stated) => (distance < stated.max(NO_MISMATCH), false),
            // A remainder below eps of its terms is within the rounding of the coefficients.
            None => (distance < NEAR, error > f64::EPSILON),
        };
        let doubt = is_near.then_some(Doubt::Near).or(has_no_gap.then_some(Doubt::NoGap)).or(other);
        Self { distance, error, ambiguous: doubt.is_some(), doubt }
    }

    /// Adds a doubt, unless there is one already.
    pub(crate) fn or(self, other: Doubt) -> Self {
        let doubt = self.doubt.or(Some(other));
        Self { ambiguous: true, doubt, ..self }
    }

    /// Removes a doubt about the computation, which agreement with exact arithmetic settles. Doubts about the numbers stay: only their
    /// author knows whether they were rounded.
    pub(crate) fn settled(self) -> Self {
        let doubt = self.doubt.filter(|doubt| !matches!(doubt, Doubt::NoGap | Doubt::Elimination));
        Self { ambiguous: doubt.is_some(), doubt, ..self }
    }

    /// `-log10 d` of the distance d: the verdict holds unless coefficients are wrong in a digit before this one. Infinite (`null` in JSON)
    /// if d is 0.
    pub fn digits_kept(&self) -> f64 {
        (-self.distance.log10()).max(0.0)
    }

    /// `-log10 e` of the error e: the number of digits to which the dropped equations agree with the kept ones. Infinite (`null` in JSON)
    /// if all agree.
    pub fn digits_dropped(&self) -> f64 {
        -self.error.log10()
    }
}

/// Returns true if the right-hand sides of dependent equations differ by so little that another reading of them gives another verdict.
pub(crate) fn are_sides_in_doubt(
    dependent: &[Dependent],
    history: &History,
    rule: &MismatchRule,
    tolerance: Tolerance,
) -> bool {
    let reads_digits = rule.reads_digits() && tolerance.stated().is_none();
    doubted(dependent, rule.system, tolerance).next().is_some()
        || (reads_digits && dependent.iter().any(|d| agrees_as_typed(d, history, rule)))
}

/// Returns true if the mismatch of a conflict is within the last digit with which the coefficients of its equations were typed.
fn agrees_as_typed(d: &Dependent, history: &History, rule: &MismatchRule) -> bool {
    if d.kind != Kind::Conflicting || d.relative_mismatch >= last_digit(*TYPED.start()) {
        return false;
    }
    let terms = d.source.explain(history);
    let members = terms.iter().map(|term| term.row).chain([d.row]);
    let precision = typed_precision(members.map(|row| rule.system.row(row).map(|(_, value)| value)));
    // Only right-hand sides of the certificate count. The elimination may have added larger ones and subtracted them again.
    let sides = terms.iter().map(|term| (term.coefficient * rule.side(term.row).size).abs());
    let size = sides.fold(rule.side(d.row).size, f64::max);
    d.mismatch.abs() < precision * size
}

/// Dependent equations that might get another verdict with another tolerance of right-hand sides.
fn doubted<'a>(
    dependent: &'a [Dependent],
    system: LocalSystem<'a>,
    tolerance: Tolerance,
) -> impl Iterator<Item = usize> + 'a {
    let is_stated = tolerance.stated().is_some();
    let largest_rhs = system.rhs().iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let is_doubtful = move |d: &&Dependent| {
        let small = !is_stated && d.relative_mismatch > NO_MISMATCH && d.relative_mismatch < SMALL_MISMATCH;
        // `0 = b` has no terms and no unit of its own: a computed b is compared with those of other equations.
        let empty = system.length(d.row) == 0 && d.mismatch != 0.0 && !is_typed(d.mismatch);
        small || d.is_suspect || (empty && d.mismatch.abs() < SMALL_MISMATCH * largest_rhs)
    };
    dependent.iter().filter(is_doubtful).map(|d| d.row)
}
