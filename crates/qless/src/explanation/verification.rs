//! Verifies repairs: the system with the new values is analysed again.
//!
//! Only the components with a conflict to cure or a changed number are analysed, because the verdicts of others stay the same.

use std::cell::Cell;

use super::changes::{Change, Number};
use crate::factor::block::Block;
use crate::input::incidence::Incidence;
use crate::{Analysis, Effort, Kind, Options, analyse};

/// Number of equations that are analysed again for all repairs of a system; this takes about a second if presolve settles them.
const MOST_ANALYSED: usize = 1 << 20;
/// Number of operations of a dense factorization that take as long as one equation of presolve: a microsecond.
const OPERATIONS: usize = 4096;

/// A system with changed numbers, analysed again.
pub(super) struct ChangedSystem {
    /// The analysis of the components with a conflict to cure or a changed number; the equations have the same numbers.
    pub analysis: Analysis,
    /// Conflicts that should be cured, and equations that have become conflicting.
    pub wrong: Vec<usize>,
}

/// Analyses changed systems.
pub(super) struct Verification<'a> {
    analysis: &'a Analysis,
    options: Options,
    /// Number of equations that may still be analysed. [`OPERATIONS`] operations of the dense factorization of a block count as one
    /// equation.
    left: Cell<usize>,
}

impl<'a> Verification<'a> {
    pub fn new(analysis: &'a Analysis) -> Self {
        // A higher effort than `Checked` would cost time and change no verdict.
        let options = Options { effort: analysis.options.effort.min(Effort::Checked), ..analysis.options.clone() };
        Self { analysis, options, left: Cell::new(MOST_ANALYSED) }
    }

    /// Returns true if the number of equations that may be analysed is used up.
    pub fn is_over(&self) -> bool {
        self.left.get() == 0
    }

    /// Returns true if, with these changes, none of the conflicts is left and no other equation has become conflicting.
    pub fn holds(&self, conflicts: &[usize], way: &[Change]) -> bool {
        self.changed(conflicts, way).is_some_and(|changed| changed.wrong.is_empty())
    }

    /// Analyses the system with these changes; `None` if that fails.
    pub fn changed(&self, conflicts: &[usize], way: &[Change]) -> Option<ChangedSystem> {
        let concerned = self.concerned(conflicts, way);
        let system = self.analysis.system.only(|i, _| concerned[i], |i| concerned[i]);
        let system = system.with_numbers(|rhs, prescribed| {
            for &Change { number, to, .. } in way {
                match number {
                    Number::RightHandSide(row) => rhs[row] = to,
                    Number::Prescribed(dof) => {
                        prescribed.iter_mut().filter(|(j, _)| *j == dof).for_each(|(_, value)| *value = to);
                    }
                }
            }
        });
        let analysis = analyse(&system, &self.options).ok()?;
        let of_block = |block: &Block| block.rows.len().pow(2).saturating_mul(block.dofs.len()) / OPERATIONS;
        let count = concerned.iter().filter(|&&concerned| concerned).count();
        let cost = analysis.blocks.iter().map(of_block).fold(count, usize::saturating_add);
        self.left.set(self.left.get().saturating_sub(cost));
        let conflicted = |row: &usize| self.analysis.kinds[*row] == Kind::Conflicting;
        let may_conflict = |row: &usize| conflicted(row) && conflicts.binary_search(row).is_err();
        let found = analysis.dependent.iter().filter(|d| d.kind == Kind::Conflicting).map(|d| d.row);
        let wrong = found.filter(|row| !may_conflict(row)).collect();
        Some(ChangedSystem { analysis, wrong })
    }

    /// Marks the equations of all components with a conflict to cure or a changed number.
    fn concerned(&self, conflicts: &[usize], way: &[Change]) -> Vec<bool> {
        let Analysis { numbering, system, incidence, .. } = self.analysis;
        let incidence = incidence.get_or_init(|| Incidence::new(numbering.view(system, system.rhs())));
        let mut rows = conflicts.to_vec();
        for change in way {
            match change.number {
                Number::RightHandSide(row) => rows.push(row),
                Number::Prescribed(dof) => {
                    let local = numbering.dofs.iter().position(|&j| j as usize == dof);
                    rows.extend(local.iter().flat_map(|&j| incidence.rows(j as u32)).map(|&i| i as usize));
                }
            }
        }
        let mut concerned = vec![false; system.equations()];
        self.analysis.labels().mark(&rows, &mut concerned);
        concerned
    }
}
