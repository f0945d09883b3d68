//! Scales that make `A = [K C^T; C 0]` dimensionless: powers of two `S = diag(2^e)` such that the largest entry in every row of `S A S` is
//! near 1.
//!
//! ```text
//! s_j = 1 / sqrt(|K_jj|)                DOFs with stiffness: s_j u_j' = u_j, where u_j' are square roots of energy
//! s_j = 1 / max_i |K_ij| s_i            DOFs that K couples to these; then all are balanced
//! s_r = 1 / max_j |C_rj| s_j            equations, over DOFs that have a scale by now
//! s_j = 1 / max_r |C_rj| s_r            DOFs that occur in equations only
//! ```
//!
//! Scaled numbers can be compared, whatever the units of length, force, translation and rotation are, and their products stay in the range
//! of doubles. Powers of two change no digit. Cost: a few passes over the entries, and a sort if scales spread along equations.
//!
//! A connected part of K without a diagonal entry leaves scales open: in `[0 K_01; K_10 0]`, any s_0 fits with `s_1 = 1 / (|K_01| s_0)`.
//! Such DOFs have no known unit ([`known_units`]), and numbers of two of them cannot be compared.

use qless::common::DisjointSets;

/// An entry of a matrix: `(row, column, value)`.
pub type Entry = (usize, usize, f64);
/// A nonzero entry of a matrix: `(row, column, log2 of the size)`.
type Power = (usize, usize, f64);

/// Largest number of passes that balance K. Each pass halves the exponents by which rows are out of balance; exponents are below 2^11.
/// Definite matrices need one pass.
const SWEEPS: usize = 20;
/// The exponent of a DOF without a scale.
const NONE: f64 = f64::NEG_INFINITY;

/// The exponents of the scales of the n DOFs, then of the m equations of C.
pub fn scales(k: impl Iterator<Item = Entry>, c: impl Iterator<Item = Entry>, (n, m): (usize, usize)) -> Vec<i32> {
    let mut scale = of_stiffness(&powers(k), n);
    scale.resize(n + m, NONE);
    spread(&mut scale, &powers(c.map(|(i, j, v)| (n + i, j, v))));
    scale.into_iter().map(|s| if s == NONE { 0 } else { s.floor() as i32 }).collect()
}

fn powers(entries: impl Iterator<Item = Entry>) -> Vec<Power> {
    entries.filter(|&(_, _, v)| v != 0.0).map(|(i, j, v)| (i, j, v.abs().log2())).collect()
}

/// Exponents of scales from K alone; a DOF without an entry in K gets none.
fn of_stiffness(k: &[Power], n: usize) -> Vec<f64> {
    let mut scale = vec![NONE; n];
    k.iter().filter(|(i, j, _)| i == j).for_each(|&(i, _, e)| scale[i] = -0.5 * e);
    spread(&mut scale, k);
    let largest = largest_of_rows(k, n, |_, _, e| e);
    let missing = scale.iter_mut().zip(largest).filter(|(s, most)| **s == NONE && *most != NONE);
    missing.for_each(|(s, most)| *s = -0.5 * most);
    for _ in 0..SWEEPS {
        let most = largest_of_rows(k, n, |i, j, e| scale[i] + e + scale[j]);
        // Scales are rounded to whole exponents in the end, so that a finer balance is useless.
        if most.iter().all(|e| *e == NONE || e.abs() <= 0.5) {
            break;
        }
        scale.iter_mut().zip(most).filter(|(_, most)| *most != NONE).for_each(|(s, most)| *s -= 0.5 * most);
    }
    scale
}

/// The largest `size(i, j, e)` in each row and its column.
fn largest_of_rows(k: &[Power], n: usize, size: impl Fn(usize, usize, f64) -> f64) -> Vec<f64> {
    let mut most = vec![NONE; n];
    for &(i, j, e) in k {
        let e = size(i, j, e);
        most[i] = most[i].max(e);
        most[j] = most[j].max(e);
    }
    most
}

/// Gives each row i without a scale `s_i = 1 / max_j |v_ij| s_j` from its neighbours j with a scale, breadth first; v are the terms.
fn spread(scale: &mut [f64], terms: &[Power]) {
    if !scale.contains(&NONE) {
        return;
    }
    let mut terms: Vec<_> = terms.iter().flat_map(|&(i, j, e)| [(i, j, e), (j, i, e)]).collect();
    terms.sort_unstable_by_key(|&(i, ..)| i);
    let of = |i: usize| terms[terms.partition_point(|term| term.0 < i)..].iter().take_while(move |term| term.0 == i);
    let mut level: Vec<usize> = (0..scale.len()).filter(|&i| scale[i] != NONE).collect();
    let mut most = vec![NONE; scale.len()];
    while !level.is_empty() {
        let mut next = Vec::new();
        for (i, &(_, j, e)) in level.iter().flat_map(|&i| of(i).map(move |term| (i, term))) {
            if scale[j] == NONE {
                next.extend((most[j] == NONE).then_some(j));
                most[j] = most[j].max(e + scale[i]);
            }
        }
        next.iter().for_each(|&j| scale[j] = -most[j]);
        level = next;
    }
}

/// e with `2^e <= |v| < 2^(e + 1)`; -1023 for zero and numbers below the normal range.
pub fn power(v: f64) -> i32 {
    (v.to_bits() >> 52 & 0x7ff) as i32 - 1023
}

/// `v 2^e`, in two steps, since 2^e may leave the range of doubles.
pub fn times_power(v: f64, e: i32) -> f64 {
    let two_to = |e: i32| f64::from_bits(((e.clamp(-1022, 1023) + 1023) as u64) << 52);
    let half = e.div_euclid(2);
    v * two_to(half) * two_to(e - half)
}

/// The smallest unknown of each unknown's connected part; each pair `(i, j)` connects two unknowns.
pub fn parts(count: usize, pairs: impl Iterator<Item = (usize, usize)>) -> Vec<usize> {
    let mut sets = DisjointSets::new(count);
    pairs.for_each(|(i, j)| sets.join(i, j));
    (0..count).map(|i| sets.root(i)).collect()
}

/// For each DOF, whether its unit is known; then for each equation, whether the units of all its DOFs are known, so that its multiplier has
/// a known unit too.
///
/// A diagonal entry of K determines the unit of its DOF and of all DOFs in the same connected part of K. Equations determine the units of
/// DOFs without stiffness from those of their other DOFs. If K is zero, all units count as known.
pub fn known_units(
    k: impl Iterator<Item = Entry>,
    c: impl Iterator<Item = Entry>,
    (n, m): (usize, usize),
) -> Vec<bool> {
    let mut known = vec![true; n + m];
    let stiff: Vec<_> = k.filter(|&(_, _, v)| v != 0.0).map(|(i, j, _)| (i, j)).collect();
    if stiff.is_empty() {
        return known;
    }
    let (part, mut alone, mut has_diagonal) = (parts(n, stiff.iter().copied()), vec![true; n], vec![false; n]);
    stiff.iter().for_each(|&(i, j)| (alone[i], alone[j]) = (false, false));
    stiff.iter().filter(|(i, j)| i == j).for_each(|&(i, _)| has_diagonal[part[i]] = true);
    (0..n).for_each(|j| known[j] = has_diagonal[part[j]]);
    let terms: Vec<_> = c.filter(|&(_, _, v)| v != 0.0).map(|(i, j, _)| (n + i, j)).collect();
    let part = parts(n + m, terms.iter().copied().filter(|&(_, j)| alone[j]));
    let mut has_known = vec![false; n + m];
    terms.iter().filter(|(_, j)| known[*j]).for_each(|&(i, _)| has_known[part[i]] = true);
    (0..n).filter(|&j| alone[j]).for_each(|j| known[j] |= has_known[part[j]]);
    terms.iter().for_each(|&(i, j)| known[i] &= known[j]);
    known
}
