//! A set after any changes equals a new set with the same constraints.

mod edits;
mod recipe;
mod run;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Distance, Equal, Point};

use crate::common::Outcome;
use recipe::{DOFS, KINDS};
use run::Run;

/// Thousands of operations on small sets, compared often with a new set.
#[test]
fn a_set_is_that_of_its_active_constraints() -> Outcome {
    for seed in 0..40 {
        let mut run = Run::new(seed, 40 + 10 * seed as usize)?;
        for _ in 0..30 {
            for _ in 0..=run.random.below(12) {
                run.step()?;
            }
            run.compare()?;
        }
    }
    Ok(())
}

/// So many constraints that segments and chunks of H are split; then almost all are removed.
#[test]
fn large_sets_grow_and_shrink() -> Outcome {
    let mut run = Run::new(7, 12_000)?;
    for _ in 0..4 {
        (0..9000).try_for_each(|_| run.add())?;
        run.compare()?;
        for _ in 0..20 {
            run.step()?;
            run.compare_values()?;
        }
        run.compare()?;
    }
    while run.entries.len() > 500 {
        for k in (KINDS + 1..run.entries.len()).rev().step_by(2) {
            let entry = run.entries.remove(k);
            run.set.remove(entry.id)?;
        }
        run.compare()?;
    }
    Ok(())
}

/// H has entries only while the set has curved constraints.
#[test]
fn curvature_comes_and_goes() -> Outcome {
    let point = |i: usize| Point::new([3 * i, 3 * i + 1, 3 * i + 2], [i as f64, 0.5, 0.0]);
    for rods in [1, 30] {
        let mut builder = ConstraintSet::builder(93);
        (0..30).try_for_each(|i| builder.add("tie", Equal::new([3 * i + 1, 3 * i + 4])).map(drop))?;
        let mut set = builder.build()?;
        let mut evaluation = set.allocate();
        let (u, mut patterns) = (vec![0.1; 93], Vec::new());
        for _ in 0..3 {
            set.assemble(&u, &vec![1.0; set.equations()], &mut evaluation)?;
            assert_eq!((evaluation.h().rows(), evaluation.h().nnz()), (93, 0));
            let ids = (0..rods).map(|i| set.add("rod", Distance::new(point(i), point(i + 1))));
            let ids = ids.collect::<Result<Vec<_>, _>>()?;
            set.assemble(&u, &vec![1.0; set.equations()], &mut evaluation)?;
            assert_eq!(evaluation.h().nnz(), 3 * (rods + 1) + 6 * rods);
            patterns.push(evaluation.h().clone());
            ids.into_iter().try_for_each(|id| set.remove(id))?;
        }
        assert!(patterns.iter().all(|h| *h == patterns[0]));
    }
    Ok(())
}

impl Run {
    /// Evaluates after changes, without comparing with a second set.
    fn compare_values(&mut self) -> Outcome {
        let u: Vec<f64> = (0..DOFS * self.nodes).map(|_| self.random.number()).collect();
        let w = vec![1.0; self.set.equations()];
        self.set.assemble(&u, &w, &mut self.evaluation)?;
        Ok(())
    }
}
