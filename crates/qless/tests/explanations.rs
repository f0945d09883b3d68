//! Explanations are short, irreducible, and give the equation that they explain.

use qless::common::SplitMix64;
use qless::explanation::{Explanation, Member};
use qless::{Analysis, ConstraintSystem, Kind, Options, SystemBuilder, analyse};

fn below(random: &mut SplitMix64, n: usize) -> usize {
    (random.next() % n as u64) as usize
}

fn shuffle<T>(random: &mut SplitMix64, items: &mut [T]) {
    (1..items.len()).rev().for_each(|k| items.swap(k, below(random, k + 1)));
}

/// Rank modulo 2^31 - 1 of rows of small whole numbers: their minors are far smaller or zero in these tests.
fn rank(mut rows: Vec<Vec<i64>>) -> usize {
    const P: i64 = (1 << 31) - 1;
    let inverse = |a: i64| {
        let (mut result, mut power, mut exponent) = (1, a.rem_euclid(P), P - 2);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = result * power % P;
            }
            power = power * power % P;
            exponent >>= 1;
        }
        result
    };
    let columns = rows.first().map_or(0, Vec::len);
    let mut rank = 0;
    for column in 0..columns {
        let Some(pivot) = (rank..rows.len()).find(|&i| rows[i][column].rem_euclid(P) != 0) else { continue };
        rows.swap(rank, pivot);
        let pivot_row = rows[rank].clone();
        let scale = inverse(pivot_row[column]);
        for row in &mut rows[rank + 1..] {
            let factor = row[column].rem_euclid(P) * scale % P;
            row.iter_mut().zip(&pivot_row).for_each(|(a, b)| *a = (*a - factor * b.rem_euclid(P)).rem_euclid(P));
        }
        rank += 1;
    }
    rank
}

fn equation(system: &ConstraintSystem, i: usize) -> Vec<i64> {
    let mut row = vec![0; system.dofs()];
    system.matrix().row(i).for_each(|(j, v)| row[j] = v as i64);
    row
}

fn dense(system: &ConstraintSystem, member: Member) -> Vec<i64> {
    let mut row = vec![0; system.dofs()];
    match member {
        Member::Equation { row: i, .. } => return equation(system, i),
        Member::Prescribed { dof, .. } => row[dof] = 1,
        _ => unreachable!("there are two kinds of members"),
    }
    row
}

/// Checks the members against the system: they give the vector, no one can be left out, and none conflicts with the kept equations.
fn check(system: &ConstraintSystem, analysis: &Analysis, vector: &[i64], explanation: &Explanation) {
    let members = &explanation.members;
    let rows: Vec<Vec<i64>> = members.iter().map(|&member| dense(system, member)).collect();
    for j in 0..system.dofs() {
        let sum: f64 = members.iter().zip(&rows).map(|(member, row)| member.coefficient() * row[j] as f64).sum();
        assert!((sum - vector[j] as f64).abs() < 1e-9, "DOF {j}: {sum} for {}; {explanation:?}", vector[j]);
    }
    let with = |left_out: Option<usize>| {
        let kept = rows.iter().enumerate().filter(|&(k, _)| Some(k) != left_out).map(|(_, row)| row.clone());
        rank(kept.chain([vector.to_vec()]).collect())
    };
    assert_eq!(with(None), members.len(), "dependent members: {explanation:?}");
    for k in 0..members.len() {
        assert_eq!(with(Some(k)), members.len(), "member {k} can be left out: {explanation:?}");
    }
    for member in members {
        if let Member::Equation { row, .. } = *member {
            assert_ne!(analysis.kinds()[row], Kind::Conflicting);
        }
    }
}

/// Explains all that can be explained; returns the lengths of the explanations of dependent equations.
fn check_all(system: &ConstraintSystem) -> Vec<usize> {
    let analysis = analyse(system, &Options::default()).expect("an analysis");
    for &(dof, value) in analysis.generated() {
        let explanation = analysis.explain_fixed(dof).expect("factors").expect("it is fixed");
        let mut vector = vec![0; system.dofs()];
        vector[dof] = 1;
        check(system, &analysis, &vector, &explanation);
        assert!((explanation.right_hand_side - value).abs() <= 1e-8 * (1.0 + value.abs()));
    }
    let explain = |found: &qless::Dependent| {
        let explanation = analysis.explain(found.row).expect("a row").expect("it is dependent");
        let vector = equation(system, found.row);
        check(system, &analysis, &vector, &explanation);
        let mismatch = system.rhs()[found.row] - explanation.right_hand_side;
        assert!((mismatch - found.mismatch).abs() < 1e-8, "{found:?} {explanation:?}");
        explanation.members.len()
    };
    analysis.dependent().iter().map(explain).collect()
}

/// Equal neighbours on a grid of `n` x `n` nodes, in any order.
fn grid(n: usize, random: &mut SplitMix64) -> ConstraintSystem {
    let right = (0..n * n).filter(|k| k % n + 1 < n).map(|k| (k, k + 1));
    let down = (0..n * (n - 1)).map(|k| (k, k + n));
    let mut ties: Vec<_> = right.chain(down).collect();
    shuffle(random, &mut ties);
    let mut builder = SystemBuilder::new(n * n);
    ties.iter().for_each(|&(a, b)| _ = builder.equation([(a, 1.0), (b, -1.0)], 0.0));
    builder.build().expect("valid")
}

#[test]
fn a_redundant_tie_of_a_grid_closes_a_square() {
    for seed in 1..=10 {
        let system = grid(30, &mut SplitMix64::new(seed));
        let analysis = analyse(&system, &Options::default()).expect("an analysis");
        let length = |row| analysis.explain(row).expect("a row").expect("dependent").members.len();
        let lengths: Vec<usize> = analysis.dependent().iter().map(|found| length(found.row)).collect();
        let mean = lengths.iter().sum::<usize>() as f64 / lengths.len() as f64;
        assert_eq!(lengths.len(), 841);
        assert!(mean <= 4.0 && lengths.iter().all(|&length| length <= 8), "{mean} {:?}", lengths.iter().max());
    }
}

/// Ties of random ratios, sums of few DOFs, combinations of two or three of these, prescribed values; some right-hand sides are wrong.
fn random_system(seed: u64) -> ConstraintSystem {
    let random = &mut SplitMix64::new(seed);
    let dofs = 4 + below(random, 20);
    let solution: Vec<f64> = (0..dofs).map(|_| below(random, 9) as f64 - 4.0).collect();
    let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
    for _ in 0..dofs / 2 + below(random, dofs) {
        let length = [1, 2, 2, 2, 3, 4][below(random, 6)];
        let ratios: &[f64] = if below(random, 2) == 0 { &[1.0, -1.0] } else { &[1.0, -1.0, 2.0, -3.0] };
        rows.push((0..length).map(|_| (below(random, dofs), ratios[below(random, ratios.len())])).collect());
    }
    for _ in 0..=below(random, 4) {
        let count = 2 + below(random, 2);
        let parts = (0..count).map(|_| rows[below(random, rows.len())].clone());
        rows.push(parts.collect::<Vec<_>>().concat());
    }
    shuffle(random, &mut rows);
    let mut builder = SystemBuilder::new(dofs);
    for row in rows {
        let wrong = if below(random, 25) == 0 { 1.0 } else { 0.0 };
        let b = row.iter().map(|&(j, v)| v * solution[j]).sum::<f64>() + wrong;
        builder.equation(row, b);
    }
    for j in 0..dofs {
        if below(random, 8) == 0 {
            builder.prescribe(j, solution[j]);
        }
    }
    builder.build().expect("valid")
}

#[test]
fn explanations_are_irreducible_and_give_the_equation() {
    let lengths: Vec<usize> = (1..=1500).flat_map(|seed| check_all(&random_system(seed))).collect();
    assert!(lengths.len() > 3000, "{} explanations", lengths.len());
}
