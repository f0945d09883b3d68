//! Out of a configuration where G has lost rank: `c_k + z^T Z^T H_k Z z / 2 = 0`, second order where first order is silent.
//!
//! At such a place a row that is left out is a combination of the others, `y_k^T G = 0`, but its value is not: `y_k^T c != 0`. No du
//! changes that to first order. Within the motions `du = Z z` that the kept rows allow, it changes by
//! `z^T Z^T (sum_r y_kr H_r) Z z / 2`, the effective Hessian with the certificate as weights. With all left-out rows together,
//! weighted by `f_k = c_k / rounding_k^2`, a solution nearby needs `sum_k f_k c_k + z^T A z / 2 = 0`: a negative eigenvalue of A. If
//! there is none, that is the proof that none is near. If there is one, its vector is the way.

use faer::{Mat, Side};
use qless::{Analysis, Form, Reduction};

use super::residual::sizes_of_dofs;
use super::run::Run;
use super::step::times;
use super::{NewtonError, linearisation::Linearisation};
use crate::Quantities;

/// Krylov vectors, all of them kept: where there are fewer masters this is exact.
const VECTORS: usize = 60;
/// Eigenvalues that are negative by less, relative to the sizes of the terms, are none.
const NEGATIVE: f64 = 1e-10;

/// A motion that lessens the rows `rows`, of the length that second order gives; nothing if there is proof that none does.
pub fn way_out(
    run: &mut Run,
    analysis: &Analysis,
    rows: &[usize],
    step: usize,
) -> Result<Option<Vec<f64>>, NewtonError> {
    let argument = |source| NewtonError::Argument { step, source };
    let sizes = sizes_of_dofs(run.set, &run.place.u, &mut run.place.quantities).map_err(argument)?;
    let (weights, amount) = weights(run, analysis, rows).map_err(argument)?;
    run.set.effective_hessian(&run.place.u, &weights, &mut run.place.quantities).map_err(argument)?;
    let motions = Motions::new(run, sizes, step)?;
    let terms = |(w, rounding): (&f64, &f64)| w.abs() * rounding / f64::EPSILON;
    let scale: f64 = weights.iter().zip(run.place.rounding.c()).map(terms).filter(|t| t.is_finite()).sum();
    let Some((lowest, z)) = lowest(|z| motions.bent(&run.place.quantities, z), motions.count()).map_err(argument)?
    else {
        return Ok(None);
    };
    if lowest >= -NEGATIVE * scale {
        return Ok(None);
    }
    let length = (-2.0 * amount / lowest).sqrt();
    let z: Vec<f64> = z.iter().map(|z| length * z).collect();
    motions.upwards(&z).map(Some).map_err(argument)
}

/// `sum_k f_k y_k`, and `sum_k f_k c_k`, with f of size one.
fn weights(run: &Run, analysis: &Analysis, rows: &[usize]) -> Result<(Vec<f64>, f64), qless::ArgumentError> {
    let (c, rounding) = (run.place.quantities.c(), run.place.rounding.c());
    let raw = |&k: &usize| c[k] / rounding[k] / rounding[k];
    let most = rows.iter().map(|k| raw(k).abs()).filter(|f| f.is_finite()).fold(0.0, f64::max);
    let (mut weights, mut amount) = (vec![0.0; c.len()], 0.0);
    for &k in rows {
        let f = if raw(&k).is_finite() { raw(&k) / most } else { 0.0 };
        weights[k] += f;
        amount += f * c[k];
        for because in analysis.because(k)? {
            weights[because.row] -= f * because.coefficient;
        }
    }
    Ok((weights, amount))
}

/// `du = Z z`: what the kept rows allow, with masters measured by their sizes.
struct Motions {
    reduction: Reduction,
    sizes: Vec<f64>,
    held: Vec<f64>,
    /// `du_j = s_j y_j`, where the reduction is of y.
    units: Vec<f64>,
}

impl Motions {
    fn new(run: &Run, sizes: Vec<f64>, step: usize) -> Result<Self, NewtonError> {
        let mut still = run.place.quantities.clone();
        still.c.fill(0.0);
        let found = Linearisation::new(run.set, &still, run.prescribed, (step, run.options))?;
        let reduction = found.analysis.reduction_in(Form::Factored);
        let reduction = reduction.map_err(|source| NewtonError::Reduction { step, source })?;
        Ok(Self { reduction, sizes, held: vec![0.0; run.prescribed.len()], units: found.units })
    }

    fn count(&self) -> usize {
        self.reduction.masters().len()
    }

    fn motion(&self, z: &[f64]) -> Result<Vec<f64>, qless::ArgumentError> {
        let masters = self.reduction.masters().iter().zip(z);
        let masters: Vec<f64> = masters.map(|(&j, z)| self.sizes[j] / self.units[j] * z).collect();
        let y = self.reduction.expand(&masters, &self.held)?;
        Ok(y.iter().zip(&self.units).map(|(y, unit)| unit * y).collect())
    }

    /// `Z^T H Z z`.
    fn bent(&self, quantities: &Quantities, z: &[f64]) -> Result<Vec<f64>, qless::ArgumentError> {
        let force = times(quantities.h(), &self.motion(z)?);
        let force: Vec<f64> = force.iter().zip(&self.units).map(|(force, unit)| unit * force).collect();
        let slaves: Vec<f64> = self.reduction.slaves().iter().map(|&j| force[j]).collect();
        let back = self.reduction.apply_transposed(&slaves)?;
        let masters = self.reduction.masters().iter().zip(back);
        Ok(masters.map(|(&j, back)| self.sizes[j] / self.units[j] * (force[j] + back)).collect())
    }

    /// The motion or its opposite: that in which the DOF that moves most increases.
    fn upwards(&self, z: &[f64]) -> Result<Vec<f64>, qless::ArgumentError> {
        let du = self.motion(z)?;
        let by_size = du.iter().zip(&self.sizes).map(|(du, size)| if *size > 0.0 { du / size } else { 0.0 });
        let most = by_size.fold(0.0, |most: f64, x| if x.abs() > most.abs() { x } else { most });
        Ok(du.iter().map(|du| du * most.signum()).collect())
    }
}

/// The lowest eigenvalue of a symmetric operator on n numbers, and its vector of length one, by Lanczos' method; nothing for n = 0.
fn lowest<E>(apply: impl Fn(&[f64]) -> Result<Vec<f64>, E>, n: usize) -> Result<Option<(f64, Vec<f64>)>, E> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut images: Vec<Vec<f64>> = Vec::new();
    let mut next: Vec<f64> = (0..n as u64).map(super::redundancy::random).collect();
    while basis.len() < n.min(VECTORS) {
        let before = norm(&next);
        (0..2).for_each(|_| basis.iter().for_each(|b| subtract(&mut next, b)));
        let size = norm(&next);
        if size.is_nan() || size <= 1e-10 * before {
            break;
        }
        next.iter_mut().for_each(|x| *x /= size);
        let image = apply(&next)?;
        basis.push(std::mem::replace(&mut next, image.clone()));
        images.push(image);
    }
    let k = basis.len();
    if k == 0 {
        return Ok(None);
    }
    let projected = Mat::from_fn(k, k, |i, j| dot(&basis[i], &images[j]));
    let Ok(eigen) = projected.self_adjoint_eigen(Side::Lower) else { return Ok(None) };
    let smallest = (0..k).min_by(|&a, &b| eigen.S()[a].total_cmp(&eigen.S()[b]));
    Ok(smallest.map(|i| {
        let mut z = vec![0.0; n];
        for (j, b) in basis.iter().enumerate() {
            z.iter_mut().zip(b).for_each(|(z, b)| *z += eigen.U()[(j, i)] * b);
        }
        (eigen.S()[i], z)
    }))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Takes from `a` its part along `b`, of length one.
fn subtract(a: &mut [f64], b: &[f64]) {
    let part = dot(a, b);
    a.iter_mut().zip(b).for_each(|(a, b)| *a -= part * b);
}
