//! The equations that get multipliers: those that are independent at a consistent configuration.
//!
//! They are chosen where the constraints hold, and kept during the iteration. At a distance d from there, redundant rows are independent by
//! an amount of order d, and the matrix with their multipliers would be almost singular. One analysis serves all parts that choose at the
//! same time.

use std::sync::Arc;

use qless::{Analysis, Kind};
use qless_constraints::{ConstraintSet, Evaluation};

use super::{EquilibriumError, EquilibriumOptions};
use crate::newton::{Parts, Place, Scales, analyse_rows};

/// Independent equations at one configuration.
#[derive(Debug)]
pub struct RowChoice {
    /// Units of the columns of the constraint Jacobian G.
    units: Vec<f64>,
    /// The analysis, which has the certificates of redundant rows.
    analysis: Analysis,
}

impl RowChoice {
    /// Analyses the constraint Jacobian G in `evaluation`; rows in `before` are preferred.
    pub fn new(
        (set, parts): (&ConstraintSet, &Parts),
        evaluation: &Evaluation,
        prescribed: &[(usize, f64)],
        (options, mut before): (&EquilibriumOptions, Vec<usize>),
    ) -> Result<Arc<Self>, EquilibriumError> {
        let mut still = evaluation.clone();
        // Only the rank is needed, and it depends on the Jacobian alone. Without the constraint values c, no rows conflict.
        still.clear_values();
        let mut settings = options.analysis.clone();
        before.sort_unstable();
        settings.preferences.equations = before;
        let rounding = &set.rounding(evaluation.u())?;
        let units = Scales::new(set, evaluation, rounding, parts).units;
        let place = Place { set, evaluation: &still, rounding, units: &units };
        let analysis = analyse_rows(place, prescribed, (0, settings))?;
        Ok(Arc::new(Self { units, analysis }))
    }
}

/// Kept rows of one part, ascending.
#[derive(Clone, Debug)]
pub struct PartRows {
    pub list: Vec<usize>,
    choice: Arc<RowChoice>,
}

impl PartRows {
    /// The independent rows among `of`.
    pub fn new(of: &[usize], choice: &Arc<RowChoice>) -> Self {
        let kinds = choice.analysis.kinds();
        let list = of.iter().copied().filter(|&r| kinds[r] == Kind::Independent).collect();
        Self { list, choice: choice.clone() }
    }

    /// Units of the columns of the constraint Jacobian G.
    pub fn units(&self) -> &[f64] {
        &self.choice.units
    }

    pub fn kept(&self, row: usize) -> bool {
        self.list.binary_search(&row).is_ok()
    }

    /// The certificate `(c_k, k)` of a redundant row, `row = sum c_k row_k`; empty for other rows.
    pub fn certificate(&self, row: usize) -> impl Iterator<Item = (f64, usize)> {
        let because = self.choice.analysis.because(row).unwrap_or_default();
        because.into_iter().map(|term| (term.coefficient, term.row))
    }
}
