//! Models with thousands of DOFs: no false alarm, no free motion overlooked, the same bits on any number of threads.

use faer::sparse::{SparseColMat, Triplet};
use qless::{ConstraintSystem, SystemBuilder};
use qless_solve::enforce::{EnforceError, Problem};

use super::models::beam_element;
use crate::linkages::Outcome;

type Entries = Vec<Triplet<usize, usize, f64>>;

fn solved(name: &str, dofs: usize, entries: &Entries, system: &ConstraintSystem, held: bool) -> Outcome {
    let k = SparseColMat::try_new_from_triplets(dofs, dofs, entries)?;
    let mut f = vec![0.0; dofs];
    f[dofs / 2] = 1.0;
    let problem = Problem::new(&k, &f, system)?;
    let methods = [("transformation", problem.transformation()), ("lagrange", problem.lagrange())];
    let springs = [("penalty", problem.penalty(1e7, 1e-1)), ("augmented", problem.augmented(1e5, 1e-10))];
    for (method, solution) in methods.into_iter().chain(springs) {
        match solution {
            Ok(solution) if held => assert!(solution.accuracy < 0.5, "{name}: {method}: {:e}", solution.accuracy),
            Err(EnforceError::Unsupported(motion)) if !held => {
                assert!(motion.dofs.len() > dofs / 3, "{name}: {method}: {motion}");
            }
            other => {
                let other = other.map(|solution| solution.accuracy);
                return Err(format!("{name}: {method}, held is {held}: {other:?}").into());
            }
        }
    }
    Ok(())
}

/// A membrane of 50 x 50 springs of decimal stiffness, in two tied halves, with one spring to the ground or none.
#[test]
fn membranes() -> Outcome {
    let side = 50;
    for held in [true, false] {
        let mut entries = Entries::new();
        let mut spring = |a: usize, b: usize, s: f64| {
            entries.extend([(a, a, s), (b, b, s), (a, b, -s), (b, a, -s)].map(|(i, j, v)| Triplet::new(i, j, v)));
        };
        for i in 0..side {
            for j in 0..side {
                let (at, s) = (i * side + j, 0.1 * (1 + (i * 7 + j * 3) % 9) as f64);
                if j + 1 < side {
                    spring(at, at + 1, s);
                }
                if i + 1 < side && i + 1 != side / 2 {
                    spring(at, at + side, s);
                }
            }
        }
        if held {
            entries.push(Triplet::new(0, 0, 0.3));
        }
        let mut builder = SystemBuilder::new(side * side);
        for j in 0..side {
            let at = side / 2 * side + j;
            builder.equation([(at, 1.0), (at - side, -1.0)], 0.0);
            builder.equation([(at, 0.1), (at - side, -0.1)], 0.0);
        }
        solved("membrane", side * side, &entries, &builder.build()?, held)?;
    }
    Ok(())
}

/// A slender truss of 600 bays, held at one end or free, and rotated, so that every entry has rounding.
#[test]
fn slender_trusses() -> Outcome {
    let bays = 600;
    for held in [true, false] {
        let (cos, sin) = (0.9_f64.cos(), 0.9_f64.sin());
        let at = |i: usize| {
            let (x, y) = (0.1 * (i / 2) as f64, 0.1 * (i % 2) as f64);
            [x * cos - y * sin, x * sin + y * cos]
        };
        let (nodes, middle) = (2 * bays + 2, bays / 2);
        // The last two nodes duplicate those in the middle.
        let dofs = 2 * nodes + 4;
        let mut entries = Entries::new();
        let mut bar = |i: usize, j: usize| {
            let own = |i: usize, other: usize| if i / 2 == middle && other / 2 > middle { nodes + i % 2 } else { i };
            let (p, q) = (own(i, j), own(j, i));
            let d = [at(j)[0] - at(i)[0], at(j)[1] - at(i)[1]];
            let s = 2.1e11 * 1e-4 / d[0].hypot(d[1]).powi(3);
            for (a, b, sign) in [(p, p, s), (p, q, -s), (q, p, -s), (q, q, s)] {
                for (r, c) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    entries.push(Triplet::new(2 * a + r, 2 * b + c, sign * d[r] * d[c]));
                }
            }
        };
        for b in 0..=bays {
            bar(2 * b, 2 * b + 1);
            if b < bays {
                bar(2 * b, 2 * b + 2);
                bar(2 * b + 1, 2 * b + 3);
                bar(2 * b, 2 * b + 3);
            }
        }
        let mut builder = SystemBuilder::new(dofs);
        for side in 0..2 {
            for axis in 0..2 {
                builder.equation([(2 * (2 * middle + side) + axis, 1.0), (2 * (nodes + side) + axis, -1.0)], 0.0);
            }
        }
        if held {
            (0..4).for_each(|j| builder.prescribe(j, 0.0));
        }
        solved("truss", dofs, &entries, &builder.build()?, held)?;
    }
    Ok(())
}

/// A free beam of 400 elements. Its softest deformation has 1e-10 of the stiffness of an element.
#[test]
fn floating_beams() -> Outcome {
    let count = 400;
    let mut entries = Entries::new();
    for i in 0..count {
        // The nodes of the second half come after the tie.
        let shift = if i < count / 2 { 2 * i } else { 2 * i + 2 };
        for (r, row) in beam_element(0.3).iter().enumerate() {
            entries.extend(row.iter().enumerate().map(|(c, v)| Triplet::new(shift + r, shift + c, 0.7 * v)));
        }
    }
    let dofs = 2 * count + 4;
    let mut builder = SystemBuilder::new(dofs);
    builder.equation([(count, 1.0), (count + 2, -1.0)], 0.0);
    builder.equation([(count + 1, 1.0), (count + 3, -1.0)], 0.0);
    solved("beam", dofs, &entries, &builder.build()?, false)
}

/// Equations that are independent by only 6e-8: u is right to its stated accuracy.
#[test]
fn nearly_dependent_equations_are_no_motion() -> Outcome {
    let eps = f64::powi(2.0, -24);
    let mut builder = SystemBuilder::new(3);
    builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    builder.equation([(1, 1.0), (2, -1.0 - eps)], 0.0);
    builder.equation([(0, 1.0), (2, -1.0)], eps);
    let system = builder.build()?;
    let entries = [(0, 0, 2.0), (1, 1, 3.0), (2, 2, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 2, -1.0), (2, 1, -1.0)];
    let k = SparseColMat::try_new_from_triplets(3, 3, &entries.map(|(i, j, v)| Triplet::new(i, j, v)))?;
    let problem = Problem::new(&k, &[1.0, 2.0, 3.0], &system)?;
    for solution in [problem.lagrange()?, problem.transformation()?] {
        let error =
            solution.u.iter().zip([1.0 + eps, 1.0 + eps, 1.0]).fold(0.0, |most: f64, (u, e)| most.max((u - e).abs()));
        assert!(error <= 3.0 * solution.accuracy && error < 1e-6, "{error:e}, {:e}", solution.accuracy);
    }
    Ok(())
}

#[test]
fn bits_do_not_depend_on_threads() -> Outcome {
    use super::models::{Kind, Lack, PLAIN, model};
    for case in 0..6 {
        let model = model(case, Kind::Symmetric, Lack::Nothing, PLAIN)?;
        let on = |threads: usize| -> Outcome<_> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
            Ok(pool.install(|| -> Result<_, EnforceError> {
                let problem = Problem::new(&model.k, &model.f, &model.system)?;
                Ok([problem.transformation()?, problem.lagrange()?, problem.augmented(1e5, 1e-11)?])
            })?)
        };
        let one = on(1)?;
        for threads in [2, 3, 8] {
            assert_eq!(one, on(threads)?, "{}", model.name);
        }
    }
    Ok(())
}
