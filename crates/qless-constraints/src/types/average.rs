//! `min sum_i w_i |u_i - u_r - theta x r_i|^2`: a reference node that follows the weighted average of others (RBE3).
//!
//! Its conditions for `u_r` and `theta` are the equations: `sum_i w_i e_i = 0` and `sum_i w_i r_i x e_i = 0` with
//! `e_i = u_i - u_r - theta x r_i`, `r_i = X_i - X_r`. They add no stiffness, and spread a load on the reference.

use crate::geometry::node::{AXES, Point};
use crate::scalar::vector::{Vector, cross, dot, scale, sub};
use crate::{Constraint, Store};

/// A weighted average.
///
#[doc = include_str!("../../docs/pictures/average.svg")]
///
#[doc = include_str!("../../docs/types/average.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Average, Point}};
/// let at = |node: usize, x: f64, y: f64| Point::new([3 * node, 3 * node + 1, 3 * node + 2], [x, y, 0.0]);
/// let nodes = vec![(at(2, 0.0, 0.0), 1.0), (at(3, 1.0, 0.0), 1.0), (at(4, 0.0, 1.0), 2.0)];
/// let mut builder = ConstraintSet::builder(15);
/// builder.add("load", Average { reference: at(0, 0.3, 0.3), rotations: [3, 4, 5], nodes })?;
/// assert_eq!(builder.build()?.equations(), 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Average {
    /// The node that follows.
    pub reference: Point,
    /// theta, its rotations, in radians.
    pub rotations: [usize; 3],
    /// The nodes that lead, with their weights.
    pub nodes: Vec<(Point, f64)>,
}

/// What can be wrong with an average.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AverageError {
    /// A weight is not a positive number.
    #[error("weight {node}, from 1, is {weight}; weights must be positive")]
    Weight {
        /// The node, from 1.
        node: usize,
        /// Its weight.
        weight: f64,
    },
    /// The nodes lie in a line, or there are fewer than three.
    #[error("the {nodes} nodes lie in a line or in one place, so that their rotation is not defined")]
    InLine {
        /// How many there are.
        nodes: usize,
    },
}

impl Average {
    fn check(&self) -> Result<(), AverageError> {
        for (i, &(_, weight)) in self.nodes.iter().enumerate() {
            if !(weight > 0.0 && weight.is_finite()) {
                return Err(AverageError::Weight { node: i + 1, weight });
            }
        }
        let in_line = self.farthest_from_line().is_none_or(|(breadth, length)| breadth <= 1e-8 * length);
        if in_line { Err(AverageError::InLine { nodes: self.nodes.len() }) } else { Ok(()) }
    }

    /// Greatest distance from the line through the first node and the one farthest from it, and the length of that line.
    fn farthest_from_line(&self) -> Option<(f64, f64)> {
        let (first, _) = self.nodes.first()?;
        let arms: Vec<Vector<f64>> = self.nodes.iter().map(|(node, _)| sub(node.at, first.at)).collect();
        let far = arms.iter().max_by(|a, b| dot(**a, **a).total_cmp(&dot(**b, **b)))?;
        let length = dot(*far, *far).sqrt();
        let beside = |arm: &Vector<f64>| {
            let off = cross(scale(1.0 / length, *far), *arm);
            dot(off, off).sqrt()
        };
        (length > 0.0).then(|| (arms.iter().map(beside).fold(0.0, f64::max), length))
    }
}

/// `(theta x r)_axis = sum_k spin[axis][k] theta_k`.
fn spin(r: Vector<f64>) -> [Vector<f64>; 3] {
    [[0.0, r[2], -r[1]], [-r[2], 0.0, r[0]], [r[1], -r[0], 0.0]]
}

impl Constraint for Average {
    const NAME: &'static str = "weighted average";
    type Error = AverageError;

    fn process(self, store: &mut Store) -> Result<(), AverageError> {
        self.check()?;
        let mut force: [Vec<(usize, f64)>; 3] = Default::default();
        let mut moment: [Vec<(usize, f64)>; 3] = Default::default();
        for (node, weight) in &self.nodes {
            let r = sub(node.at, self.reference.at);
            let turn = spin(r);
            for axis in 0..3 {
                // Terms of w_i e_i along the axis.
                let mut error = vec![(node.dofs[axis], *weight), (self.reference.dofs[axis], -weight)];
                error.extend((0..3).map(|k| (self.rotations[k], -weight * turn[axis][k])));
                // (r x e)_row = -(e x r)_row = -sum_k spin[row][k] e_k.
                for row in (0..3).filter(|&row| row != axis) {
                    moment[row].extend(error.iter().map(|&(dof, v)| (dof, -turn[row][axis] * v)));
                }
                force[axis].extend(error);
            }
        }
        for (what, rows) in [("translation", force), ("rotation", moment)] {
            for (axis, terms) in rows.into_iter().enumerate() {
                store.equation(format!("{what} {}", AXES[axis]), terms, 0.0);
            }
        }
        Ok(())
    }
}
