//! Coincident points of two bodies: `x_a + R_a s_a - x_b - R_b s_b = 0`, a length. Up to eight constraints are
//! evaluated at once.

use std::borrow::Cow;
use std::slice;

use super::attachment::{AttachedPoint, Body};
use super::relative::{rotation_vectors, triangle};
use crate::geometry::lanes::{LANES, Lanes, RotatedArmLanes, RotationVectorLanes};
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

/// Two points that coincide: `c = sign (x_a - x_b)`.
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

    /// All pairs of rotations of the same body.
    fn pairs(&self, _: usize, pair: &mut dyn FnMut(usize, usize)) {
        for (first, kind) in [(0, self.a.kind), (self.a.dofs(), self.b.kind)] {
            let first = first + kind.positions();
            let rotations = first..first + kind.rotations();
            rotations.clone().for_each(|j| (first..=j).for_each(|k| pair(j, k)));
        }
    }

    fn rotation_vectors(&self, found: &mut dyn FnMut(usize)) {
        let second = self.a.dofs() + self.b.kind.positions();
        rotation_vectors([(self.a.kind.positions(), self.a.kind), (second, self.b.kind)], found);
    }

    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        Self::values_and_jacobians(slice::from_ref(self), u, c, g);
    }

    fn hessian(&self, u: &[f64], w: &[f64], h: &mut [f64]) {
        Self::second_derivatives(slice::from_ref(self), u, w, h);
    }

    const AT_ONCE: usize = LANES;

    /// `[I, d(R_a s_a), -I, -d(R_b s_b)]`.
    fn values_and_jacobians(items: &[Self], u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let [a, b] = Self::vectors(items, u);
        let [mut of_a, mut of_b] = [RotatedArmLanes::default(), RotatedArmLanes::default()];
        a.slopes(&mut of_a);
        b.slopes(&mut of_b);
        let (mut u, mut g) = (u, g);
        for (lane, (item, c)) in items.iter().zip(c.as_chunks_mut::<3>().0).enumerate() {
            let (u_a, u_b, own);
            (u_a, u) = u.split_at(item.a.dofs());
            (u_b, u) = u.split_at(item.b.dofs());
            let n = u_a.len() + u_b.len();
            (own, g) = g.split_at_mut(3 * n);
            let x_a = item.a.write_slopes(u_a, item.sign, [0, n], own, (&of_a, lane));
            let x_b = item.b.write_slopes(u_b, -item.sign, [u_a.len(), n], own, (&of_b, lane));
            *c = scale(item.sign, sub(x_a, x_b));
        }
    }

    fn second_derivatives(items: &[Self], u: &[f64], w: &[f64], h: &mut [f64]) {
        let weights = w.as_chunks::<3>().0;
        let mut m = Vector::<Lanes>::default();
        for (lane, (item, w)) in items.iter().zip(weights).enumerate() {
            (0..3).for_each(|k| m[k].0[lane] = item.sign * w[k]);
        }
        let [a, b] = Self::vectors(items, u);
        let [mut of_a, mut of_b] = [[Lanes::default(); 6]; 2];
        a.hessians(&m, &mut of_a);
        b.hessians(&m.map(|m| -m), &mut of_b);
        let (mut u, mut h) = (u, h);
        for (lane, (item, &w)) in items.iter().zip(weights).enumerate() {
            let (u_a, u_b, own_a, own_b);
            (u_a, u) = u.split_at(item.a.dofs());
            (u_b, u) = u.split_at(item.b.dofs());
            (own_a, h) = h.split_at_mut(triangle(item.a.kind));
            (own_b, h) = h.split_at_mut(triangle(item.b.kind));
            item.a.curvature(u_a, scale(item.sign, w), own_a, (&of_a, lane));
            item.b.curvature(u_b, scale(-item.sign, w), own_b, (&of_b, lane));
        }
    }
}

impl Coincident {
    /// Rotation vectors of the first and of the second bodies.
    #[inline]
    fn vectors(items: &[Self], mut u: &[f64]) -> [RotationVectorLanes; 2] {
        let mut all = <[RotationVectorLanes; 2]>::default();
        for (lane, item) in items.iter().enumerate() {
            for (vectors, carrier) in all.iter_mut().zip([&item.a, &item.b]) {
                let own;
                (own, u) = u.split_at(carrier.dofs());
                vectors.set(lane, (carrier.kind, carrier.arm), own);
            }
        }
        all
    }
}
