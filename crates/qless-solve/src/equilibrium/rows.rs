//! The equations that carry multipliers: those that are independent at a consistent configuration.
//!
//! They are chosen where the constraints hold, and kept on the way: off the constraints by d, redundant rows are independent by d, and
//! with multipliers on them the matrix would be singular but for d. One analysis serves all parts that choose at the time.

use std::sync::Arc;

use qless::{Analysis, Kind, Options, analyse};
use qless_constraints::{ConstraintSet, Quantities};

use super::parts::EquilibriumParts;
use super::{EquilibriumOptions, StepFailure};
use crate::newton::units;

/// What an analysis says of all equations at one configuration.
#[derive(Debug)]
pub struct RowChoice {
    /// Of the columns of G there.
    units: Vec<f64>,
    /// Which equations are independent.
    kept: Vec<bool>,
    /// What says which rows others follow from.
    analysis: Analysis,
}

impl RowChoice {
    /// The rows that are independent where `quantities` were evaluated, `before` first.
    pub fn new(
        (set, parts): (&ConstraintSet, &EquilibriumParts),
        quantities: &Quantities,
        prescribed: &[(usize, f64)],
        (options, mut before): (&EquilibriumOptions, Vec<usize>),
    ) -> Result<Arc<Self>, StepFailure> {
        let mut still = quantities.clone();
        // Only the rank is asked for.
        still.clear_values();
        let held: Vec<(usize, f64)> = prescribed.iter().map(|&(j, v)| (j, 0.0 * v)).collect();
        let mut settings: Options = options.analysis.clone();
        before.sort_unstable();
        settings.preferences.equations = before;
        let units = units(set, quantities, &parts.of_equations.columns)?;
        let analysis = analyse(&set.linearised_in(&units, &still, &held)?, &settings)?;
        let kept = analysis.kinds().iter().map(|&kind| kind == Kind::Independent).collect();
        Ok(Arc::new(Self { units, kept, analysis }))
    }
}

/// Kept rows of one part, ascending.
#[derive(Clone, Debug)]
pub struct KeptRows {
    list: Vec<usize>,
    /// Whether one was left out that is independent in the units.
    thinned: bool,
    choice: Arc<RowChoice>,
}

impl KeptRows {
    /// Those of the given ones that are independent.
    pub fn new(of: &[usize], choice: &Arc<RowChoice>) -> Self {
        let list = of.iter().copied().filter(|&r| choice.kept[r]).collect();
        Self { list, thinned: false, choice: choice.clone() }
    }

    pub fn list(&self) -> &[usize] {
        &self.list
    }

    /// Of the columns of G, those of DOFs first.
    pub fn units(&self) -> &[f64] {
        &self.choice.units
    }

    pub fn kept(&self, row: usize) -> bool {
        self.list.binary_search(&row).is_ok()
    }

    /// `(c_k, k)` of a row that follows from others, `row = sum c_k row_k`; none of one that does not.
    pub fn because(&self, row: usize) -> impl Iterator<Item = (f64, usize)> {
        let because = self.choice.analysis.because(row).unwrap_or_default();
        because.into_iter().map(|term| (term.coefficient, term.row))
    }

    /// Leaves out a row that depends on others.
    pub fn leave_out(&mut self, row: usize) {
        self.list.retain(|&r| r != row);
        self.thinned = true;
    }

    pub fn is_thinned(&self) -> bool {
        self.thinned
    }

    /// Chooses anew among the given ones; whether that changed anything.
    pub fn renew(&mut self, of: &[usize], choice: &Arc<RowChoice>) -> bool {
        let other = Self::new(of, choice);
        let changed = other.list != self.list;
        *self = other;
        changed
    }
}
