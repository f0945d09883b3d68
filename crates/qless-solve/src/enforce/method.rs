//! How each equation is enforced.

use super::EnforceError;
use super::matrix::entries;
use super::part::Part;

/// How one equation is enforced. [`Problem::enforce`](super::Problem::enforce) takes one for each, in one solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// A slave is eliminated: `u = L q + u_0` (Eq. 6-9).
    Elimination,
    /// lambda is an unknown (Eq. 10).
    Multiplier,
    /// A spring of `D = factor k / |C_i|^2` pulls towards the equation (Eq. 11): `C_i u - b_i = lambda_i / D` is left of it, and nothing
    /// where it acts on a part without any stiffness, since the factor would have no meaning.
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

    /// Whether its numbers can be used.
    pub(super) fn checked(self) -> Result<(), EnforceError> {
        match self.factor() {
            Some(factor) if !(factor > 0.0 && factor.is_finite()) => Err(EnforceError::Factor(factor)),
            _ => Ok(()),
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

/// `D_i = factor k_i / |C_i|^2` of each equation that has a spring, `k_i` the largest entry of K on the diagonal of its free DOFs, or, where
/// there is none, of the part; zero for others. It has the units of the equation: the factor has none. Where a part has no stiffness at all,
/// no spring can be compared with it: its D is zero, and its equations are met.
pub(super) fn springs(part: &Part, methods: &[Method]) -> Result<Vec<f64>, EnforceError> {
    let mut diagonal = vec![0.0_f64; part.dofs.len()];
    entries(&part.k).filter(|&(i, j, _)| i == j).for_each(|(i, _, v)| diagonal[i] += v.abs());
    let largest = entries(&part.k).fold(0.0, |most: f64, (_, _, v)| most.max(v.abs()));
    let of_row = |(row, method): (usize, &Method)| {
        let Some(factor) = method.factor() else { return Ok(0.0) };
        let (mut near, mut square) = (0.0_f64, 0.0);
        for (j, v) in part.system.matrix().row(row) {
            near = near.max(diagonal[j]);
            square += v * v;
        }
        let spring = factor * if near > 0.0 { near } else { largest } / square;
        let is_usable = largest == 0.0 || (spring > 0.0 && spring.is_finite());
        if is_usable { Ok(spring) } else { Err(EnforceError::Factor(factor)) }
    };
    methods.iter().enumerate().map(of_row).collect()
}
