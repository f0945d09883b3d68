//! The equations that joints consist of, beside [`super::coincident`]; the derivatives of the second are taken by dual numbers.
//!
//! - directions keep their angle: `(R_a s) . (R_b t) - s . t = 0`;
//! - a point keeps its height: `(R_a s) . (p_b - p_a) - s . (P_b - P_a) = 0`, a length.

use crate::geometry::carrier::{Body, Carrier, Kind};
use crate::geometry::turned;
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, dot, sub};
use crate::{Nonlinear, Store};

/// The direction `s` of body a and `t` of body b keep their angle.
pub fn angle(store: &mut Store, part: &'static str, a: &Body, b: &Body, [s, t]: [Vector<f64>; 2]) {
    let dofs = [a.rotation_dofs(), b.rotation_dofs()].concat();
    store.nonlinear(part, &dofs, Angle { a: a.kind, b: b.kind, s, t, cosine: dot(s, t) });
}

/// The point `at` of body b keeps its height along the direction `s` of body a, above the same point of body a.
pub fn height(store: &mut Store, part: &'static str, a: &Body, b: &Body, at: Vector<f64>, s: Vector<f64>) {
    let parameters = Height { a: a.carry(at), b: b.carry(at), s };
    store.nonlinear(part, &[a.dofs(), b.dofs()].concat(), parameters);
}

/// Two directions at a constant angle.
struct Angle {
    a: Kind,
    b: Kind,
    s: Vector<f64>,
    t: Vector<f64>,
    cosine: f64,
}

impl Nonlinear for Angle {
    const PARTS: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let (a, b) = u.split_at(self.a.rotations());
        c[0] = dot(self.a.turn(a, self.s), self.b.turn(b, self.t)) - S::from(self.cosine);
    }

    #[inline]
    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let (a, b) = u.split_at(self.a.rotations());
        let (s, t) = (self.a.turn(a, self.s), self.b.turn(b, self.t));
        c[0] = dot(s, t) - self.cosine;
        let (of_a, of_b) = g.split_at_mut(a.len());
        turned::gradient(self.a, a, self.s, t, of_a);
        turned::gradient(self.b, b, self.t, s, of_b);
    }

    /// Each body as if the other stood still, and `d(R_a s)^T d(R_b t)`.
    #[inline]
    fn hessian(&self, u: &[f64], w: &[f64], h: &mut [f64]) {
        let (a, b) = u.split_at(self.a.rotations());
        let push = |v: Vector<f64>| v.map(|x| w[0] * x);
        let (of_a, mut rest) = h.split_at_mut(triangle(self.a));
        turned::hessian(self.a, a, self.s, push(self.b.turn(b, self.t)), of_a);
        let mut of_b = [0.0; 10];
        turned::hessian(self.b, b, self.t, push(self.a.turn(a, self.s)), &mut of_b[..triangle(self.b)]);
        let (_, slopes_a) = turned::slopes(self.a, a, self.s);
        let (_, slopes_b) = turned::slopes(self.b, b, self.t);
        for j in 0..b.len() {
            let own;
            (own, rest) = rest.split_at_mut(a.len() + j + 1);
            (0..a.len()).for_each(|k| own[k] = w[0] * (0..3).map(|i| slopes_a[i][k] * slopes_b[i][j]).sum::<f64>());
            own[a.len()..].copy_from_slice(&of_b[triangle_before(j)..=triangle_before(j) + j]);
        }
    }
}

/// Entries of the lower triangle of the rotations.
pub(super) fn triangle(kind: Kind) -> usize {
    kind.rotations() * (kind.rotations() + 1) / 2
}

/// Where row j of a lower triangle starts.
fn triangle_before(j: usize) -> usize {
    j * (j + 1) / 2
}

/// A point at a constant height above another, zero in the reference configuration.
struct Height {
    a: Carrier,
    b: Carrier,
    s: Vector<f64>,
}

impl Nonlinear for Height {
    const PARTS: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let (a, b) = u.split_at(self.a.dofs());
        let up = self.a.kind.turn(&a[self.a.kind.positions()..], self.s);
        c[0] = dot(up, sub(self.b.point(b), self.a.point(a)));
    }

    /// All but two positions, and the position with the rotation of body b.
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
}
