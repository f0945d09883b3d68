//! The arrays that a set evaluates into, their update after changes of the set, and the weights of the effective Hessian.

use std::ops::Range;

use qless::common::Identity;
use qless::{ArgumentError, Csr, SystemError};

use crate::equations::hessian::HessianPlan;
use crate::equations::layout::{RowLayout, RowSlice, differences, write_csr};
use crate::equations::linear::batch::LinearBatch;
use crate::equations::nonlinear::batch::NonlinearBatch;
use crate::set::{ConstraintSet, long};

/// The results of an evaluation, with the patterns of the set at that time. Other sets refuse them.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// The set that allocated it.
    set: Identity,
    /// The configuration of the last evaluation of c and G.
    pub(super) u: Vec<f64>,
    pub(crate) c: Vec<f64>,
    pub(crate) g: Csr,
    pub(super) h: Csr,
    /// The version of the set whose c and G these are.
    pub(super) evaluated: Identity,
    rows: RowLayout,
    chunks: RowLayout,
}

impl PartialEq for Evaluation {
    /// Compares the numbers.
    fn eq(&self, other: &Self) -> bool {
        (&self.c, &self.g, &self.h) == (&other.c, &other.g, &other.h)
    }
}

impl Evaluation {
    /// The configuration of the last evaluation.
    pub fn u(&self) -> &[f64] {
        &self.u
    }

    /// Constraint values, length m.
    pub fn c(&self) -> &[f64] {
        &self.c
    }

    /// Sets c to zero, so that [`ConstraintSet::linearised`](crate::ConstraintSet::linearised) gives `G du = 0`.
    pub fn clear_values(&mut self) {
        self.c.fill(0.0);
    }

    /// Jacobian, m x n.
    pub fn g(&self) -> &Csr {
        &self.g
    }

    /// Effective Hessian, n x n, symmetric, both halves stored. It has no entries before its first evaluation.
    pub fn h(&self) -> &Csr {
        &self.h
    }
}

impl ConstraintSet {
    /// Arrays of the right size, with the pattern of G and the coefficients of linear equations, which are constant.
    ///
    /// The first evaluation of H makes its pattern. When the set changes, the next evaluation updates the arrays.
    pub fn allocate(&self) -> Evaluation {
        let rows = self.layout();
        let sound = "the set has checked DOFs and sizes";
        Evaluation {
            set: self.register.identity,
            u: vec![0.0; self.dofs],
            c: vec![0.0; self.equations()],
            g: self.pattern(0..rows.len()).expect(sound),
            h: Csr::zero(self.dofs, self.dofs).expect(sound),
            evaluated: Identity::NONE,
            rows,
            chunks: vec![(Identity::NONE, self.dofs)],
        }
    }

    /// Updates c and G after changes of the set. Rows after the first change are moved once, however many changes there were.
    pub(super) fn follow(&self, evaluation: &mut Evaluation) -> Result<(), ArgumentError> {
        self.own("the evaluation", evaluation.set)?;
        if evaluation.evaluated == self.version.get() {
            return Ok(());
        }
        let sound = "the set has checked DOFs and sizes";
        let rows = self.layout();
        replace(&mut evaluation.g, (&evaluation.rows, &rows), |segments| self.pattern(segments)).expect(sound);
        evaluation.c.resize(self.equations(), 0.0);
        evaluation.rows = rows;
        evaluation.evaluated = Identity::NONE;
        Ok(())
    }

    /// Updates H after changes of the set. Returns the current plan.
    pub(super) fn follow_hessian(&self, evaluation: &mut Evaluation) -> &HessianPlan {
        let (plan, sound) = (self.plan(), "the set has checked DOFs and sizes");
        let chunks = plan.layout();
        replace(&mut evaluation.h, (&evaluation.chunks, &chunks), |segments| plan.pattern(segments)).expect(sound);
        evaluation.chunks = chunks;
        plan
    }

    /// Checks that c and G are those of the current set.
    pub(super) fn current(&self, evaluation: &Evaluation) -> Result<(), ArgumentError> {
        self.own("the evaluation", evaluation.set)?;
        let what = "c and G";
        if evaluation.evaluated == self.version.get() { Ok(()) } else { Err(ArgumentError::Outdated { what }) }
    }

    /// G with the coefficients of linear equations, and zeros elsewhere.
    pub(super) fn whole_pattern(&self) -> Csr {
        self.pattern(0..self.linear.batches.len() + self.nonlinear.batches.len())
            .expect("the set has checked DOFs and sizes")
    }

    pub(super) fn layout(&self) -> RowLayout {
        let linear = self.linear.batches.iter().map(|batch| (batch.stamp.get(), batch.rows()));
        linear.chain(self.nonlinear.batches.iter().map(|batch| (batch.stamp(), batch.rows()))).collect()
    }

    /// The rows of G of some batches, linear ones first, with the coefficients of linear equations.
    fn pattern(&self, segments: Range<usize>) -> Result<Csr, SystemError> {
        let batches = self.linear.batches.len();
        let linear = &self.linear.batches[segments.start.min(batches)..segments.end.min(batches)];
        let nonlinear =
            &self.nonlinear.batches[segments.start.saturating_sub(batches)..segments.end.saturating_sub(batches)];
        let nonlinear = nonlinear.iter().map(|batch| StoredRows::Nonlinear(batch.as_ref()));
        let all: Vec<StoredRows> = linear.iter().map(StoredRows::Linear).chain(nonlinear).collect();
        write_csr(self.dofs, &all, StoredRows::size, StoredRows::write)
    }
}

/// A batch of rows of G.
enum StoredRows<'a> {
    Linear(&'a LinearBatch),
    Nonlinear(&'a dyn NonlinearBatch),
}

impl StoredRows<'_> {
    /// Number of rows and of entries.
    fn size(&self) -> (usize, usize) {
        match self {
            Self::Linear(batch) => (batch.rows(), batch.nnz),
            Self::Nonlinear(batch) => (batch.rows(), batch.nnz()),
        }
    }

    fn write(&self, part: RowSlice) {
        let RowSlice { first, end, col, val } = part;
        match self {
            Self::Linear(batch) => batch.write_rows(first, end, col, val),
            Self::Nonlinear(batch) => batch.write_pattern(first, end, col),
        }
    }
}

/// Replaces the rows of changed batches or chunks. If all changed, the new matrix is used without a copy.
fn replace(
    matrix: &mut Csr,
    (old, new): (&RowLayout, &RowLayout),
    pattern: impl Fn(Range<usize>) -> Result<Csr, SystemError>,
) -> Result<(), SystemError> {
    let edits = differences(old, new).into_iter().map(|(rows, segments)| Ok((rows, pattern(segments)?)));
    let mut edits = edits.collect::<Result<Vec<_>, SystemError>>()?;
    if edits.first().is_some_and(|(rows, _)| *rows == (0..matrix.rows())) {
        *matrix = edits.swap_remove(0).1;
        return Ok(());
    }
    matrix.replace_rows(&edits)
}

/// Weights `w_r` of the effective Hessian `sum_r w_r H_r`.
///
/// ```
/// use qless_constraints::Weights;
/// let c = [0.5, -1.0];
/// assert_eq!(Weights::Multipliers(&[3.0, 4.0]).values(&c)?, [3.0, 4.0]);
/// assert_eq!(Weights::Penalty(&[10.0, 100.0]).values(&c)?, [5.0, -100.0]);
/// assert_eq!(Weights::Augmented { multipliers: &[3.0, 4.0], penalty: &[10.0, 100.0] }.values(&c)?, [8.0, -96.0]);
/// # Ok::<(), qless::ArgumentError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weights<'a> {
    /// Lagrange: `w = lambda`.
    Multipliers(&'a [f64]),
    /// Penalty: `w = p c`; the term `G^T p G` of its tangent needs no Hessian.
    Penalty(&'a [f64]),
    /// Augmented Lagrange: `w = lambda + p c`.
    Augmented {
        /// Multipliers, one per equation.
        multipliers: &'a [f64],
        /// Penalty factors, one per equation.
        penalty: &'a [f64],
    },
}

impl Weights<'_> {
    /// The weight of each equation, from the constraint values.
    ///
    /// # Errors
    /// [`ArgumentError::WrongLength`] unless there is one multiplier or penalty per value.
    pub fn values(&self, c: &[f64]) -> Result<Vec<f64>, ArgumentError> {
        let (multipliers, penalty) = match *self {
            Self::Multipliers(multipliers) => (multipliers, c),
            Self::Penalty(penalty) => (c, penalty),
            Self::Augmented { multipliers, penalty } => (multipliers, penalty),
        };
        long("the list of multipliers", multipliers.len(), c.len())?;
        long("the list of penalties", penalty.len(), c.len())?;
        let penal = |penalty: &[f64]| c.iter().zip(penalty).map(|(c, p)| p * c).collect::<Vec<_>>();
        Ok(match *self {
            Self::Multipliers(multipliers) => multipliers.to_vec(),
            Self::Penalty(penalty) => penal(penalty),
            Self::Augmented { multipliers, penalty } => {
                penal(penalty).iter().zip(multipliers).map(|(product, multiplier)| product + multiplier).collect()
            }
        })
    }
}
