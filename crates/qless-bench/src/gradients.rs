//! Conjugate gradients (Hestenes and Stiefel 1952) for the two systems `S x = r` of a large problem of springs.
//!
//! Both matrices S are products of sparse matrices. They are not formed, because their factorization would fill in.

use qless::{ConstraintSystem, Csr, Reduction};

use super::chain::{Chain, times};

/// Limit for the steps; more would mean that the condition number is too large.
const STEPS: usize = 1_000;

/// x with `|S x - r| <= tolerance |r|` for a symmetric positive definite S; `None` without convergence.
fn solve(apply: impl Fn(&[f64]) -> Vec<f64>, r: &[f64], tolerance: f64) -> Option<Vec<f64>> {
    let (mut x, mut rest, mut way) = (vec![0.0; r.len()], r.to_vec(), r.to_vec());
    let mut square = dot(&rest, &rest);
    let enough = tolerance * tolerance * square;
    for _ in 0..STEPS {
        if square <= enough {
            return Some(x);
        }
        let image = apply(&way);
        let step = square / dot(&way, &image);
        add(&mut x, step, &way);
        add(&mut rest, -step, &image);
        let before = std::mem::replace(&mut square, dot(&rest, &rest));
        way.iter_mut().zip(&rest).for_each(|(way, rest)| *way = rest + square / before * *way);
    }
    None
}

/// Relative residual at which conjugate gradients stop for the multipliers; `spring.rs` refines the solution afterwards.
const OF_MULTIPLIERS: f64 = 1e-10;
/// Relative residual at which conjugate gradients stop for the masters; nothing refines that solution.
const OF_MASTERS: f64 = 1e-16;

/// Solves `K du + C^T dl = left`, `C du = apart` for du and dl: first `C K^-1 C^T dl = C K^-1 left - apart` by conjugate gradients, then
/// du. Prescribed DOFs have du = 0, and their equations of K are left out. The rows of C are scaled to length 1.
pub fn with_multipliers(
    k: &Chain,
    system: &ConstraintSystem,
    left: &[f64],
    apart: &[f64],
) -> Option<(Vec<f64>, Vec<f64>)> {
    let c = system.matrix();
    let free = k.free();
    let product = |x: &[f64]| -> Vec<f64> {
        (0..c.rows()).map(|i| c.row(i).filter(|&(j, _)| free[j]).map(|(j, v)| v * x[j]).sum()).collect()
    };
    let length = |i: usize| c.row(i).filter(|&(j, _)| free[j]).map(|(_, v)| v * v).sum::<f64>().sqrt();
    let scale: Vec<f64> = (0..c.rows()).map(|i| 1.0 / length(i)).collect();
    let scaled = |x: &[f64]| -> Vec<f64> { x.iter().zip(&scale).map(|(x, scale)| x * scale).collect() };
    let apply = |x: &[f64]| scaled(&product(&k.solve(&transposed(c, &scaled(x)))));
    let mut rest = product(&k.solve(left));
    add(&mut rest, -1.0, apart);
    let multipliers = scaled(&solve(apply, &scaled(&rest), OF_MULTIPLIERS)?);
    let mut pull = left.to_vec();
    add(&mut pull, -1.0, &transposed(c, &multipliers));
    Some((k.solve(&pull), multipliers))
}

/// u with `u_s = T u_q + G u_p + g` and `T*^T (K u - f) = 0`. T* is T together with identity rows for the masters.
pub fn with_masters(f: &[f64], reduction: &Reduction, prescribed: &[f64]) -> Option<Vec<f64>> {
    let at_rest = reduction.expand(&vec![0.0; reduction.masters().len()], prescribed).ok()?;
    let moved = |q: &[f64]| -> Vec<f64> {
        let mut u = vec![0.0; at_rest.len()];
        reduction.masters().iter().zip(q).for_each(|(&j, &q)| u[j] = q);
        let row = |i: usize| reduction.t().row(i).map(|(j, v)| v * q[j]).sum();
        reduction.slaves().iter().enumerate().for_each(|(i, &j)| u[j] = row(i));
        u
    };
    let gathered = |force: &[f64]| -> Vec<f64> {
        let of_slaves: Vec<f64> = reduction.slaves().iter().map(|&j| force[j]).collect();
        let mut sum = transposed(reduction.t(), &of_slaves);
        sum.iter_mut().zip(reduction.masters()).for_each(|(sum, &j)| *sum += force[j]);
        sum
    };
    let mut rest = f.to_vec();
    add(&mut rest, -1.0, &times(&at_rest));
    let q = solve(|q| gathered(&times(&moved(q))), &gathered(&rest), OF_MASTERS)?;
    reduction.expand(&q, prescribed).ok()
}

/// `C^T x`.
fn transposed(c: &Csr, x: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; c.cols()];
    for (i, x) in x.iter().enumerate() {
        c.row(i).for_each(|(j, v)| sum[j] += v * x);
    }
    sum
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Adds `factor b` to a.
fn add(a: &mut [f64], factor: f64, b: &[f64]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
}
