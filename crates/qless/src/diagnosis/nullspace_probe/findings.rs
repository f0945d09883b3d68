//! What a pass finds, and how much of it is to be relied on.

/// A slave that moves more than this, for masters of size 1, stands at the end of multipliers that grew: what presolve made of
/// its equations has lost that many digits.
const STEEP: f64 = 1e3;
/// A slave that moves more than this, for right-hand sides of size 1, stands for equations that are nearly dependent.
const WEAK: f64 = 3e4;
/// A row to which more than this of a user's equation was added has lost that many digits.
const FAR: f64 = 1e5;

/// A sample that is nearer to its limit than this factor is drawn again with numbers that depend on the component alone.
const NEARLY: f64 = 0.1;

/// Rows of `C_S^-1` up to this size are looked at no closer.
const HARMLESS: f64 = 8.0;

/// Whether a row of `C_S^-1` says all that is worth knowing.
pub(crate) fn is_harmless(size: f64) -> bool {
    is_at_most(size, HARMLESS)
}

/// What a pass finds.
#[derive(Default)]
pub(crate) struct NullspaceProbe {
    /// For each row of the basis an upper bound of the absolute row sum of `C_S^-1`: how large the slave can become for right-hand sides of
    /// size 1. C_S holds the kept equations on their slaves. Set by a pass with [`super::InverseEstimate::Bound`].
    pub bound_of_inverse: Vec<f64>,
    /// The size of the slave for random right-hand sides. Set by a pass that samples, which runs if some bound is large.
    pub sample_of_inverse: Vec<f64>,
    /// The largest move of a slave.
    pub(super) steepest: f64,
    /// Rows made by presolve that should not be relied on, for growth or for nearness to dependence.
    pub doubtful: Vec<Doubtful>,
    /// Slaves that stay at zero for random masters, each in its unit, and zero prescribed values.
    pub immobile: Vec<u32>,
    /// For each row of the basis a bound of that row of T: its own largest coefficient, infinite where it names other slaves.
    pub bounds: Vec<f64>,
}

/// A row of the basis that should not be relied on.
#[derive(Clone, Copy)]
pub(crate) struct Doubtful {
    pub row: usize,
    pub sample: f64,
    /// No digits were lost: it may merely be near to dependence.
    pub is_near_only: bool,
}

impl Doubtful {
    /// Whether the rows are no nearer to dependence than the tolerance, as far as the sample can tell.
    pub fn is_within(&self, tolerance: f64) -> bool {
        self.is_near_only && is_at_most(self.sample, 4.0 / tolerance)
    }
}

impl NullspaceProbe {
    /// Whether no number is large, so that nothing hangs on how others were drawn.
    pub fn is_harmless(&self) -> bool {
        is_at_most(self.steepest, NEARLY * STEEP) && self.doubtful.is_empty() && is_harmless(self.largest())
    }

    /// The largest bound of a row of `C_S^-1`.
    pub fn largest(&self) -> f64 {
        self.bound_of_inverse.iter().fold(0.0, |most, &size| if is_at_most(size, most) { most } else { size })
    }

    #[inline]
    pub(super) fn judge(&mut self, t: usize, sample: f64, moves: f64, far: bool) {
        self.steepest = if is_at_most(moves, self.steepest) { self.steepest } else { moves };
        // What is no number is no small one.
        if far || !is_at_most(sample, WEAK) || !is_at_most(moves, STEEP) {
            let is_near_only = !far && is_at_most(moves, STEEP);
            self.doubtful.push(Doubtful { row: t, sample, is_near_only });
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
    reach > FAR
}
