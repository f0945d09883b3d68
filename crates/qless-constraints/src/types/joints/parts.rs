//! The three equations that all joints consist of. Their derivatives are taken by dual numbers.
//!
//! - points coincide: `x_a + R_a s_a - x_b - R_b s_b = 0`, a length;
//! - directions keep their angle: `(R_a s) . (R_b t) - s . t = 0`;
//! - a point keeps its height: `(R_a s) . (p_b - p_a) - s . (P_b - P_a) = 0`, a length.

use std::borrow::Cow;

use crate::geometry::carrier::{Body, Carrier, Kind};
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, dot, sub};
use crate::{Nonlinear, Store};

/// The point `at` of both bodies stays one point.
pub fn coincident(store: &mut Store, part: impl Into<Cow<'static, str>>, a: &Body, b: &Body, at: Vector<f64>) {
    store.nonlinear(part, &[a.dofs(), b.dofs()].concat(), Coincident { a: a.carry(at), b: b.carry(at) });
}

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

/// Two points that coincide.
struct Coincident {
    a: Carrier,
    b: Carrier,
}

impl Nonlinear for Coincident {
    const PARTS: &'static [&'static str] = &["x", "y", "z"];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let (a, b) = u.split_at(self.a.dofs());
        c.copy_from_slice(&sub(self.a.point(a), self.b.point(b)));
    }

    /// Rotations of one body only.
    fn pairs(&self, _: usize, pair: &mut dyn FnMut(usize, usize)) {
        for (first, kind) in [(0, self.a.kind), (self.a.dofs(), self.b.kind)] {
            let first = first + kind.positions();
            let rotations = first..first + kind.rotations();
            rotations.clone().for_each(|j| (first..=j).for_each(|k| pair(j, k)));
        }
    }
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
