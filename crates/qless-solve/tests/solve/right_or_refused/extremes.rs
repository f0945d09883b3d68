//! Models without free DOFs or stiffness, numbers at the ends of the range, and independent parts.

use faer::sparse::{SparseColMat, Triplet};
use qless::elimination::View;
use qless::{Elimination, Options, SystemBuilder};
use qless_solve::enforce::{EnforceError, Llt, Method, Problem, Solution, Steps};

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
