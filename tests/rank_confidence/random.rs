//! 2,000 systems of eleven classes, each by its seed; ranks are not known by construction but by SVD.

use std::collections::BTreeMap;

use qless::{ConstraintSystem, SystemBuilder};
use qless_scenes::{Rng, Scene, oracle};

use super::svd_reference::{Case, Truth};

type Row = (BTreeMap<usize, f64>, f64);

pub const COUNT: u64 = 2000;

const CLASSES: [&str; 11] = [
    "whole numbers",
    "decimals",
    "mixed magnitudes",
    "near dependence",
    "chains",
    "bands",
    "dense blocks",
    "prescribed DOFs",
    "components",
    "rows in powers of two",
    "units",
];

/// Equations on n DOFs, some prescribed.
struct Made {
    dofs: usize,
    rows: Vec<Row>,
    prescribed: Vec<(usize, f64)>,
}

/// The system of a seed; the class is `seed % 11`.
pub fn case(seed: u64) -> Case {
    let class = (seed % CLASSES.len() as u64) as usize;
    let mut rng = Rng::new(seed);
    let name = format!("random::case({seed}), {}", CLASSES[class]);
    let mut case = match class {
        9 => scaled(name, seed, &mut rng),
        10 => in_units(name, &mut rng),
        _ => Case::new(name, made(class, &mut rng).system(&mut rng)),
    };
    // Of chains the exact rank is no matter of rounding: where the SVD says less, doubt is fair.
    let with_chains = [4, 8, 9, 10].contains(&class);
    case.near = class == 3
        || with_chains && oracle::rank_free(&case.base).expect("within reach") > Truth::new(&case.base, 1e-10).rank;
    case
}

fn made(class: usize, rng: &mut Rng) -> Made {
    match class {
        1 => decimals(rng),
        2 => mixed(rng),
        3 => near(rng),
        4 => chain(rng),
        5 => band(rng),
        6 => blocks(rng),
        7 => with_prescribed(whole(rng), rng),
        8 => components(rng),
        _ => whole(rng),
    }
}

fn scaled(name: String, seed: u64, rng: &mut Rng) -> Case {
    let class = [0, 1, 4, 5, 6, 7][rng.below(6)];
    let system = made(class, rng).system(rng);
    let scene = Scene { system, truth: qless_scenes::Truth::default(), nodes: Vec::new(), dofs: Vec::new() };
    Case::new(name, scene.scale_rows(40, seed).expect("in range").0.system)
}

/// Powers of two near powers of ten, so that numbers stay exact.
fn in_units(name: String, rng: &mut Rng) -> Case {
    let class = [0, 1, 4, 6, 7][rng.below(5)];
    let base = made(class, rng).system(rng);
    let decades: Vec<f64> = (0..2 + rng.below(3)).map(|_| 2_f64.powi(rng.below(41) as i32 - 20)).collect();
    let units: Vec<f64> = (0..base.dofs()).map(|_| decades[rng.below(decades.len())]).collect();
    let scene =
        Scene { system: base.clone(), truth: qless_scenes::Truth::default(), nodes: Vec::new(), dofs: Vec::new() };
    let system = scene.scale_dofs(&units).expect("in range").system;
    Case { base, units, ..Case::new(name, system) }
}

impl Made {
    /// Rows in random order.
    fn system(&self, rng: &mut Rng) -> ConstraintSystem {
        let mut builder = SystemBuilder::new(self.dofs);
        for i in rng.permutation(self.rows.len()).expect("few") {
            let (terms, b) = &self.rows[i];
            builder.equation(terms.iter().filter(|(_, v)| **v != 0.0).map(|(&j, &v)| (j, v)), *b);
        }
        self.prescribed.iter().for_each(|&(j, value)| builder.prescribe(j, value));
        builder.build().expect("valid")
    }
}

/// Rows of 2 to 6 terms with coefficients and right-hand sides of one kind.
fn sparse(rng: &mut Rng, coefficient: impl Fn(&mut Rng) -> f64) -> Made {
    let dofs = 3 + rng.below(48);
    let count = 1 + rng.below(dofs);
    let row = |rng: &mut Rng| {
        let terms = 2 + rng.below(5);
        let terms = rng.distinct(terms, dofs).expect("few").into_iter().map(|j| (j, coefficient(rng))).collect();
        (terms, rng.below(9) as f64 - 4.0)
    };
    Made { dofs, rows: (0..count).map(|_| row(rng)).collect(), prescribed: Vec::new() }
}

/// Appends combinations of 2 to 4 of the rows.
fn combine(made: &mut Made, most: usize, rng: &mut Rng, factor: impl Fn(&mut Rng) -> f64) {
    let rows = made.rows.len();
    for _ in 0..rng.below(most + 1) {
        let (mut terms, mut b) = (BTreeMap::new(), 0.0);
        let parts = 2 + rng.below(3);
        for k in rng.distinct(parts, rows).expect("few") {
            let factor = factor(rng);
            made.rows[k].0.iter().for_each(|(&j, v)| *terms.entry(j).or_insert(0.0) += factor * v);
            b += factor * made.rows[k].1;
        }
        // What is left of terms that cancel is no coefficient anybody writes.
        terms.retain(|_, v: &mut f64| v.abs() > 1e-12);
        if !terms.is_empty() {
            made.rows.push((terms, b));
        }
    }
}

fn whole(rng: &mut Rng) -> Made {
    let mut made = sparse(rng, |rng| rng.coefficient(3));
    combine(&mut made, 12, rng, |rng| rng.coefficient(2));
    made
}

/// As typed with 1 to 6 digits.
fn decimals(rng: &mut Rng) -> Made {
    let digits = 10_f64.powi(1 + rng.below(6) as i32);
    let typed = move |rng: &mut Rng| ((rng.real() * digits).round() + 0.5_f64.copysign(rng.real()) * 2.0) / digits;
    let nonzero = move |rng: &mut Rng| std::iter::repeat_with(|| typed(rng)).find(|v| *v != 0.0).unwrap_or(1.0);
    let mut made = sparse(rng, nonzero);
    combine(&mut made, 12, rng, |rng| rng.coefficient(9) / 10.0);
    made
}

/// Coefficients from 1e-4 to 1e4 in a row.
fn mixed(rng: &mut Rng) -> Made {
    let mut made = sparse(rng, |rng| rng.coefficient(9) * 10_f64.powi(rng.below(9) as i32 - 4));
    combine(&mut made, 6, rng, |rng| rng.coefficient(2));
    made
}

/// Combinations with one coefficient off by a part in 10^1 to 10^14.
fn near(rng: &mut Rng) -> Made {
    let mut made = whole(rng);
    let independent = made.rows.len();
    combine(&mut made, 4, rng, |rng| rng.coefficient(2));
    let off = 1.0 + 10_f64.powi(-1 - rng.below(14) as i32);
    for (terms, _) in &mut made.rows[independent..] {
        let at = rng.below(terms.len());
        terms.values_mut().nth(at).into_iter().for_each(|v| *v *= off);
    }
    made
}

/// `u_i = f_i u_(i+1)` with factors that grow, shrink or do both; closed, tied to one end, or neither.
fn chain(rng: &mut Rng) -> Made {
    let dofs = 3 + rng.below(100);
    let (low, high) = [(0.5, 1.0), (1.0, 2.0), (0.5, 2.0), (0.9, 1.1), (0.1, 10.0)][rng.below(5)];
    let mut rows: Vec<Row> = Vec::new();
    for i in 1..dofs {
        let factor = if rng.below(2) == 0 { low } else { high };
        rows.push((BTreeMap::from([(i - 1, 1.0), (i, -factor)]), rng.below(3) as f64 - 1.0));
    }
    let mut made = Made { dofs, rows, prescribed: Vec::new() };
    match rng.below(3) {
        0 => made.prescribed.push((rng.below(dofs), 1.0)),
        1 => combine(&mut made, 3, rng, |rng| rng.coefficient(2)),
        _ => {}
    }
    made
}

fn band(rng: &mut Rng) -> Made {
    let dofs = 5 + rng.below(90);
    let width = 2 + rng.below(5);
    let strong = [0.0, 1.0, 4.0][rng.below(3)];
    let mut rows: Vec<Row> = Vec::new();
    for i in 0..dofs - rng.below(4) {
        let columns = i.saturating_sub(width / 2)..dofs.min(i + width / 2 + 1);
        rows.push((columns.map(|j| (j, rng.real() + if i == j { strong } else { 0.0 })).collect(), rng.real()));
    }
    let mut made = Made { dofs, rows, prescribed: Vec::new() };
    combine(&mut made, 5, rng, |rng| rng.coefficient(2));
    made
}

/// Dense blocks of 3 to 12 equations, and some equations that connect them.
fn blocks(rng: &mut Rng) -> Made {
    let mut made = Made { dofs: 0, rows: Vec::new(), prescribed: Vec::new() };
    for _ in 0..=rng.below(4) {
        let (rows, dofs, first) = (3 + rng.below(10), 3 + rng.below(12), made.dofs);
        made.dofs += dofs;
        made.rows.extend((0..rows.min(dofs)).map(|_| ((first..first + dofs).map(|j| (j, rng.real())).collect(), 1.0)));
    }
    for _ in 0..rng.below(4) {
        let dofs = made.dofs;
        made.rows
            .push((rng.distinct(2, dofs).expect("few").into_iter().map(|j| (j, rng.coefficient(2))).collect(), 0.0));
    }
    combine(&mut made, 6, rng, |rng| rng.coefficient(3));
    made
}

fn with_prescribed(mut made: Made, rng: &mut Rng) -> Made {
    let count = 1 + rng.below(made.dofs / 3 + 1);
    made.prescribed =
        rng.distinct(count, made.dofs).expect("few").into_iter().map(|j| (j, rng.coefficient(3))).collect();
    made
}

/// 2 to 6 systems of other classes on DOFs of their own; rows come in random order.
fn components(rng: &mut Rng) -> Made {
    let mut all = Made { dofs: 0, rows: Vec::new(), prescribed: Vec::new() };
    for _ in 0..2 + rng.below(5) {
        let class = [0, 1, 4, 5, 6, 7][rng.below(6)];
        let part = made(class, rng);
        let moved = |(terms, b): &Row| (terms.iter().map(|(&j, &v)| (all.dofs + j, v)).collect(), *b);
        all.rows.extend(part.rows.iter().map(moved).collect::<Vec<Row>>());
        all.prescribed.extend(part.prescribed.iter().map(|&(j, value)| (all.dofs + j, value)));
        all.dofs += part.dofs;
    }
    all
}
