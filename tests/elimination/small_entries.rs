//! Entries of T, G and g count in the equations of their own slaves, however small they are beside entries in other units:
//! `C_S T = -C_M`, `C_S G = -C_p` and `C_S g = b` hold entry by entry, for coefficients of twelve decades.

use qless::{ConstraintSystem, Kind, Options, Reduction, SystemBuilder, analyse};
use qless_scenes::Rng;

/// One of some small integers, or three digits with an exponent between -6 and 6, as typed.
fn number(rng: &mut Rng) -> f64 {
    if rng.below(5) < 2 {
        return [1.0, -1.0, 2.0, -0.5, 3.0][rng.below(5)];
    }
    let sign = if rng.below(2) == 0 { "" } else { "-" };
    let text = format!("{sign}{}.{:02}e{}", 1 + rng.below(9), rng.below(100), rng.below(13) as i32 - 6);
    text.parse().expect("a number")
}

fn random_system(rng: &mut Rng) -> ConstraintSystem {
    let dofs = 3 + rng.below(7);
    let mut builder = SystemBuilder::new(dofs);
    for _ in 0..2 + rng.below(dofs - 1) {
        let count = 2 + rng.below(2);
        let terms = rng.distinct(count, dofs).expect("enough DOFs");
        let terms: Vec<_> = terms.into_iter().map(|j| (j, number(rng))).collect();
        let b = if rng.below(5) < 3 { number(rng) } else { 0.0 };
        builder.equation(terms, b);
    }
    if rng.below(2) == 0 {
        let dof = rng.below(dofs);
        builder.prescribe(dof, number(rng));
    }
    builder.build().expect("valid")
}

/// The largest sum of terms of an equation in one column of `[T G g]`, relative to the magnitudes of the terms; 0 if it is rounding of the
/// largest terms of the equation in any column of the same matrix.
fn worst(system: &ConstraintSystem, kinds: &[Kind], reduction: &Reduction) -> f64 {
    let (q, p) = (reduction.masters().len(), reduction.prescribed().len());
    let place = |list: &[usize], j: usize| list.iter().position(|&other| other == j);
    let mut worst = 0.0_f64;
    for i in (0..kinds.len()).filter(|&i| kinds[i] == Kind::Independent) {
        let mut sums = vec![(0.0_f64, 0.0_f64); q + p + 1];
        let mut largest = [0.0_f64; 3];
        let side = |c: usize| usize::from(c >= q) + usize::from(c >= q + p);
        let mut add = |c: usize, term: f64| {
            sums[c] = (sums[c].0 + term, sums[c].1 + term.abs());
            largest[side(c)] = largest[side(c)].max(term.abs());
        };
        add(q + p, -system.rhs()[i]);
        for (j, v) in system.matrix().row(i) {
            if let Some(s) = place(reduction.slaves(), j) {
                reduction.t().row(s).for_each(|(c, x)| add(c, v * x));
                reduction.g_matrix().row(s).for_each(|(c, x)| add(q + c, v * x));
                add(q + p, v * reduction.g()[s]);
            } else {
                let master = place(reduction.masters(), j);
                let prescribed = || place(reduction.prescribed(), j).map(|c| q + c);
                add(master.or_else(prescribed).expect("a DOF of the reduction"), v);
            }
        }
        let counts = sums.into_iter().enumerate().filter(|&(c, (sum, _))| sum.abs() > 1e-13 * largest[side(c)]);
        worst = counts.map(|(_, (sum, size))| sum.abs() / size).fold(worst, f64::max);
    }
    worst
}

/// The reduction is checked with random masters, which can hide an entry beside one that is 1e9 times as large: in one of a thousand systems.
#[test]
fn every_entry_satisfies_its_equations() {
    let (mut seen, mut bad) = (0, Vec::new());
    for seed in 0..4000 {
        let system = random_system(&mut Rng::new(seed));
        let analysis = analyse(&system, &Options::default()).expect("an analysis");
        if analysis.confidence().ambiguous || analysis.dependent().iter().any(|d| d.kind == Kind::Conflicting) {
            continue;
        }
        let Ok(reduction) = analysis.reduction() else { continue };
        seen += 1;
        if worst(&system, analysis.kinds(), &reduction) > 1e-9 {
            bad.push(seed);
        }
    }
    assert!(seen > 3000, "{seen} reductions");
    assert!(bad.len() * 500 <= seen, "{bad:?} of {seen}");
}
