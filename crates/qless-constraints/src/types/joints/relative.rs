//! Equations on the relative rotation `R_a^T R_b` of two bodies: functions c of the quaternion `q = conj(q_a) q_b`.
//!
//! With `z = dc/dq` and products of quaternions, `dc/dq_b = q_a z` and `dc/dq_a = q_b conj(z)`. The Hessian has three
//! terms: the second derivatives of q_a and q_b, multiplied by `dc/dq_a` and `dc/dq_b`; `dq^T (d^2 c / dq^2) dq`; and
//! `z . (conj(dq_a) dq_b)` between the bodies.

use std::array::from_fn;
use std::borrow::Cow;

use super::attachment::Body;
use crate::geometry::quaternion::{BodyQuaternion, Quaternion, body_quaternion, conjugate, inner, product};
use crate::geometry::rotation::RotationKind;
use crate::scalar::{Dual, Scalar};
use crate::{EquationSink, Nonlinear};

/// Maximum number of equations of one [`RotationFunction`].
pub const MAX_EQUATIONS: usize = 3;
/// A 4 x 4 matrix that acts on quaternions.
pub type QuaternionMatrix = [Quaternion<f64>; 4];

/// A function c of the relative rotation of two bodies, given as a quaternion q. Joints set it to zero.
pub trait RotationFunction: Send + Sync + 'static {
    /// As [`Nonlinear::EQUATION_NAMES`], at most [`MAX_EQUATIONS`].
    const EQUATION_NAMES: &'static [&'static str];
    /// As [`Nonlinear::DRIVEN`].
    const DRIVEN: bool = false;

    /// As [`Nonlinear::at_time`].
    fn at_time(&mut self, _time: f64) -> Result<(), f64> {
        Ok(())
    }
    /// As [`Nonlinear::angle`].
    fn angle(&self) -> Option<f64> {
        None
    }
    /// Writes `c(q)` for the relative quaternion q.
    fn value<S: Scalar>(&self, q: Quaternion<S>, c: &mut [S]);

    /// Writes `c(q)`, and returns `dc_r / dq` for each equation r.
    fn slopes(&self, q: Quaternion<f64>, c: &mut [f64]) -> [Quaternion<f64>; MAX_EQUATIONS] {
        let mut of = [Dual::<4>::from(0.0); MAX_EQUATIONS];
        self.value(from_fn(|j| Dual::variable(q[j], j)), &mut of[..c.len()]);
        c.iter_mut().zip(of).for_each(|(c, of)| *c = of.real);
        of.map(|of| of.slope)
    }

    /// Returns `d(w.c) / dq` and `d^2 (w.c) / dq^2` for the weights w.
    fn curvature(&self, q: Quaternion<f64>, w: &[f64]) -> (Quaternion<f64>, QuaternionMatrix) {
        let mut of = [Dual::<4, Dual<4>>::from(0.0); MAX_EQUATIONS];
        self.value(from_fn(|j| Dual::variable(Dual::variable(q[j], j), j)), &mut of[..w.len()]);
        let sum = |number: &dyn Fn(&Dual<4, Dual<4>>) -> f64| w.iter().zip(&of).map(|(w, of)| w * number(of)).sum();
        let square = from_fn(|j| from_fn(|k| sum(&|of| of.slope[j].slope[k])));
        (from_fn(|j| sum(&|of| of.real.slope[j])), square)
    }
}

/// Adds the equations `function` on the relative rotation of two bodies.
pub fn relative<F: RotationFunction>(
    sink: &mut EquationSink,
    part: impl Into<Cow<'static, str>>,
    a: &Body,
    b: &Body,
    function: F,
) {
    let dofs = [a.rotation_dofs(), b.rotation_dofs()].concat();
    [a, b].iter().for_each(|body| body.state(sink));
    sink.nonlinear(part, &dofs, RelativeRotation { a: a.kind, b: b.kind, function });
}

struct RelativeRotation<F> {
    a: RotationKind,
    b: RotationKind,
    function: F,
}

impl<F> RelativeRotation<F> {
    /// The quaternions of both bodies, and the relative quaternion `q = conj(q_a) q_b`.
    #[inline]
    fn turns(&self, u: &[f64]) -> (BodyQuaternion, BodyQuaternion, Quaternion<f64>) {
        let (a, b) = u.split_at(self.a.rotations());
        let (a, b) = (BodyQuaternion::new(self.a, a), BodyQuaternion::new(self.b, b));
        let q = product(conjugate(a.q), b.q);
        (a, b, q)
    }
}

impl<F: RotationFunction> Nonlinear for RelativeRotation<F> {
    const EQUATION_NAMES: &'static [&'static str] = F::EQUATION_NAMES;
    const DRIVEN: bool = F::DRIVEN;

    fn at_time(&mut self, time: f64) -> Result<(), f64> {
        self.function.at_time(time)
    }

    fn angle(&self) -> Option<f64> {
        self.function.angle()
    }

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let (a, b) = u.split_at(self.a.rotations());
        self.function.value(product(conjugate(body_quaternion(self.a, a)), body_quaternion(self.b, b)), c);
    }

    #[inline]
    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let (a, b, q) = self.turns(u);
        let slopes = self.function.slopes(q, c);
        for (row, z) in g.chunks_exact_mut(u.len()).zip(slopes) {
            let (of_a, of_b) = row.split_at_mut(self.a.rotations());
            a.gradient(product(b.q, conjugate(z)), of_a);
            b.gradient(product(a.q, z), of_b);
        }
    }

    fn hessian(&self, u: &[f64], w: &[f64], h: &mut [f64]) {
        let (a, b, q) = self.turns(u);
        let (z, square) = self.function.curvature(q, w);
        let (count_a, n) = (self.a.rotations(), u.len());
        let (slopes_a, slopes_b) = (a.slopes(), b.slopes());
        // dq / du_j, and its product with d^2 c / dq^2.
        let (mut dq, mut hessian_dq) = ([[0.0; 4]; 8], [[0.0; 4]; 8]);
        (0..count_a).for_each(|j| dq[j] = product(conjugate(slopes_a[j]), b.q));
        (count_a..n).for_each(|j| dq[j] = product(conjugate(a.q), slopes_b[j - count_a]));
        (0..n).for_each(|j| hessian_dq[j] = square.map(|row| inner(row, dq[j])));
        let mut own = [[0.0; 10]; 2];
        a.hessian(product(b.q, conjugate(z)), &mut own[0][..triangle(self.a)]);
        b.hessian(product(a.q, z), &mut own[1][..triangle(self.b)]);
        let mut slots = h.iter_mut();
        for j in 0..n {
            let of_b = j >= count_a;
            let across = if of_b { product(z, conjugate(slopes_b[j - count_a])) } else { [0.0; 4] };
            for (k, slot) in (0..=j).zip(&mut slots) {
                let second = match (of_b, k >= count_a) {
                    // With z = dc/dq: z . (conj(dq_a) dq_b) = conj(dq_a) . (z conj(dq_b)).
                    (true, false) => inner(conjugate(slopes_a[k]), across),
                    (true, true) => own[1][triangle_before(j - count_a) + k - count_a],
                    (false, _) => own[0][triangle_before(j) + k],
                };
                *slot = inner(dq[k], hessian_dq[j]) + second;
            }
        }
    }
}

/// Number of entries in the lower triangle of a Hessian with respect to the rotations of one body.
pub fn triangle(kind: RotationKind) -> usize {
    triangle_before(kind.rotations())
}

/// Index of the first entry of row j in a lower triangle.
pub fn triangle_before(j: usize) -> usize {
    j * (j + 1) / 2
}
