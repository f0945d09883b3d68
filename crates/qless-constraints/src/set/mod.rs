//! A set of constraints, stored by type: `c(u)`, `G = dc/du` and `H = sum_r w_r d^2 c_r / du^2`.
//!
//! The patterns of G and H are made once from the lists of DOFs and pairs; then the values are written in place, in parallel.
//! A number is always computed by the same operations in the same order, so that the result does not depend on the threads.
//! Rows: all linear equations in the order in which they were added, then the nonlinear ones, type by type.

mod batch;
mod block;
mod builder;
mod curvatures;
mod effective;
mod error;
mod homogeneous;
mod labels;
mod linear;
mod lists;
mod order;
mod pattern;
pub(crate) mod rotations;
mod rounding;
mod store;
mod sums;
mod system;
mod tasks;
mod time;
mod weights;

use std::ops::Range;

use qless::{ArgumentError, Csr, Identity};

use block::Block;
pub use builder::SetBuilder;
use effective::{Plan, Weighted};
pub use error::{AddError, LineariseError, StoreError};
pub use labels::ConstraintId;
use labels::Owner;
use linear::Rows;
pub use rounding::Rounding;
use rounding::Size;
pub use store::Store;
pub use system::Vanishing;
pub use time::TimeError;
pub use weights::Weights;

/// Validated constraints on n DOFs.
///
/// ```
/// use qless_constraints::ConstraintSet;
/// use qless_constraints::types::{Distance, Equal, Point};
/// let a = Point::new([0, 1, 2], [0.0; 3]);
/// let b = Point::new([3, 4, 5], [2.0, 0.0, 0.0]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("rod", Distance::new(a, b))?;
/// builder.add("guide", Equal::new([1, 4]))?;
/// let set = builder.build()?;
/// let mut quantities = set.allocate();
/// // The rod is stretched from 2 to 3: c = (3^2 - 2^2) / (2 * 2).
/// set.evaluate(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0], &mut quantities)?;
/// assert_eq!(quantities.c(), [0.0, 1.25]);
/// assert_eq!(set.label(1)?, "rod");
/// assert_eq!(quantities.g().row(1).filter(|&(_, v)| v != 0.0).collect::<Vec<_>>(), [(0, -1.5), (3, 1.5)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ConstraintSet {
    identity: Identity,
    dofs: usize,
    linear: Rows,
    blocks: Vec<Box<dyn Block>>,
    names: Vec<String>,
    /// G with the coefficients of the linear equations in it.
    pattern: Csr,
    plan: Plan,
    time: f64,
    /// The largest coordinate that each DOF adds to, for [`ConstraintSet::rounding`]; shorter if the others add to none.
    sizes: Vec<Size>,
}

impl std::fmt::Debug for ConstraintSet {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct("ConstraintSet");
        text.field("dofs", &self.dofs).field("constraints", &self.names.len()).finish_non_exhaustive()
    }
}

/// What a set evaluates to. Patterns never change; values are those of the last evaluation. No other set takes it.
#[derive(Clone, Debug)]
pub struct Quantities {
    of: Identity,
    /// The configuration of the last evaluation of c and G.
    u: Vec<f64>,
    pub(crate) c: Vec<f64>,
    pub(crate) g: Csr,
    h: Csr,
}

impl PartialEq for Quantities {
    /// The same numbers.
    fn eq(&self, other: &Self) -> bool {
        (&self.c, &self.g, &self.h) == (&other.c, &other.g, &other.h)
    }
}

impl Quantities {
    /// Constraint values, length m.
    pub fn c(&self) -> &[f64] {
        &self.c
    }

    /// Jacobian, m x n.
    pub fn g(&self) -> &Csr {
        &self.g
    }

    /// Effective Hessian, n x n, symmetric, both halves stored.
    pub fn h(&self) -> &Csr {
        &self.h
    }
}

impl ConstraintSet {
    /// No constraints yet, on DOFs `0..dofs`.
    pub fn builder(dofs: usize) -> SetBuilder {
        SetBuilder::new(dofs)
    }

    /// Number of DOFs n.
    pub fn dofs(&self) -> usize {
        self.dofs
    }

    /// Number of equations m.
    pub fn equations(&self) -> usize {
        self.pattern.rows()
    }

    /// Number of constraints that were added.
    pub fn constraints(&self) -> usize {
        self.names.len()
    }

    /// Arrays of the right size: the pattern of G from the DOF lists, of H from the pair lists.
    ///
    /// The coefficients of linear equations are written here and stay.
    pub fn allocate(&self) -> Quantities {
        Quantities {
            of: self.identity,
            u: vec![0.0; self.dofs],
            c: vec![0.0; self.equations()],
            g: self.pattern.clone(),
            h: self.plan.allocate(),
        }
    }

    /// Writes `c(u)` and `G(u)`, in parallel.
    ///
    /// What is not finite in u is not finite in what depends on it; [`ConstraintSet::linearised`] refuses it.
    ///
    /// # Errors
    /// [`ArgumentError`] if `u` does not have length n, or the quantities were not allocated by this set.
    pub fn evaluate(&self, u: &[f64], quantities: &mut Quantities) -> Result<(), ArgumentError> {
        self.check(u, None, quantities)?;
        quantities.u.copy_from_slice(u);
        tasks::run(tasks::of_values(&self.linear, &self.blocks, &mut quantities.c, &mut quantities.g), u);
        Ok(())
    }

    /// Writes the effective Hessian `sum_r w_r H_r(u)`, in parallel; `weights` has one number per equation ([`Weights`]).
    ///
    /// # Errors
    /// [`ArgumentError`] if `u` or `weights` has the wrong length, or the quantities were not allocated by this set.
    pub fn effective_hessian(
        &self,
        u: &[f64],
        weights: &[f64],
        quantities: &mut Quantities,
    ) -> Result<(), ArgumentError> {
        self.check(u, Some(weights), quantities)?;
        let weighted = Weighted::new(&self.blocks, self.linear.rows(), weights);
        tasks::run(self.plan.tasks(&weighted, quantities.h.values_mut()), u);
        Ok(())
    }

    /// [`ConstraintSet::evaluate`] and [`ConstraintSet::effective_hessian`] at once, which reads u once: for weights that do not rest on c,
    /// such as multipliers.
    ///
    /// ```
    /// use qless_constraints::ConstraintSet;
    /// use qless_constraints::types::{Distance, PlanarPoint};
    /// let (a, b) = (PlanarPoint::new([0, 1], [0.0; 2]), PlanarPoint::new([2, 3], [0.0, 2.0]));
    /// let mut builder = ConstraintSet::builder(4);
    /// builder.add("rod", Distance::new(a, b))?;
    /// let set = builder.build()?;
    /// let mut quantities = set.allocate();
    /// set.assemble(&[0.0; 4], &[6.0], &mut quantities)?;
    /// // w H = 6 [I -I; -I I] / 2.
    /// assert_eq!(quantities.g().values(), [0.0, -1.0, 0.0, 1.0]);
    /// assert_eq!(quantities.h().row(0).collect::<Vec<_>>(), [(0, 3.0), (2, -3.0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] if `u` or `weights` has the wrong length, or the quantities were not allocated by this set.
    pub fn assemble(&self, u: &[f64], weights: &[f64], quantities: &mut Quantities) -> Result<(), ArgumentError> {
        self.check(u, Some(weights), quantities)?;
        quantities.u.copy_from_slice(u);
        let Quantities { c, g, h, .. } = quantities;
        let weighted = Weighted::new(&self.blocks, self.linear.rows(), weights);
        let mut tasks = tasks::of_values(&self.linear, &self.blocks, c, g);
        tasks.extend(self.plan.tasks(&weighted, h.values_mut()));
        tasks::run(tasks, u);
        Ok(())
    }

    fn check(&self, u: &[f64], weights: Option<&[f64]>, quantities: &Quantities) -> Result<(), ArgumentError> {
        long("u", u.len(), self.dofs)?;
        weights.map_or(Ok(()), |weights| long("the list of weights", weights.len(), self.equations()))?;
        self.own("the quantities", quantities.of)
    }

    fn own(&self, what: &'static str, of: Identity) -> Result<(), ArgumentError> {
        if of == self.identity { Ok(()) } else { Err(ArgumentError::Foreign { what }) }
    }

    /// Which block of equations a row belongs to, and its row there; nothing for linear equations.
    fn place(&self, row: usize) -> Option<(&dyn Block, usize)> {
        let mut row = row.checked_sub(self.linear.rows())?;
        for block in &self.blocks {
            if row < block.rows() {
                return Some((block.as_ref(), row));
            }
            row -= block.rows();
        }
        None
    }

    /// The constraint of a row and the name of the part that it is.
    fn owner(&self, row: usize) -> Result<(&Owner, &'static str), ArgumentError> {
        if row >= self.equations() {
            return Err(ArgumentError::OutOfRange { what: "equation", found: row, count: self.equations() });
        }
        Ok(self.place(row).map_or_else(|| (self.linear.owner(row), ""), |(block, own)| block.owner(own)))
    }

    /// Which constraint an equation belongs to.
    ///
    /// # Errors
    /// [`ArgumentError::OutOfRange`].
    pub fn constraint_of(&self, row: usize) -> Result<ConstraintId, ArgumentError> {
        Ok(self.owner(row)?.0.constraint(self.identity))
    }

    /// The equations of a constraint, ascending. O(m).
    ///
    /// # Errors
    /// [`ArgumentError::Foreign`] for a constraint of another set.
    pub fn rows_of(&self, constraint: ConstraintId) -> Result<Vec<usize>, ArgumentError> {
        self.own("the constraint", constraint.set)?;
        Ok((0..self.equations()).filter(|&row| self.constraint_of(row) == Ok(constraint)).collect())
    }

    /// The label of an equation: that of its constraint, and which part of it.
    ///
    /// # Errors
    /// [`ArgumentError::OutOfRange`].
    pub fn label(&self, row: usize) -> Result<String, ArgumentError> {
        let (owner, part) = self.owner(row)?;
        Ok(owner.label(&self.names, part))
    }

    /// Whether the equation is linear: its row of G never changes.
    pub fn is_linear(&self, row: usize) -> bool {
        self.linear_rows().contains(&row)
    }

    /// The linear equations.
    pub fn linear_rows(&self) -> Range<usize> {
        0..self.linear.rows()
    }
}

/// The right length.
pub(crate) fn long(what: &'static str, found: usize, expected: usize) -> Result<(), ArgumentError> {
    if found == expected { Ok(()) } else { Err(ArgumentError::WrongLength { what, found, expected }) }
}

#[cfg(test)]
mod tests;
