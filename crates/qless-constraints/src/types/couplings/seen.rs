//! The rigid motion nearest to that of a face, `argmin int |u - v - omega x r|^2 dA`, as a function of the DOFs of its nodes.

use std::collections::BTreeMap;

use super::area::Gauss;
use super::arm::axis;
use super::error::CouplingError;
use super::fit::{Fit, Observation};
use super::rows::clean;
use crate::geometry::surface::Surface;
use crate::scalar::vector::{Vector, add, scale};

/// What the points of integration see of the motion of the face.
pub struct Seen {
    points: Vec<Gauss>,
    fit: Fit,
}

impl Seen {
    pub fn new(points: Vec<Gauss>) -> Self {
        let most = points.iter().map(Gauss::weight).fold(0.0, f64::max);
        let of = |gauss: &Gauss| {
            let (at, root) = (gauss.at, (gauss.weight() / most).sqrt());
            [0, 1, 2].map(|k| Observation { at, axis: axis(k), is_rotation: false, root })
        };
        let fit = Fit::new(&points.iter().flat_map(of).collect::<Vec<_>>());
        Self { points, fit }
    }

    /// `sum_g a_g N_i(x_g)` for each DOF of the face.
    pub fn terms(
        &self,
        face: &Surface<3>,
        motion: [f64; 6],
        place: Vector<f64>,
    ) -> Result<Vec<(usize, f64)>, CouplingError> {
        let factors = self.fit.factors_of(motion, place)?;
        let mut nodes: BTreeMap<usize, Vector<f64>> = BTreeMap::new();
        for (gauss, &a) in self.points.iter().zip(factors.as_chunks::<3>().0) {
            for (&node, &function) in face.faces[gauss.face].nodes.iter().zip(&gauss.functions) {
                let sum = nodes.entry(node).or_default();
                *sum = add(*sum, scale(function, a));
            }
        }
        clean(nodes.values_mut().flatten(), self.fit.blur);
        for (k, &sum) in motion[..3].iter().enumerate() {
            complete(nodes.values_mut().map(|a| &mut a[k]), sum);
        }
        Ok(nodes.into_iter().flat_map(|(node, a)| (0..3).map(move |k| (face.nodes[node].dofs[k], a[k]))).collect())
    }
}

/// Gives what is missing to a sum to the largest: far from the origin rounding that is left out is more than that of a translation.
fn complete<'a>(parts: impl Iterator<Item = &'a mut f64>, sum: f64) {
    let parts: Vec<&mut f64> = parts.collect();
    let missing = sum - parts.iter().map(|a| **a).sum::<f64>();
    let largest = parts.into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs()));
    largest.into_iter().filter(|a| **a != 0.0).for_each(|a| *a += missing);
}
