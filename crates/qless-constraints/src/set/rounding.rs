//! `|c^_r - c_r| <= rounding of c_r`, and the same for every entry of G: what rounding may have done to them.
//!
//! Running error analysis: [`crate::Nonlinear::value`] in numbers with derivatives, each of which carries a bound, so that the size of every
//! term counts, whatever cancels after it. DOFs, parameters and coordinates are taken as known to one unit in the last place; as
//! `x = at + u`, that of a coordinate is put on its DOF. Some ten times the operations of [`ConstraintSet::evaluate`].

use qless::ArgumentError;
use rayon::prelude::*;

use super::batch::Batch;
use super::tasks::{Work, of_values};
use super::{ConstraintSet, long};
use crate::scalar::Bounded;

/// Bounds on the rounding of c and G at one configuration, in the units of c and G; infinite where nothing is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounding {
    c: Vec<f64>,
    g: Vec<f64>,
    start: Vec<usize>,
}

impl Rounding {
    /// How far each constraint value may be from that of exact arithmetic, length m.
    pub fn c(&self) -> &[f64] {
        &self.c
    }

    /// The same for the entries of G, in the order of `Quantities::g().values()`.
    pub fn g(&self) -> &[f64] {
        &self.g
    }

    /// The bounds on the entries of row `r` of G, in the order of its columns; rows from m on have none.
    ///
    /// A row that is no larger in any of its entries is rounding and nothing else.
    pub fn of_row(&self, r: usize) -> &[f64] {
        if r < self.c.len() { &self.g[self.start[r]..self.start[r + 1]] } else { &[] }
    }
}

/// The size of a number in 16 bits: rounded up, by at most a sixteenth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Size(u16);

/// What is known of the coordinates that a DOF adds to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sizes {
    /// The largest of them.
    pub at: Size,
    /// The largest of the nodes that they belong to, along any axis; something if there is a node, wherever it lies.
    pub node: Size,
}

/// The bits of a double that a size does not keep.
const CUT: u32 = 48;

impl Size {
    /// Of a number that is not NaN.
    #[inline]
    pub fn above(x: f64) -> Self {
        let largest = (f64::MAX.to_bits() >> CUT) as u16;
        Self(if x == 0.0 { 0 } else { ((x.abs().to_bits() >> CUT) as u16 + 1).min(largest) })
    }

    /// Of the least number that there is, for one that is zero.
    pub fn of_something(x: f64) -> Self {
        Self::above(x).max(Self(1))
    }

    pub fn is_something(self) -> bool {
        self.0 > 0
    }

    pub fn number(self) -> f64 {
        f64::from_bits(u64::from(self.0) << CUT)
    }
}

/// The configuration, each DOF with what is not known of it.
pub(super) struct Known<'a> {
    u: &'a [f64],
    /// The largest coordinate that each DOF adds to; shorter if the others add to none.
    sizes: &'a [Sizes],
}

impl Known<'_> {
    /// One DOF.
    pub fn dof(&self, j: u32) -> Bounded {
        let (u, size) = (self.u[j as usize], self.sizes.get(j as usize).copied().unwrap_or_default());
        Bounded::known_to(u, u.abs() + size.at.number())
    }
}

/// The bound, or infinity where the arithmetic of bounds has none.
///
/// Twice that of [`crate::Nonlinear::value`]: a Jacobian written by hand has the same terms in another order.
pub(super) fn bound(of: Bounded) -> f64 {
    if of.error.is_nan() { f64::INFINITY } else { 2.0 * of.error }
}

impl ConstraintSet {
    /// What rounding may have done to `c(u)` and `G(u)`, from the sizes of the terms that went into them.
    ///
    /// `|c_r|` is not zero but for rounding where it is at most `rounding.c()[r]`; a row of G is nothing but rounding where all its entries
    /// are at most `rounding.of_row(r)`.
    ///
    /// ```
    /// use qless_constraints::ConstraintSet;
    /// use qless_constraints::types::{Distance, PlanarPoint};
    /// // A rod of a millimetre, 1000 km from the origin: one unit in the last place of a coordinate is 1e-10.
    /// let a = PlanarPoint::new([0, 1], [1e6, 0.0]);
    /// let b = PlanarPoint::new([2, 3], [1e6 + 1e-3, 0.0]);
    /// let mut builder = ConstraintSet::builder(4);
    /// builder.add("rod", Distance::new(a, b))?;
    /// let rounding = builder.build()?.rounding(&[0.0; 4])?;
    /// assert!(rounding.c()[0] > 1e-10 && rounding.c()[0] < 1e-8);
    /// // Its direction is known to some six digits.
    /// assert!(rounding.of_row(0)[2] > 1e-7 && rounding.of_row(0)[2] < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] if `u` does not have length n.
    pub fn rounding(&self, u: &[f64]) -> Result<Rounding, ArgumentError> {
        long("u", u.len(), self.dofs)?;
        let (mut c, mut g) = (vec![0.0; self.equations()], self.whole_pattern());
        let constant = self.linear.nnz();
        g.values_mut()[..constant].iter_mut().for_each(|a| *a = Bounded::from(*a).error);
        let known = Known { u, sizes: self.stated.largest() };
        of_values(&self.linear, &self.blocks.all, &mut c, &mut g).into_par_iter().for_each(|task| match task.work {
            Work::Linear { batch, c } => of_batch(batch, u, c),
            Work::Nonlinear { block, c, g } => block.rounding(&known, c, g),
            Work::Copy { .. } | Work::Hessian { .. } => (),
        });
        Ok(Rounding { c, start: g.starts().to_vec(), g: g.values().to_vec() })
    }
}

/// The rounding of linear equations.
fn of_batch(batch: &Batch, u: &[f64], c: &mut [f64]) {
    batch.evaluate(u, c);
    let mut values = c.iter_mut();
    batch.for_each_row(|terms| {
        let term = |(j, a): (u32, f64)| Bounded::from(a) * Bounded::from(u[j as usize]);
        let sum = terms.map(term).fold(Bounded::from(0.0), |sum, term| sum + term);
        // c = sum - b.
        values.next().into_iter().for_each(|c| *c = bound(sum - Bounded::from(sum.real - *c)));
    });
}
