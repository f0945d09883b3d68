//! The volume of a closed surface of triangles, with its derivatives.

use crate::Nonlinear;
use crate::geometry::node::moved;
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, cross, dot};

/// The stored parameters of [`super::Volume`].
pub(super) struct Patch {
    at: Vec<Vector<f64>>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<(usize, usize)>,
    volume: f64,
    scale: f64,
}

impl Patch {
    /// From coordinates relative to a node, triangles of these, and `V_0`.
    pub fn new(at: Vec<Vector<f64>>, triangles: Vec<[u32; 3]>, volume: f64) -> Self {
        let edges = edges(&triangles);
        Self { at, triangles, edges, volume, scale: volume.powf(-2.0 / 3.0) }
    }
}

/// Nodes joined by an edge, each once, ascending: the greater first.
fn edges(triangles: &[[u32; 3]]) -> Vec<(usize, usize)> {
    let sides = |&[a, b, d]: &[u32; 3]| [(a, b), (b, d), (d, a)];
    let ordered = |(a, b): (u32, u32)| (a.max(b) as usize, a.min(b) as usize);
    let mut edges: Vec<_> = triangles.iter().flat_map(sides).map(ordered).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

impl Nonlinear for Patch {
    const PARTS: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let x = |node: u32| moved(&self.at[node as usize], u, 3 * node as usize);
        let six = self.triangles.iter().fold(S::from(0.0), |sum, &[a, b, d]| sum + dot(x(a), cross(x(b), x(d))));
        c[0] = (six / S::from(6.0) - S::from(self.volume)) * S::from(self.scale);
    }

    /// Different components of nodes that an edge joins.
    fn pairs(&self, _: usize, pair: &mut dyn FnMut(usize, usize)) {
        for &(j, k) in &self.edges {
            for row in 0..3 {
                (0..3).filter(|&col| col != row).for_each(|col| pair(3 * j + row, 3 * k + col));
            }
        }
    }

    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        self.jacobian_in(u, c, g);
    }

    /// `dV / da = sum over triangles of b x d / 6`.
    fn jacobian_in<S: Scalar>(&self, u: &[S], c: &mut [S], g: &mut [S]) {
        self.value(u, c);
        g.fill(S::from(0.0));
        let (factor, x) = (S::from(self.scale / 6.0), |node: u32| moved(&self.at[node as usize], u, 3 * node as usize));
        for &[a, b, d] in &self.triangles {
            for (node, next, last) in [(a, b, d), (b, d, a), (d, a, b)] {
                let slope = cross(x(next), x(last));
                let own = &mut g[3 * node as usize..][..3];
                own.iter_mut().zip(slope).for_each(|(g, slope)| *g = *g + factor * slope);
            }
        }
    }

    /// `d^2 V / da db = -[d]x / 6` for each triangle `(a, b, d)`.
    fn hessian(&self, u: &[f64], w: &[f64], h: &mut [f64]) {
        h.fill(0.0);
        let factor = w[0] * self.scale / 6.0;
        for &[a, b, d] in &self.triangles {
            for (first, second, other) in [(a, b, d), (b, d, a), (d, a, b)] {
                let x: Vector<f64> = moved(&self.at[other as usize], u, 3 * other as usize);
                // d(a . (b x d)) / da_i db_j = e_ijk d_k; transposed, its sign changes.
                let sign = if first > second { factor } else { -factor };
                let edge = (first.max(second) as usize, first.min(second) as usize);
                let slot = 6 * self.edges.partition_point(|&e| e < edge);
                let entries = [x[2], -x[1], -x[2], x[0], x[1], -x[0]];
                (0..6).for_each(|k| h[slot + k] += sign * entries[k]);
            }
        }
    }
}
