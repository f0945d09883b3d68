use qless::{Csr, SystemBuilder};
use qless_scenes::families::{Edges, PeriodicCell};
use qless_scenes::oracle::{exact_rank, singular_values};
use qless_scenes::{Rng, SceneError, families, oracle};

/// Rank by Bareiss' fraction-free elimination on whole numbers.
fn bareiss(mut a: Vec<Vec<i128>>) -> usize {
    let (mut rank, mut previous) = (0, 1);
    let columns = a[0].len();
    for col in 0..columns {
        let Some(pivot) = (rank..a.len()).find(|&i| a[i][col] != 0) else { continue };
        a.swap(rank, pivot);
        for i in rank + 1..a.len() {
            for j in (col..columns).rev() {
                a[i][j] = (a[rank][col] * a[i][j] - a[i][col] * a[rank][j]) / previous;
            }
        }
        previous = a[rank][col];
        rank += 1;
    }
    rank
}

fn random(rng: &mut Rng) -> Vec<Vec<i128>> {
    let (m, n) = (1 + rng.below(12), 1 + rng.below(12));
    let share = 1 + rng.below(4);
    let entry = |rng: &mut Rng| if rng.below(4) < share { rng.coefficient(3) as i128 } else { 0 };
    let mut rows: Vec<Vec<i128>> = (0..m).map(|_| (0..n).map(|_| entry(rng)).collect()).collect();
    let (a, b, target) = (rng.below(m), rng.below(m), rng.below(m));
    rows[target] = (0..n).map(|j| rows[a][j] - 2 * rows[b][j]).collect();
    rows
}

fn csr(rows: &[Vec<i128>], factor: f64) -> Csr {
    let mut matrix = Csr::empty(rows[0].len());
    for row in rows {
        matrix
            .push_row(row.iter().enumerate().filter(|(_, v)| **v != 0).map(|(j, &v)| (j, v as f64 * factor)))
            .expect("ascending");
    }
    matrix
}

#[test]
fn agrees_with_fraction_free_elimination() {
    let mut rng = Rng::new(11);
    for case in 0..500 {
        let rows = random(&mut rng);
        let expected = bareiss(rows.clone());
        assert_eq!(exact_rank(&csr(&rows, 1.0)).expect("within reach"), expected, "case {case}: {rows:?}");
        assert_eq!(exact_rank(&csr(&rows, 0.125)).expect("within reach"), expected, "case {case}, scaled");
        assert_eq!(
            exact_rank(&csr(&rows, 1.0).transpose().expect("few columns")).expect("within reach"),
            expected,
            "case {case}, transposed"
        );
    }
}

#[test]
fn a_difference_in_the_last_bit_counts() {
    let mut matrix = Csr::empty(2);
    matrix.push_row([(0, 1.0), (1, 1.0)]).expect("ascending");
    matrix.push_row([(0, 1.0), (1, 1.0 + f64::EPSILON)]).expect("ascending");
    assert_eq!(exact_rank(&matrix).expect("within reach"), 2);
}

#[test]
fn no_rows_have_rank_zero() {
    assert_eq!(exact_rank(&Csr::empty(3)).expect("within reach"), 0);
}

#[test]
fn thirty_thousand_rows_are_within_reach() -> Result<(), SceneError> {
    let scene = families::grid_2d(125, 125)?;
    assert_eq!(exact_rank(scene.system.matrix()).expect("within reach"), 125 * 125 - 1);
    Ok(())
}

fn assert_near(found: &[f64], known: &[f64]) {
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-14 * known[0];
    assert!(found.len() == known.len() && found.iter().zip(known).all(near), "{found:?} for {known:?}");
}

/// The singular values of `[1 1; 0 1]` are the golden ratio and its inverse, for any row scale and any prescribed DOFs.
#[test]
fn singular_values_are_those_of_equilibrated_rows_of_free_dofs() {
    let mut builder = SystemBuilder::new(3);
    builder.equation([(0, 3e300), (1, 8.0), (2, 8.0)], 1.0);
    builder.equation([(0, 1.0), (2, 0.25)], 2.0);
    builder.prescribe(0, 5.0);
    let golden = f64::midpoint(1.0, 5_f64.sqrt());
    assert_near(&singular_values(&builder.build().expect("valid")).expect("within reach"), &[golden, 1.0 / golden]);
}

#[test]
fn singular_values_of_paths_and_cycles() -> Result<(), SceneError> {
    let sine = |k: usize, n: usize| 2.0 * (std::f64::consts::PI * k as f64 / n as f64).sin();
    let path: Vec<f64> = (1..50).rev().map(|k| sine(k, 100)).collect();
    assert_near(&singular_values(&families::path(50)?.system).expect("within reach"), &path);
    let mut cycle: Vec<f64> = (0..50).map(|k| sine(k, 50)).collect();
    cycle.sort_by(|a, b| b.total_cmp(a));
    assert_near(&singular_values(&families::cycle(50, 0.0)?.system).expect("within reach"), &cycle);
    Ok(())
}

#[test]
fn rows_without_free_dofs_have_no_singular_values_but_zero() {
    let mut builder = SystemBuilder::new(2);
    builder.equation([(0, 1.0)], 1.0);
    builder.equation([(0, 1.0), (1, 1.5)], 1.0);
    builder.prescribe(0, 1.0);
    assert_near(&singular_values(&builder.build().expect("valid")).expect("within reach"), &[1.5]);
    assert_eq!(singular_values(&SystemBuilder::new(2).build().expect("valid")).expect("within reach"), [0.0; 0]);
}

/// 42 of 225 singular values are zero. Divide and conquer returns 2e-5 of the largest for one of them.
#[test]
fn many_zeros_are_zeros() -> Result<(), SceneError> {
    let scene = PeriodicCell::new(4, 4, Edges::Matching).scene(6)?;
    let (rank, values) = (
        oracle::rank_free(&scene.system).expect("within reach"),
        oracle::singular_values(&scene.system).expect("within reach"),
    );
    assert_eq!((rank, values.len()), (183, 225));
    assert!(values[rank] < 1e-14 * values[0], "{:e}", values[rank]);
    Ok(())
}
