//! Order, blocks, threads and primes do not change an exact rank; exceeding the memory limit is an error.

use qless::exact::{self, ExactError, ExactRank, Reading, Settings};
use qless::{ConstraintSystem, SystemBuilder};
use qless_scenes::{Rng, families};

/// Systems of several components, some dependent or conflicting, whose elimination fills in.
fn random(rng: &mut Rng) -> ConstraintSystem {
    let (m, n) = (3 + rng.below(30), 3 + rng.below(40));
    let mut builder = SystemBuilder::new(n);
    let mut rows: Vec<(Vec<(usize, f64)>, f64)> = Vec::new();
    for _ in 0..m {
        let row = match rng.below(4) {
            0 if !rows.is_empty() => {
                let (terms, b) = &rows[rng.below(rows.len())];
                let factor = rng.coefficient(3);
                (terms.iter().map(|&(j, v)| (j, factor * v)).collect(), factor * b + [0.0, 0.0, 1.0][rng.below(3)])
            }
            _ => {
                let count = 1 + rng.below(4);
                let terms =
                    rng.distinct(count, n).expect("few").into_iter().map(|j| (j, rng.coefficient(9) / 8.0)).collect();
                (terms, rng.coefficient(4))
            }
        };
        rows.push(row);
    }
    for (terms, b) in rows {
        builder.equation(terms, b);
    }
    let count = rng.below(4);
    rng.distinct(count, n).expect("few").into_iter().for_each(|dof| builder.prescribe(dof, rng.coefficient(5) / 10.0));
    builder.build().expect("valid")
}

/// The equations of several systems in one, with rows in the given order and new DOF numbers.
fn reordered(systems: &[&ConstraintSystem], rng: &mut Rng) -> (ConstraintSystem, Vec<usize>) {
    let dofs = systems.iter().map(|system| system.dofs()).sum();
    let columns = rng.permutation(dofs).expect("few");
    let (mut rows, mut first) = (Vec::new(), 0);
    let mut builder = SystemBuilder::new(dofs);
    for system in systems {
        for i in 0..system.equations() {
            let terms: Vec<_> = system.matrix().row(i).map(|(j, v)| (columns[first + j], v)).collect();
            rows.push((terms, system.rhs()[i]));
        }
        system.prescribed().iter().for_each(|&(dof, value)| builder.prescribe(columns[first + dof], value));
        first += system.dofs();
    }
    let order = rng.permutation(rows.len()).expect("few");
    for &i in &order {
        builder.equation(rows[i].0.clone(), rows[i].1);
    }
    (builder.build().expect("valid"), order)
}

fn exact(system: &ConstraintSystem, reading: Reading) -> ExactRank {
    exact::rank(system, reading).expect("small")
}

/// The result of the component of each equation.
fn by_equation(exact: &ExactRank) -> Vec<exact::PartRank> {
    exact.part_of.iter().map(|&part| exact.parts[part as usize]).collect()
}

#[test]
fn every_part_keeps_its_rank_in_any_order_and_any_company() {
    let mut rng = Rng::new(2);
    for case in 0..300 {
        let (a, b) = (random(&mut rng), random(&mut rng));
        let (both, order) = reordered(&[&a, &b], &mut rng);
        for reading in [Reading::Typed, Reading::Stored] {
            let alone = [exact(&a, reading), exact(&b, reading)];
            let together = exact(&both, reading);
            let expected = [by_equation(&alone[0]), by_equation(&alone[1])].concat();
            let expected: Vec<_> = order.iter().map(|&i| expected[i]).collect();
            assert_eq!(by_equation(&together), expected, "case {case}, {reading:?}");
            assert_eq!(together.rank, alone[0].rank + alone[1].rank);
            assert_eq!(together.is_solvable(), alone[0].is_solvable() && alone[1].is_solvable());
        }
    }
}

#[test]
fn totals_are_those_of_the_parts() {
    let mut rng = Rng::new(3);
    for _ in 0..300 {
        let system = random(&mut rng);
        let exact = exact(&system, Reading::Typed);
        assert_eq!(exact.parts.iter().map(|part| part.rank).sum::<usize>(), exact.rank);
        assert_eq!(exact.parts.iter().map(|part| part.equations).sum::<usize>(), system.equations());
        assert_eq!(exact.parts.iter().all(|part| part.solvable), exact.is_solvable());
        assert!(exact.parts.iter().all(|part| part.equations > 0 && part.rank <= part.equations));
        assert!(exact.augmented_rank - exact.rank <= 1);
    }
}

/// Eighths are the same number in both readings.
#[test]
fn coefficients_that_are_exact_in_binary_have_one_rank() {
    let mut rng = Rng::new(4);
    for _ in 0..300 {
        let (matrix, rows) = {
            let system = random(&mut rng);
            (system.matrix().clone(), system.equations())
        };
        let system = ConstraintSystem::from_csr(&matrix, &vec![0.0; rows], &[]).expect("valid");
        let [typed, stored] = [Reading::Typed, Reading::Stored].map(|reading| exact(&system, reading));
        assert_eq!((typed.rank, typed.parts), (stored.rank, stored.parts));
    }
}

#[test]
fn threads_change_nothing_and_primes_only_themselves() {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    let (one, two) = (pool(1), pool(2));
    let mut rng = Rng::new(6);
    for seed in 0..100 {
        let system = random(&mut rng);
        let first = exact(&system, Reading::Typed);
        assert_eq!(one.install(|| exact(&system, Reading::Typed)), first);
        assert_eq!(two.install(|| exact(&system, Reading::Typed)), first);
        let mut other = exact::rank(&system, Settings { seed: seed + 2, ..Reading::Typed.into() }).expect("small");
        assert!(other.primes.iter().all(|p| !first.primes.contains(p)));
        other.primes = first.primes;
        assert_eq!(other, first);
    }
}

/// A full matrix of 60 rows holds 3,600 coefficients, and a sparse one fills in.
#[test]
fn fill_beyond_the_limit_is_refused_with_its_size() {
    let mut rng = Rng::new(7);
    let mut matrix = |n: usize, count: usize| {
        let mut builder = SystemBuilder::new(n);
        for _ in 0..n {
            let terms: Vec<_> =
                rng.distinct(count, n).expect("few").into_iter().map(|j| (j, rng.coefficient(99))).collect();
            builder.equation(terms, 1.0);
        }
        builder.build().expect("valid")
    };
    for (system, limit) in [(matrix(60, 60), 3000), (matrix(400, 6), 5000)] {
        let settings = Settings { fill: limit, ..Reading::Typed.into() };
        let Err(ExactError::Fill { rows, fill, limit: told }) = exact::rank(&system, settings) else {
            panic!("{} rows were not refused", system.equations())
        };
        assert!(rows <= system.equations() && told == limit);
        // The limit stops the run early.
        assert!(fill > limit && fill < 2 * limit, "{fill}");
        assert_eq!(exact(&system, Reading::Typed).rank, system.equations());
    }
}

/// Peeled equations need no memory.
#[test]
fn peeled_equations_do_not_count_as_fill() {
    let path = families::path(1000).expect("a scene").system;
    let settings = Settings { fill: 0, ..Reading::Typed.into() };
    assert_eq!(exact::rank(&path, settings).map(|exact| exact.rank), Ok(999));
}
