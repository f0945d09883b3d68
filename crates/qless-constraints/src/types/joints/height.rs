//! Prescribed height of a point: `(R_a s) . (x_b + R_b s_b - x_a) - s . s_a - h = 0`, a length.
//!
//! `s` is a direction fixed to body a. `s_a` and `s_b` are the arms from the centres `x_a` and `x_b` of the bodies to one
//! point in the reference configuration. Both bodies carry this point along; h is the height of b's point above a's, along `R_a s`.

use std::borrow::Cow;

use super::attachment::{AttachedPoint, Body};
use super::relative::triangle_before;
use crate::geometry::rotation_derivatives;
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, dot, scale, sub};
use crate::{EquationSink, Nonlinear};

/// Adds the equation that keeps the point `at` of body b at the same height as that of body a, along the direction `s`
/// of body a.
pub fn height(
    sink: &mut EquationSink,
    part: impl Into<Cow<'static, str>>,
    a: &Body,
    b: &Body,
    at: Vector<f64>,
    s: Vector<f64>,
) {
    let parameters = Height::new(a, b, at, s);
    sink.numbers(at);
    [a, b].iter().for_each(|body| body.state(sink));
    sink.nonlinear(part, &[a.dofs(), b.dofs()].concat(), parameters);
}

/// The parameters of the height equation, `(R_a s) . (x_b + R_b s_b - x_a) - s . s_a - h = 0`.
pub struct Height {
    /// The centre of body a.
    a: AttachedPoint,
    b: AttachedPoint,
    s: Vector<f64>,
    /// The constant `s . s_a`, where `s_a` is the arm of the point on body a.
    arm: f64,
    /// The prescribed height h.
    pub rise: f64,
}

impl Height {
    pub fn new(a: &Body, b: &Body, at: Vector<f64>, s: Vector<f64>) -> Self {
        Self { a: a.attach(a.at), b: b.attach(at), s, arm: dot(s, a.attach(at).arm), rise: 0.0 }
    }

    /// The vector from the centre of body a to the point of body b.
    fn reach<S: Scalar>(&self, a: &[S], b: &[S]) -> Vector<S> {
        sub(self.b.point(b), self.a.centre(a))
    }
}

impl Nonlinear for Height {
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let (a, b) = u.split_at(self.a.dofs());
        let up = self.a.kind.rotate(&a[self.a.kind.positions()..], self.s);
        c[0] = dot(up, self.reach(a, b)) - S::from(self.arm) - S::from(self.rise);
    }

    /// All pairs of DOFs, except two positions, and except a position with a rotation of body b: their second derivatives are zero.
    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        let (second, turns) = (self.a.dofs(), self.a.kind.positions()..self.a.dofs());
        let rotates_b = |j: usize| j >= second + self.b.kind.positions();
        for j in 0..dofs {
            for k in 0..=j {
                if turns.contains(&j) || turns.contains(&k) || (rotates_b(j) && rotates_b(k)) {
                    pair(j, k);
                }
            }
        }
    }

    /// The Jacobian is `[-R_a s, d(R_a s) . reach, R_a s, d(R_b s_b) . R_a s]`, where d is the derivative in the rotations, and `reach` the
    /// vector from the centre of body a to the point of body b.
    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let ((a, b), first) = (u.split_at(self.a.dofs()), self.a.kind.positions());
        let (up, reach) = (self.a.kind.rotate(&a[first..], self.s), self.reach(a, b));
        c[0] = dot(up, reach) - self.arm - self.rise;
        let (of_a, of_b) = g.split_at_mut(a.len());
        let (down, turns_a) = of_a.split_at_mut(first);
        let (risen, turns_b) = of_b.split_at_mut(self.b.kind.positions());
        down.iter_mut().zip(up).for_each(|(g, up)| *g = -up);
        risen.iter_mut().zip(up).for_each(|(g, up)| *g = up);
        rotation_derivatives::gradient(self.a.kind, &a[first..], self.s, reach, turns_a);
        rotation_derivatives::gradient(self.b.kind, &b[self.b.kind.positions()..], self.b.arm, up, turns_b);
    }

    fn hessian(&self, u: &[f64], w: &[f64], h: &mut [f64]) {
        let ((a, b), [first, second]) = (u.split_at(self.a.dofs()), [self.a.kind.positions(), self.b.kind.positions()]);
        let (turns_a, turns_b, s) = (&a[first..], &b[second..], scale(w[0], self.s));
        let (up, slopes_a) = rotation_derivatives::slopes(self.a.kind, turns_a, s);
        let (_, slopes_b) = rotation_derivatives::slopes(self.b.kind, turns_b, self.b.arm);
        let mut own = [[0.0; 10]; 2];
        rotation_derivatives::hessian(self.a.kind, turns_a, s, self.reach(a, b), &mut own[0]);
        rotation_derivatives::hessian(self.b.kind, turns_b, self.b.arm, up, &mut own[1]);
        // Derivative of the vector from the centre of a to the point of b, with respect to a DOF: a position of a or b, or a rotation of b.
        let moved = |j: usize| -> Vector<f64> {
            let along = |axis: usize, sign: f64| std::array::from_fn(|i| if i == axis { sign } else { 0.0 });
            match j.checked_sub(a.len()) {
                None => along(j, -1.0),
                Some(j) if j < second => along(j, 1.0),
                Some(j) => std::array::from_fn(|i| slopes_b[i][j - second]),
            }
        };
        let rotates_a = |j: usize| (first..a.len()).contains(&j);
        let mut slots = h.iter_mut();
        self.pairs(u.len(), &mut |j, k| {
            let of_both = |turn: usize, other: usize| {
                let moved = moved(other);
                (0..3).map(|i| slopes_a[i][turn - first] * moved[i]).sum()
            };
            let value: f64 = match (rotates_a(j), rotates_a(k)) {
                (true, true) => own[0][triangle_before(j - first) + k - first],
                (true, false) => of_both(j, k),
                (false, true) => of_both(k, j),
                (false, false) => own[1][triangle_before(j - a.len() - second) + k - a.len() - second],
            };
            if let Some(slot) = slots.next() {
                *slot = value;
            }
        });
    }
}
