//! Random factors and accuracies: returned solutions are right, and refusals are justified.

use faer::Mat;
use faer::prelude::Solve;
use qless_solve::enforce::{EnforceError, Method};

use super::measure::Measure;
use super::models::{Model, Random};
use super::{Case, Outcome, for_each_case};

/// Factor by which an estimate may be wrong.
const MARGIN: f64 = 3.0;
/// Smaller errors are rounding.
const ROUNDING: f64 = 1e-12;

/// How often a solution was right, a refusal justified, and a refusal not justified.
#[derive(Debug, Default)]
struct Counts {
    right: usize,
    rightly: usize,
    wrongly: usize,
}

fn methods(random: &mut Random, rows: usize, turn: usize) -> Vec<Method> {
    let mut power = |least: i32, count: u64| 10_f64.powi(least + random.below(count) as i32);
    let mut method = |turn: usize| match turn {
        0 => Method::Penalty { factor: power(0, 12) },
        1 => Method::Augmented { factor: power(-3, 16) },
        2 => Method::Elimination,
        _ => Method::Multiplier,
    };
    (0..rows).map(|row| method(if turn < 2 { turn } else { (row + turn) % 4 })).collect()
}

/// u of the exact penalties: `[K C^T; C -1/D]` by orthogonal factors.
fn penalised(model: &Model, kept: &[usize], methods: &[Method]) -> Vec<f64> {
    let (free, n) = (model.free(), model.free().len());
    let largest = free.iter().flat_map(|&i| free.iter().map(move |&j| model.k[i][j].abs())).max().unwrap_or(0);
    let compliance = |row: usize| {
        let Method::Penalty { factor } = methods[row] else { return 0.0 };
        let on = || free.iter().copied().filter(|&j| model.c[row][j] != 0);
        let near = on().map(|j| model.k[j][j].abs()).max().filter(|k| *k > 0).unwrap_or(largest);
        let square: i128 = on().map(|j| model.c[row][j].pow(2)).sum();
        if near > 0 { square as f64 / (factor * near as f64) } else { 0.0 }
    };
    let a = Mat::from_fn(n + kept.len(), n + kept.len(), |i, j| match (i < n, j < n) {
        (true, true) => model.k[free[i]][free[j]] as f64,
        (true, false) => model.c[kept[j - n]][free[i]] as f64,
        (false, true) => model.c[kept[i - n]][free[j]] as f64,
        _ => {
            if i == j {
                -compliance(kept[i - n])
            } else {
                0.0
            }
        }
    });
    let b = Mat::from_fn(n + kept.len(), 1, |i, _| {
        let rhs = |row: &[i128], rhs: i128| model.less_prescribed(row, rhs) as f64;
        if i < n { rhs(&model.k[free[i]], model.f[free[i]]) } else { rhs(&model.c[kept[i - n]], model.b[kept[i - n]]) }
    });
    let factors = a.col_piv_qr();
    let mut x = factors.solve(&b);
    for _ in 0..3 {
        x = &x + factors.solve(&b - &a * &x);
    }
    let mut u = vec![0.0; model.f.len()];
    free.iter().enumerate().for_each(|(i, &j)| u[j] = x[(i, 0)]);
    u
}

fn check(case: &Case, counts: &mut Counts) {
    let Some((right, _)) = &case.right else { return };
    let kept = case.problem.kept();
    let (measure, random) =
        (Measure::new(case.model, kept), &mut Random::new(case.name.len() as u64 + counts.right as u64));
    for turn in 0..6 {
        let methods = methods(random, case.given.system.equations(), turn);
        let accuracy = 10_f64.powi(-1 - random.below(9) as i32);
        let is_penalised = kept.iter().any(|&row| matches!(methods[row], Method::Penalty { .. }));
        let name = format!("{}: {methods:?}, {accuracy:e}", case.name);
        match case.problem.enforce(&methods, accuracy) {
            Ok(solution) => {
                let off = measure.off(&solution.u, right, case.length);
                let allowed = if is_penalised { solution.accuracy.min(accuracy) } else { solution.accuracy };
                assert!(off <= (MARGIN * allowed).max(ROUNDING), "{name}: {off:e}, {:e}", solution.accuracy);
                assert!(solution.accuracy < 1.0, "{name}: {:e}", solution.accuracy);
                counts.right += 1;
            }
            Err(EnforceError::PenaltyTooSmall { cost, .. }) => {
                let off = measure.off(&penalised(case.model, kept, &methods), right, 1.0);
                // Units of two DOFs are rounded to powers of two. Parts without stiffness have no springs.
                let is_stiff = case.model.free().iter().all(|&j| case.model.k[j][j] != 0);
                let is_true = cost <= 4.0 * off && off <= 4.0 * cost;
                assert!(cost >= 1.0 || !is_stiff || is_true, "{name}: {cost:e} of {off:e}");
                // In between, an estimate decides.
                counts.rightly += usize::from(off > accuracy / MARGIN);
                counts.wrongly += usize::from(off <= accuracy / MARGIN);
            }
            Err(other) => panic!("{name}: {other}"),
        }
    }
}

#[test]
fn springs_are_right_to_what_was_asked_or_refused_rightly() -> Outcome {
    let mut counts = Counts::default();
    for_each_case(|case| {
        check(case, &mut counts);
        Ok(())
    })?;
    println!("{counts:?}");
    assert!(counts.right > 10_000 && counts.rightly > 300, "{counts:?}");
    assert!(counts.wrongly * 1000 <= counts.right, "{counts:?}");
    Ok(())
}
