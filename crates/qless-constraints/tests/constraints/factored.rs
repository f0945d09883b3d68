use faer::sparse::{SparseColMat, Triplet};
use qless::{ChangingSystem, ConstraintSystem, Form, Options, analyse};
use qless_constraints::enforce::{Problem, Solution, reduced};
use qless_constraints::newton::{NewtonOptions, solve};
use qless_scenes::fssi::{self, Mesh};

use crate::linkages::{Outcome, bricard, four_bar, parallelogram, random};

/// Dense rows on both sides of a tie: T has more than four times the nonzeros of its equations and factors.
fn mortar() -> Outcome<ConstraintSystem> {
    Ok(fssi::mortar(&Mesh::with_equations(1_500), 1)?.system)
}

/// Springs from each DOF to the next and to the ground.
fn springs(dofs: usize) -> Outcome<SparseColMat<usize, f64>> {
    let mut entries: Vec<_> = (0..dofs).map(|i| Triplet::new(i, i, 3.0 + random(i))).collect();
    entries.extend((1..dofs).flat_map(|i| [Triplet::new(i, i - 1, -1.0), Triplet::new(i - 1, i, -1.0)]));
    Ok(SparseColMat::try_new_from_triplets(dofs, dofs, &entries)?)
}

fn loads(dofs: usize) -> Vec<f64> {
    (0..dofs).map(|j| 1.0 + random(j + 300)).collect()
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    let size = b.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    a.iter().zip(b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / size
}

/// `max |K u + C^T lambda - f|` over the free DOFs, and `max |C u - b|`.
fn out_of_balance(
    k: &SparseColMat<usize, f64>,
    f: &[f64],
    system: &ConstraintSystem,
    solution: &Solution,
) -> (f64, f64) {
    let mut rest: Vec<f64> = f.iter().zip(&solution.forces).map(|(f, own)| -f - own).collect();
    for j in 0..k.ncols() {
        let column = k.symbolic().row_idx_of_col(j).zip(k.val_of_col(j));
        column.for_each(|(i, v)| rest[i] += v * solution.u[j]);
    }
    system.prescribed().iter().for_each(|&(j, _)| rest[j] = 0.0);
    let gap = |row: usize| {
        let value: f64 = system.matrix().row(row).map(|(j, v)| v * solution.u[j]).sum();
        (value - system.rhs()[row]).abs()
    };
    let gaps = (0..system.equations()).map(gap).fold(0.0, f64::max);
    (rest.iter().fold(0.0, |most: f64, r| most.max(r.abs())), gaps)
}

#[test]
fn dense_parts_are_enforced_as_with_t() -> Outcome {
    let system = mortar()?;
    let (k, f) = (springs(system.dofs())?, loads(system.dofs()));
    let analysis = analyse(&system, &Options::default())?;
    let values: Vec<f64> = system.prescribed().iter().map(|&(_, value)| value).collect();
    let explicit = analysis.reduction(&system)?;
    let truth = reduced(&k, &f, &explicit, &values)?;
    for form in [Form::Auto, Form::Factored] {
        let reduction = analysis.reduction_in(&system, form)?;
        assert!(!reduction.is_explicit(), "{form:?}: T has {} nonzeros, C {}", explicit.t.nnz(), system.matrix().nnz());
        let u = reduced(&k, &f, &reduction, &values)?;
        assert!(difference(&u, &truth) < 1e-9, "{form:?}: {:e}", difference(&u, &truth));
    }
    let problem = Problem::new(&k, &f, &system)?;
    let lagrange = problem.lagrange()?;
    let transformed = problem.transformation()?;
    let mixed = problem.mixed(&problem.plan(1e9)?)?;
    for (name, found) in
        [("transformation", transformed), ("mixed", mixed), ("augmented", problem.augmented(1e3, 1e-12)?)]
    {
        assert!(difference(&found.u, &truth) < 1e-9, "{name}: {:e}", difference(&found.u, &truth));
        let balance = out_of_balance(&k, &f, &system, &found);
        println!("{name}: {balance:?}");
        assert!(balance.0 < 1e-8 && balance.1 < 1e-8, "{name}: {balance:?}");
        assert!(difference(&found.forces, &lagrange.forces) < 1e-8, "{name}: forces");
    }
    Ok(())
}

/// A block that stays factors is expanded as a fresh analysis of the whole does it, whatever came before.
#[test]
fn dense_parts_change() -> Outcome {
    let system = mortar()?;
    let made = |detour: bool| -> Outcome<Vec<f64>> {
        let mut set = ChangingSystem::new(system.dofs(), Options::default());
        system.prescribed().iter().try_for_each(|&(dof, value)| set.prescribe(dof, value))?;
        let mut ids = Vec::new();
        for row in 0..system.equations() {
            ids.push(set.add(system.matrix().row(row), system.rhs()[row])?);
        }
        if detour {
            let extra = set.add([(0, 1.0), (1, 2.0)], 0.5)?;
            set.set_rhs(ids[0], 0.25)?;
            set.update()?;
            set.remove(extra)?;
            set.set_rhs(ids[0], system.rhs()[0])?;
        }
        set.update()?;
        assert!(set.blocks().any(|block| !block.reduction.is_explicit()));
        let mut u: Vec<f64> = (0..system.dofs()).map(random).collect();
        set.expand(&mut u)?;
        Ok(u)
    };
    let (fresh, after) = (made(false)?, made(true)?);
    assert!(fresh.iter().zip(&after).all(|(a, b)| a.to_bits() == b.to_bits()));
    for row in 0..system.equations() {
        let value: f64 = system.matrix().row(row).map(|(j, v)| v * fresh[j]).sum();
        assert!((value - system.rhs()[row]).abs() < 1e-9, "row {row}: {value}");
    }
    Ok(())
}

/// Newton's steps have no T: what they lead to satisfies all constraints and is near to where they began.
#[test]
fn disturbed_linkages_are_assembled_without_t() -> Outcome {
    for (name, builder) in [("parallelogram", parallelogram()?), ("four-bar", four_bar()?), ("Bricard", bricard()?)] {
        let set = builder.build();
        for case in 0..20 {
            let start: Vec<f64> = (0..set.dofs()).map(|j| 0.02 * random(j + 101 * case)).collect();
            let found = solve(&set, &start, &[], &NewtonOptions::default())?;
            let mut quantities = set.allocate();
            set.evaluate(&found.u, &mut quantities);
            assert!(quantities.c.iter().all(|c| c.abs() < 1e-11), "{name}, case {case}");
            let way = start.iter().zip(&found.u).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            assert!(way < 0.5, "{name}, case {case}: {way}");
        }
    }
    Ok(())
}
