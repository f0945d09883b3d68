use std::array::from_fn;

use faer::sparse::{SparseColMat, Triplet};
use qless::{ChangingSystem, ConstraintSystem, Form, Options, SystemBuilder, analyse};
use qless_constraints::ConstraintSet;
use qless_constraints::types::{Body, Spherical};
use qless_scenes::fssi::{self, Mesh};
use qless_solve::enforce::{Problem, Solution, reduced};
use qless_solve::newton::{NewtonOptions, solve};

use crate::linkages::{Outcome, bricard, difference, four_bar, random};

/// A chain in which each link depends on the one before and on two DOFs shared by two links: row i of T has i nonzeros. Beside it, a tie.
fn chain() -> Outcome<ConstraintSystem> {
    let links = 300;
    let mut builder = SystemBuilder::new(2 * links + 5);
    let own = |i: usize| links + 1 + i;
    for i in 0..links {
        let follows = [(i + 1, 1.0), (i, -0.95), (own(i), 0.3 + 0.1 * random(i)), (own(i + 1), 0.2)];
        builder.equation(follows, 0.01 * random(i + 7));
    }
    builder.equation([(2 * links + 2, 1.0), (2 * links + 3, -0.5)], 0.1);
    builder.equation([(2 * links + 2, 2.0), (2 * links + 3, -1.0)], 0.2);
    builder.prescribe(0, 0.5);
    builder.prescribe(own(40), -0.25);
    Ok(builder.build()?)
}

/// Dense rows on both sides of a tie.
fn mortar() -> Outcome<ConstraintSystem> {
    Ok(fssi::mortar(&Mesh::with_equations(1_500), 1)?.system)
}

/// Springs between neighbouring DOFs and to the ground.
fn springs(dofs: usize) -> Outcome<SparseColMat<usize, f64>> {
    let mut entries: Vec<_> = (0..dofs).map(|i| Triplet::new(i, i, 3.0 + random(i))).collect();
    entries.extend((1..dofs).flat_map(|i| [Triplet::new(i, i - 1, -1.0), Triplet::new(i - 1, i, -1.0)]));
    Ok(SparseColMat::try_new_from_triplets(dofs, dofs, &entries)?)
}

fn loads(dofs: usize) -> Vec<f64> {
    (0..dofs).map(|j| 1.0 + random(j + 300)).collect()
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
    enforced_as_with_t(&chain()?, &[Form::Auto, Form::Factored])
}

#[test]
fn mortar_ties_are_enforced_as_with_t() -> Outcome {
    enforced_as_with_t(&mortar()?, &[Form::Factored])
}

fn enforced_as_with_t(system: &ConstraintSystem, forms: &[Form]) -> Outcome {
    let (k, f) = (springs(system.dofs())?, loads(system.dofs()));
    let analysis = analyse(system, &Options::default())?;
    let values: Vec<f64> = system.prescribed().iter().map(|&(_, value)| value).collect();
    let explicit = analysis.reduction()?;
    let truth = reduced(&k, &f, &explicit, &values)?;
    for &form in forms {
        let reduction = analysis.reduction_in(form)?;
        assert!(
            !reduction.is_explicit(),
            "{form:?}: T has {} nonzeros, C {}",
            explicit.t().nnz(),
            system.matrix().nnz()
        );
        let u = reduced(&k, &f, &reduction, &values)?;
        assert!(difference(&u, &truth) < 1e-9, "{form:?}: {:e}", difference(&u, &truth));
    }
    let problem = Problem::new(&k, &f, system)?;
    let lagrange = problem.lagrange()?;
    let transformed = problem.transformation()?;
    let mixed = problem.mixed(&problem.plan(1e9)?)?;
    for (name, found) in
        [("transformation", transformed), ("mixed", mixed), ("augmented", problem.augmented(1e6, 1e-13)?)]
    {
        // Springs a million times stiffer than K cost six digits.
        let limit = if name == "augmented" { 1e-8 } else { 1e-9 };
        assert!(difference(&found.u, &truth) < limit, "{name}: {:e}", difference(&found.u, &truth));
        let balance = out_of_balance(&k, &f, system, &found);
        println!("{name}: {balance:?}");
        assert!(balance.0 < 10.0 * limit && balance.1 < 10.0 * limit, "{name}: {balance:?}");
        assert!(difference(&found.forces, &lagrange.forces) < 10.0 * limit, "{name}: forces");
    }
    Ok(())
}

/// The fill that a plan foresees for a factored part is about the square of the mean length of the rows of T.
#[test]
fn fill_of_dense_parts_is_foreseen_without_t() -> Outcome {
    let system = chain()?;
    let (k, f) = (springs(system.dofs())?, loads(system.dofs()));
    let explicit = analyse(&system, &Options::default())?.reduction_in(Form::Explicit)?;
    let mean = explicit.t().nnz() as f64 / explicit.slaves().len() as f64;
    let plan = Problem::new(&k, &f, &system)?.plan(10.0)?;
    let dense = plan.iter().max_by_key(|block| block.rows.len()).ok_or("no block")?;
    let ratio = dense.fill / (mean * mean);
    assert!((0.25..4.0).contains(&ratio), "{} foreseen; rows of T have {mean} entries", dense.fill);
    Ok(())
}

/// After any changes, a factored component expands as after a new analysis of the whole.
#[test]
fn dense_parts_change() -> Outcome {
    let system = chain()?;
    let made = |detour: bool| -> Outcome<Vec<f64>> {
        let mut set = ChangingSystem::new(system.dofs(), Options::default()).expect("few DOFs");
        system.prescribed().iter().try_for_each(|&(dof, value)| set.prescribe(dof, value))?;
        let mut ids = Vec::new();
        for row in 0..system.equations() {
            ids.push(set.add(system.matrix().row(row), system.rhs()[row])?);
        }
        if detour {
            let extra = set.add([(1, 1.0), (2, 2.0)], 0.5)?;
            set.set_rhs(ids[0], 0.25)?;
            set.update()?;
            set.remove(extra)?;
            set.set_rhs(ids[0], system.rhs()[0])?;
        }
        set.update()?;
        assert!(set.blocks().any(|block| !block.reduction().is_explicit()));
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

/// Newton's method with the explicit reduction; DOFs in `held` do not move.
fn with_t(set: &ConstraintSet, start: &[f64], held: &[usize]) -> Outcome<Vec<f64>> {
    let (mut u, mut evaluation) = (start.to_vec(), set.allocate());
    for _ in 0..12 {
        set.evaluate(&u, &mut evaluation).expect("of this set");
        if evaluation.c().iter().all(|c| c.abs() < 1e-13) {
            break;
        }
        let increments: Vec<(usize, f64)> = held.iter().map(|&j| (j, 0.0)).collect();
        let system = set.linearised(&evaluation, &increments)?;
        let reduction = analyse(&system, &Options::default())?.reduction()?;
        let du =
            reduction.expand(&vec![0.0; reduction.masters().len()], &vec![0.0; held.len()]).expect("of its lengths");
        u.iter_mut().zip(du).for_each(|(u, du)| *u += du);
    }
    Ok(u)
}

/// Newton steps use no T, and give the same results as those with T.
#[test]
fn linkages_are_assembled_as_with_t() -> Outcome {
    let mut compared = 0;
    for (name, builder) in [("four-bar", four_bar()?), ("Bricard", bricard()?)] {
        let set = builder.build().expect("few DOFs");
        for case in 0..20 {
            let start: Vec<f64> = (0..set.dofs()).map(|j| 2e-3 * random(j + 101 * case)).collect();
            let solution = solve(&set, &start, &[], &NewtonOptions::default())?;
            // If Newton's method shortened a step, it may reach another configuration of the same mechanism.
            if solution.iterates.iter().any(|iterate| iterate.length < 1.0) {
                continue;
            }
            compared += 1;
            let found = solution.u;
            // Newton's method chooses which masters stay; those of T are therefore prescribed at its result.
            let mut evaluation = set.allocate();
            set.evaluate(&found, &mut evaluation).expect("of this set");
            let reduction = analyse(&set.linearised(&evaluation, &[])?, &Options::default())?.reduction()?;
            let mut start = start;
            reduction.masters().iter().for_each(|&j| start[j] = found[j]);
            let truth = with_t(&set, &start, reduction.masters())?;
            let most = found.iter().zip(&truth).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            assert!(most < 1e-8, "{name}, case {case}: {most:e}");
        }
    }
    assert!(compared >= 30, "{compared} of 40");
    Ok(())
}

/// Ball joints at scattered positions: far more bodies than a dense T would allow in reasonable time.
#[test]
fn long_chains_are_assembled() -> Outcome {
    let bodies = 2_000;
    let at = |i: usize| from_fn(|k| 0.6 * random(3 * i + k) + if k == 0 { i as f64 } else { 0.0 });
    let body = |i: usize| match i {
        0 => Body::ground(),
        _ => Body::with_vector(from_fn(|k| 6 * i - 6 + k), at(i), from_fn(|k| 6 * i - 3 + k)),
    };
    let mut builder = ConstraintSet::builder(6 * bodies);
    for i in 0..bodies {
        builder.add(format!("joint {i}"), Spherical { a: body(i), b: body(i + 1), at: at(i) })?;
    }
    let set = builder.build().expect("few DOFs");
    let start: Vec<f64> = (0..set.dofs()).map(|j| 1e-3 * random(j)).collect();
    let found = solve(&set, &start, &[], &NewtonOptions::default())?;
    let mut evaluation = set.allocate();
    set.evaluate(&found.u, &mut evaluation).expect("of this set");
    assert!(evaluation.c().iter().all(|c| c.abs() < 1e-10));
    assert_eq!(found.iterates.last().map(|iterate| iterate.rank), Some(3 * bodies));
    Ok(())
}
