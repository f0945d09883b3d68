//! The findings of a pass over the kept equations, and the limits above which a row or its slave is not reliable.

/// If a slave moves more than this for masters of size 1, coefficients have grown during substitution: presolve's rows may have lost three
/// digits or more.
const STEEP: f64 = 1e3;
/// A slave whose row is not peeled is doubtful if it moves more than this for right-hand sides of size 1: its equation may be nearly
/// dependent.
const WEAK: f64 = 3e4;
/// A row to which a user's equation was added with a factor above this has lost more than five digits. So has a slave that moves more than
/// this. Below this limit, enough of the sixteen digits of a double remain for a tolerance of 1e-10.
const FAR: f64 = 1e5;

/// If a result of the probe is above this fraction of its limit, the probe is repeated with random numbers that depend on the component
/// alone.
const NEARLY: f64 = 0.1;

/// If the rows of `C_S^-1` (C_S: the columns of the slaves) are no larger than this, they need no closer estimate.
const HARMLESS: f64 = 8.0;

/// The findings of a pass over the kept equations.
#[derive(Default)]
pub(crate) struct NullspaceProbe {
    /// Largest value of a slave for right-hand sides of size 1: a bound from the entries of `C_S^-1`, or a random sample. C_S holds the
    /// columns of the slaves in the kept equations.
    pub(super) largest: f64,
    /// The largest motion of a slave for random masters.
    pub(super) steepest: f64,
    /// Rows made by presolve that are not reliable, because of growth or nearness to dependence.
    pub doubtful: Vec<usize>,
    /// The doubtful rows whose slaves have too few digits left, so that the rows are doubtful at any distance from dependence.
    pub lost: Vec<usize>,
    /// DOFs that hardly move for random masters and zero prescribed values, and whether they rest.
    pub slow: Vec<(u32, bool)>,
    /// For each row of the basis, a bound of the row of T: the largest coefficient, or infinity if the row of the basis contains other
    /// slaves.
    pub bounds: Vec<f64>,
}

impl NullspaceProbe {
    /// Returns true if all results of the probe are far below their limits, so that the verdict does not depend on the random numbers.
    pub fn is_harmless(&self) -> bool {
        is_at_most(self.steepest, NEARLY * STEEP) && self.doubtful.is_empty() && is_at_most(self.largest, HARMLESS)
    }

    #[inline]
    pub(super) fn judge(&mut self, t: usize, is_peeled: bool, sample: f64, moves: f64, far: bool) {
        self.steepest = if is_at_most(moves, self.steepest) { self.steepest } else { moves };
        self.largest = if is_at_most(sample, self.largest) { self.largest } else { sample };
        // A NaN is not small. Peeled rows are triangular, so they are not near dependence, whatever their numbers are.
        if far || !is_at_most(moves, STEEP) || !(is_peeled || is_at_most(sample, WEAK)) {
            self.doubtful.push(t);
            if is_far(moves) {
                self.lost.push(t);
            }
        }
    }
}

/// Returns true if `x <= limit`; false for NaN.
#[inline]
fn is_at_most(x: f64, limit: f64) -> bool {
    x <= limit
}

/// Returns true if `reach` exceeds [`FAR`] or is NaN: a row has then lost more than five digits. `reach` is the largest multiple of a
/// user's equation in the row, or the motion of its slave.
pub(crate) fn is_far(reach: f64) -> bool {
    !is_at_most(reach, FAR)
}
