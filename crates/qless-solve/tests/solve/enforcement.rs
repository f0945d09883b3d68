use faer::sparse::SparseColMat;
use qless::{ConstraintSystem, SystemBuilder};
use qless_solve::enforce::{EnforceError, Problem, Solution};

use crate::linkages::{Outcome, difference, random, spring_chain};

const DOFS: usize = 40;

/// A chain of springs on an elastic bed, DOFs 0 to 39, with a convective term if it is to be unsymmetric.
fn stiffness(convection: f64) -> Outcome<SparseColMat<usize, f64>> {
    spring_chain(DOFS, |i| 0.1 + 0.01 * i as f64, |i| 2.0 + random(i), convection)
}

/// Ties, a mean, a closed chain of equal DOFs, sums of rows; four of 13 equations are redundant. Two DOFs are prescribed.
fn constraints(conflict: f64) -> Outcome<ConstraintSystem> {
    let mut builder = SystemBuilder::new(DOFS);
    builder.labelled_equation("tie", [(3, 1.0), (10, -0.25), (11, -0.75)], 0.1);
    builder.labelled_equation("mean", (20..28).map(|j| (j, 1.0)), 2.0);
    for (a, b) in [(30, 31), (31, 32), (32, 33), (33, 30)] {
        builder.labelled_equation(format!("ring {a}-{b}"), [(a, 1.0), (b, -1.0)], 0.0);
    }
    builder.labelled_equation("lever", [(5, 1.0), (6, -2.0), (0, 0.5)], 0.0);
    builder.labelled_equation("tie again", [(3, 2.0), (10, -0.5), (11, -1.5)], 0.2 + conflict);
    let both = [(3, 1.0), (10, -0.25), (11, -0.75), (5, 1.0), (6, -2.0), (0, 0.5)];
    builder.labelled_equation("tie and lever", both, 0.1);
    builder.labelled_equation("step", [(15, 1.0), (16, -1.0)], 0.3);
    builder.labelled_equation("far step", [(16, 1.0), (17, -1.0)], 0.2);
    builder.labelled_equation("both steps", [(15, 1.0), (17, -1.0)], 0.5);
    builder.labelled_equation("on the wall", [(39, 1.0), (38, -1.0)], 0.05);
    builder.prescribe(0, 0.4);
    builder.prescribe(39, -0.1);
    Ok(builder.build()?)
}

fn loads() -> Vec<f64> {
    (0..DOFS).map(|j| 1.0 + random(j + 300)).collect()
}

#[track_caller]
fn assert_same(name: &str, a: &Solution, b: &Solution) {
    let reaction = |s: &Solution| s.reactions.iter().map(|r| r.1).collect::<Vec<_>>();
    assert!(difference(&a.u, &b.u) < 1e-10, "{name}: u");
    assert!(difference(&a.multipliers, &b.multipliers) < 1e-10, "{name}: multipliers");
    assert!(difference(&a.forces, &b.forces) < 1e-10, "{name}: forces");
    assert!(difference(&reaction(a), &reaction(b)) < 1e-10, "{name}: reactions");
}

/// All exact methods give the same u, multipliers, forces and reactions, for symmetric and unsymmetric K; each equation holds.
#[test]
fn methods_agree() -> Outcome {
    for convection in [0.0, 0.7] {
        let (k, f, system) = (stiffness(convection)?, loads(), constraints(0.0)?);
        let problem = Problem::new(&k, &f, &system)?;
        assert_eq!((problem.kept().len(), problem.redundant().len()), (9, 4));
        let truth = problem.lagrange()?;
        assert_same("transformation", &problem.transformation()?, &truth);
        assert_same("augmented", &problem.augmented(1e3, 1e-13)?, &truth);
        for limit in [0.0, 3.0, 1e9] {
            assert_same("mixed", &problem.mixed(&problem.plan(limit)?)?, &truth);
        }
        for row in 0..system.equations() {
            let value: f64 = system.matrix().row(row).map(|(j, v)| v * truth.u[j]).sum();
            assert!((value - system.rhs()[row]).abs() < 1e-13, "{}", system.equation_label(row));
        }
        assert!(problem.redundant().iter().all(|&row| truth.multipliers[row] == 0.0));
        assert_eq!((truth.u[0], truth.u[39]), (0.4, -0.1));
    }
    Ok(())
}

/// The plan eliminates sparse blocks and gives the mean a multiplier; the user can swap that.
#[test]
fn plan_is_by_block_and_can_be_changed() -> Outcome {
    let (k, f, system) = (stiffness(0.0)?, loads(), constraints(0.0)?);
    let problem = Problem::new(&k, &f, &system)?;
    let mut plan = problem.plan(4.0)?;
    let mean = plan.iter().position(|block| block.rows == [1]).ok_or("the mean is a block")?;
    assert!(!plan[mean].eliminate && plan.iter().filter(|block| block.eliminate).count() == plan.len() - 1);
    plan.iter_mut().for_each(|block| block.eliminate = !block.eliminate);
    assert_same("turned round", &problem.mixed(&plan)?, &problem.lagrange()?);
    plan.pop();
    assert!(matches!(problem.mixed(&plan), Err(EnforceError::Plan { .. })));
    Ok(())
}

/// Random sets of DOFs, each with a random spanning tree of ties, numbered at random. Each set of two or more is a block of a plan.
#[test]
fn blocks_of_a_plan_are_the_equations_that_share_free_dofs() -> Outcome {
    let below = |seed: usize, count: usize| ((random(seed) + 0.5) * 1e6) as usize % count;
    for seed in 0..100 {
        let set: Vec<usize> = (0..DOFS).map(|j| below(1000 * seed + j, 9)).collect();
        let mut builder = SystemBuilder::new(DOFS);
        let mut ties: Vec<(usize, usize)> = Vec::new();
        for j in 0..DOFS {
            let before: Vec<usize> = (0..j).filter(|&i| set[i] == set[j]).collect();
            if let Some(&i) = before.get(below(1000 * seed + 500 + j, before.len().max(1))) {
                ties.push((j, i));
            }
        }
        ties.sort_by_key(|&(j, i)| (7 * j + 11 * i + seed) % 13);
        ties.iter().for_each(|&(j, i)| _ = builder.equation([(j, 1.0), (i, -1.0)], 0.0));
        let (k, f, system) = (stiffness(0.0)?, loads(), builder.build()?);
        let mut found: Vec<Vec<usize>> =
            Problem::new(&k, &f, &system)?.plan(2.0)?.into_iter().map(|block| block.rows).collect();
        let of_set = |of: usize| (0..ties.len()).filter(|&row| set[ties[row].0] == of).collect::<Vec<_>>();
        let mut expected: Vec<Vec<usize>> = (0..9).map(of_set).filter(|rows| !rows.is_empty()).collect();
        found.sort();
        expected.sort();
        assert_eq!(found, expected, "{seed}");
    }
    Ok(())
}

/// The error of the penalty method falls as 1 / factor: its slope on doubly logarithmic paper is -1.
#[test]
fn penalty_follows_its_theory() -> Outcome {
    let (k, f, system) = (stiffness(0.0)?, loads(), constraints(0.0)?);
    let problem = Problem::new(&k, &f, &system)?;
    let truth = problem.transformation()?;
    let errors: Vec<f64> = (3..8)
        .map(|digits| Ok(difference(&problem.penalty(10_f64.powi(digits), 0.5)?.u, &truth.u)))
        .collect::<Result<_, EnforceError>>()?;
    for pair in errors.windows(2) {
        println!("penalty error {:.3e}", pair[0]);
        assert!((pair[0] / pair[1] - 10.0).abs() < 0.2, "{errors:?}");
    }
    Ok(())
}

fn smallest_to_largest(matrix: &SparseColMat<usize, f64>) -> Outcome<f64> {
    let values = matrix.to_dense().singular_values().map_err(|_| "no singular values")?;
    Ok(values[values.len() - 1] / values[0])
}

/// Lagrange's matrix of all equations is singular; that of the independent ones is not.
#[test]
fn redundant_equations_make_the_matrix_singular() -> Outcome {
    let (k, f, system) = (stiffness(0.0)?, loads(), constraints(0.0)?);
    let problem = Problem::new(&k, &f, &system)?;
    let all: Vec<usize> = (0..system.equations()).collect();
    assert!(smallest_to_largest(&problem.lagrange_matrix(&all)?)? < 1e-15);
    assert!(smallest_to_largest(&problem.lagrange_matrix(problem.kept())?)? > 1e-5);
    Ok(())
}

#[test]
fn what_cannot_be_solved_is_said() -> Outcome {
    let (k, f, system) = (stiffness(0.0)?, loads(), constraints(0.3)?);
    match Problem::new(&k, &f, &system) {
        Err(EnforceError::Conflict { labels, .. }) => assert_eq!(labels.len(), 1),
        _ => return Err("the conflict was not found".into()),
    }
    let system = constraints(0.0)?;
    assert!(matches!(Problem::new(&k, &f[1..], &system), Err(EnforceError::Size { found: 39, .. })));
    let problem = Problem::new(&k, &f, &system)?;
    assert!(matches!(problem.penalty(-1.0, 0.1), Err(EnforceError::Factor(_))));
    assert!(matches!(problem.augmented(1e3, 1e-19), Err(EnforceError::NoConvergence { .. })));
    // Without any stiffness, the constraints do not support the model.
    let nothing = SparseColMat::try_new_from_triplets(DOFS, DOFS, &[])?;
    let loose = Problem::new(&nothing, &f, &system)?;
    assert!(matches!(loose.transformation(), Err(EnforceError::Unsupported(_))));
    assert!(matches!(loose.lagrange(), Err(EnforceError::Unsupported(_))));
    Ok(())
}

/// A redundant equation whose coefficients differ by rounding from a combination is in doubt, but holds.
#[test]
fn equations_in_doubt_that_hold_are_no_reason_to_refuse() -> Outcome {
    for seed in 0..20 {
        let k = stiffness(0.0)?;
        let f = loads();
        let mut builder = SystemBuilder::new(DOFS);
        let row = |first: usize| [0, 3, 5].map(|j| (first + j, 1.0 + random(seed + first + j)));
        builder.equation(row(2), 0.1);
        builder.equation(row(4), 0.2);
        // About a hundredth of the tolerance.
        let both = [row(2), row(4).map(|(j, v)| (j, v * (1.0 + 1e-12 * (1.0 + random(j)))))].concat();
        builder.equation(both, 0.3);
        let system = builder.build()?;
        let analysis = qless::analyse(&system, &qless::Options::default())?;
        assert!(analysis.confidence().ambiguous && analysis.rank() == 2, "{seed}: {:?}", analysis.confidence());
        let problem = Problem::new(&k, &f, &system)?;
        assert!(difference(&problem.transformation()?.u, &problem.lagrange()?.u) < 1e-10, "{seed}: u");
    }
    Ok(())
}

/// Loads on DOFs that the equations fix do not change u; only such loads are told, and only if they are not zero.
#[test]
fn loads_on_fixed_dofs_are_told() -> Outcome {
    let k = stiffness(0.0)?;
    let mut builder = SystemBuilder::new(DOFS);
    builder.equation([(3, 1.0), (4, 1.0)], 0.5);
    builder.equation([(3, 1.0), (4, -1.0)], 0.5);
    let system = builder.build()?;
    let mut f = loads();
    f[4] = 0.0;
    let problem = Problem::new(&k, &f, &system)?;
    assert_eq!(problem.loads_without_effect(), [(3, f[3])]);
    Ok(())
}
