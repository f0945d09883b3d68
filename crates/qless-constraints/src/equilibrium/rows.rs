//! The equations that carry multipliers: those that are independent at a consistent configuration.
//!
//! They are chosen where the constraints hold, and kept on the way: off the constraints by d, redundant rows are independent by d, and
//! with multipliers on them the matrix would be singular but for d.

use std::sync::Arc;

use qless::{Analysis, Kind, Options, analyse};

use super::{EquilibriumOptions, Failure};
use crate::newton::{Columns, units};
use crate::{ConstraintSet, Quantities};

/// Kept rows, ascending.
#[derive(Clone, Debug)]
pub struct Rows {
    list: Vec<usize>,
    kept: Vec<bool>,
    /// Whether one was left out that is independent in the units.
    thinned: bool,
    /// Of the DOFs there.
    units: Vec<f64>,
    /// What says which rows others follow from.
    analysis: Arc<Analysis>,
}

impl Rows {
    /// The rows that are independent where `quantities` were evaluated, `before` first.
    pub fn new(
        set: &ConstraintSet,
        quantities: &Quantities,
        prescribed: &[(usize, f64)],
        (options, before): (&EquilibriumOptions, &[usize]),
    ) -> Result<Self, Failure> {
        let mut still = quantities.clone();
        // Only the rank is asked for.
        still.c.fill(0.0);
        let held: Vec<(usize, f64)> = prescribed.iter().map(|&(j, v)| (j, 0.0 * v)).collect();
        let mut settings: Options = options.analysis.clone();
        settings.preferences.equations = before.to_vec();
        let units = units(set, quantities, &Columns::plain(quantities.g()))?;
        let analysis = analyse(&set.linearised_in(&units, &still, &held)?, &settings)?;
        let kept: Vec<bool> = analysis.kinds().iter().map(|&kind| kind == Kind::Independent).collect();
        let list = (0..kept.len()).filter(|&r| kept[r]).collect();
        Ok(Self { list, kept, thinned: false, units, analysis: Arc::new(analysis) })
    }

    pub fn list(&self) -> &[usize] {
        &self.list
    }

    pub fn units(&self) -> &[f64] {
        &self.units
    }

    pub fn kept(&self, row: usize) -> bool {
        self.kept[row]
    }

    /// `(c_k, k)` of a row that follows from others, `row = sum c_k row_k`; none of one that does not.
    pub fn because(&self, row: usize) -> impl Iterator<Item = (f64, usize)> {
        let because = self.analysis.because(row).unwrap_or_default();
        because.into_iter().map(|term| (term.coefficient, term.row))
    }

    /// Leaves out a row that depends on others.
    pub fn leave_out(&mut self, row: usize) {
        self.list.retain(|&r| r != row);
        (self.kept[row], self.thinned) = (false, true);
    }

    pub fn is_thinned(&self) -> bool {
        self.thinned
    }

    /// Chooses anew at another configuration; whether that changed anything.
    pub fn renew(
        &mut self,
        set: &ConstraintSet,
        quantities: &Quantities,
        prescribed: &[(usize, f64)],
        options: &EquilibriumOptions,
    ) -> Result<bool, Failure> {
        let other = Self::new(set, quantities, prescribed, (options, &self.list))?;
        let changed = other.list != self.list;
        *self = other;
        Ok(changed)
    }
}
