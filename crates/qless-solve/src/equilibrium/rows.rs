//! The equations that get multipliers: those that are independent at a consistent configuration.
//!
//! They are chosen where the constraints hold, and kept during the iteration. At a distance d from there, redundant rows are independent by
//! an amount of order d, and the matrix with their multipliers would be almost singular. One analysis serves all parts that choose at the
//! same time.

use std::sync::Arc;

use qless::{Analysis, Kind, Noise, Options, analyse};
use qless_constraints::{ConstraintSet, Evaluation};

use super::parts::EquilibriumParts;
use super::{EquilibriumOptions, StepFailure};
use crate::newton::units;

/// Independent equations at one configuration.
#[derive(Debug)]
pub struct RowChoice {
    /// Units of the columns of G.
    units: Vec<f64>,
    /// Which equations are independent.
    kept: Vec<bool>,
    /// The analysis, which has the certificates of redundant rows.
    analysis: Analysis,
}

impl RowChoice {
    /// Analyses G as evaluated in `evaluation`; rows in `before` are preferred.
    pub fn new(
        (set, parts): (&ConstraintSet, &EquilibriumParts),
        evaluation: &Evaluation,
        prescribed: &[(usize, f64)],
        (options, mut before): (&EquilibriumOptions, Vec<usize>),
    ) -> Result<Arc<Self>, StepFailure> {
        let mut still = evaluation.clone();
        // Only the rank is needed.
        still.clear_values();
        let held: Vec<(usize, f64)> = prescribed.iter().map(|&(j, v)| (j, 0.0 * v)).collect();
        let mut settings: Options = options.analysis.clone();
        before.sort_unstable();
        settings.preferences.equations = before;
        // The set has already left out coefficients that are rounding.
        settings.noise = Noise::None;
        let units = units(set, evaluation, &parts.of_equations.columns)?;
        let analysis = analyse(&set.linearised_in(&units, &still, &held)?, &settings)?;
        let kept = analysis.kinds().iter().map(|&kind| kind == Kind::Independent).collect();
        Ok(Arc::new(Self { units, kept, analysis }))
    }
}

/// Kept rows of one part, ascending.
#[derive(Clone, Debug)]
pub struct PartRows {
    pub list: Vec<usize>,
    /// Whether a row was removed although the analysis found it independent.
    pub is_thinned: bool,
    choice: Arc<RowChoice>,
}

impl PartRows {
    /// The independent rows among `of`.
    pub fn new(of: &[usize], choice: &Arc<RowChoice>) -> Self {
        let list = of.iter().copied().filter(|&r| choice.kept[r]).collect();
        Self { list, is_thinned: false, choice: choice.clone() }
    }

    /// Units of the columns of G; those of DOFs come first.
    pub fn units(&self) -> &[f64] {
        &self.choice.units
    }

    pub fn kept(&self, row: usize) -> bool {
        self.list.binary_search(&row).is_ok()
    }

    /// `(c_k, k)` of a redundant row, `row = sum c_k row_k`; empty for others.
    pub fn certificate(&self, row: usize) -> impl Iterator<Item = (f64, usize)> {
        let because = self.choice.analysis.because(row).unwrap_or_default();
        because.into_iter().map(|term| (term.coefficient, term.row))
    }

    /// Removes a row that depends on others.
    pub fn leave_out(&mut self, row: usize) {
        self.list.retain(|&r| r != row);
        self.is_thinned = true;
    }

    /// Chooses anew among `of`; returns whether the rows changed.
    pub fn renew(&mut self, of: &[usize], choice: &Arc<RowChoice>) -> bool {
        let other = Self::new(of, choice);
        let changed = other.list != self.list;
        *self = other;
        changed
    }
}
