//! The input of one rank: its equations over any DOFs of the job, and the DOFs that it owns and needs.

mod error;
mod rows;

use std::ops::Range;

use qless::ConstraintSystem;

pub use error::{ShareError, SharePlace};
pub(crate) use rows::{ShareRows, check_numbers};

/// The equations of `C u = b` that one rank holds.
///
/// DOFs and equations have global numbers. Each rank owns a contiguous range of DOFs; the ranges of all ranks cover 0 to n in order, as
/// in PETSc, MFEM and hypre. Any rank may hold any equation. The number of an equation is its place in the whole system, so the result
/// does not depend on the distribution.
///
/// ```
/// use qless_mpi::Share;
/// // This rank owns DOFs 0 to 9, ties DOF 3 to DOF 12 of another rank, and asks for the row of T of DOF 12.
/// let mut share = Share::new(0..10);
/// share.equation(0, [(3, 1.0), (12, -1.0)], 0.0);
/// share.prescribe(7, 0.25);
/// share.need(12);
/// assert_eq!(share.equations(), 1);
/// ```
#[derive(Clone, Debug)]
pub struct Share {
    pub(crate) owned: Range<u64>,
    pub(crate) rows: ShareRows,
    pub(crate) prescribed: Vec<(u64, f64)>,
    pub(crate) needed: Vec<u64>,
    terms: Vec<(u64, f64)>,
}

impl Share {
    /// Creates a share without equations, for a rank that owns these DOFs.
    pub fn new(owned: Range<u64>) -> Self {
        Self { owned, rows: ShareRows::new(), prescribed: Vec::new(), needed: Vec::new(), terms: Vec::new() }
    }

    /// Adds equation `number` of the whole system, `sum a_j u_j = rhs`. Terms on the same DOF are summed.
    pub fn equation(&mut self, number: u64, terms: impl IntoIterator<Item = (u64, f64)>, rhs: f64) {
        self.terms.clear();
        self.terms.extend(terms);
        rows::sum_repeats(&mut self.terms);
        self.rows.push(number, rhs, self.terms.iter().copied());
    }

    /// Adds the equations and prescribed values of a system, for example one of `qless-constraints`. Its DOF j is DOF `dof(j)` of the job,
    /// and its equation i has the number `number(i)`.
    ///
    /// ```
    /// use qless::SystemBuilder;
    /// use qless_mpi::Share;
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    /// let mut share = Share::new(0..10);
    /// share.add_system(&builder.build()?, |j| [3, 12][j], |i| 100 + i as u64);
    /// assert_eq!(share.numbers(), [100]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn add_system(&mut self, system: &ConstraintSystem, dof: impl Fn(usize) -> u64, number: impl Fn(usize) -> u64) {
        for (i, &rhs) in system.rhs().iter().enumerate() {
            self.equation(number(i), system.matrix().row(i).map(|(j, value)| (dof(j), value)), rhs);
        }
        system.prescribed().iter().for_each(|&(j, value)| self.prescribe(dof(j), value));
    }

    /// Prescribes the value of any DOF. Several ranks may prescribe the same DOF with equal values.
    pub fn prescribe(&mut self, dof: u64, value: f64) {
        self.prescribed.push((dof, value));
    }

    /// Sets the right-hand side of an equation, by its index in the order in which the equations were added.
    ///
    /// # Panics
    /// If the index is out of range.
    pub fn set_rhs(&mut self, equation: usize, rhs: f64) {
        self.rows.rhs[equation] = rhs;
    }

    /// Sets the value of every prescribed DOF of this share.
    pub fn set_prescribed(&mut self, value: impl Fn(u64) -> f64) {
        self.prescribed.iter_mut().for_each(|(dof, own)| *own = value(*dof));
    }

    /// Asks for the row of T of a DOF beyond those that this rank owns.
    pub fn need(&mut self, dof: u64) {
        self.needed.push(dof);
    }

    /// Number of equations that this rank holds.
    pub fn equations(&self) -> usize {
        self.rows.len()
    }

    /// The numbers of the equations that this rank holds, in the order in which the equations were added.
    pub fn numbers(&self) -> &[u64] {
        &self.rows.numbers
    }

    /// Returns the first fault in this share; `dofs` is the number of DOFs of the job.
    pub(crate) fn check(&self, rank: usize, dofs: u64) -> Result<(), ShareError> {
        for &(dof, value) in &self.prescribed {
            within(dof, dofs, rank, SharePlace::Prescribed { dof })?;
            finite(value, rank, SharePlace::Prescribed { dof })?;
        }
        self.needed.iter().try_for_each(|&dof| within(dof, dofs, rank, SharePlace::Needed { dof }))?;
        for (i, &equation) in self.rows.numbers.iter().enumerate() {
            if equation >= 1 << 62 {
                return Err(ShareError::NumberTooLarge { rank, number: equation });
            }
            for (dof, value) in self.rows.row(i) {
                within(dof, dofs, rank, SharePlace::Coefficient { equation, dof })?;
                finite(value, rank, SharePlace::Coefficient { equation, dof })?;
            }
            finite(self.rows.rhs[i], rank, SharePlace::RightHandSide { equation })?;
        }
        Ok(())
    }
}

fn within(dof: u64, dofs: u64, rank: usize, what: SharePlace) -> Result<(), ShareError> {
    if dof < dofs { Ok(()) } else { Err(ShareError::DofOutOfRange { rank, what, dofs }) }
}

fn finite(value: f64, rank: usize, what: SharePlace) -> Result<(), ShareError> {
    if value.is_finite() { Ok(()) } else { Err(ShareError::NotFinite { rank, what, value }) }
}
