//! Springs of very different stiffness. The solution is chosen first: `f = K u + C^T lambda`, `b = C u`, without rounding.
//!
//! In units of energy the soft DOFs are negligible beside the stiff ones; each equation must still hold by its own terms.

use qless_solve::enforce::{EnforceError, Problem, Solution, Stiffness};

use super::Outcome;
use super::measure::Measure;
use super::models::{Model, Random};

/// Models that are tried; only some of them consist of doubles.
const MODELS: usize = 6000;
/// Largest exponent of the springs.
const POWERS: u64 = 60;
/// Largest residual of an equation, relative to its terms.
const HOLDS: f64 = 1e-10;
/// Factor by which an estimate may be wrong.
const MARGIN: f64 = 3.0;
const ROUNDING: f64 = 1e-14;

fn stiffness(random: &mut Random, n: usize, definite: bool) -> Vec<Vec<i128>> {
    let mut k = vec![vec![0_i128; n]; n];
    let mut spring = |random: &mut Random, i: usize, j: usize| {
        let sign = if definite || random.below(2) == 0 { 1 } else { -1 };
        let s = sign * (1_i128 << random.below(POWERS));
        let ends = if i == j { vec![(i, i, s)] } else { vec![(i, i, s), (j, j, s), (i, j, -s), (j, i, -s)] };
        ends.into_iter().for_each(|(i, j, v)| k[i][j] += v);
    };
    (0..n).for_each(|i| spring(random, i, i));
    for _ in 0..n {
        let (i, j) = (random.below(n as u64), random.below(n as u64));
        spring(random, i, j);
    }
    k
}

/// A number from 1 to `most`, of either sign.
fn number(random: &mut Random, most: u64) -> i128 {
    let size = 1 + random.below(most) as i128;
    if random.below(2) == 0 { size } else { -size }
}

/// A model with its u; none if a number is not a double.
fn model(seed: usize) -> Option<(Model, Vec<f64>)> {
    let random = &mut Random::new(seed as u64 * 6007 + 5);
    let n = 2 + random.below(7);
    let definite = random.below(3) > 0;
    let k = stiffness(random, n, definite);
    let u: Vec<i128> = (0..n).map(|_| number(random, 4)).collect();
    let (mut c, mut lambda) = (Vec::new(), Vec::new());
    for _ in 0..=random.below(n as u64 - 1) {
        let mut row = vec![0_i128; n];
        (0..=random.below(3)).for_each(|_| row[random.below(n as u64)] = number(random, 3));
        c.push(row);
        lambda.push(number(random, 4) << random.below(POWERS / 2));
    }
    let along = |row: &Vec<i128>| row.iter().zip(&u).map(|(a, u)| a * u).sum::<i128>();
    let of_rows = |j: usize| c.iter().zip(&lambda).map(|(row, lambda)| row[j] * lambda).sum::<i128>();
    let f: Vec<i128> = (0..n).map(|j| along(&k[j]) + of_rows(j)).collect();
    let b = c.iter().map(along).collect();
    let is_double = |v: &i128| *v as f64 as i128 == *v;
    let all = k.iter().flatten().chain(&f).all(is_double);
    let right = u.iter().map(|u| *u as f64).collect();
    let name = format!("{seed}, {}", if definite { "definite" } else { "indefinite" });
    all.then(|| (Model { name, k, f, c, b, prescribed: vec![None; n] }, right))
}

/// The largest `|C u - b|` relative to its terms. Numbers are small and u is right to some digits, so that the difference is exact.
fn left(model: &Model, kept: &[usize], u: &[f64], right: &[f64]) -> f64 {
    let of_row = |&r: &usize| {
        let terms = || model.c[r].iter().map(|c| *c as f64).zip(u.iter().zip(right));
        let left: f64 = terms().map(|(c, (u, right))| c * (u - right)).sum();
        left.abs() / (terms().map(|(c, (_, right))| (c * right).abs()).sum::<f64>() + model.b[r].abs() as f64)
    };
    kept.iter().map(of_row).fold(0.0, f64::max)
}

/// Results of the methods.
#[derive(Debug, Default)]
struct Counts {
    right: usize,
    refused: usize,
}

#[test]
fn every_equation_holds_by_its_own_terms_beside_stiff_springs() -> Outcome {
    let (mut counts, mut wrong) = (Counts::default(), Vec::new());
    for (model, right) in (0..MODELS).filter_map(model) {
        let given = model.given(1.0, 1.0)?;
        let problem = Problem::new(Stiffness::unsymmetric(&given.k), &given.f, &given.system)?;
        let measure = Measure::new(&model, problem.kept());
        let methods: [(&str, Result<Solution, EnforceError>); 3] = [
            ("transformation", problem.transformation()),
            ("lagrange", problem.lagrange()),
            ("augmented", problem.augmented(1e6, HOLDS)),
        ];
        for (method, solved) in methods {
            let Ok(solution) = solved else {
                counts.refused += 1;
                continue;
            };
            counts.right += 1;
            let (off, left) =
                (measure.off(&solution.u, &right, 1.0), left(&model, problem.kept(), &solution.u, &right));
            let is_true = off <= (MARGIN * solution.accuracy).max(ROUNDING);
            if left > HOLDS || !is_true {
                wrong.push(format!("{}, {method}: {left:e}; {off:e}, {:e}", model.name, solution.accuracy));
            }
        }
    }
    println!("{counts:?}");
    assert!(wrong.is_empty(), "{} of {counts:?}: {wrong:#?}", wrong.len());
    assert!(counts.right > 1000 && counts.refused * 20 < counts.right, "{counts:?}");
    Ok(())
}
