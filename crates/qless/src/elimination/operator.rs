//! `x -> L^T K L x` without K_q, for Krylov methods.

use super::Elimination;
use crate::ArgumentError;

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
