//! Nothing free, nothing stiff; numbers at the ends of the range; parts that have nothing to do with one another.

use faer::sparse::{SparseColMat, Triplet};
use qless::{Map, Options, SystemBuilder, View};
use qless_constraints::enforce::{EnforceError, Llt, Method, Problem, Solution, Steps};

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
    // All DOFs are prescribed; K has no say but in the reactions.
    let k = matrix(2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0)])?;
    let mut builder = SystemBuilder::new(2);
    builder.prescribe(0, 1.0);
    builder.prescribe(1, -1.0);
    let system = builder.build()?;
    for solution in by_all(&Problem::new(&k, &[0.5, 0.0], &system)?) {
        let solution = solution?;
        assert_eq!((solution.u, solution.reactions), (vec![1.0, -1.0], vec![(0, 2.5), (1, -3.0)]));
    }
    let map = Map::new(&system, &Options::default())?;
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

/// Right or refused, without a panic, from 1e-300 to 1e300.
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

/// A part 1e12 times softer is measured by itself: its forces are in balance too, and its motion is found.
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

/// Equations in other units, and in another order, are the same equations.
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
    assert!(matches!(
        other.enforce(&methods, 1e-9),
        Err(EnforceError::Factor(_) | EnforceError::PenaltyTooLarge { .. })
    ));
    Ok(())
}
