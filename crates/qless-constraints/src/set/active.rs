//! The linearised equations `G du = -c` of a changing set, updated in a [`qless::ChangingSystem`].
//!
//! ```text
//! rows added, removed or changed  ->  add, remove, set_terms, set_rhs  ->  affected blocks are analysed and reduced again
//! ```
//!
//! If G does not depend on u, or u stays, activating a constraint costs only the analysis of the blocks with its equations. To find the
//! changes, each update reads all of G once.

use std::collections::HashMap;

use qless::change::{ChangeError, EquationId};
use qless::common::Identity;
use qless::{ArgumentError, ChangingSystem, Kind, Options};

use crate::set::ConstraintSet;
use crate::set::evaluation::Evaluation;

/// Identifies a row while other rows come and go: its constraint, its type (0 for linear equations), and its index among the equations of
/// this constraint and type.
type RowKey = (u32, u32, u32);

/// An equation of the set as it was last passed to the [`ChangingSystem`].
#[derive(Debug)]
struct ActiveRow {
    key: RowKey,
    id: EquationId,
    terms: Box<[(usize, f64)]>,
    rhs: f64,
}

/// The linearised equations `G du = -c` of a changing [`ConstraintSet`]: m equations on n DOFs, with rank and reduction.
///
/// ```
/// use qless::{Kind, Options};
/// use qless_constraints::types::Equal;
/// use qless_constraints::{ActiveSystem, ConstraintSet};
/// let mut builder = ConstraintSet::builder(6);
/// let ids = [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5]].map(|dofs| builder.add("tie", Equal::new(dofs)).expect("valid"));
/// let mut set = builder.build()?;
/// let (mut evaluation, mut system) = (set.allocate(), ActiveSystem::new(&set, Options::default())?);
/// set.evaluate(&[0.0; 6], &mut evaluation)?;
/// assert_eq!((system.update(&set, &evaluation)?, system.rank()), (2, 4));
/// assert_eq!(system.kind(2), Some(Kind::Redundant));
/// // The ring opens; the other block is not analysed again.
/// set.deactivate(ids[1])?;
/// set.evaluate(&[0.0; 6], &mut evaluation)?;
/// assert_eq!((system.update(&set, &evaluation)?, system.rank()), (1, 4));
/// assert_eq!(system.kind(1), Some(Kind::Independent));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct ActiveSystem {
    set: Identity,
    system: ChangingSystem,
    rows: Vec<ActiveRow>,
}

/// Why the linearised equations could not be updated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ActiveError {
    /// The set or the evaluation does not belong to this system, or the evaluation is out of date.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// A number of a linearised equation is not finite.
    #[error("{label}: its linearised equation contains {value}; give a configuration at which it is finite")]
    NotFinite {
        /// Label of the equation.
        label: String,
        /// The number.
        value: f64,
    },
    /// A block of equations cannot be analysed or reduced, or an argument (a DOF or a number) is not valid.
    #[error(transparent)]
    Change(#[from] ChangeError),
}

impl ActiveSystem {
    /// A system on the DOFs of a set, without equations yet.
    ///
    /// # Errors
    /// [`ActiveError::Change`] for more DOFs than fit into memory.
    pub fn new(set: &ConstraintSet, options: Options) -> Result<Self, ActiveError> {
        let system = ChangingSystem::new(set.dofs(), options)?;
        Ok(Self { set: set.register.identity, system, rows: Vec::new() })
    }

    /// Takes over the changes of the set and its evaluation, and analyses the affected blocks. Returns the number of these blocks.
    ///
    /// # Errors
    /// [`ActiveError::Argument`] and [`ActiveError::NotFinite`]: nothing changes then. [`ActiveError::Change`]: if a block cannot be
    /// analysed or reduced, the system has taken over the changes but keeps its old results.
    pub fn update(&mut self, set: &ConstraintSet, evaluation: &Evaluation) -> Result<usize, ActiveError> {
        set.own("the set of the system", self.set)?;
        set.current(evaluation)?;
        finite(set, evaluation)?;
        let rounding = set.rounding_of_nonlinear(evaluation)?;
        let mut old: HashMap<RowKey, ActiveRow> = self.rows.drain(..).map(|known| (known.key, known)).collect();
        for (row, key) in set.keys().into_iter().enumerate() {
            let known = old.remove(&key);
            let (terms, rhs) = evaluation.linear_equation(row, rounding.as_ref());
            let known = if let Some(mut known) = known {
                let bits = |(j, v): (usize, f64)| (j, v.to_bits());
                if !known.terms.iter().copied().map(bits).eq(terms.clone().map(bits)) {
                    known.terms = terms.collect();
                    self.system.set_terms(known.id, known.terms.iter().copied())?;
                }
                if known.rhs.to_bits() != rhs.to_bits() {
                    known.rhs = rhs;
                    self.system.set_rhs(known.id, rhs)?;
                }
                known
            } else {
                let terms: Box<[_]> = terms.collect();
                ActiveRow { key, id: self.system.add(terms.iter().copied(), rhs)?, terms, rhs }
            };
            self.rows.push(known);
        }
        let mut gone: Vec<EquationId> = old.into_values().map(|known| known.id).collect();
        // Sorts the identities, since the order of a hash map differs between runs.
        gone.sort_unstable();
        gone.into_iter().try_for_each(|id| self.system.remove(id))?;
        Ok(self.system.update()?)
    }

    /// Prescribes an increment du for a DOF, or changes a prescribed one.
    ///
    /// # Errors
    /// [`ActiveError::Change`] for a DOF out of range or a number that is not finite.
    pub fn prescribe(&mut self, dof: usize, increment: f64) -> Result<(), ActiveError> {
        Ok(self.system.prescribe(dof, increment)?)
    }

    /// Makes a DOF free again.
    ///
    /// # Errors
    /// [`ActiveError::Change`] for a DOF out of range.
    pub fn release(&mut self, dof: usize) -> Result<(), ActiveError> {
        Ok(self.system.release(dof)?)
    }

    /// The kind of the equation in this row of the set: independent, redundant or conflicting, as of the last update. `None` if there is no
    /// such row.
    pub fn kind(&self, row: usize) -> Option<Kind> {
        self.rows.get(row).and_then(|known| self.system.kind(known.id))
    }

    /// The identity that the equation in this row of the set has in [`ActiveSystem::system`], as of the last update.
    pub fn equation(&self, row: usize) -> Option<EquationId> {
        self.rows.get(row).map(|known| known.id)
    }

    /// Rank of the linearised equations `G du = -c` at the last update: the rank of the Jacobian G without the columns of the DOFs whose
    /// increments are prescribed.
    pub fn rank(&self) -> usize {
        self.system.rank()
    }

    /// The changing system that holds the linearised equations. It gives the blocks with their reductions, and the certificates.
    pub fn system(&self) -> &ChangingSystem {
        &self.system
    }

    /// Computes the increments of the slaves, `du_s = T du_q + G du_p + g`, from those of the masters, `du_q`, and of the prescribed DOFs,
    /// `du_p`. On entry, `du` holds `du_q`; on return, it holds all three. Here T, G and g belong to the reduction: this G is not the
    /// Jacobian.
    ///
    /// # Errors
    /// [`ActiveError::Change`] unless `du` has one finite number per DOF.
    pub fn expand(&self, du: &mut [f64]) -> Result<(), ActiveError> {
        Ok(self.system.expand(du)?)
    }
}

fn finite(set: &ConstraintSet, evaluation: &Evaluation) -> Result<(), ActiveError> {
    for row in 0..evaluation.c.len() {
        if let Some(value) = evaluation.not_finite(row) {
            return Err(ActiveError::NotFinite { label: set.label(row)?, value });
        }
    }
    Ok(())
}

impl ConstraintSet {
    /// The key of each row.
    pub(super) fn keys(&self) -> Vec<RowKey> {
        let linear = self.linear.owners.iter().map(|owner| (owner.constraint, 0));
        let nonlinear = self.nonlinear.batches.iter().zip(1..).flat_map(|(batch, kind)| {
            let of = move |i| std::iter::repeat_n((batch.owner(i).constraint, kind), batch.equations_per_item());
            (0..batch.items()).flat_map(of)
        });
        let mut before = (u32::MAX, u32::MAX, 0);
        let key = |(constraint, kind)| {
            let place = if (before.0, before.1) == (constraint, kind) { before.2 + 1 } else { 0 };
            before = (constraint, kind, place);
            before
        };
        linear.chain(nonlinear).map(key).collect()
    }
}
