//! `repairs`: which numbers to change so that no conflict is left.

use super::Report;
use crate::explanation::{Change, Number, Repair};
use crate::factor::backend::BackendError;
use crate::{Analysis, ConstraintSystem};

/// How to cure conflicts that have numbers in common: [`Repair`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct RepairFinding {
    /// The conflicting rows that the repair cures, from 1.
    pub conflicts: Vec<usize>,
    /// Ways to cure all these conflicts together, the most plausible first. A way is a list of changes. There are at most 16 ways, and all
    /// have the same number of changes.
    pub ways: Vec<Vec<ChangeFinding>>,
    /// Number of ways to cure the conflicts with as few changes as each listed way has: the listed ways, and further ones that were not
    /// verified.
    pub count: usize,
}

/// Another value for a right-hand side or a prescribed value.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(untagged))]
#[non_exhaustive]
pub enum ChangeFinding {
    /// Another right-hand side of an equation; removing the equation cures the same conflicts.
    Equation {
        /// The row of the equation, from 1.
        row: usize,
        /// The label of the equation.
        label: String,
        /// The present right-hand side.
        from: f64,
        /// The right-hand side that cures the conflicts.
        to: f64,
    },
    /// Another prescribed value.
    Prescribed {
        /// The DOF, from 1.
        dof: usize,
        /// The label of the DOF.
        label: String,
        /// The place of the value in the input; the key is absent if it is not known.
        #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
        place: Option<String>,
        /// The present value.
        from: f64,
        /// The value that cures the conflicts.
        to: f64,
    },
}

impl Report {
    /// Adds the [`Analysis::repairs`] of the conflicts.
    ///
    /// ```
    /// use qless::{Options, Report, SystemBuilder, analyse};
    /// let mut builder = SystemBuilder::new(2);
    /// for b in [0.01, 0.1, 0.01] {
    ///     builder.equation([(1, 1.0), (0, -1.0)], b);
    /// }
    /// let analysis = analyse(&builder.build()?, &Options::default())?;
    /// let report = Report::new(&analysis, Report::TERMS).with_repairs(&analysis)?;
    /// assert_eq!((report.repairs[0].conflicts.as_slice(), report.repairs[0].count), ([2].as_slice(), 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BackendError`] if a block cannot be factored again.
    pub fn with_repairs(mut self, analysis: &Analysis) -> Result<Self, BackendError> {
        let finding = |repair: Repair| RepairFinding::new(analysis.system(), &repair);
        self.repairs = analysis.repairs()?.into_iter().map(finding).collect();
        Ok(self)
    }
}

impl RepairFinding {
    fn new(system: &ConstraintSystem, repair: &Repair) -> Self {
        let change = |change: &Change| ChangeFinding::new(system, *change);
        Self {
            conflicts: repair.conflicts.iter().map(|row| row + 1).collect(),
            ways: repair.ways.iter().map(|way| way.iter().map(change).collect()).collect(),
            count: repair.count,
        }
    }
}

impl ChangeFinding {
    fn new(system: &ConstraintSystem, Change { number, from, to }: Change) -> Self {
        match number {
            Number::RightHandSide(row) => Self::Equation { row: row + 1, label: system.equation_label(row), from, to },
            Number::Prescribed(dof) => Self::Prescribed {
                dof: dof + 1,
                label: system.dof_label(dof),
                place: system.prescribed_place(dof).map(str::to_owned),
                from,
                to,
            },
        }
    }
}
