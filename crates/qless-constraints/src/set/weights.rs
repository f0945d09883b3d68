//! The "product strategy": by what each constraint Hessian is multiplied, as the method that enforces the constraints says.

use qless::ArgumentError;

use super::long;

/// Weights `w_r` of the effective Hessian `sum_r w_r H_r`.
///
/// ```
/// use qless_constraints::Weights;
/// let c = [0.5, -1.0];
/// assert_eq!(Weights::Multipliers(&[3.0, 4.0]).of(&c)?, [3.0, 4.0]);
/// assert_eq!(Weights::Penalty(&[10.0, 100.0]).of(&c)?, [5.0, -100.0]);
/// assert_eq!(Weights::Augmented { multipliers: &[3.0, 4.0], penalty: &[10.0, 100.0] }.of(&c)?, [8.0, -96.0]);
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
        /// One per equation.
        multipliers: &'a [f64],
        /// One per equation.
        penalty: &'a [f64],
    },
}

impl Weights<'_> {
    /// One weight per equation, from the constraint values.
    ///
    /// # Errors
    /// [`ArgumentError::WrongLength`] unless multipliers and penalties are as many as the values.
    pub fn of(&self, c: &[f64]) -> Result<Vec<f64>, ArgumentError> {
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
