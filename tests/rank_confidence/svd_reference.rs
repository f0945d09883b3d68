//! `rank = #{sigma_i > tolerance}` where `sigma_r / sigma_(r+1) > 1e6`, by a dense SVD of the rows brought to one size.

use qless::{Analysis, ConstraintSystem, Kind, SystemBuilder};
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

    /// Whether some coefficients are so small in their rows (below `2^-10`) that columns may be scaled: then sigma is that of
    /// another matrix, and cannot be compared.
    pub fn may_scale_columns(&self) -> bool {
        let free = |j: usize| self.system.prescribed().binary_search_by_key(&j, |p| p.0).is_err();
        (0..self.system.equations()).any(|i| {
            let sizes = || self.system.matrix().row(i).filter(|&(j, _)| free(j)).map(|(_, v)| v.abs());
            sizes().fold(f64::INFINITY, f64::min) < sizes().fold(0.0, f64::max) / 512.0
        })
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

    /// Whether what is dropped is rounding.
    pub fn is_exact(&self) -> bool {
        self.next() <= ROUNDING * self.largest()
    }

    /// Neither is anything small nor is what is zero more than rounding.
    pub fn is_clear(&self) -> bool {
        self.sigma() > SURE && self.is_exact()
    }

    /// What the SVD itself may be wrong by.
    pub fn rounding(&self) -> f64 {
        ROUNDING * self.largest()
    }
}

/// The equations that were kept, with all boundary conditions.
pub fn kept(system: &ConstraintSystem, analysis: &Analysis) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(system.dofs());
    for i in (0..system.equations()).filter(|&i| analysis.kinds()[i] == Kind::Independent) {
        builder.equation(system.matrix().row(i), system.rhs()[i]);
    }
    system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(j, value));
    builder.build().expect("as valid as the whole")
}
