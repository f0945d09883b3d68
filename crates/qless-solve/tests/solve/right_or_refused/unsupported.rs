//! Unsupported models: every method names the DOFs that move.

use faer::sparse::{SparseColMat, Triplet};
use qless::{ConstraintSystem, SystemBuilder};
use qless::{Options, analyse};
use qless_solve::enforce::{EnforceError, FreeMotion, Method, Problem, Solution, reduced};

use super::models::{Kind, Lack, Model, Units, all_units, model};
use crate::linkages::Outcome;

type Solved = Result<Solution, EnforceError>;

/// The result of each method.
fn all_methods(problem: &Problem, equations: usize) -> Result<Vec<(&'static str, Solved)>, EnforceError> {
    let turns =
        [Method::Elimination, Method::Multiplier, Method::Augmented { factor: 1e5 }, Method::Penalty { factor: 1e6 }];
    let rows: Vec<Method> = (0..equations).map(|i| turns[i % 4]).collect();
    Ok(vec![
        ("transformation", problem.transformation()),
        ("lagrange", problem.lagrange()),
        ("mixed", problem.mixed(&problem.plan(3.0)?)),
        ("penalty", problem.penalty(1e7, 1e-2)),
        ("stiff penalty", problem.penalty(1e12, 1e-2)),
        ("augmented", problem.augmented(1e6, 1e-10)),
        ("row by row", problem.enforce(&rows, 1e-2)),
    ])
}

/// All methods refuse the model, and K and C do not resist the motion that they name.
#[track_caller]
fn refused(name: &str, k: &SparseColMat<usize, f64>, f: &[f64], system: &ConstraintSystem) -> Outcome<FreeMotion> {
    let problem = Problem::new(k, f, system)?;
    let mut last = None;
    for (method, solved) in all_methods(&problem, system.equations())? {
        match solved {
            Err(EnforceError::Unsupported(motion)) => {
                felt(name, k, system, &motion);
                last = Some(motion);
            }
            Err(other) => return Err(format!("{name}: {method}: {other}").into()),
            Ok(solution) => {
                let most = solution.u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
                return Err(format!("{name}: {method}: u = {most:e}, accuracy {:e}", solution.accuracy).into());
            }
        }
    }
    Ok(last.ok_or("a method")?)
}

/// `v^T K v` and `C v` are small compared with their terms; v is zero at prescribed DOFs.
fn felt(name: &str, k: &SparseColMat<usize, f64>, system: &ConstraintSystem, motion: &FreeMotion) {
    let mut v = vec![0.0; k.ncols()];
    motion.dofs.iter().zip(&motion.motion).for_each(|(&dof, &value)| v[dof] = value);
    let (mut work, mut size) = (0.0, 0.0_f64);
    for j in 0..v.len() {
        for (i, s) in k.symbolic().row_idx_of_col(j).zip(k.val_of_col(j)) {
            work += v[i] * s * v[j];
            size += (v[i] * s * v[j]).abs();
        }
    }
    assert!(f64::abs(work) <= 1e-11 * size, "{name}: work {work:e} of {size:e}");
    let largest = v.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    assert!(largest > 0.0, "{name}: a motion");
    for row in 0..system.equations() {
        let gap: f64 = system.matrix().row(row).map(|(j, c)| c * v[j]).sum();
        let size: f64 = system.matrix().row(row).map(|(j, c)| (c * v[j]).abs()).sum();
        assert!(gap.abs() <= 1e-5 * size, "{name}: {gap:e} of {size:e}");
    }
    assert!(system.prescribed().iter().all(|&(j, _)| v[j] == 0.0), "{name}: prescribed DOFs do not move");
}

/// No ground, a missing tie, a DOF without stiffness; K symmetric, unsymmetric, negative.
#[test]
fn two_hundred_models_are_refused_by_all_methods() -> Outcome {
    let units: Vec<Units> = all_units().collect();
    for case in 0..200 {
        let lack = [Lack::Ground, Lack::Tie, Lack::Stiffness][case / 3 % 3];
        let kind = [Kind::Symmetric, Kind::Unsymmetric, Kind::Indefinite][case / 9 % 3];
        let Model { k, mut f, system, name, .. } = model(case, kind, lack, units[case / 27 % 9])?;
        // A balanced load does not hide a free motion, although u would be finite.
        if case % 5 == 0 {
            f.fill(0.0);
        }
        let motion = refused(&name, &k, &f, &system)?;
        if lack == Lack::Stiffness {
            assert_eq!(motion.dofs, [k.ncols() - 1], "{name}");
        }
    }
    Ok(())
}

/// Two tied springs without ground, 0.1 and 0.2: the sum `0.1 + 0.2 - 0.3` is not a stiffness, in any unit.
#[test]
fn rounding_is_no_support() -> Outcome {
    for units in all_units() {
        let (s, name) = (units.force / units.length, format!("{units:?}"));
        let (a, b) = (0.1 * s, 0.2 * s);
        let entries = [(0, 0, a), (0, 1, -a), (1, 0, -a), (1, 1, a), (2, 2, b), (2, 3, -b), (3, 2, -b), (3, 3, b)];
        let entries = entries.map(|(i, j, v)| Triplet::new(i, j, v));
        let k = SparseColMat::try_new_from_triplets(4, 4, &entries)?;
        let mut builder = SystemBuilder::new(4);
        builder.equation([(1, 1.0), (2, -1.0)], 0.0);
        let system = builder.build()?;
        let motion = refused(&name, &k, &[units.force, 0.0, 0.0, 0.0], &system)?;
        assert_eq!(motion.dofs, [0, 1, 2, 3], "{name}");
        assert!(motion.motion.iter().all(|v| (v - motion.motion[0]).abs() < 1e-12), "{name}: {motion:?}");

        // One DOF, whose stiffness is what is left of 0.1 + 0.2 - 0.3.
        let entries = [(0, 0, a + b), (0, 1, -3.0 * a), (1, 0, -3.0 * a), (1, 1, 0.3 * s)];
        let k = SparseColMat::try_new_from_triplets(2, 2, &entries.map(|(i, j, v)| Triplet::new(i, j, v)))?;
        let mut builder = SystemBuilder::new(2);
        builder.equation([(0, 1.0), (1, -1.0)], 0.0);
        let system = builder.build()?;
        refused(&name, &k, &[units.force, 0.0], &system)?;
        let reduction = analyse(&system, &Options::default())?.reduction()?;
        assert!(matches!(reduced(&k, &[units.force, 0.0], &reduction, &[]), Err(EnforceError::Unsupported(_))));
    }
    Ok(())
}

/// Where forces that K cannot carry and motions that it does not feel have nothing in common: `K = [1 -1; 1 -1]`, and worse.
#[test]
fn defective_matrices_are_refused() -> Outcome {
    for units in all_units() {
        let s = units.force / units.length;
        let pair = [(0, 0, s), (0, 1, -s), (1, 0, s), (1, 1, -s)];
        let k = SparseColMat::try_new_from_triplets(2, 2, &pair.map(|(i, j, v)| Triplet::new(i, j, v)))?;
        let motion = refused("a pair", &k, &[units.force, 0.0], &SystemBuilder::new(2).build()?)?;
        assert!((motion.motion[0] - motion.motion[1]).abs() < 1e-9, "{motion:?}");
        // Resonance: K less a mass at its frequency, tied to a spring that hangs on it.
        let entries =
            [(0, 0, 0.3 * s), (0, 1, -0.3 * s), (1, 0, -0.3 * s), (1, 1, 0.3 * s), (2, 2, 0.1 * s), (3, 3, 0.7 * s)];
        let more =
            [(2, 3, -0.1 * s), (3, 2, -0.1 * s), (2, 2, 0.2 * s), (2, 2, -0.2 * s), (3, 3, 0.1 * s), (3, 3, -0.7 * s)];
        let all: Vec<_> = entries.into_iter().chain(more).map(|(i, j, v)| Triplet::new(i, j, v)).collect();
        let k = SparseColMat::try_new_from_triplets(4, 4, &all)?;
        let mut builder = SystemBuilder::new(4);
        builder.equation([(1, 1.0), (2, -1.0)], 0.0);
        refused("resonance", &k, &[0.0, 0.0, units.force, 0.0], &builder.build()?)?;
    }
    Ok(())
}
