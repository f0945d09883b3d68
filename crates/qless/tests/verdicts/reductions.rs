//! T, G and g of random systems: `u_s = T u_q + G u_p + g` satisfies the equations for all masters and prescribed values, in each form, and
//! whichever slaves are preferred.

use qless::common::SplitMix64;
use qless::{
    Analysis, BackendChoice, ConstraintSystem, Form, Kind, Options, Preferences, Reduction, SystemBuilder, analyse,
};

use super::below;

/// Whole coefficients, some equations twice or as sums of two others, and right-hand sides that some displacements satisfy. Each DOF has a
/// unit of its own.
fn consistent(random: &mut SplitMix64) -> ConstraintSystem {
    let (m, n) = (2 + below(random, 7), 4 + below(random, 9));
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for i in 0..m {
        let twice = |k: usize| rows[k % rows.len()].clone();
        let row = match below(random, 6) {
            0 if i > 1 => twice(0).iter().zip(twice(i / 2)).map(|(a, b)| a - 2.0 * b).collect(),
            _ => (0..n).map(|_| if below(random, 5) < 2 { below(random, 9) as f64 - 4.0 } else { 0.0 }).collect(),
        };
        rows.push(row);
    }
    let unit: Vec<f64> = (0..n).map(|_| 2_f64.powi(below(random, 13) as i32 - 6)).collect();
    let u: Vec<f64> = (0..n).map(|_| below(random, 21) as f64 - 10.0).collect();
    let mut builder = SystemBuilder::new(n);
    for row in &rows {
        let side = row.iter().zip(&u).map(|(v, u)| v * u).sum();
        builder.equation((0..n).map(|j| (j, row[j] * unit[j])), side);
    }
    (0..below(random, 3)).for_each(|j| builder.prescribe(j, u[j] / unit[j]));
    builder.build().expect("valid")
}

fn check(system: &ConstraintSystem, analysis: &Analysis, reduction: &Reduction, random: &mut SplitMix64, name: &str) {
    let mut numbers = |n: usize| (0..n).map(|_| below(random, 2001) as f64 / 1000.0 - 1.0).collect::<Vec<_>>();
    let (q, p) = (numbers(reduction.masters().len()), numbers(reduction.prescribed().len()));
    let u = reduction.expand(&q, &p).expect("of these lengths");
    for i in (0..system.equations()).filter(|&i| analysis.kinds()[i] == Kind::Independent) {
        let terms = system.matrix().row(i).map(|(j, v)| v * u[j]);
        let (sum, size) = terms.fold((0.0, 0.0), |(sum, size), term: f64| (sum + term, size + term.abs()));
        let b = system.rhs()[i];
        assert!((sum - b).abs() <= 1e-11 * (size + b.abs()), "{name}, row {i}: {sum} for {b}");
    }
    let mut all = [reduction.slaves(), reduction.masters(), reduction.prescribed()].concat();
    all.sort_unstable();
    assert_eq!(all, (0..system.dofs()).collect::<Vec<_>>(), "{name}");
    // Rows, columns and the transpose are parts of the same T.
    let at_rest = vec![0.0; p.len()];
    let [moved, rest] = [&q, &vec![0.0; q.len()]].map(|q| reduction.expand(q, &at_rest).expect("of these lengths"));
    let weights = numbers(reduction.slaves().len());
    let transposed = reduction.apply_transposed(&weights).expect("of this length");
    let mut by_columns = vec![(0.0, 0.0); weights.len()];
    for (c, (q, transposed)) in q.iter().zip(transposed).enumerate() {
        let (mut product, mut size) = (0.0, 0.0);
        for (i, v) in reduction.column(c).expect("a master") {
            by_columns[i] = (by_columns[i].0 + v * q, by_columns[i].1 + (v * q).abs());
            (product, size) = (product + v * weights[i], size + v.abs());
        }
        assert!((transposed - product).abs() <= 1e-11 * size, "{name}, master {c}: {transposed} and {product}");
    }
    for (i, (&slave, (sum, size))) in reduction.slaves().iter().zip(by_columns).enumerate() {
        let by_row: f64 = reduction.row(i).expect("a slave").iter().map(|&(c, v)| v * q[c]).sum();
        let size = 1e-11 * (size + moved[slave].abs() + rest[slave].abs());
        let difference = moved[slave] - rest[slave];
        assert!((sum - difference).abs() <= size && (by_row - difference).abs() <= size, "{name}, slave {slave}");
    }
}

#[test]
fn equations_hold_for_all_masters_and_prescribed_values() {
    let mut random = SplitMix64::new(23);
    for case in 0..400 {
        let system = consistent(&mut random);
        let backend = [BackendChoice::Faer, BackendChoice::Sparse, BackendChoice::Gauss][case % 3];
        let mut some = || (0..system.dofs()).filter(|_| below(&mut random, 3) == 0).collect::<Vec<_>>();
        let masters = some();
        let slaves = some().into_iter().filter(|j| !masters.contains(j)).collect();
        let growth = [1.5, 4.0, 1e3][case / 6 % 3];
        let preferences = Preferences { masters, slaves, ..Preferences::default() };
        for (presolve, preferences) in [(true, Preferences::default()), (case % 2 == 0, preferences)] {
            let options = Options { backend, presolve, growth, preferences, ..Options::default() };
            let analysis = analyse(&system, &options).expect("valid");
            for form in [Form::Explicit, Form::Factored] {
                let reduction = analysis.reduction_in(form).expect("consistent");
                let name = format!("case {case}, {form:?}, presolve {presolve}: {system:?}");
                check(&system, &analysis, &reduction, &mut random, &name);
            }
        }
    }
}
