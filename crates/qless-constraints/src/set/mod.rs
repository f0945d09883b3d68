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
mod store;
mod sums;
mod system;
mod tasks;
mod weights;

use std::ops::Range;

use qless::Csr;

use block::Block;
pub use builder::SetBuilder;
use effective::{Plan, Weighted};
pub use error::{AddError, StoreError};
pub use labels::ConstraintId;
use labels::Owner;
use linear::Rows;
pub use store::Store;
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
/// let set = builder.build();
/// let mut quantities = set.allocate();
/// // The rod is stretched from 2 to 3: c = (3^2 - 2^2) / (2 * 2).
/// set.evaluate(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0], &mut quantities);
/// assert_eq!(quantities.c, [0.0, 1.25]);
/// assert_eq!(set.label(1), "rod");
/// assert_eq!(quantities.g.row(1).filter(|&(_, v)| v != 0.0).collect::<Vec<_>>(), [(0, -1.5), (3, 1.5)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ConstraintSet {
    dofs: usize,
    linear: Rows,
    blocks: Vec<Box<dyn Block>>,
    names: Vec<String>,
    /// G with the coefficients of the linear equations in it.
    pattern: Csr,
    plan: Plan,
}

/// What a set evaluates to. Patterns never change; values are those of the last evaluation.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantities {
    /// Constraint values, length m.
    pub c: Vec<f64>,
    /// Jacobian, m x n.
    pub g: Csr,
    /// Effective Hessian, n x n, symmetric, both halves stored.
    pub h: Csr,
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
        Quantities { c: vec![0.0; self.equations()], g: self.pattern.clone(), h: self.plan.allocate() }
    }

    /// Writes `c(u)` and `G(u)`, in parallel.
    ///
    /// # Panics
    /// If `u` does not have length n, or the quantities were not allocated by this set.
    pub fn evaluate(&self, u: &[f64], quantities: &mut Quantities) {
        self.check(u, None, quantities);
        tasks::run(tasks::of_values(&self.linear, &self.blocks, &mut quantities.c, &mut quantities.g), u);
    }

    /// Writes the effective Hessian `sum_r w_r H_r(u)`, in parallel; `weights` has one number per equation ([`Weights`]).
    ///
    /// # Panics
    /// If `u` or `weights` has the wrong length, or the quantities were not allocated by this set.
    pub fn effective_hessian(&self, u: &[f64], weights: &[f64], quantities: &mut Quantities) {
        self.check(u, Some(weights), quantities);
        let weighted = Weighted::new(&self.blocks, self.linear.rows(), weights);
        tasks::run(self.plan.tasks(&weighted, &mut quantities.h.val), u);
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
    /// let set = builder.build();
    /// let mut quantities = set.allocate();
    /// set.assemble(&[0.0; 4], &[6.0], &mut quantities);
    /// // w H = 6 [I -I; -I I] / 2.
    /// assert_eq!(quantities.g.val, [0.0, -1.0, 0.0, 1.0]);
    /// assert_eq!(quantities.h.row(0).collect::<Vec<_>>(), [(0, 3.0), (2, -3.0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// If `u` or `weights` has the wrong length, or the quantities were not allocated by this set.
    pub fn assemble(&self, u: &[f64], weights: &[f64], quantities: &mut Quantities) {
        self.check(u, Some(weights), quantities);
        let Quantities { c, g, h } = quantities;
        let weighted = Weighted::new(&self.blocks, self.linear.rows(), weights);
        let mut tasks = tasks::of_values(&self.linear, &self.blocks, c, g);
        tasks.extend(self.plan.tasks(&weighted, &mut h.val));
        tasks::run(tasks, u);
    }

    fn check(&self, u: &[f64], weights: Option<&[f64]>, quantities: &Quantities) {
        assert_eq!(u.len(), self.dofs, "u has one value per DOF");
        assert!(weights.is_none_or(|weights| weights.len() == self.equations()), "one weight per equation");
        let own = (self.pattern.nnz(), self.plan.nnz());
        assert_eq!((quantities.g.nnz(), quantities.h.nnz()), own, "the quantities belong to another set");
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
    fn owner(&self, row: usize) -> (&Owner, &'static str) {
        self.place(row).map_or_else(|| (self.linear.owner(row), ""), |(block, own)| block.owner(own))
    }

    /// Which constraint an equation belongs to.
    pub fn constraint_of(&self, row: usize) -> ConstraintId {
        self.owner(row).0.constraint()
    }

    /// The equations of a constraint, ascending. O(m).
    pub fn rows_of(&self, constraint: ConstraintId) -> Vec<usize> {
        (0..self.equations()).filter(|&row| self.constraint_of(row) == constraint).collect()
    }

    /// The label of an equation: that of its constraint, and which part of it.
    pub fn label(&self, row: usize) -> String {
        let (owner, part) = self.owner(row);
        owner.label(&self.names, part)
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

#[cfg(test)]
mod tests;
