//! How each equation is enforced.

use super::EnforceError;
use super::matrix::entries;
use super::problem::Problem;

/// How one equation is enforced. [`Problem::enforce`] takes one for each, in one solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// A slave is eliminated: `u = L q + u_0` (Eq. 6-9).
    Elimination,
    /// lambda is an unknown (Eq. 10).
    Multiplier,
    /// A spring of `D = factor k / |C_i|^2` pulls towards the equation (Eq. 11): `C_i u - b_i = lambda_i / D` is left of it.
    Penalty {
        /// How much stiffer the spring is than what it holds.
        factor: f64,
    },
    /// The same spring, and lambda takes over step by step: nothing is left.
    Augmented {
        /// How much stiffer the spring is than what it holds.
        factor: f64,
    },
}

impl Method {
    /// The factor of the spring, if there is one.
    pub(super) fn factor(self) -> Option<f64> {
        match self {
            Self::Penalty { factor } | Self::Augmented { factor } => Some(factor),
            Self::Elimination | Self::Multiplier => None,
        }
    }

    /// The same with `share` times the spring.
    pub(super) fn times(self, share: f64) -> Self {
        match self {
            Self::Penalty { factor } => Self::Penalty { factor: factor * share },
            Self::Augmented { factor } => Self::Augmented { factor: factor * share },
            other => other,
        }
    }

    /// The same without a spring.
    pub(super) fn without_spring(self) -> Self {
        if self.factor().is_some() { Self::Multiplier } else { self }
    }
}

/// `D_i = factor k_i / |C_i|^2` of each equation that has a spring, `k_i` the largest entry of K on the diagonal of its DOFs, or, where
/// there is none, of all; zero for others. It has the units of the equation: the factor has none.
pub(super) fn springs(problem: &Problem, methods: &[Method]) -> Result<Vec<f64>, EnforceError> {
    let mut diagonal = vec![0.0_f64; problem.system.dofs()];
    entries(&problem.k).filter(|&(i, j, _)| i == j).for_each(|(i, _, v)| diagonal[i] += v.abs());
    let largest = entries(&problem.k).fold(0.0, |most: f64, (_, _, v)| most.max(v.abs()));
    let mut springs = vec![0.0; problem.system.equations()];
    for &row in &problem.kept {
        let Some(factor) = methods[row].factor() else { continue };
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(EnforceError::Factor(factor));
        }
        let (mut near, mut square) = (0.0_f64, 0.0);
        for (j, v) in problem.system.matrix().row(row) {
            near = near.max(diagonal[j]);
            square += v * v;
        }
        // Without any stiffness every spring is as good as another.
        let near = [near, largest, 1.0].into_iter().find(|&k| k > 0.0).unwrap_or(1.0);
        let spring = factor * near / square;
        springs[row] =
            if spring > 0.0 && spring.is_finite() { spring } else { return Err(EnforceError::Factor(factor)) };
    }
    Ok(springs)
}
