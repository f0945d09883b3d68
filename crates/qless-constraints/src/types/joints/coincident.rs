//! Coincident points of two bodies: `x_a + R_a s_a - x_b - R_b s_b = 0`, a length. `s_a` and `s_b` are the arms from the positions `x_a`
//! and `x_b` of the bodies to the point.

use std::borrow::Cow;

use super::attachment::{AttachedPoint, Body};
use super::relative::triangle;
use crate::geometry::rotation_derivatives;
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, scale, sub};
use crate::{EquationSink, Nonlinear};

/// Adds the equations that keep the point `at` of both bodies together.
pub fn coincident(sink: &mut EquationSink, part: impl Into<Cow<'static, str>>, a: &Body, b: &Body, at: Vector<f64>) {
    // The body with the lower DOFs comes first: then the entries of G are already sorted.
    let swap = a.dofs().first() > b.dofs().first();
    let (first, second, sign) = if swap { (b, a, -1.0) } else { (a, b, 1.0) };
    let parameters = Coincident { a: first.attach(at), b: second.attach(at), sign };
    sink.numbers(at);
    [a, b].iter().for_each(|body| body.state(sink));
    sink.nonlinear(part, &[first.dofs(), second.dofs()].concat(), parameters);
}

/// Two points `p_a` and `p_b` of two bodies that coincide: `c = sign (p_a - p_b)`, where `sign` is 1 or -1.
struct Coincident {
    a: AttachedPoint,
    b: AttachedPoint,
    sign: f64,
}

impl Nonlinear for Coincident {
    const EQUATION_NAMES: &'static [&'static str] = &["x", "y", "z"];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let (a, b) = u.split_at(self.a.dofs());
        c.copy_from_slice(&scale(S::from(self.sign), sub(self.a.point(a), self.b.point(b))));
    }

    /// All pairs of rotation DOFs of the same body.
    fn pairs(&self, _: usize, pair: &mut dyn FnMut(usize, usize)) {
        for (first, kind) in [(0, self.a.kind), (self.a.dofs(), self.b.kind)] {
            let first = first + kind.positions();
            let rotations = first..first + kind.rotations();
            rotations.clone().for_each(|j| (first..=j).for_each(|k| pair(j, k)));
        }
    }

    /// Writes `c = sign (p_a - p_b)` for the points `p_a` and `p_b`, and its Jacobian `sign [I, d(R_a s_a), -I, -d(R_b s_b)]`, where d is
    /// the derivative in the rotations.
    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let (a, b) = u.split_at(self.a.dofs());
        let x_a = self.a.write_slopes(a, self.sign, [0, u.len()], g);
        let x_b = self.b.write_slopes(b, -self.sign, [a.len(), u.len()], g);
        c.copy_from_slice(&scale(self.sign, sub(x_a, x_b)));
    }

    fn hessian(&self, u: &[f64], w: &[f64], h: &mut [f64]) {
        let ((a, b), m) = (u.split_at(self.a.dofs()), scale(self.sign, [w[0], w[1], w[2]]));
        let (of_a, of_b) = h.split_at_mut(triangle(self.a.kind));
        rotation_derivatives::hessian(self.a.kind, &a[self.a.kind.positions()..], self.a.arm, m, of_a);
        rotation_derivatives::hessian(self.b.kind, &b[self.b.kind.positions()..], self.b.arm, scale(-1.0, m), of_b);
    }
}
