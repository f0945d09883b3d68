//! `Steps` with each solver and each storage of K, compared with Lagrange's method.

use faer::sparse::SparseColMat;
use qless::elimination::{EliminationError, Storage, View};
use qless::{ConstraintSystem, Elimination, Options, SystemBuilder};
use qless_solve::enforce::{EnforceError, Ldlt, Llt, Lu, Problem, Solver, Steps};

use crate::linkages::{Outcome, random, spring_chain};

const DOFS: usize = 30;

/// Springs between neighbours and to the ground, with a convective term if K is to be unsymmetric.
fn stiffness(convection: f64, step: usize) -> Outcome<SparseColMat<usize, f64>> {
    let ground = |i: usize| 0.5 + 0.1 * (step + i % 3) as f64;
    spring_chain(DOFS, ground, |i| 1.0 + random(i + step).abs(), convection)
}

fn constraints(t: f64) -> Outcome<ConstraintSystem> {
    let mut builder = SystemBuilder::new(DOFS);
    builder.equation([(3, 1.0), (10, -0.25), (11, -0.75)], 0.1 * t);
    builder.equation([(3, 2.0), (10, -0.5), (11, -1.5)], 0.2 * t);
    builder.equation((15..20).map(|j| (j, 1.0)), t);
    builder.equation([(25, 1.0), (0, -1.0)], 0.0);
    builder.prescribe(0, t * t);
    builder.prescribe(29, -t);
    Ok(builder.build()?)
}

/// Starts, indices and values of the rows of one half, or of all.
fn by_rows(k: &SparseColMat<usize, f64>, storage: Storage) -> (Vec<i32>, Vec<i32>, Vec<f64>) {
    let (mut starts, mut index, mut values) = (vec![0], Vec::new(), Vec::new());
    for i in 0..DOFS {
        for j in 0..DOFS {
            let stored = match storage {
                Storage::Full => true,
                Storage::Lower => j <= i,
                Storage::Upper => j >= i,
            };
            if let Some(&v) = k.get(i, j).filter(|_| stored) {
                index.push(j as i32);
                values.push(v);
            }
        }
        starts.push(index.len() as i32);
    }
    (starts, index, values)
}

/// Twenty steps with new stiffness, loads, right-hand sides and prescribed values.
fn follow<S: Solver>(solver: S, convection: f64, storage: Storage) -> Outcome {
    let first = by_rows(&stiffness(convection, 0)?, storage);
    let map = Elimination::new(&constraints(0.0)?, &Options::default())?;
    let mut steps = Steps::new(map, View::rows(&first.0, &first.1).storing(storage), solver)?;
    for step in 0..20 {
        let t = 0.1 * step as f64;
        let (k, f) = (stiffness(convection, step)?, (0..DOFS).map(|i| random(i + 7 * step)).collect::<Vec<_>>());
        let system = constraints(t)?;
        let values: Vec<f64> = system.prescribed().iter().map(|&(_, value)| value).collect();
        steps.elimination_mut().update(system.rhs(), &values)?;
        let mut u = vec![0.0; DOFS];
        steps.solve(&by_rows(&k, storage).2, &f, &mut u)?;
        let truth = Problem::new(&k, &f, &system)?.lagrange()?.u;
        let off = u.iter().zip(&truth).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(off < 1e-12, "step {step}: {off:e}");
        let mut again = vec![0.0; DOFS];
        steps.solve_again(&by_rows(&k, storage).2, &f, &mut again)?;
        assert_eq!(u, again);
    }
    Ok(())
}

#[test]
fn every_solver_follows_the_steps() -> Outcome {
    for storage in [Storage::Full, Storage::Lower, Storage::Upper] {
        follow(Llt::default(), 0.0, storage)?;
        follow(Ldlt::default(), 0.0, storage)?;
    }
    follow(Lu::default(), 0.0, Storage::Full)?;
    // Rows of an unsymmetric matrix must not be read as its columns.
    follow(Lu::default(), 0.3, Storage::Full)
}

#[test]
fn what_a_solver_cannot_do_is_said() -> Outcome {
    let map = || -> Outcome<Elimination> { Ok(Elimination::new(&constraints(1.0)?, &Options::default())?) };
    let k = stiffness(0.0, 0)?;
    let (starts, index, values) = by_rows(&k, Storage::Lower);
    let mut steps = Steps::new(map()?, View::rows(&starts, &index).storing(Storage::Lower), Lu::default())?;
    let (f, mut u) = ([0.0; DOFS], [0.0; DOFS]);
    assert!(matches!(steps.solve(&values, &f, &mut u), Err(EnforceError::Solver(_))));
    let mut steps = Steps::new(map()?, View::rows(&starts, &index).storing(Storage::Lower), Llt::default())?;
    assert!(matches!(steps.solve_again(&values, &f, &mut u), Err(EnforceError::Solver(_))), "nothing is factored yet");
    let negative: Vec<f64> = values.iter().map(|v| -v).collect();
    assert!(matches!(steps.solve(&negative, &f, &mut u), Err(EnforceError::Solver(_))), "not positive definite");
    assert!(matches!(steps.solve(&values[1..], &f, &mut u), Err(EnforceError::Argument(_))));
    assert!(matches!(steps.solve(&values, &f[1..], &mut u), Err(EnforceError::Argument(_))));
    assert!(matches!(steps.solve(&values, &f, &mut u[1..]), Err(EnforceError::Argument(_))));
    let mut bad = f;
    bad[4] = f64::NAN;
    assert!(matches!(steps.solve(&values, &bad, &mut u), Err(EnforceError::Argument(_))));
    steps.solve(&values, &f, &mut u)?;
    Ok(())
}

/// Nothing leaves that was not checked against the equations, so steps need them.
#[test]
fn steps_need_the_equations() -> Outcome {
    let whole = Elimination::new(&constraints(1.0)?, &Options::default())?;
    let (starts, index): (Vec<u32>, Vec<u32>) =
        ((0..=whole.dofs() as u32).collect(), (0..whole.dofs() as u32).collect());
    let bare = Elimination::from_reduction(whole.reduction().clone(), whole.prescribed_values())?;
    let refused = Steps::unsymmetric(bare, View::rows(&starts, &index), Lu::default()).err().ok_or("accepted")?;
    assert!(matches!(refused, EnforceError::Elimination(EliminationError::NoEquations)), "{refused}");
    Ok(())
}
