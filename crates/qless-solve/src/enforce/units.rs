//! Units of DOFs and equations: powers of two `S = diag(s)` that give every row of `S A S` a largest entry near 1.
//!
//! ```text
//! A = [K C^T; C 0]
//! s_j = 1 / sqrt(|K_jj|)                DOFs with stiffness: s_j u_j' = u_j, where u_j' are square roots of energy
//! s_j = 1 / max_i |K_ij| s_i            DOFs that K couples to these; then all are balanced
//! s_r = 1 / max_j |C_rj| s_j            equations, over DOFs that have their scale
//! s_j = 1 / max_r |C_rj| s_r            DOFs that occur in equations only
//! ```
//!
//! Numbers in these units can be compared, whatever the units of length, force, translation and rotation are. Cost: a few passes over the
//! entries, and a sort if units spread along equations.
//!
//! Some units remain unknown:
//!
//! ```text
//! s_i K_ij s_j = 1        u_j / s_j has no unit
//! ```
//!
//! A diagonal entry determines the unit of its DOF and of all DOFs in the same connected part of K. A part without diagonal entries may
//! leave units open: in `[0 K_01; K_10 0]`, any s_0 fits with `s_1 = 1 / (|K_01| s_0)`. Each DOF of such a part is a group of its own
//! ([`UnitGroups`]).

use qless::common::DisjointSets;

use super::matrix::entries;
use crate::common::SparseMatrix;

/// Most passes that balance K; definite matrices are balanced by their diagonal.
const SWEEPS: usize = 20;
/// A largest entry within this factor of one counts as balanced.
const EVEN: f64 = 1.5;

/// One unit per DOF, then one per equation of C; powers of two.
pub fn units(k: &SparseMatrix, c: &SparseMatrix) -> Vec<f64> {
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

/// Units of a square matrix without C.
pub fn units_of(a: &SparseMatrix) -> Vec<f64> {
    of_stiffness(a).into_iter().map(|s| if s > 0.0 { power_of_two(s) } else { 1.0 }).collect()
}

/// Units from K alone; zero if K has no entry.
fn of_stiffness(k: &SparseMatrix) -> Vec<f64> {
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

/// Gives rows without a unit the unit `s_i = 1 / max_j |v_ij| s_j` of their neighbours, breadth first.
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

/// The largest power of two up to s, within the range of doubles.
fn power_of_two(s: f64) -> f64 {
    s.log2().floor().clamp(-500.0, 500.0).exp2()
}

/// The smallest unknown of each unknown's connected part; each pair `(i, j)` connects two unknowns.
pub fn parts(count: usize, pairs: impl Iterator<Item = (usize, usize)>) -> Vec<usize> {
    let mut sets = DisjointSets::new(count);
    pairs.for_each(|(i, j)| sets.join(i, j));
    (0..count).map(|i| sets.root(i)).collect()
}

/// Groups of DOFs with comparable units.
pub struct UnitGroups {
    group_of: Vec<u32>,
    count: usize,
}

/// Group of all DOFs with known units.
const KNOWN: u32 = 0;

impl UnitGroups {
    pub fn new(k: &SparseMatrix, c: &SparseMatrix) -> Self {
        let n = k.ncols();
        let real = || entries(k).filter(|&(_, _, v)| v != 0.0);
        let part = parts(n, real().map(|(i, j, _)| (i, j)));
        // Without any stiffness, the equations connect all DOFs, and all units count as known.
        let (mut known, mut is_stiff) = (vec![false; n], false);
        real().for_each(|(i, j, _)| (known[part[j]], is_stiff) = (known[part[j]] || i == j, true));
        let mut known: Vec<bool> = (0..n).map(|j| !is_stiff || known[part[j]]).collect();
        let mut alone = vec![true; n];
        real().for_each(|(i, j, _)| (alone[i], alone[j]) = (false, false));
        if known.contains(&false) {
            spread_known(c, &alone, &mut known);
        }
        let mut count = 1;
        let mut own = || {
            count += 1;
            count - 1
        };
        let group_of = known.into_iter().map(|known| if known { KNOWN } else { own() }).collect();
        Self { group_of, count: count as usize }
    }

    /// `(group, DOF)` of all DOFs.
    pub fn of_dofs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.group_of.iter().enumerate().map(|(j, &group)| (group as usize, j))
    }

    /// Whether the units of a DOF are known.
    pub fn is_known(&self, dof: usize) -> bool {
        self.group_of[dof] == KNOWN
    }

    /// Whether there is more than one group.
    pub fn are_many(&self) -> bool {
        self.count > 1
    }

    /// The largest absolute value in each group, given one number per DOF.
    pub fn largest(&self, numbers: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut largest = vec![0.0_f64; self.count];
        for (&group, number) in self.group_of.iter().zip(numbers) {
            largest[group as usize] = largest[group as usize].max(number.abs());
        }
        largest
    }

    /// As [`UnitGroups::largest`] for loads; these are comparable in the known group only.
    pub fn largest_load(&self, loads: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut largest = self.largest(loads);
        largest[1..].fill(0.0);
        largest
    }
}

/// DOFs without stiffness get a known unit if an equation connects them to a DOF with one.
fn spread_known(c: &SparseMatrix, alone: &[bool], known: &mut [bool]) {
    let n = known.len();
    let terms = || entries(c).filter(|&(_, _, v)| v != 0.0).map(|(i, j, _)| (n + i, j));
    let part = parts(n + c.nrows(), terms().filter(|&(_, j)| alone[j]));
    let mut has_one = vec![false; part.len()];
    terms().filter(|&(_, j)| known[j]).for_each(|(i, _)| has_one[part[i]] = true);
    (0..n).filter(|&j| alone[j]).for_each(|j| known[j] |= has_one[part[j]]);
}
