//! Expand, increment and restrict into memory of the caller, on all threads. If T is explicit, nothing is allocated.

use rayon::prelude::*;

use super::Elimination;
use super::roles::{Role, product};
use crate::ArgumentError;
use crate::common::argument::{long, numbers};

/// Number of entries of a chunk for one thread.
const CHUNK: usize = 1 << 14;

impl Elimination {
    /// Computes all DOFs `u = L u_q + u_0` from the values u_q of [`Elimination::masters`]. L holds T and the identity; `u_0` holds the
    /// constants and the prescribed values.
    ///
    /// # Errors
    /// [`ArgumentError`] for a wrong length, or a number or result that is not finite; u is then invalid.
    pub fn expand_into(&self, masters: &[f64], u: &mut [f64]) -> Result<(), ArgumentError> {
        self.check(masters, u.len())?;
        if !self.reduction.is_explicit() {
            u.copy_from_slice(&self.reduction.expand(masters, &self.prescribed_values)?);
            return Ok(());
        }
        self.spread(masters, u, |role| match role {
            Role::Slave(i) => self.roles.constants[i as usize],
            Role::Prescribed(p) => self.prescribed_values[p as usize],
            Role::Master(_) => 0.0,
        })
    }

    /// Expands an increment of the masters: `du = L du_q`, where L holds T and the identity. Prescribed DOFs and constants do not change.
    ///
    /// # Errors
    /// As [`Elimination::expand_into`].
    pub fn expand_increment_into(&self, masters: &[f64], du: &mut [f64]) -> Result<(), ArgumentError> {
        self.check(masters, du.len())?;
        if !self.reduction.is_explicit() {
            du.copy_from_slice(&self.reduction.increment(masters)?);
            return Ok(());
        }
        self.spread(masters, du, |_| 0.0)
    }

    /// [`Elimination::expand_increment_into`] for many vectors, such as modes. Both lists hold one vector after the other.
    ///
    /// # Errors
    /// As [`Elimination::expand_into`]; [`ArgumentError::WrongLength`] unless both lists hold the same number of vectors.
    pub fn expand_increments_into(&self, masters: &[f64], du: &mut [f64]) -> Result<(), ArgumentError> {
        self.check_many(masters.len(), du.len())?;
        let (q, n) = (self.masters().len(), self.dofs());
        let expand = |(k, du): (usize, &mut [f64])| self.expand_increment_into(&masters[k * q..(k + 1) * q], du);
        du.par_chunks_mut(n).enumerate().try_for_each(expand)
    }

    /// Transfers forces on all DOFs to the masters: `f_q = L^T f`, where L holds T and the identity.
    ///
    /// # Errors
    /// As [`Elimination::expand_into`].
    pub fn restrict_into(&self, forces: &[f64], masters: &mut [f64]) -> Result<(), ArgumentError> {
        numbers("the list of forces", forces, self.dofs())?;
        long("the list of masters", masters.len(), self.masters().len())?;
        let (places, slaves, columns) = (self.masters(), self.slaves(), &self.roles.of_masters);
        if self.reduction.is_explicit() {
            return fill(masters, "L^T f", |q| forces[places[q]] + product(columns, q, forces));
        }
        let of_slaves: Vec<f64> = slaves.iter().map(|&j| forces[j]).collect();
        let sums = self.reduction.apply_transposed(&of_slaves)?;
        fill(masters, "L^T f", |q| forces[places[q]] + sums[q])
    }

    /// [`Elimination::restrict_into`] for many vectors. Both lists hold one vector after the other.
    ///
    /// # Errors
    /// As [`Elimination::expand_increments_into`].
    pub fn restrict_many_into(&self, forces: &[f64], masters: &mut [f64]) -> Result<(), ArgumentError> {
        self.check_many(masters.len(), forces.len())?;
        let (q, n) = (self.masters().len(), self.dofs());
        let restrict = |(k, masters): (usize, &mut [f64])| self.restrict_into(&forces[k * n..(k + 1) * n], masters);
        masters.par_chunks_mut(q.max(1)).enumerate().try_for_each(restrict)
    }

    /// Checks that both lists have the same number of vectors.
    fn check_many(&self, masters: usize, all: usize) -> Result<(), ArgumentError> {
        let count = all.checked_div(self.dofs()).unwrap_or_default();
        long("the list of vectors over all DOFs", all, count * self.dofs())?;
        long("the list of vectors over masters", masters, count * self.masters().len())
    }

    fn check(&self, masters: &[f64], all: usize) -> Result<(), ArgumentError> {
        numbers("the list of masters", masters, self.masters().len())?;
        long("the list of DOFs", all, self.dofs())
    }

    fn spread(
        &self,
        masters: &[f64],
        u: &mut [f64],
        constant: impl Fn(Role) -> f64 + Sync,
    ) -> Result<(), ArgumentError> {
        let t = &self.reduction.t;
        fill(u, "u", |j| {
            let role = self.roles.of[j];
            match role {
                Role::Master(q) => masters[q as usize],
                Role::Slave(i) => constant(role) + product(t, i as usize, masters),
                Role::Prescribed(_) => constant(role),
            }
        })
    }
}

/// Fills a list with a function of the index; an error if a value is not finite.
pub(super) fn fill(
    out: &mut [f64],
    what: &'static str,
    value: impl Fn(usize) -> f64 + Sync,
) -> Result<(), ArgumentError> {
    let fill = |first: usize, out: &mut [f64]| {
        let mut finite = true;
        for (k, out) in out.iter_mut().enumerate() {
            *out = value(first + k);
            finite &= out.is_finite();
        }
        finite
    };
    let finite = if out.len() < 2 * CHUNK || rayon::current_num_threads() == 1 {
        fill(0, out)
    } else {
        let chunk = |(k, out): (usize, &mut [f64])| fill(k * CHUNK, out);
        out.par_chunks_mut(CHUNK).enumerate().map(chunk).reduce(|| true, |a, b| a & b)
    };
    if finite { Ok(()) } else { Err(ArgumentError::Overflow { what, place: first_not_finite(out) }) }
}

/// The index of the first number that is not finite.
pub(super) fn first_not_finite(values: &[f64]) -> usize {
    values.iter().position(|v| !v.is_finite()).unwrap_or_default()
}

/// The condensed matrix `L^T K L` as an operator: K is a function that multiplies vectors over all DOFs.
///
/// ```
/// use qless::{Elimination, Options, SystemBuilder};
/// let mut builder = SystemBuilder::new(3);
/// builder.equation([(2, 1.0), (0, -1.0)], 0.0);
/// let elimination = Elimination::new(&builder.build()?, &Options::default())?;
/// let mut operator = elimination.operator(|u: &[f64], f: &mut [f64]| f.iter_mut().zip(u).for_each(|(f, u)| *f = 2.0 * u));
/// let mut product = [0.0; 2];
/// // u1 = 1 and u0 = u2 = 3.
/// operator.apply_into(&[1.0, 3.0], &mut product)?;
/// assert_eq!(product, [2.0, 12.0]);
/// # Ok::<(), qless::elimination::EliminationError>(())
/// ```
pub struct Operator<'a, K> {
    elimination: &'a Elimination,
    k: K,
    u: Vec<f64>,
    f: Vec<f64>,
}

impl<K> std::fmt::Debug for Operator<'_, K> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Operator of {:?}", self.elimination)
    }
}

impl Elimination {
    /// The condensed matrix `L^T K L` as an operator, where L holds T and the identity. `k(u, f)` must add `K u` to f, which is zero before
    /// the call.
    pub fn operator<K: FnMut(&[f64], &mut [f64])>(&self, k: K) -> Operator<'_, K> {
        Operator { elimination: self, k, u: vec![0.0; self.dofs()], f: vec![0.0; self.dofs()] }
    }
}

impl<K: FnMut(&[f64], &mut [f64])> Operator<'_, K> {
    /// Multiplies by the condensed matrix: `y = L^T K L x`, where L holds T and the identity. Both x and y are vectors over
    /// [`Elimination::masters`].
    ///
    /// # Errors
    /// As [`Elimination::restrict_into`].
    pub fn apply_into(&mut self, x: &[f64], y: &mut [f64]) -> Result<(), ArgumentError> {
        self.elimination.expand_increment_into(x, &mut self.u)?;
        self.f.fill(0.0);
        (self.k)(&self.u, &mut self.f);
        self.elimination.restrict_into(&self.f, y)
    }
}
