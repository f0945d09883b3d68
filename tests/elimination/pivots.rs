//! Which DOFs become slaves before any factorization, how many equations that leaves, and columns of T and certificates in all units.

use qless::{ConstraintSystem, Form, Kind, Options, SystemBuilder, analyse};
use qless_scenes::Rng;

/// Dense equations of DOFs in the given units, with 0 as right-hand side.
fn dense(m: usize, units: &[f64], rng: &mut Rng) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(units.len());
    for _ in 0..m {
        builder.equation(
            units.iter().enumerate().map(|(j, unit)| (j, (rng.real() + 1.5 * rng.coefficient(1)) * unit)),
            0.0,
        );
    }
    builder.build().expect("valid")
}

/// Equations of four terms each, with right-hand sides up to `largest`.
fn sparse(m: usize, units: &[f64], largest: f64, rng: &mut Rng) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(units.len());
    for i in 0..m {
        let mut dofs = [i, rng.below(units.len()), rng.below(units.len()), rng.below(units.len())].to_vec();
        dofs.sort_unstable();
        dofs.dedup();
        let terms: Vec<_> = dofs.into_iter().map(|j| (j, (rng.real() + 1.5 * rng.coefficient(1)) * units[j])).collect();
        builder.equation(terms, largest * rng.real());
    }
    builder.build().expect("valid")
}

/// Units of `2^-90` to `2^90`, most of them 1.
fn units(n: usize, rng: &mut Rng) -> Vec<f64> {
    (0..n).map(|_| 2.0_f64.powi([0, 0, 90, -90][rng.below(4)])).collect()
}

/// `a u_1 + c u_2 = 0`, said twice so that no DOF is in one equation alone: the slave is the DOF with the larger coefficient.
#[test]
fn two_terms_are_solved_for_the_larger_one() {
    for seed in 0..100 {
        let mut rng = Rng::new(seed);
        let mut builder = SystemBuilder::new(20);
        for pair in 0..10 {
            let small = 0.3 + 0.3 * rng.real().abs();
            let terms = if rng.below(2) == 0 { [1.0, small] } else { [small, 1.0] };
            for factor in [1.0, -3.0] {
                builder.equation(terms.iter().enumerate().map(|(i, v)| (2 * pair + i, v * factor)), 0.0);
            }
        }
        let reduction = analyse(&builder.build().expect("valid"), &Options::default())
            .expect("valid")
            .reduction()
            .expect("within the gate");
        assert!(reduction.growth() < 1.0, "seed {seed}: {}", reduction.growth());
        assert_eq!(reduction.slaves().len(), 10);
    }
}

/// Each column of `C [T; I]` is zero relative to the largest motion of the column, with each DOF in its unit.
#[test]
fn columns_of_t_are_accurate_in_any_unit() {
    for seed in 0..200 {
        let mut rng = Rng::new(seed);
        let (m, n) = if seed % 2 == 0 { (3 + rng.below(6), 12 + rng.below(6)) } else { (30, 50) };
        let units = units(n, &mut rng);
        let system = if seed % 2 == 0 { dense(m, &units, &mut rng) } else { sparse(m, &units, 0.0, &mut rng) };
        let options = Options { presolve: seed % 4 < 2, ..Options::default() };
        let analysis = analyse(&system, &options).expect("valid");
        for form in [Form::Explicit, Form::Factored] {
            let reduction = analysis.reduction_in(form).expect("within the gate");
            for (q, &master) in reduction.masters().iter().enumerate() {
                let mut u = vec![0.0; n];
                u[master] = 1.0;
                reduction.column(q).expect("a master").into_iter().for_each(|(i, v)| u[reduction.slaves()[i]] = v);
                let largest = u.iter().zip(&units).map(|(u, unit)| (u * unit).abs()).fold(0.0, f64::max);
                for i in (0..m).filter(|&i| analysis.kinds()[i] == Kind::Independent) {
                    let sum: f64 = system.matrix().row(i).map(|(j, v)| v * u[j]).sum();
                    let what = format!("seed {seed}, {form:?}: column of {master}, equation {i}");
                    assert!(sum.abs() <= 1e-9 * largest, "{what}: {sum:e} of {largest:e}");
                }
            }
        }
    }
}

/// Slaves with a small T in mixed units can be as good as dependent. No units prevent a reduction whose rank is not in doubt.
#[test]
fn equations_with_sides_are_reduced_in_any_unit() {
    for seed in 0..400 {
        let mut rng = Rng::new(seed);
        let units = units(50, &mut rng);
        let system = sparse(30, &units, 1.0, &mut rng);
        let analysis = analyse(&system, &Options { presolve: seed % 2 == 0, ..Options::default() }).expect("valid");
        for form in [Form::Explicit, Form::Factored] {
            let refused = analysis.reduction_in(form).err();
            assert!(refused.is_none() || analysis.confidence().ambiguous, "seed {seed}, {form:?}: {refused:?}");
        }
    }
}

/// A part of the second of these systems needs other units for its T (seed 11 of the test above); the first keeps its T to the last bit.
#[test]
fn units_of_one_part_do_not_change_another() {
    let drawn = |seed: u64| {
        let mut rng = Rng::new(seed);
        let units = units(50, &mut rng);
        sparse(30, &units, 1.0, &mut rng)
    };
    let reduced = |systems: &[&ConstraintSystem]| {
        let mut builder = SystemBuilder::new(50 * systems.len());
        for (k, system) in systems.iter().enumerate() {
            (0..30).for_each(|i| {
                let terms: Vec<_> = system.matrix().row(i).map(|(j, v)| (50 * k + j, v)).collect();
                builder.equation(terms, system.rhs()[i]);
            });
        }
        let options = Options { presolve: false, ..Options::default() };
        analyse(&builder.build().expect("valid"), &options).expect("valid").reduction().expect("within the gate")
    };
    let other = drawn(11);
    for seed in 20..60 {
        let first = drawn(seed);
        let (alone, both) = (reduced(&[&first]), reduced(&[&first, &other]));
        let of_first: Vec<usize> = both.slaves().iter().copied().filter(|&s| s < 50).collect();
        assert_eq!(of_first, alone.slaves(), "seed {seed}");
        for i in 0..alone.slaves().len() {
            assert!(alone.t().row(i).eq(both.t().row(i)) && alone.g()[i] == both.g()[i], "seed {seed}, row {i}");
        }
    }
}

/// The entries of T that belong to slaves, by rows and by columns, and the largest of them, if T is a factor.
#[test]
fn factors_have_the_rows_and_the_growth_of_t() {
    for seed in 0..100 {
        let mut rng = Rng::new(seed);
        let (m, n) = (4 + rng.below(6), 14 + rng.below(6));
        let system = dense(m, &vec![1.0; n], &mut rng);
        let reduction = analyse(&system, &Options::default())
            .expect("valid")
            .reduction_in(Form::Factored)
            .expect("within the gate");
        let mut t = vec![vec![0.0; reduction.masters().len()]; m];
        for q in 0..reduction.masters().len() {
            reduction.column(q).expect("a master").into_iter().for_each(|(i, v)| t[i][q] = v);
        }
        for (i, by_column) in t.iter().enumerate() {
            let mut by_row = vec![0.0; by_column.len()];
            reduction.row(i).expect("a slave").into_iter().for_each(|(q, v)| by_row[q] = v);
            let off = by_row.iter().zip(by_column).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-10, "seed {seed}: row {i} is off by {off:e}");
        }
        let most = t.iter().flatten().fold(0.0, |most: f64, v| most.max(v.abs()));
        for block in reduction.factored() {
            let growth = block.growth();
            assert!(growth <= most * (1.0 + 1e-10) && growth > 0.5 * most, "seed {seed}: {growth} for {most}");
        }
        assert!(!reduction.is_explicit(), "seed {seed}");
    }
}

/// `e_s = sum c_i row_i` for DOFs that the equations fix, in every column relative to its terms, and without terms that are rounding.
#[test]
fn fixed_dofs_are_explained_in_any_unit() {
    for seed in 0..150 {
        let mut rng = Rng::new(seed);
        let parts = 2;
        let n = 3 + rng.below(4);
        let units = units(parts * n, &mut rng);
        let mut builder = SystemBuilder::new(parts * n);
        for part in 0..parts {
            let system = dense(n, &units[part * n..][..n], &mut rng);
            (0..n).for_each(|i| _ = builder.equation(system.matrix().row(i).map(|(j, v)| (part * n + j, v)), 1.0));
        }
        let system = builder.build().expect("valid");
        let analysis = analyse(&system, &Options::default()).expect("valid");
        assert_eq!(analysis.generated().len(), parts * n, "seed {seed}");
        for s in 0..parts * n {
            let because = analysis.because_fixed(s).expect("factored once more");
            let mut columns = vec![(0.0_f64, 0.0_f64); parts * n];
            columns[s] = (-1.0, 1.0);
            for term in &because {
                assert_eq!(term.row / n, s / n, "seed {seed}: another part does not matter");
                for (j, v) in system.matrix().row(term.row) {
                    let part = term.coefficient * v;
                    columns[j] = (columns[j].0 + part, columns[j].1 + part.abs());
                }
            }
            for (j, (sum, size)) in columns.into_iter().enumerate() {
                assert!(sum.abs() <= 1e-9 * size, "seed {seed}, DOF {s}: {sum:e} of {size:e} at {j}");
            }
        }
    }
}

/// Elimination without fill solves sparse equations of three terms, in a band with loops, without a factorization. These are counts of
/// work, not of time.
#[test]
fn sparse_bands_need_no_factorization() {
    let mut eliminated = 0;
    for seed in 0..100 {
        let mut rng = Rng::new(seed);
        let mut builder = SystemBuilder::new(60);
        for i in 0..40 {
            let first = i + i / 2;
            let terms = [first, (first + 1 + rng.below(3)) % 60, (first + 5 + rng.below(4)) % 60]
                .map(|j| (j, rng.coefficient(3)));
            builder.equation(terms, 0.0);
            if rng.below(3) == 0 {
                builder.equation(terms.map(|(j, v)| (j, 2.0 * v)), 0.0);
            }
        }
        let presolve = analyse(&builder.build().expect("valid"), &Options::default()).expect("valid").presolve();
        assert_eq!(presolve.core_rows, 0, "seed {seed}");
        eliminated += presolve.rows_removed_by_elimination;
    }
    assert!(eliminated > 3000, "{eliminated}");
}
