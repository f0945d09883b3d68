//! `min_q sum_k w_k (u_k - d_k . q)^2`: the rigid motion `q = (v, omega)` that fits observed displacements best.
//!
//! q is the motion at the centre of the observations, with rotations scaled to lengths. D is the matrix with the rows
//! `d_k`, and `A = diag(sqrt w) D = U S V^T`. Then a component `p . q` of the best fit is `sum_k a_k u_k` with
//! `a = diag(sqrt w) U S^-1 V^T p`. Motions whose singular value is only rounding are undetermined.

use std::collections::BTreeMap;

use super::error::CouplingError;
use super::face_integrals::GaussPoint;
use super::node6::Component;
use super::rigid_motion::{about, along, arm};
use super::svd::{JacobiSvd, svd};
use crate::geometry::surface::Surface;
use crate::scalar::vector::{Vector, add, axis, cross, hypot, scale};
use crate::scalar::{HALF_DIGITS, clean, complete};

/// Rounding error of an arm (a vector from the centre to a point), relative to the largest coordinate. Computing an arm takes a few
/// operations on coordinates.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// One observed component of the motion of a point.
#[derive(Clone, Copy)]
pub struct MotionObservation {
    pub at: Vector<f64>,
    /// Direction of the translation, or axis of the rotation.
    pub axis: Vector<f64>,
    pub is_rotation: bool,
    /// Square root of the weight; for a rotation, multiplied by a length.
    pub root: f64,
}

/// The best fit: a linear function of the observed components.
pub struct RigidMotionFit {
    factors: JacobiSvd,
    roots: Vec<f64>,
    centre: Vector<f64>,
    /// The length by which rotations are multiplied, so that all six components of the motion are lengths.
    length: f64,
    /// Largest singular value that counts as zero. As a result, nodes count as on a line if they deviate from it by less than about 1e-8 of
    /// its length.
    least: f64,
    /// Size of the coordinates divided by the size of the arms (the vectors from the centre), at least 1. The rounding of coordinates grows
    /// by this factor, relative to the arms.
    pub blur: f64,
}

impl RigidMotionFit {
    /// Fits m observations. Cost: O(m).
    pub fn new(observations: &[MotionObservation]) -> Self {
        let (centre, size) = centre(observations);
        let spread = observations.iter().map(|o| hypot(arm_from(o.at, centre, size))).fold(0.0, f64::max);
        let unit = if spread > 0.0 { spread } else { 1.0 };
        let mut rows: Vec<[f64; 6]> = observations.iter().map(|o| row(o, arm_from(o.at, centre, size), unit)).collect();
        let balance = balance(&rows);
        rows.iter_mut().for_each(|row| row[3..].iter_mut().for_each(|x| *x *= balance));
        let factors = svd(rows);
        let blur = if spread > 0.0 { (size / spread).max(1.0) } else { 1.0 };
        let least = HALF_DIGITS.max(ROUNDING * blur).min(0.5) * factors.values.iter().copied().fold(0.0, f64::max);
        let roots = observations.iter().map(|o| o.root).collect();
        Self { factors, roots, centre, length: unit / balance, least, blur }
    }

    /// Returns the factors `a_k` of `motion . q = sum_k a_k u_k`, where q is the fitted motion at `place` and `u_k` are the observations.
    pub fn factors_of(&self, motion: [f64; 6], place: Vector<f64>) -> Result<Vec<f64>, CouplingError> {
        let p = self.about_centre(motion, place);
        let v = |j: usize| (0..6).map(|i| self.factors.v[i][j] * p[i]).sum::<f64>();
        // Written so that NaN counts as undetermined.
        let determined = |j: &usize| self.factors.values[*j] > self.least;
        let undetermined: Vec<usize> = (0..6).filter(|j| !determined(j)).collect();
        let missed = undetermined.iter().fold(0.0, |sum: f64, &j| sum.hypot(v(j)));
        let whole = p.iter().fold(0.0, |sum: f64, x| sum.hypot(*x));
        if missed > HALF_DIGITS.max(ROUNDING * self.blur) * whole || missed.is_nan() {
            return Err(self.undetermined_error(motion, place, &undetermined, v));
        }
        let factor: [f64; 6] = std::array::from_fn(|j| {
            if determined(&j) { v(j) / self.factors.values[j] / self.factors.values[j] } else { 0.0 }
        });
        let coefficient = |(row, root): (&[f64; 6], &f64)| root * (0..6).map(|j| row[j] * factor[j]).sum::<f64>();
        Ok(self.factors.scaled.iter().zip(&self.roots).map(coefficient).collect())
    }

    /// `motion . q(place)` in terms of the motion `(v, omega)` of the centre, with the rotation omega scaled to a length. With
    /// `motion = (d, t)` and the arm a from the centre: `d . (v + omega x a) + t . omega = d . v + (a x d + t) . omega`.
    fn about_centre(&self, [a, b, c, d, e, f]: [f64; 6], place: Vector<f64>) -> [f64; 6] {
        let turn = add(cross(arm(place, self.centre), [a, b, c]), [d, e, f]);
        [a, b, c, turn[0] / self.length, turn[1] / self.length, turn[2] / self.length]
    }

    /// Makes the error for a motion that is not determined. The error names the undetermined motion of the reference that changes
    /// `motion . q` most.
    fn undetermined_error(
        &self,
        motion: [f64; 6],
        place: Vector<f64>,
        undetermined: &[usize],
        v: impl Fn(usize) -> f64,
    ) -> CouplingError {
        let q: [f64; 6] = std::array::from_fn(|i| undetermined.iter().map(|&j| self.factors.v[i][j] * v(j)).sum());
        let rotation = [q[3], q[4], q[5]];
        let shift = cross(rotation, scale(1.0 / self.length, arm(place, self.centre)));
        let translation = add([q[0], q[1], q[2]], shift);
        let size = hypot(translation).hypot(hypot(rotation));
        let (translation, rotation) = (scale(1.0 / size, translation), scale(1.0 / size, rotation));
        let most = |a: &Component, b: &Component| motion[*a as usize].abs().total_cmp(&motion[*b as usize].abs());
        let component = Component::ALL.into_iter().max_by(|a, b| most(a, b)).unwrap_or(Component::X);
        CouplingError::Undetermined { component, translation, rotation }
    }
}

/// Returns the weighted mean of the positions of observed translations, and the largest magnitude of a coordinate. The mean is computed
/// relative to the first position, which keeps its digits far from the origin.
fn centre(observations: &[MotionObservation]) -> (Vector<f64>, f64) {
    let Some(first) = observations.first() else { return ([0.0; 3], 0.0) };
    let most = observations.iter().fold(0.0, |most: f64, o| most.max(o.root));
    let weight = |o: &MotionObservation| (o.root / most).powi(2);
    let is_translation = |o: &&MotionObservation| !o.is_rotation;
    // The centre matters only for translations, since they depend on arms. Without translations, any centre will do.
    let total: f64 = observations.iter().filter(is_translation).map(weight).sum();
    let part = |o: &MotionObservation| scale(weight(o) / total, arm(o.at, first.at));
    let mean =
        if total > 0.0 { observations.iter().filter(is_translation).map(part).fold([0.0; 3], add) } else { [0.0; 3] };
    let size = observations.iter().flat_map(|o| o.at).fold(0.0, |most: f64, x| most.max(x.abs()));
    (add(first.at, mean), size)
}

/// The arm from the centre. Components that are only rounding are zero.
fn arm_from(at: Vector<f64>, centre: Vector<f64>, size: f64) -> Vector<f64> {
    arm(at, centre).map(|x| if x.abs() <= ROUNDING / 4.0 * size { 0.0 } else { x })
}

fn row(observation: &MotionObservation, r: Vector<f64>, unit: f64) -> [f64; 6] {
    let [a, b, c, d, e, f] = if observation.is_rotation { about(observation.axis) } else { along(observation.axis, r) };
    [a, b, c, d / unit, e / unit, f / unit].map(|x| observation.root * x)
}

/// The factor that gives rotations the same total weight as translations, so that the matrix is well conditioned.
fn balance(rows: &[[f64; 6]]) -> f64 {
    let size = |columns: std::ops::Range<usize>| {
        rows.iter().flat_map(|row| &row[columns.clone()]).fold(0.0, |sum: f64, x| sum.hypot(*x))
    };
    let (translations, rotations) = (size(0..3), size(3..6));
    if translations > 0.0 && rotations > 0.0 { translations / rotations } else { 1.0 }
}

/// The mean rigid motion of a face, `argmin int |u - v - omega x r|^2 dA`, as a function of the DOFs of its nodes.
pub struct MeanRigidMotion {
    points: Vec<GaussPoint>,
    fit: RigidMotionFit,
}

impl MeanRigidMotion {
    pub fn new(points: Vec<GaussPoint>) -> Self {
        let most = points.iter().map(GaussPoint::weight).fold(0.0, f64::max);
        let observe = |gauss: &GaussPoint| {
            let (at, root) = (gauss.at, (gauss.weight() / most).sqrt());
            [0, 1, 2].map(|k| MotionObservation { at, axis: axis(k), is_rotation: false, root })
        };
        let fit = RigidMotionFit::new(&points.iter().flat_map(observe).collect::<Vec<_>>());
        Self { points, fit }
    }

    /// Terms of `motion . q`, where q is the mean motion at `place`: `sum_g a_g N_i(x_g)` for each DOF of the face, with the factors `a_g`
    /// of the quadrature points `x_g`.
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
        // Far from the origin, `clean` also drops entries that change the sums noticeably. So the sums are corrected: then translations of
        // the face stay exact.
        for (k, &sum) in motion[..3].iter().enumerate() {
            complete(nodes.values_mut().map(|a| &mut a[k]), sum);
        }
        Ok(nodes.into_iter().flat_map(|(node, a)| (0..3).map(move |k| (face.nodes[node].dofs[k], a[k]))).collect())
    }
}
