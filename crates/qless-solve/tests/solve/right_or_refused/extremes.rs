//! Models without free DOFs or stiffness, numbers at the ends of the range, and independent parts.

use faer::sparse::{SparseColMat, Triplet};
use qless::elimination::View;
use qless::{Elimination, Options, SystemBuilder};
use qless_solve::enforce::{EnforceError, Llt, Method, Problem, Solution, Steps};

use super::models::{Kind, Lack, Model, PLAIN, model};
use crate::linkages::Outcome;

fn matrix(n: usize, entries: &[(usize, usize, f64)]) -> Outcome<SparseColMat<usize, f64>> {
    let entries: Vec<_> = entries.iter().map(|&(i, j, v)| Triplet::new(i, j, v)).collect();
    Ok(SparseColMat::try_new_from_triplets(n, n, &entries)?)
}

fn by_all(problem: &Problem) -> [Result<Solution, EnforceError>; 4] {
    [problem.transformation(), problem.lagrange(), problem.penalty(1e6, 1e-3), problem.augmented(1e4, 1e-12)]
}

#[test]
fn nothing_to_solve_is_solved() -> Outcome {
    // All DOFs are prescribed; K affects the reactions only.
    let k = matrix(2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0)])?;
    let mut builder = SystemBuilder::new(2);
    builder.prescribe(0, 1.0);
    builder.prescribe(1, -1.0);
    let system = builder.build()?;
    for solution in by_all(&Problem::new(&k, &[0.5, 0.0], &system)?) {
        let solution = solution?;
        assert_eq!((solution.u, solution.reactions), (vec![1.0, -1.0], vec![(0, 2.5), (1, -3.0)]));
    }
    let map = Elimination::new(&system, &Options::default())?;
    let mut steps = Steps::new(map, View::columns(&[0, 2, 4], &[0_u32, 1, 0, 1]), Llt::default())?;
    let mut u = [0.0; 2];
    steps.solve(&[2.0, -1.0, -1.0, 2.0], &[0.5, 0.0], &mut u)?;
    assert_eq!(u, [1.0, -1.0]);
    // Equations fix all DOFs, and there is no stiffness at all.
    let mut builder = SystemBuilder::new(2);
    builder.equation([(0, 1.0), (1, 1.0)], 3.0);
    builder.equation([(0, 1.0), (1, -1.0)], 1.0);
    let system = builder.build()?;
    let nothing = matrix(2, &[])?;
    let problem = Problem::new(&nothing, &[1.0, 0.0], &system)?;
    for solution in [problem.transformation()?, problem.lagrange()?] {
        assert!((solution.u[0] - 2.0).abs() < 1e-14 && (solution.u[1] - 1.0).abs() < 1e-14);
        assert!((solution.forces[0] + 1.0).abs() < 1e-14 && solution.forces[1].abs() < 1e-14);
    }
    Ok(())
}

/// From 1e-300 to 1e300 the result is right or an error, and never a panic.
#[test]
fn numbers_at_the_ends_of_the_range_do_no_harm() -> Outcome {
    for s in [1e-300, 1e-150, 1e150, 1e300] {
        for force in [1e-300, 1.0, 1e300] {
            let k = matrix(3, &[(0, 0, 2.0 * s), (1, 1, 3.0 * s), (2, 2, 5.0 * s)])?;
            let mut builder = SystemBuilder::new(3);
            builder.equation([(0, 1.0), (1, -1.0)], 0.0);
            let system = builder.build()?;
            let f = [5.0 * force, 0.0, 0.0];
            for solution in by_all(&Problem::new(&k, &f, &system)?).into_iter().flatten() {
                let exact = force / s;
                assert!((solution.u[0] - exact).abs() <= 2e-3 * exact, "{s:e}, {force:e}: {:?}", solution.u);
            }
        }
    }
    Ok(())
}

/// A part that is 1e12 times softer is measured by its own forces; they are in balance, and its free motion is found.
#[test]
fn parts_are_judged_by_themselves() -> Outcome {
    for lack in [Lack::Nothing, Lack::Ground] {
        let (stiff, soft) = (model(1, Kind::Symmetric, Lack::Nothing, PLAIN)?, model(4, Kind::Symmetric, lack, PLAIN)?);
        let (n, m) = (stiff.f.len(), soft.f.len());
        let scaled = |model: &Model, first: usize, s: f64| {
            let k = &model.k;
            (0..k.ncols())
                .flat_map(|j| {
                    let column = k.symbolic().row_idx_of_col(j).zip(k.val_of_col(j));
                    column.map(|(i, v)| (first + i, first + j, s * v)).collect::<Vec<_>>()
                })
                .collect::<Vec<_>>()
        };
        let k = matrix(n + m, &[scaled(&stiff, 0, 1.0), scaled(&soft, n, 1e-12)].concat())?;
        let mut builder = SystemBuilder::new(n + m);
        for (model, first) in [(&stiff, 0), (&soft, n)] {
            for row in 0..model.system.equations() {
                let terms = model.system.matrix().row(row).map(|(j, v)| (first + j, v));
                builder.equation(terms, model.system.rhs()[row]);
            }
            model.system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(first + j, value));
        }
        let system = builder.build()?;
        let f: Vec<f64> = stiff.f.iter().copied().chain(soft.f.iter().map(|f| 1e-12 * f)).collect();
        let alone = Problem::new(&soft.k, &soft.f, &soft.system)?;
        for (both, alone) in by_all(&Problem::new(&k, &f, &system)?).into_iter().zip(by_all(&alone)) {
            match (both, alone) {
                (Ok(both), Ok(alone)) => {
                    let most = alone.u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
                    let off = both.u[n..].iter().zip(&alone.u).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
                    assert!(off <= 1e-9 * most, "{off:e} of {most:e}");
                }
                (Err(EnforceError::Unsupported(both)), Err(EnforceError::Unsupported(alone))) => {
                    assert_eq!(both.dofs, alone.dofs.iter().map(|j| n + j).collect::<Vec<_>>());
                }
                (both, alone) => return Err(format!("{both:?} with, {alone:?} without the other part").into()),
            }
        }
    }
    Ok(())
}

/// Equations in other units and in another order give the same results.
#[test]
fn equations_may_be_multiplied() -> Outcome {
    let model = model(10, Kind::Symmetric, Lack::Nothing, PLAIN)?;
    let mut builder = SystemBuilder::new(model.f.len());
    for row in (0..model.system.equations()).rev() {
        let factor = [1e-9, 1.0, 1e7][row % 3];
        let terms = model.system.matrix().row(row).map(|(j, v)| (j, factor * v));
        builder.equation(terms, factor * model.system.rhs()[row]);
    }
    model.system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(j, value));
    let system = builder.build()?;
    let (plain, other) = (Problem::new(&model.k, &model.f, &model.system)?, Problem::new(&model.k, &model.f, &system)?);
    for (a, b) in by_all(&plain).into_iter().zip(by_all(&other)) {
        let (a, b) = (a?, b?);
        let most = a.u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        let off = a.u.iter().zip(&b.u).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(off <= 1e-9 * most, "{off:e} of {most:e}");
    }
    let methods = vec![Method::Augmented { factor: f64::MAX }; system.equations()];
    assert!(matches!(other.enforce(&methods, 1e-9), Err(EnforceError::Factor(_))));
    Ok(())
}

/// If K and the equations are multiplied by any numbers, u is the same, or the error says that a result leaves the range of doubles.
#[test]
fn factors_of_1e290_change_nothing() -> Outcome {
    let ends = [1e-290, 1e-150, 1e-20, 1.0, 1e20, 1e150, 1e290];
    let plain =
        [(0, 0, 3.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0), (1, 2, -1.0), (2, 1, -1.0), (2, 2, 1.5), (3, 3, 1.0)];
    let mut right = 0;
    for (stiff, row) in ends.into_iter().flat_map(|stiff| ends.map(|row| (stiff, row))) {
        for held in [true, false] {
            let k: Vec<_> =
                plain.iter().filter(|entry| held || entry.0 < 3).map(|&(i, j, v)| (i, j, v * stiff)).collect();
            let mut builder = SystemBuilder::new(4);
            builder.equation([(0, row), (2, -2.0 * row)], 0.5 * row);
            builder.equation([(0, -4.0), (2, 8.0)], -2.0);
            let (system, f) = (builder.build()?, [1.0, 2.0, -1.0, 3.0].map(|f| f * stiff));
            let k = matrix(4, &k)?;
            // With u_0 = 2 u_2 + 1/2 and u_1 from its own row: 9 u_2 = 7/4.
            let exact = [16.0 / 18.0, (2.0 + 16.0 / 18.0 + 7.0 / 36.0) / 2.0, 7.0 / 36.0, 3.0];
            for solved in by_all(&Problem::new(&k, &f, &system)?) {
                match solved {
                    Ok(solution) => {
                        let off = (0..4).map(|j| (solution.u[j] - exact[j]).abs()).fold(0.0, f64::max);
                        assert!(held && off < 1e-4, "{stiff:e}, {row:e}: {:?}", solution.u);
                        right += 1;
                    }
                    Err(EnforceError::Unsupported(motion)) => {
                        assert!(!held && motion.dofs == [3], "{stiff:e}, {row:e}");
                    }
                    // lambda is the stiffness divided by the factor of the row.
                    Err(EnforceError::OutOfRange) => assert!(stiff / row > 1e300, "{stiff:e}, {row:e}"),
                    Err(other) => return Err(format!("{stiff:e}, {row:e}: {other}").into()),
                }
            }
        }
    }
    assert!(right > 150, "{right}");
    Ok(())
}

/// Neighbours whose stiffness differs by 1e20: a stiff spring hides the soft one in `K + C^T D C`, but not in `[K C^T; C -1/D]`.
#[test]
fn penalties_between_stiff_and_soft_are_no_alarm() -> Outcome {
    for s in [1e-6, 1.0, 1e6] {
        let k = matrix(2, &[(0, 0, 1e20 * s), (1, 1, s)])?;
        let mut builder = SystemBuilder::new(2);
        builder.equation([(0, 1.0), (1, -1.0)], 0.0);
        let system = builder.build()?;
        for f in [[1.0, 0.0], [0.0, 1.0], [1e20, 1.0]] {
            let problem = Problem::new(&k, &f, &system)?;
            let exact = (f[0] + f[1]) / (1e20 * s + s);
            for solution in [problem.penalty(1e8, 1e-6)?, problem.augmented(1e8, 1e-9)?] {
                assert!(solution.u.iter().all(|u| (u - exact).abs() <= 2e-6 * exact), "{s:e}, {f:?}: {:?}", solution.u);
            }
        }
    }
    Ok(())
}

/// Factors, accuracies and limits that are not positive are refused, also for equations that are not enforced.
#[test]
fn parameters_that_mean_nothing_are_refused() -> Outcome {
    let k = matrix(2, &[(0, 0, 1.0), (1, 1, 1.0)])?;
    let mut builder = SystemBuilder::new(2);
    builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    builder.equation([(0, 2.0), (1, -2.0)], 0.0);
    let system = builder.build()?;
    let problem = Problem::new(&k, &[1.0, 0.0], &system)?;
    for bad in [f64::NAN, -1.0, 0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY] {
        for row in 0..2 {
            for method in [Method::Penalty { factor: bad }, Method::Augmented { factor: bad }] {
                let mut methods = [Method::Multiplier; 2];
                methods[row] = method;
                assert!(matches!(problem.enforce(&methods, 1e-3), Err(EnforceError::Factor(_))), "{method:?}");
            }
        }
        assert!(matches!(problem.enforce(&[Method::Multiplier; 2], bad), Err(EnforceError::Accuracy(_))), "{bad}");
        if bad.is_nan() || bad < 0.0 {
            assert!(matches!(problem.plan(bad), Err(EnforceError::Limit(_))), "{bad}");
        }
        if !bad.is_finite() {
            let reduction = qless::analyse(&system, &Options::default())?.reduction()?;
            let refused = qless_solve::enforce::reduced(&k, &[bad, 0.0], &reduction, &[]);
            assert!(matches!(refused, Err(EnforceError::NotFinite { .. })), "{bad}");
        }
    }
    assert!(problem.plan(f64::INFINITY)?.iter().all(|block| block.eliminate));
    Ok(())
}
