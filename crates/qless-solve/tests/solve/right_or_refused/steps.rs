//! `Steps` with every solver and every storage.

use faer::sparse::SparseColMat;
use qless::elimination::{Storage, View};
use qless::{Elimination, Options};
use qless_solve::enforce::{EnforceError, Ldlt, Llt, Lu, Problem, Solver, SolverError, Steps};

use super::models::{Kind, Lack, Model, Units, all_units, model, off};
use crate::linkages::Outcome;

type Solved = Result<Vec<f64>, EnforceError>;

/// Starts, rows and values of the columns of one half or of all entries.
fn columns(k: &SparseColMat<usize, f64>, storage: Storage) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for j in 0..k.ncols() {
        for (i, &v) in k.symbolic().row_idx_of_col(j).zip(k.val_of_col(j)) {
            let stored = match storage {
                Storage::Full => true,
                Storage::Lower => i >= j,
                Storage::Upper => i <= j,
            };
            if stored {
                rows.push(i);
                values.push(v);
            }
        }
        starts.push(rows.len());
    }
    (starts, rows, values)
}

fn step<S: Solver>(model: &Model, solver: S, storage: Storage) -> Outcome<Solved> {
    let (starts, rows, values) = columns(&model.k, storage);
    let map = Elimination::new(&model.system, &Options::default())?;
    let mut steps = Steps::new(map, View::columns(&starts, &rows).storing(storage), solver)?;
    let mut u = vec![0.0; model.f.len()];
    Ok(steps.solve(&values, &model.f, &mut u).map(|()| u))
}

fn by_all(model: &Model, kind: Kind) -> Outcome<Vec<(&'static str, Solved)>> {
    let mut found = vec![("LU", step(model, Lu::default(), Storage::Full)?)];
    if kind == Kind::Symmetric {
        found.push(("LLT", step(model, Llt::default(), Storage::Lower)?));
        found.push(("LLT, upper", step(model, Llt::default(), Storage::Upper)?));
        found.push(("LDLT", step(model, Ldlt::default(), Storage::Full)?));
    }
    Ok(found)
}

#[test]
fn steps_are_right_where_the_model_is_held() -> Outcome {
    let units: Vec<Units> = all_units().collect();
    for case in 0..90 {
        let kind = [Kind::Symmetric, Kind::Unsymmetric, Kind::Indefinite][case / 3 % 3];
        let model = model(case, kind, Lack::Nothing, units[case / 9 % 9])?;
        let truth = Problem::new(&model.k, &model.f, &model.system)?.transformation()?;
        for (name, u) in by_all(&model, kind)? {
            let u = u.map_err(|error| format!("{}: {name}: {error}", model.name))?;
            let error = off(&model, &u, &truth.u);
            assert!(error <= 3.0 * truth.accuracy, "{}: {name}: {error:e}", model.name);
        }
    }
    Ok(())
}

#[test]
fn steps_are_refused_where_it_is_not() -> Outcome {
    let units: Vec<Units> = all_units().collect();
    for case in 0..90 {
        let lack = [Lack::Ground, Lack::Tie, Lack::Stiffness][case / 3 % 3];
        let kind = [Kind::Symmetric, Kind::Unsymmetric][case / 9 % 2];
        let model = model(case, kind, lack, units[case / 9 % 9])?;
        for (name, u) in by_all(&model, kind)? {
            match u {
                Err(EnforceError::Unsupported(motion)) => assert!(!motion.dofs.is_empty(), "{}: {name}", model.name),
                other => return Err(format!("{}: {name}: {other:?}", model.name).into()),
            }
        }
    }
    Ok(())
}

/// A solver that returns wrong results is detected.
#[test]
fn a_wrong_solver_is_found_out() -> Outcome {
    struct Wrong(Llt, f64);
    impl Solver for Wrong {
        fn factor(&mut self, matrix: qless_solve::enforce::SolverMatrix) -> Result<(), SolverError> {
            self.0.factor(matrix)
        }
        fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError> {
            self.0.solve(b)?;
            b[0] *= self.1;
            Ok(())
        }
    }
    let model = model(0, Kind::Symmetric, Lack::Nothing, super::models::PLAIN)?;
    let truth = step(&model, Llt::default(), Storage::Lower)??;
    // A small error is refined away; a large one is refused.
    let u = step(&model, Wrong(Llt::default(), 1.0 + 1e-6), Storage::Lower)??;
    assert!(off(&model, &u, &truth) < 1e-11);
    let far = step(&model, Wrong(Llt::default(), 3.0), Storage::Lower)?;
    assert!(matches!(far, Err(EnforceError::OutOfBalance { .. })), "{far:?}");
    Ok(())
}

/// After a refused step, there are no factors to solve with, whatever the load.
#[test]
fn nothing_is_solved_with_what_was_refused() -> Outcome {
    let model = model(0, Kind::Symmetric, Lack::Ground, super::models::PLAIN)?;
    let (starts, rows, values) = columns(&model.k, Storage::Lower);
    let map = Elimination::new(&model.system, &Options::default())?;
    let view = View::columns(&starts, &rows).storing(Storage::Lower);
    let mut steps = Steps::new(map, view, Llt::default())?;
    let (none, mut u) = (vec![0.0; model.f.len()], vec![0.0; model.f.len()]);
    assert!(matches!(steps.solve(&values, &none, &mut u), Err(EnforceError::Unsupported(_))));
    assert!(matches!(steps.solve_again(&values, &none, &mut u), Err(EnforceError::Solver(_))));
    Ok(())
}
