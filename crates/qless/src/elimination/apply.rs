//! Expand, increment and project, into memory of the caller, on all threads; nothing is allocated where T is numbers.

use rayon::prelude::*;

use super::Elimination;
use super::roles::{Role, product};
use crate::ArgumentError;
use crate::common::argument::{long, numbers};

/// Fewer numbers than this are not worth a thread of their own.
const WORTH_A_THREAD: usize = 1 << 14;

impl Elimination {
    /// `u = L u_q + u_0`: all DOFs from those of [`Elimination::masters`].
    ///
    /// # Errors
    /// [`ArgumentError`] for a wrong length, a number that is not finite, or a result that is none (u is then not to be used).
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

    /// `du = L du_q`: the same for increments; prescribed DOFs and constants do not move.
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

    /// [`Elimination::expand_increment_into`] for many vectors (modes, say), one after the other in both lists.
    ///
    /// # Errors
    /// As [`Elimination::expand_into`]; [`ArgumentError::WrongLength`] unless both lists hold the same number of vectors.
    pub fn expand_increments_into(&self, masters: &[f64], du: &mut [f64]) -> Result<(), ArgumentError> {
        self.check_many(masters.len(), du.len())?;
        let (q, n) = (self.masters().len(), self.dofs());
        let of = |(k, du): (usize, &mut [f64])| self.expand_increment_into(&masters[k * q..(k + 1) * q], du);
        du.par_chunks_mut(n).enumerate().try_for_each(of)
    }

    /// `f_q = L^T f`: forces on all DOFs as the masters feel them.
    ///
    /// # Errors
    /// As [`Elimination::expand_into`].
    pub fn restrict_into(&self, forces: &[f64], masters: &mut [f64]) -> Result<(), ArgumentError> {
        numbers("the list of forces", forces, self.dofs())?;
        long("the list of masters", masters.len(), self.masters().len())?;
        let (places, slaves, columns) = (self.masters(), self.slaves(), &self.roles.of_masters);
        if self.reduction.is_explicit() {
            let of = |q: usize| forces[places[q]] + product(columns, q, forces);
            return fill(masters, "L^T f", of);
        }
        let of_slaves: Vec<f64> = slaves.iter().map(|&j| forces[j]).collect();
        let sums = self.reduction.apply_transposed(&of_slaves)?;
        fill(masters, "L^T f", |q| forces[places[q]] + sums[q])
    }

    /// [`Elimination::restrict_into`] for many vectors, one after the other in both lists.
    ///
    /// # Errors
    /// As [`Elimination::expand_increments_into`].
    pub fn restrict_many_into(&self, forces: &[f64], masters: &mut [f64]) -> Result<(), ArgumentError> {
        self.check_many(masters.len(), forces.len())?;
        let (q, n) = (self.masters().len(), self.dofs());
        let of = |(k, masters): (usize, &mut [f64])| self.restrict_into(&forces[k * n..(k + 1) * n], masters);
        masters.par_chunks_mut(q.max(1)).enumerate().try_for_each(of)
    }

    /// Lists over masters and over all DOFs of the same number of vectors.
    fn check_many(&self, masters: usize, all: usize) -> Result<(), ArgumentError> {
        let count = all / self.dofs();
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

/// Number k of a result by a function of k, which must be finite.
pub(super) fn fill(out: &mut [f64], what: &'static str, of: impl Fn(usize) -> f64 + Sync) -> Result<(), ArgumentError> {
    let all = |first: usize, out: &mut [f64]| {
        let mut finite = true;
        for (k, out) in out.iter_mut().enumerate() {
            *out = of(first + k);
            finite &= out.is_finite();
        }
        if finite { Ok(()) } else { Err(ArgumentError::Overflow { what, place: first }) }
    };
    let done = if out.len() < 2 * WORTH_A_THREAD || rayon::current_num_threads() == 1 {
        all(0, out)
    } else {
        let stretch = |(k, out): (usize, &mut [f64])| all(k * WORTH_A_THREAD, out);
        out.par_chunks_mut(WORTH_A_THREAD).enumerate().map(stretch).reduce(|| Ok(()), Result::and)
    };
    let place = |_| out.iter().position(|v| !v.is_finite()).unwrap_or_default();
    done.map_err(|error| ArgumentError::Overflow { what, place: place(error) })
}

/// The condensed matrix as a product: K is a function that multiplies vectors over all DOFs.
///
/// ```
/// use qless::{Elimination, Options, SystemBuilder};
/// let mut builder = SystemBuilder::new(3);
/// builder.equation([(2, 1.0), (0, -1.0)], 0.0);
/// let elimination = Elimination::new(&builder.build()?, &Options::default())?;
/// let mut operator = elimination.operator(|u: &[f64], f: &mut [f64]| f.iter_mut().zip(u).for_each(|(f, u)| *f = 2.0 * u));
/// let mut product = [0.0; 2];
/// // u1 = 1 and u2 = 3, which u0 follows.
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
    /// `L^T K L`; `k(u, f)` writes `f = K u`, f being zero before.
    pub fn operator<K: FnMut(&[f64], &mut [f64])>(&self, k: K) -> Operator<'_, K> {
        Operator { elimination: self, k, u: vec![0.0; self.dofs()], f: vec![0.0; self.dofs()] }
    }
}

impl<K: FnMut(&[f64], &mut [f64])> Operator<'_, K> {
    /// `y = L^T K L x`, both over [`Elimination::masters`].
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
