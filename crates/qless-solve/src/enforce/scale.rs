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
//! Cost: a few passes over the entries, and a sort where units spread.

use super::matrix::{Matrix, entries};

/// Passes that balance K, at most; definite matrices are balanced by their diagonal.
const SWEEPS: usize = 20;
/// A largest entry within this factor of one is balanced.
const EVEN: f64 = 1.5;

/// One unit per DOF, then one per equation of C; powers of two.
pub fn units(k: &Matrix, c: &Matrix) -> Vec<f64> {
    let mut units = of_stiffness(k);
    let n = units.len();
    units.resize(n + c.nrows(), 0.0);
    spread(&mut units, entries(c).map(|(i, j, v)| (n + i, j, v)));
    units.into_iter().map(|s| if s > 0.0 { power_of_two(s) } else { 1.0 }).collect()
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
    spread(&mut units, entries(k));
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

/// From those with a unit to those that have none yet, `s_i = 1 / max_j |v_ij| s_j`, a level at a time.
pub fn spread(units: &mut [f64], terms: impl Iterator<Item = (usize, usize, f64)>) {
    if units.iter().all(|unit| *unit > 0.0) {
        return;
    }
    let mut terms: Vec<_> = terms.flat_map(|(i, j, v)| [(i, j, v.abs()), (j, i, v.abs())]).collect();
    terms.sort_unstable_by_key(|&(i, ..)| i);
    let of = |i: usize| terms[terms.partition_point(|term| term.0 < i)..].iter().take_while(move |term| term.0 == i);
    let mut level: Vec<usize> = (0..units.len()).filter(|&i| units[i] > 0.0).collect();
    let mut most = vec![0.0_f64; units.len()];
    while !level.is_empty() {
        let mut next = Vec::new();
        for (i, &(_, j, v)) in level.iter().flat_map(|&i| of(i).map(move |term| (i, term))) {
            if units[j] == 0.0 && v * units[i] > 0.0 {
                next.extend((most[j] == 0.0).then_some(j));
                most[j] = most[j].max(v * units[i]);
            }
        }
        next.iter().for_each(|&j| units[j] = most[j].recip());
        level = next;
    }
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
