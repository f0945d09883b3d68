//! Finds conflicts that large right-hand sides hide. Equation k is dependent: `row_k = sum c_i row_i` over the kept equations i.
//!
//! ```text
//! C u = b            over the kept equations       mismatch of equation k    b_k - C_k u = b_k - sum c_i b_i
//! C v = w b          w random, 0.5 <= |w_i| < 1.5  its size                  max(|b_k|, |C_k v|), near the largest |c_i b_i|
//! C x = w (eps t)    t_i the terms of C_i u        its error                 max(eps t_k, |C_k x|), if coefficients are rounded
//! ```
//!
//! The elimination measures a mismatch against the largest right-hand side that it met, also if that side cancelled and is not in the
//! certificate: `1e14` of one equation hides a mismatch of 0.5 among others of size 1. One solution u shows the mismatches of all
//! equations, and three solutions v show their sizes. The sizes are computed first, in doubles, because they settle the verdict on most
//! equations. A certificate is computed only for an equation whose mismatch is within its error.

use rayon::prelude::*;

use super::certificate::{CertificateTerm, History};
use super::classify::{Dependent, Kind, MismatchRule, Source};
use super::confidence::{ACCURACY, NEAR, NO_MISMATCH, SMALL_MISMATCH};
use super::distance::least_distances;
use super::nullspace_probe::RandomKeys;
use super::refined::{SolveKept, product};
use crate::common::random::signed;
use crate::factor::backend::many::Slab;
use crate::input::components::Labels;
use crate::input::numbering::LocalSystem;
use crate::input::scale::ldexp;
use crate::presolve::eliminated::Mismatch;
use crate::presolve::rows::MORE_THAN_ROUNDING;

/// Number of solutions v of `C v = w b` with random weights w. The chance that all three random sums are a million times too small is about
/// 1e-18.
const V: usize = 3;
/// Number of solutions: u of `C u = b`, and all v of `C v = w b`.
const W: usize = V + 1;
/// Seeds of the random weights w, one for each solution v of `C v = w b`.
const SEEDS: [u64; V] = [0x9e37_79b9, 0x85eb_ca6b, 0xc2b2_ae35];

/// Classifies redundant equations again if their mismatch may exceed the tolerance of their own right-hand side, and all equations whose
/// mismatch may be in doubt: the doubt depends on the terms of the certificate alone. `distances` are those of cores of kept equations from
/// dependence, each with one of its equations; None if they were not computed.
pub(crate) fn find(
    dependent: &mut [Dependent],
    keys: &mut RandomKeys,
    kept: &impl SolveKept,
    distances: Option<&[(u32, f64)]>,
    rule: &MismatchRule,
) {
    let is_unclear = |d: &Dependent, size: f64| {
        let (mismatch, error) = (d.mismatch.abs(), MORE_THAN_ROUNDING * d.rest.error);
        let may_conflict = d.kind == Kind::Redundant && mismatch + error > rule.tolerance * size;
        let is_small = d.relative_mismatch < SMALL_MISMATCH && mismatch > error && mismatch > NO_MISMATCH * size;
        !d.is_suspect && (may_conflict || is_small)
    };
    // A certificate that is given has the mismatch of its own terms only.
    let is_hidden = |d: &Dependent| matches!(d.source, Source::Traced(..)) && is_unclear(d, rule.side(d.row).size);
    let mut unclear: Vec<usize> = (0..dependent.len()).filter(|&k| is_hidden(&dependent[k])).collect();
    if unclear.is_empty() {
        return;
    }
    let labels = Labels::of(rule.system);
    if !keys.are_within_components() {
        *keys = RandomKeys::within_components(&labels, rule.system);
    }
    let v = kept.correction(|i| weights(keys, i, rule.side(i).size));
    unclear.retain(|&k| is_unclear(&dependent[k], size_above_rounding(rule.system, dependent[k].row, &v)));
    if unclear.is_empty() {
        return;
    }
    let rows: Vec<usize> = unclear.iter().map(|&k| dependent[k].row).collect();
    let least = distances.map_or_else(|| vec![NEAR; labels.count], |known| least_distances(&labels, known));
    let history = kept.parts().2;
    let classified = |(&k, rest): (&usize, Mismatch)| {
        let d = &dependent[k];
        let found = Dependent::new(d.row, rest, d.dropped, d.source.clone(), rule);
        // The size of the terms is an estimate, which excuses no conflict that the elimination has found.
        if d.kind == Kind::Conflicting && found.kind != Kind::Conflicting {
            return None;
        }
        let is_small = found.relative_mismatch > NO_MISMATCH;
        if rest.value.is_finite() && (found.kind == Kind::Conflicting || found.is_suspect || is_small) {
            return Some((k, found));
        }
        let distance = least[labels.of_row[d.row] as usize];
        found.is_excused(rule.tolerance).then(|| reclassified(d, distance, history, rule)).flatten().map(|d| (k, d))
    };
    let rests = mismatches(kept, keys, rule, &rows);
    let found: Vec<(usize, Dependent)> = unclear.par_iter().zip(rests).filter_map(classified).collect();
    found.into_iter().for_each(|(k, found)| dependent[k] = found);
}

/// The verdict without the terms of the certificate that may be rounding; None if it stays. A mismatch that errors of the other terms may
/// explain is none. The equation conflicts if its mismatch is larger than any error of the certificate. Otherwise it stays redundant, but is
/// suspect: a term that may be rounding explains the mismatch.
fn reclassified(d: &Dependent, distance: f64, history: &History, rule: &MismatchRule) -> Option<Dependent> {
    let terms = d.source.explain(history);
    let scaled = |term: &CertificateTerm| ldexp(term.coefficient.abs(), -rule.scaling.row[term.row]);
    let least = ACCURACY / distance * terms.iter().map(scaled).fold(0.0, f64::max);
    let (mut rest, mut of_others, mut of_all) = (rule.side(d.row), 0.0, 0.0);
    for term in &terms {
        let other = rule.side(term.row);
        let error = other.size * ldexp(least, rule.scaling.row[term.row]);
        of_all += error;
        if scaled(term) > least {
            rest.subtract(term.coefficient, other);
            of_others += error;
        }
    }
    let found = Dependent::new(d.row, rest, d.dropped, d.source.clone(), rule);
    let differs = found.kind == Kind::Conflicting || found.is_suspect;
    match rest.value.abs() {
        mismatch if differs && mismatch > of_all => Some(found),
        mismatch if differs && mismatch > of_others => Some(Dependent { is_suspect: true, ..d.clone() }),
        _ => None,
    }
}

/// `number` times the random weight w of equation i, for each of the three solutions v of `C v = w b`.
fn weights(keys: &RandomKeys, i: usize, number: f64) -> [f64; V] {
    SEEDS.map(|seed| number * signed(seed, keys.row(i as u32)))
}

/// The largest `|C_k v|` of equation k over the solutions v of `C v = w b`. A value that may be rounding of its terms counts as 0.
///
/// A right-hand side L gives v an error of about `eps L / d`, where d is the distance from dependence. This error could be taken for a size
/// that excuses a mismatch of `eps L` only if `d` is below the tolerance, and then the rank is in doubt.
fn size_above_rounding(system: LocalSystem, k: usize, v: &Slab<V>) -> f64 {
    let mut terms = [0.0_f64; V];
    system.row(k).for_each(|(j, a)| terms.iter_mut().zip(&v[j]).for_each(|(t, v)| *t = t.max((a * v).abs())));
    let above = |(sum, t): (&f64, f64)| if sum.abs() > MORE_THAN_ROUNDING * f64::EPSILON * t { sum.abs() } else { 0.0 };
    product(system, k, v).iter().zip(terms).map(above).fold(0.0, f64::max)
}

/// The mismatches of dependent equations.
fn mismatches(kept: &impl SolveKept, keys: &RandomKeys, rule: &MismatchRule, dependent: &[usize]) -> Vec<Mismatch> {
    let system = rule.system;
    let weighted = |i: usize, first: f64, number: f64| {
        let [a, b, c] = weights(keys, i, number);
        [first, a, b, c]
    };
    let sides = |i: usize| weighted(i, system.rhs()[i], rule.side(i).size);
    let mut start = vec![[0.0; W]; system.dofs()];
    system.prescribed().iter().for_each(|&(j, value)| start[j][0] = value);
    let solutions = kept.solve(start, sides);
    let left = |i: usize| solutions.left(system, i, sides(i))[0];
    let errors = kept.correction(|i| {
        let (left, terms) = left(i);
        weighted(i, 0.0, left.abs() + f64::EPSILON * terms)
    });
    let largest = |numbers: [f64; W], own: f64| numbers[1..].iter().fold(own, |most, v| most.max(v.abs()));
    let of = |&k: &usize| {
        let all = solutions.left(system, k, sides(k));
        let (value, terms) = (all[0].0, all.iter().fold(0.0, |most: f64, (_, terms)| most.max(*terms)));
        let size = largest(solutions.product(system, k), rule.side(k).size);
        // If the last correction still changed the mismatch, the mismatch has not converged, so the change counts as its error.
        let last = product(system, k, &solutions.last)[0].abs();
        Mismatch { value, size, error: largest(product(system, k, &errors), last.max(f64::EPSILON * terms)) }
    };
    dependent.iter().map(of).collect()
}
