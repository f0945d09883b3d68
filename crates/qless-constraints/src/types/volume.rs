//! `c = (V(x) - V_0) / V_0^(2/3)`: a patch of tetrahedra with constant volume `V = sum a . (b x d) / 6` over triangles with corners a, b,
//! d.
//!
//! The triangles are the outer faces of the patch (divergence theorem). The divisor makes c a length.

use std::collections::HashMap;

use crate::geometry::node::{Point, moved};
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, cross, dot, norm, sub};
use crate::{Constraint, EquationSink, Nonlinear};

/// A patch of tetrahedra with constant volume, one equation.
///
#[doc = include_str!("../../docs/pictures/volume.svg")]
///
#[doc = include_str!("../../docs/types/volume.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Point, Volume}};
/// let at = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let nodes = (0..4).map(|i| Point::new([3 * i, 3 * i + 1, 3 * i + 2], at[i])).collect();
/// let mut builder = ConstraintSet::builder(12);
/// builder.add("cell", Volume { nodes, tetrahedra: vec![[0, 1, 2, 3]] })?;
/// let set = builder.build()?;
/// let mut evaluation = set.allocate();
/// // The tip moves at constant height: the volume stays.
/// let mut u = [0.0; 12];
/// u[9] = 0.4;
/// set.evaluate(&u, &mut evaluation)?;
/// assert!(evaluation.c()[0].abs() < 1e-16);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// The nodes of the patch.
    pub nodes: Vec<Point>,
    /// Tetrahedra as indices into the nodes. Seen from corner 4, the corners 1, 2, 3 are counter-clockwise.
    pub tetrahedra: Vec<[usize; 4]>,
}

/// What can be wrong with a patch.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VolumeError {
    /// A tetrahedron names a missing node.
    #[error("tetrahedron {tetrahedron}, from 1, names node {node} (from 0), but the patch has {nodes}")]
    NoNode {
        /// Number of the tetrahedron, counted from 1.
        tetrahedron: usize,
        /// Number of the node, counted from 0.
        node: usize,
        /// Number of nodes of the patch.
        nodes: usize,
    },
    /// A tetrahedron is inverted, or flat up to the rounding of its coordinates.
    #[error(
        "tetrahedron {tetrahedron}, from 1, has volume {volume}; it must be positive, and more than the rounding of its coordinates: \
         correct its corners or their order"
    )]
    Inverted {
        /// Number of the tetrahedron, counted from 1.
        tetrahedron: usize,
        /// Volume of the tetrahedron.
        volume: f64,
    },
    /// Two tetrahedra lie on the same side of a common face: they overlap, or are the same tetrahedron.
    #[error(
        "tetrahedra {first} and {second}, from 1, lie on the same side of their common face; remove one, or correct its corners"
    )]
    Overlap {
        /// Number of one tetrahedron, counted from 1.
        first: usize,
        /// Number of the other tetrahedron, counted from 1.
        second: usize,
    },
    /// No tetrahedra.
    #[error("the patch has no tetrahedra; give at least one")]
    Empty,
}

impl Volume {
    /// Checks the tetrahedra and returns the volume of the patch at u = 0.
    fn volume(&self) -> Result<f64, VolumeError> {
        let mut total = 0.0;
        for (t, corners) in self.tetrahedra.iter().enumerate() {
            let tetrahedron = t + 1;
            if let Some(&node) = corners.iter().find(|&&node| node >= self.nodes.len()) {
                return Err(VolumeError::NoNode { tetrahedron, node, nodes: self.nodes.len() });
            }
            let (volume, least) = volume(corners.map(|node| self.nodes[node].at));
            if !(volume > least && volume.is_finite()) {
                return Err(VolumeError::Inverted { tetrahedron, volume });
            }
            total += volume;
        }
        if self.tetrahedra.is_empty() { Err(VolumeError::Empty) } else { Ok(total) }
    }

    /// Faces that belong to only one tetrahedron, oriented outwards, in the order of the tetrahedra.
    ///
    /// A face that two tetrahedra share occurs in both orientations and is left out. The remaining faces form a closed
    /// surface.
    fn outer_faces(&self) -> Result<Vec<[usize; 3]>, VolumeError> {
        let faces = |&[a, b, c, d]: &[usize; 4]| [[a, c, b], [a, b, d], [b, c, d], [c, a, d]].map(smallest_first);
        let all: Vec<[usize; 3]> = self.tetrahedra.iter().flat_map(faces).collect();
        let mut owner: HashMap<[usize; 3], usize> = HashMap::with_capacity(all.len());
        for (number, &face) in all.iter().enumerate() {
            let second = number / 4 + 1;
            if let Some(first) = owner.insert(face, second) {
                return Err(VolumeError::Overlap { first, second });
            }
        }
        Ok(all.into_iter().filter(|&[a, b, c]| !owner.contains_key(&[a, c, b])).collect())
    }
}

/// The same oriented face, with its smallest node first.
fn smallest_first([a, b, c]: [usize; 3]) -> [usize; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Volume of a tetrahedron, and the volume that rounding can give to a flat one.
fn volume([a, b, c, d]: [Vector<f64>; 4]) -> (f64, f64) {
    let [ab, ac, ad] = [b, c, d].map(|x| sub(x, a));
    let place = [a, b, c, d].into_iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
    let areas = norm(cross(ab, ac)) + norm(cross(ac, ad)) + norm(cross(ad, ab));
    (dot(cross(ab, ac), ad) / 6.0, f64::EPSILON * place * areas / 3.0)
}

impl Constraint for Volume {
    const NAME: &'static str = "constant volume";
    type Error = VolumeError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), VolumeError> {
        let volume = self.volume()?;
        let faces = self.outer_faces()?;
        let mut used: Vec<usize> = faces.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let place = |node: usize| used.partition_point(|&u| u < node) as u32;
        let triangles: Vec<[u32; 3]> = faces.iter().map(|face| face.map(place)).collect();
        // Coordinates relative to a node of the patch avoid cancellation far from the origin.
        let origin = self.nodes[used[0]].at;
        let at = used.iter().map(|&node| sub(self.nodes[node].at, origin)).collect();
        let dofs: Vec<usize> = used.iter().flat_map(|&node| self.nodes[node].dofs).collect();
        sink.length(volume.cbrt());
        used.iter().for_each(|&node| sink.coordinates_of(&self.nodes[node]));
        sink.nonlinear("", &dofs, ClosedSurface::new(at, triangles, volume));
        Ok(())
    }
}

/// The parameters of [`Volume`]: a closed surface of triangles.
pub(super) struct ClosedSurface {
    at: Vec<Vector<f64>>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<(usize, usize)>,
    volume: f64,
    scale: f64,
}

impl ClosedSurface {
    /// `at` are coordinates relative to one node of the patch; `volume` is the volume at u = 0.
    pub fn new(at: Vec<Vector<f64>>, triangles: Vec<[u32; 3]>, volume: f64) -> Self {
        let edges = edges(&triangles);
        Self { at, triangles, edges, volume, scale: volume.powf(-2.0 / 3.0) }
    }
}

/// Edges between nodes, without repetition, ascending, the larger node first.
fn edges(triangles: &[[u32; 3]]) -> Vec<(usize, usize)> {
    let sides = |&[a, b, d]: &[u32; 3]| [(a, b), (b, d), (d, a)];
    let ordered = |(a, b): (u32, u32)| (a.max(b) as usize, a.min(b) as usize);
    let mut edges: Vec<_> = triangles.iter().flat_map(sides).map(ordered).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

impl Nonlinear for ClosedSurface {
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let x = |node: u32| moved(&self.at[node as usize], u, 3 * node as usize);
        let six = self.triangles.iter().fold(S::from(0.0), |sum, &[a, b, d]| sum + dot(x(a), cross(x(b), x(d))));
        c[0] = (six / S::from(6.0) - S::from(self.volume)) * S::from(self.scale);
    }

    /// H couples different coordinates of two nodes that an edge joins.
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

    /// The volume V has the derivative `dV / da = sum b x d / 6` over the triangles `(a, b, d)` at the corner a.
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
                // d(a . (b x d)) / da_i db_j = e_ijk d_k; the transposed entry has the opposite sign.
                let sign = if first > second { factor } else { -factor };
                let edge = (first.max(second) as usize, first.min(second) as usize);
                let slot = 6 * self.edges.partition_point(|&e| e < edge);
                let entries = [x[2], -x[1], -x[2], x[0], x[1], -x[0]];
                (0..6).for_each(|k| h[slot + k] += sign * entries[k]);
            }
        }
    }
}
