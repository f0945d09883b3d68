//! Random operations on a set, and a new set to compare with.

use qless_constraints::{ConstraintId, ConstraintSet, EditError, Evaluation};

use super::recipe::{DOFS, KINDS, Random, Recipe};
use crate::common::Outcome;

/// The expected state of a constraint.
pub struct Entry {
    pub id: ConstraintId,
    pub label: String,
    pub recipe: Recipe,
    pub active: bool,
    /// Right-hand sides that were set later.
    pub rhs: Option<Vec<f64>>,
}

pub struct Run {
    pub set: ConstraintSet,
    pub evaluation: Evaluation,
    pub entries: Vec<Entry>,
    pub gone: Vec<ConstraintId>,
    pub random: Random,
    pub nodes: usize,
    pub count: usize,
}

impl Run {
    /// One constraint of each type, so that both sets have their types in the same order.
    pub fn new(seed: u64, nodes: usize) -> Outcome<Self> {
        let mut builder = ConstraintSet::builder(DOFS * nodes);
        let mut entries = Vec::new();
        for k in 0..=KINDS {
            let recipe =
                Recipe { kind: k.min(KINDS - 1), node: k, other: k + 1, number: if k == KINDS { 0.4 } else { 0.1 } };
            let label = format!("first {k}");
            let id = recipe.add(&label, &mut builder)?;
            entries.push(Entry { id, label, recipe, active: true, rhs: None });
        }
        let set = builder.build()?;
        let evaluation = set.allocate();
        Ok(Self { set, evaluation, entries, gone: Vec::new(), random: Random(seed), nodes, count: 0 })
    }

    pub fn step(&mut self) -> Outcome {
        let operation = self.random.below(13);
        let some = KINDS + 1 + self.random.below(self.entries.len() - KINDS);
        let Some(entry) = self.entries.get_mut(some).filter(|_| operation > 3) else { return self.add() };
        match operation {
            4 => {
                self.set.remove(entry.id)?;
                self.gone.push(self.entries.remove(some).id);
            }
            5 | 6 => {
                self.set.deactivate(entry.id)?;
                entry.active = false;
            }
            7 | 8 => {
                self.set.activate(entry.id)?;
                entry.active = true;
            }
            9 => {
                // The same DOFs with other numbers, or a different constraint.
                let number = self.random.number();
                let other = Recipe::random(&mut self.random, self.nodes);
                entry.recipe = if number > 0.0 { Recipe { number, ..entry.recipe } } else { other };
                entry.rhs = None;
                entry.recipe.add("", &mut (&mut self.set, entry.id))?;
            }
            10 => {
                let equations = [0, 1, 2, 2, 1, 0][entry.recipe.kind.min(5)];
                if entry.recipe.kind < 6 {
                    let rhs: Vec<f64> = (0..equations).map(|_| self.random.number()).collect();
                    self.set.set_rhs(entry.id, &rhs)?;
                    entry.rhs = Some(rhs);
                }
            }
            11 => self.set.set_time(self.random.number())?,
            _ => self.look()?,
        }
        Ok(())
    }

    /// Evaluates c and G, H, or all of them.
    fn look(&mut self) -> Outcome {
        let (u, w) = (vec![0.1; DOFS * self.nodes], vec![1.0; self.set.equations()]);
        match self.random.below(3) {
            0 => self.set.evaluate(&u, &mut self.evaluation)?,
            1 => self.set.effective_hessian(&u, &w, &mut self.evaluation)?,
            _ => self.evaluation = self.set.allocate(),
        }
        Ok(())
    }

    pub fn add(&mut self) -> Outcome {
        let recipe = Recipe::random(&mut self.random, self.nodes);
        let label = format!("constraint {}", self.count);
        self.count += 1;
        let id = recipe.add(&label, &mut self.set)?;
        self.entries.push(Entry { id, label, recipe, active: true, rhs: None });
        Ok(())
    }

    /// The same constraints in a new set.
    fn fresh(&self) -> Outcome<ConstraintSet> {
        let mut builder = ConstraintSet::builder(DOFS * self.nodes);
        let active = || self.entries.iter().filter(|entry| entry.active);
        let ids = active().map(|entry| entry.recipe.add(&entry.label, &mut builder)).collect::<Outcome<Vec<_>>>()?;
        let mut set = builder.build()?;
        set.set_time(self.set.time())?;
        for (entry, id) in active().zip(ids) {
            entry.rhs.iter().try_for_each(|rhs| set.set_rhs(id, rhs))?;
        }
        Ok(set)
    }

    /// Compares c, G, H, their patterns and bounds, rows and labels, to the last bit.
    pub fn compare(&mut self) -> Outcome {
        let fresh = self.fresh()?;
        let u: Vec<f64> = (0..DOFS * self.nodes).map(|_| self.random.number()).collect();
        let w: Vec<f64> = (0..fresh.equations()).map(|_| self.random.number()).collect();
        let mut expected = fresh.allocate();
        fresh.assemble(&u, &w, &mut expected)?;
        if self.random.below(2) == 0 {
            self.set.assemble(&u, &w, &mut self.evaluation)?;
        } else {
            self.set.effective_hessian(&u, &w, &mut self.evaluation)?;
            self.set.evaluate(&u, &mut self.evaluation)?;
        }
        assert_eq!(self.set.equations(), fresh.equations());
        assert!(bits(self.evaluation.c()) == bits(expected.c()));
        for (found, expected) in [(self.evaluation.g(), expected.g()), (self.evaluation.h(), expected.h())] {
            let pattern = (found.starts(), found.columns()) == (expected.starts(), expected.columns());
            assert!(pattern && bits(found.values()) == bits(expected.values()));
        }
        // Coordinates of removed and inactive constraints do not count any more.
        assert!(self.set.rounding(&u)? == fresh.rounding(&u)?);
        for row in 0..fresh.equations() {
            assert_eq!(self.set.label(row)?, fresh.label(row)?);
        }
        let entry = &self.entries[self.random.below(self.entries.len())];
        let rows = self.set.rows_of(entry.id)?;
        assert_eq!((self.set.is_active(entry.id)?, rows.is_empty()), (entry.active, !entry.active));
        assert!(rows.iter().all(|&row| self.set.constraint_of(row) == Ok(entry.id)));
        assert_eq!(
            rows.len(),
            (0..fresh.equations()).filter(|&row| self.set.constraint_of(row) == Ok(entry.id)).count()
        );
        for &gone in &self.gone {
            assert_eq!(self.set.activate(gone), Err(EditError::Gone { place: gone.place() }));
        }
        Ok(())
    }
}

pub fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}
