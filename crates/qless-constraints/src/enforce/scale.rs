//! Powers of two that take the units off: `S A S` with `S = diag(s)`, every row of which has a largest entry near 1.
//!
//! ```text
//! A = [K C^T; C 0]
//! s_j = 1 / sqrt(|K_jj|)                DOFs with stiffness: s_j u_j' = u_j, where u_j' are square roots of energy
//! s_j = 1 / max_i |K_ij| s_i            DOFs that feel those; then all are balanced
//! s_r = 1 / max_j |C_rj| s_j            equations, over DOFs that have their scale
//! s_j = 1 / max_r |C_rj| s_r            DOFs that only equations know
//! ```
//!
//! Numbers in these units can be compared, whatever the units of lengths and forces, translations and rotations are.
//! Cost: a few passes over the entries.

use super::matrix::{Matrix, entries};

/// Passes that balance K, at most; definite matrices are balanced by their diagonal.
const SWEEPS: usize = 20;
/// A largest entry within this factor of one is balanced.
const EVEN: f64 = 1.5;

/// One unit per DOF, then one per equation of C; powers of two.
pub fn units(k: &Matrix, c: &Matrix) -> Vec<f64> {
    let mut dofs = of_stiffness(k);
    let mut rows = vec![0.0; c.nrows()];
    while spread(c, &mut dofs, &mut rows) {}
    dofs.into_iter().chain(rows).map(|s| if s > 0.0 { power_of_two(s) } else { 1.0 }).collect()
}

/// Units from the stiffness of each unknown: `1 / sqrt(k_j)`.
pub fn units_of_diagonal(stiffness: &[f64]) -> Vec<f64> {
    stiffness.iter().map(|&k| if k > 0.0 { power_of_two(k.sqrt().recip()) } else { 1.0 }).collect()
}

/// Units of a square matrix that has no C.
pub fn units_of(a: &Matrix) -> Vec<f64> {
    of_stiffness(a).into_iter().map(|s| if s > 0.0 { power_of_two(s) } else { 1.0 }).collect()
}

/// Zero where K has no entry.
fn of_stiffness(k: &Matrix) -> Vec<f64> {
    let inverse_root = |v: f64| if v > 0.0 { v.sqrt().recip() } else { 0.0 };
    let (mut diagonal, mut largest) = (vec![0.0_f64; k.ncols()], vec![0.0_f64; k.ncols()]);
    for (i, j, v) in entries(k) {
        if i == j {
            diagonal[i] += v.abs();
        }
        largest[i] = largest[i].max(v.abs());
        largest[j] = largest[j].max(v.abs());
    }
    let mut units: Vec<f64> = diagonal.into_iter().map(inverse_root).collect();
    while reach(k, &mut units) {}
    units.iter_mut().zip(largest).filter(|(unit, _)| **unit == 0.0).for_each(|(unit, most)| *unit = inverse_root(most));
    for _ in 0..SWEEPS {
        let mut most = vec![0.0_f64; units.len()];
        for (i, j, v) in entries(k) {
            let v = units[i] * v.abs() * units[j];
            most[i] = most[i].max(v);
            most[j] = most[j].max(v);
        }
        if most.iter().all(|most| *most == 0.0 || (EVEN.recip()..=EVEN).contains(most)) {
            break;
        }
        units.iter_mut().zip(most).for_each(|(unit, most)| *unit *= inverse_root(most));
    }
    units
}

/// From DOFs with a unit to those that have none yet, `s_j = 1 / max_i |K_ij| s_i`; whether anything was new.
fn reach(k: &Matrix, units: &mut [f64]) -> bool {
    if units.iter().all(|unit| *unit > 0.0) {
        return false;
    }
    let mut most = vec![0.0_f64; units.len()];
    for (i, j, v) in entries(k) {
        most[i] = most[i].max(v.abs() * units[j]);
        most[j] = most[j].max(v.abs() * units[i]);
    }
    let mut found = false;
    for (unit, most) in units.iter_mut().zip(most).filter(|(unit, most)| **unit == 0.0 && *most > 0.0) {
        (*unit, found) = (most.recip(), true);
    }
    found
}

/// From DOFs to equations that have none yet, and back; whether anything was new.
fn spread(c: &Matrix, dofs: &mut [f64], rows: &mut [f64]) -> bool {
    let mut found = false;
    let mut most = vec![0.0_f64; rows.len()];
    entries(c).for_each(|(i, j, v)| most[i] = most[i].max(v.abs() * dofs[j]));
    for (row, most) in rows.iter_mut().zip(most).filter(|(row, most)| **row == 0.0 && *most > 0.0) {
        *row = most.recip();
        found = true;
    }
    let mut most = vec![0.0_f64; dofs.len()];
    entries(c).for_each(|(i, j, v)| most[j] = most[j].max(v.abs() * rows[i]));
    for (dof, most) in dofs.iter_mut().zip(most).filter(|(dof, most)| **dof == 0.0 && *most > 0.0) {
        *dof = most.recip();
        found = true;
    }
    found
}

/// The nearest one below, within the range of doubles.
fn power_of_two(s: f64) -> f64 {
    s.log2().floor().clamp(-500.0, 500.0).exp2()
}

/// The connected part of each unknown, as `(i, j)` of the entries join them.
pub fn parts(count: usize, pairs: impl Iterator<Item = (usize, usize)>) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..count).collect();
    for (i, j) in pairs {
        let (a, b) = (root(&mut parent, i), root(&mut parent, j));
        parent[a.max(b)] = a.min(b);
    }
    (0..count).map(|i| root(&mut parent, i)).collect()
}

/// The smallest member, with paths halved on the way.
pub fn root(parent: &mut [usize], mut member: usize) -> usize {
    while parent[member] != member {
        parent[member] = parent[parent[member]];
        member = parent[member];
    }
    member
}
