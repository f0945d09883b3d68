//! `rank = #{sigma_i > tolerance}` where `sigma_r / sigma_(r+1) > 1e6`, by a dense SVD of the rows brought to one size.

use qless::ConstraintSystem;
use qless_scenes::oracle::singular_values;

/// Values below this part of the largest are rounding.
const ROUNDING: f64 = 1e-14;
/// Values above this are no reason for doubt.
const SURE: f64 = 1e-4;
/// Between values that are kept and values that are dropped.
const GAP: f64 = 1e6;

/// A system and what is known of how it was made.
#[derive(Clone)]
pub struct Case {
    /// Family, sizes and seed.
    pub name: String,
    pub system: ConstraintSystem,
    /// The same in units of one size: what is judged by the SVD. The units u of `system` are `C = C_base diag(u)`.
    pub base: ConstraintSystem,
    pub units: Vec<f64>,
    /// Rows near dependence by construction, however near: there doubt is no false alarm.
    pub near: bool,
}

impl Case {
    pub fn new(name: String, system: ConstraintSystem) -> Self {
        let units = vec![1.0; system.dofs()];
        Self { name, base: system.clone(), system, units, near: false }
    }
}

/// The singular values of all rows, and what they say.
pub struct Truth {
    pub values: Vec<f64>,
    /// Values above the tolerance.
    pub rank: usize,
}

impl Truth {
    pub fn new(system: &ConstraintSystem, tolerance: f64) -> Self {
        let values = singular_values(system).expect("within reach");
        let rank = values.iter().filter(|&&sigma| sigma > tolerance).count();
        Self { values, rank }
    }

    fn largest(&self) -> f64 {
        self.values.first().copied().unwrap_or(1.0)
    }

    /// The smallest value that counts, 1 for more and where none does.
    pub fn sigma(&self) -> f64 {
        self.rank.checked_sub(1).map_or(1.0, |last| self.values[last].min(1.0))
    }

    fn next(&self) -> f64 {
        self.values.get(self.rank).copied().unwrap_or(0.0)
    }

    /// Whether no other rank could be meant.
    pub fn has_gap(&self) -> bool {
        self.sigma() > GAP * self.next()
    }

    /// Whether all other values are rounding beside the first so many.
    pub fn has_gap_at(&self, rank: usize) -> bool {
        let rest = self.values.get(rank).copied().unwrap_or(0.0);
        rest <= ROUNDING * self.largest() && (1..=rank).all(|k| self.values[k - 1] > 1e2 * ROUNDING * self.largest())
    }

    /// Whether what is dropped is rounding.
    pub fn is_exact(&self) -> bool {
        self.next() <= ROUNDING * self.largest()
    }

    /// Neither is anything small nor is what is zero more than rounding.
    pub fn is_clear(&self) -> bool {
        self.sigma() > SURE && self.is_exact()
    }
}
