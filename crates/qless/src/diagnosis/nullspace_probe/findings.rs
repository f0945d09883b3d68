//! What a pass finds, and how much of it is to be relied on.

/// A slave that moves more than this, for masters of size 1, stands at the end of multipliers that grew: what presolve made of
/// its equations has lost that many digits.
const STEEP: f64 = 1e3;
/// A slave that moves more than this, for right-hand sides of size 1, stands for equations that are nearly dependent.
const WEAK: f64 = 3e4;
/// A row to which more than this of a user's equation was added has lost that many digits, and so has a slave that moves more: of the
/// sixteen of a double, those of the tolerance of 1e-10 are left.
const FAR: f64 = 1e5;

/// A sample that is nearer to its limit than this factor is drawn again with numbers that depend on the component alone.
const NEARLY: f64 = 0.1;

/// Rows of `C_S^-1` up to this size are looked at no closer.
const HARMLESS: f64 = 8.0;

/// What a pass finds.
#[derive(Default)]
pub(crate) struct NullspaceProbe {
    /// How large a slave can become for right-hand sides of size 1, by the sizes of the numbers of `C_S^-1` or for random ones. C_S holds
    /// the kept equations on their slaves.
    pub(super) largest: f64,
    /// The largest move of a slave.
    pub(super) steepest: f64,
    /// Rows made by presolve that should not be relied on, for growth or for nearness to dependence.
    pub doubtful: Vec<usize>,
    /// Those of them whose slaves have too few digits left, however far the equations are from dependence.
    pub lost: Vec<usize>,
    /// Slaves that stay at zero for random masters, each in its unit, and zero prescribed values.
    pub immobile: Vec<u32>,
    /// For each row of the basis a bound of that row of T: its own largest coefficient, infinite where it names other slaves.
    pub bounds: Vec<f64>,
}

impl NullspaceProbe {
    /// Whether no number is large, so that nothing hangs on how others were drawn.
    pub fn is_harmless(&self) -> bool {
        is_at_most(self.steepest, NEARLY * STEEP) && self.doubtful.is_empty() && is_at_most(self.largest, HARMLESS)
    }

    #[inline]
    pub(super) fn judge(&mut self, t: usize, is_peeled: bool, sample: f64, moves: f64, far: bool) {
        self.steepest = if is_at_most(moves, self.steepest) { self.steepest } else { moves };
        self.largest = if is_at_most(sample, self.largest) { self.largest } else { sample };
        // What is no number is no small one. What is peeled is triangular, so it is not near dependence, whatever its numbers are.
        if far || !is_at_most(moves, STEEP) || !(is_peeled || is_at_most(sample, WEAK)) {
            self.doubtful.push(t);
            if is_far(moves) {
                self.lost.push(t);
            }
        }
    }
}

/// False for what is no number.
#[inline]
fn is_at_most(x: f64, limit: f64) -> bool {
    x <= limit
}

/// Whether more than [`FAR`] times some equation of the user went into a row, so that about that many digits are lost.
pub(crate) fn is_far(reach: f64) -> bool {
    !is_at_most(reach, FAR)
}
