//! `c = (|p|^2 - 1) / 2`: Euler parameters `p = (1, 0, 0, 0) + u` of length one, one equation per body.

use std::convert::Infallible;

use crate::scalar::Scalar;
use crate::{Constraint, EquationSink, Nonlinear};

/// Euler parameters of length one. Each body with Euler parameters needs this constraint once.
///
#[doc = include_str!("../../../docs/pictures/euler_norm.svg")]
///
#[doc = include_str!("../../../docs/types/euler_norm.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::EulerNorm};
/// let mut builder = ConstraintSet::builder(4);
/// builder.add("crank", EulerNorm { parameters: [0, 1, 2, 3] })?;
/// let set = builder.build()?;
/// let mut evaluation = set.allocate();
/// set.evaluate(&[-0.4, 0.8, 0.0, 0.0], &mut evaluation)?;
/// assert!(evaluation.c()[0].abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EulerNorm {
    /// The DOFs of `p - (1, 0, 0, 0)`.
    pub parameters: [usize; 4],
}

impl Constraint for EulerNorm {
    const NAME: &'static str = "length of Euler parameters";
    type Error = Infallible;

    fn emit(self, sink: &mut EquationSink) -> Result<(), Infallible> {
        self.parameters.iter().for_each(|&dof| sink.coordinate(dof, 1.0));
        sink.nonlinear("", &self.parameters, Norm);
        Ok(())
    }
}

/// The constraint has no parameters.
struct Norm;

impl Nonlinear for Norm {
    const DOFS: usize = 4;
    const QUADRATIC: bool = true;
    const NUMBERS: &'static [usize] = &[0];
    const SAME_PAIRS: bool = true;
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        // |p|^2 - 1 = 2 u_0 + |u|^2; this form avoids cancellation.
        c[0] = u.iter().fold(u[0], |sum, &x| sum + x * x * S::from(0.5));
    }

    /// `H = I`.
    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        (0..dofs).for_each(|k| pair(k, k));
    }

    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        self.value(u, c);
        g.copy_from_slice(u);
        g[0] += 1.0;
    }

    fn hessian(&self, _: &[f64], w: &[f64], h: &mut [f64]) {
        h[0] = w[0];
    }
}
