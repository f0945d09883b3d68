use std::array::from_fn;

use qless_constraints::types::{
    Body, Distance, Driven, Equal, Fixed, Line, LinearEquation, OnLine, OnPlane, Plane, Point, Prescribed, RigidBody,
    Spherical,
};
use qless_constraints::{ConstraintId, ConstraintSet, EditError, LineariseError, Quantities, ReplaceError, SetBuilder};

use crate::linkages::Outcome;

/// Numbers that look random, the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// In [-0.5, 0.5].
    fn number(&mut self) -> f64 {
        self.next() as f64 / f64::from(u32::MAX >> 1) - 0.5
    }
}

/// What a constraint was made from, so that another set can have it too.
#[derive(Clone, Copy)]
struct Recipe {
    kind: usize,
    node: usize,
    other: usize,
    number: f64,
}

const KINDS: usize = 9;

fn point(node: usize) -> Point {
    // Some have DOFs that do not ascend.
    let dofs = from_fn(|k| 3 * node + if node.is_multiple_of(5) { 2 - k } else { k });
    Point::new(dofs, [node as f64, (node * node % 7) as f64, (node % 3) as f64])
}

impl Recipe {
    fn random(random: &mut Random, nodes: usize) -> Self {
        let node = random.below(nodes - 4);
        // Most reach to neighbours, some far.
        let far = if random.below(8) == 0 { random.below(nodes - 4) } else { node + 1 + random.below(3) };
        let other = if far == node { node + 1 } else { far };
        Self { kind: random.below(KINDS), node, other, number: random.number() }
    }

    fn add(&self, label: &str, set: &mut impl Target) -> Outcome<ConstraintId> {
        let (a, b, number) = (point(self.node), point(self.other), self.number);
        let third = point(if self.other == self.node + 1 { self.node + 2 } else { self.node + 1 });
        match self.kind {
            0 => set.put(label, Distance { length: Some(2.0 + number), ..Distance::new(a, b) }),
            1 => set.put(label, LinearEquation { terms: vec![(a.dofs[0], 1.0), (b.dofs[1], number)], rhs: number }),
            2 => set.put(label, Equal::new([a.dofs[1], b.dofs[1], third.dofs[1]])),
            3 => set.put(label, Prescribed { values: vec![(a.dofs[0], number), (b.dofs[2], 2.0 * number)] }),
            4 => set.put(label, Driven::new([(a.dofs[2], 1.0)], move |t| number * t)),
            5 => set.put(label, OnLine { point: a, line: Line::Nodes(b, third) }),
            6 => set.put(
                label,
                OnPlane { point: a, plane: Plane::Fixed { through: [number; 3], normal: [1.0, 2.0, number] } },
            ),
            7 => {
                let body = Body::with_vector(a.dofs, a.at, third.dofs);
                set.put(label, RigidBody { body, nodes: vec![b.into()] })
            }
            _ => {
                let body = Body::with_vector(a.dofs, a.at, third.dofs);
                let joint = Spherical { a: body, b: Body::node(b), at: b.at };
                if number > 0.3 {
                    set.put(label, Fixed { a: body, b: Body::ground(), at: [number; 3] })
                } else {
                    set.put(label, joint)
                }
            }
        }
    }
}

/// A set or its builder; or a constraint to be replaced.
trait Target {
    fn put<C: qless_constraints::Constraint>(&mut self, label: &str, constraint: C) -> Outcome<ConstraintId>;
}

impl Target for SetBuilder {
    fn put<C: qless_constraints::Constraint>(&mut self, label: &str, constraint: C) -> Outcome<ConstraintId> {
        Ok(self.add(label, constraint)?)
    }
}

impl Target for ConstraintSet {
    fn put<C: qless_constraints::Constraint>(&mut self, label: &str, constraint: C) -> Outcome<ConstraintId> {
        Ok(self.add(label, constraint)?)
    }
}

impl Target for (&mut ConstraintSet, ConstraintId) {
    fn put<C: qless_constraints::Constraint>(&mut self, _: &str, constraint: C) -> Outcome<ConstraintId> {
        self.0.replace(self.1, constraint)?;
        Ok(self.1)
    }
}

/// A constraint as it should be in the set.
struct Entry {
    id: ConstraintId,
    label: String,
    recipe: Recipe,
    active: bool,
    /// Right-hand sides given since.
    rhs: Option<Vec<f64>>,
}

struct Run {
    set: ConstraintSet,
    quantities: Quantities,
    entries: Vec<Entry>,
    gone: Vec<ConstraintId>,
    random: Random,
    nodes: usize,
    count: usize,
}

impl Run {
    /// Each type once, so that both sets meet the types in the same order.
    fn new(seed: u64, nodes: usize) -> Outcome<Self> {
        let mut builder = ConstraintSet::builder(3 * nodes);
        let mut entries = Vec::new();
        for k in 0..=KINDS {
            let recipe =
                Recipe { kind: k.min(KINDS - 1), node: k, other: k + 1, number: if k == KINDS { 0.4 } else { 0.1 } };
            let label = format!("first {k}");
            let id = recipe.add(&label, &mut builder)?;
            entries.push(Entry { id, label, recipe, active: true, rhs: None });
        }
        let set = builder.build()?;
        let quantities = set.allocate();
        Ok(Self { set, quantities, entries, gone: Vec::new(), random: Random(seed), nodes, count: 0 })
    }

    fn step(&mut self) -> Outcome {
        let operation = self.random.below(12);
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
                // The same DOFs and other numbers, or anything else.
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
            _ => self.set.set_time(self.random.number())?,
        }
        Ok(())
    }

    fn add(&mut self) -> Outcome {
        let recipe = Recipe::random(&mut self.random, self.nodes);
        let label = format!("constraint {}", self.count);
        self.count += 1;
        let id = recipe.add(&label, &mut self.set)?;
        self.entries.push(Entry { id, label, recipe, active: true, rhs: None });
        Ok(())
    }

    /// The same constraints in a set that never changed.
    fn fresh(&self) -> Outcome<ConstraintSet> {
        let mut builder = ConstraintSet::builder(3 * self.nodes);
        let active = || self.entries.iter().filter(|entry| entry.active);
        let ids = active().map(|entry| entry.recipe.add(&entry.label, &mut builder)).collect::<Outcome<Vec<_>>>()?;
        let mut set = builder.build()?;
        set.set_time(self.set.time())?;
        for (entry, id) in active().zip(ids) {
            entry.rhs.iter().try_for_each(|rhs| set.set_rhs(id, rhs))?;
        }
        Ok(set)
    }

    /// c, G, H, their patterns and bounds, rows and labels, to the last bit.
    fn compare(&mut self) -> Outcome {
        let fresh = self.fresh()?;
        let u: Vec<f64> = (0..3 * self.nodes).map(|_| self.random.number()).collect();
        let w: Vec<f64> = (0..fresh.equations()).map(|_| self.random.number()).collect();
        let mut expected = fresh.allocate();
        fresh.assemble(&u, &w, &mut expected)?;
        if self.random.below(2) == 0 {
            self.set.assemble(&u, &w, &mut self.quantities)?;
        } else {
            self.set.effective_hessian(&u, &w, &mut self.quantities)?;
            self.set.evaluate(&u, &mut self.quantities)?;
        }
        assert_eq!(self.set.equations(), fresh.equations());
        assert!(bits(self.quantities.c()) == bits(expected.c()));
        for (found, expected) in [(self.quantities.g(), expected.g()), (self.quantities.h(), expected.h())] {
            let pattern = (found.starts(), found.columns()) == (expected.starts(), expected.columns());
            assert!(pattern && bits(found.values()) == bits(expected.values()));
        }
        // Coordinates of those that went or rest are forgotten.
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

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// Thousands of operations in small sets, compared often: whatever was done before, a set is the one with these constraints.
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

/// So many constraints that segments and chunks of H are split, and then nearly all of them gone.
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

impl Run {
    /// Brings the arrays along, without a second set.
    fn compare_values(&mut self) -> Outcome {
        let u: Vec<f64> = (0..3 * self.nodes).map(|_| self.random.number()).collect();
        let w = vec![1.0; self.set.equations()];
        self.set.assemble(&u, &w, &mut self.quantities)?;
        Ok(())
    }
}

/// Between each node and the next a rod, or an equal DOF.
fn chain(nodes: usize, is_rod: impl Fn(usize) -> bool) -> Outcome<(ConstraintSet, Vec<ConstraintId>)> {
    let mut builder = ConstraintSet::builder(3 * nodes);
    let add = |node: usize| {
        if is_rod(node) {
            return Ok(builder.add("rod", rod(node))?);
        }
        Ok(builder.add("tie", Equal::new([3 * node, 3 * node + 3]))?)
    };
    let ids = (0..nodes - 1).map(add).collect::<Outcome<_>>()?;
    Ok((builder.build()?, ids))
}

fn rod(node: usize) -> Distance<3> {
    Distance { length: Some(1.0 + (node % 7) as f64), ..Distance::new(point(node), point(node + 1)) }
}

/// Constraints of one type come between others of that type wherever these fill their segments.
#[test]
fn full_segments_take_what_comes_between() -> Outcome {
    let (nodes, mut random) = (5000, Random(3));
    let (mut set, ids) = chain(nodes, |node| node.is_multiple_of(2))?;
    let mut is_rod: Vec<bool> = (0..nodes).map(|node| node.is_multiple_of(2)).collect();
    let mut quantities = set.allocate();
    for _ in 0..4 {
        for _ in 0..1000 {
            let node = random.below(nodes - 1);
            is_rod[node] = true;
            set.replace(ids[node], rod(node))?;
        }
        let fresh = chain(nodes, |node| is_rod[node])?.0;
        let u: Vec<f64> = (0..3 * nodes).map(|_| random.number()).collect();
        let w: Vec<f64> = (0..nodes - 1).map(|_| random.number()).collect();
        let mut expected = fresh.allocate();
        fresh.assemble(&u, &w, &mut expected)?;
        set.assemble(&u, &w, &mut quantities)?;
        assert!(bits(quantities.c()) == bits(expected.c()));
        for (found, expected) in [(quantities.g(), expected.g()), (quantities.h(), expected.h())] {
            assert_eq!((found.starts(), found.columns()), (expected.starts(), expected.columns()));
            assert!(bits(found.values()) == bits(expected.values()));
        }
    }
    Ok(())
}

/// Numbers of before a change are not taken for those after it.
#[test]
fn numbers_from_before_a_change_are_refused() -> Outcome {
    let mut builder = ConstraintSet::builder(6);
    let rod = builder.add("rod", Distance::new(point(0), point(1)))?;
    let clamp = builder.add("clamp", Prescribed::fixed([0, 1]))?;
    let mut set = builder.build()?;
    let mut quantities = set.allocate();
    let outdated = |set: &ConstraintSet, quantities: &Quantities| {
        matches!(set.linearised(quantities, &[]), Err(LineariseError::Argument(_)))
    };
    assert!(outdated(&set, &quantities), "never evaluated");
    set.evaluate(&[0.1; 6], &mut quantities)?;
    assert!(!outdated(&set, &quantities));
    set.deactivate(rod)?;
    assert!(outdated(&set, &quantities));
    set.evaluate(&[0.1; 6], &mut quantities)?;
    assert_eq!(set.linearised(&quantities, &[])?.equations(), 2);
    set.set_rhs(clamp, &[1.0, 2.0])?;
    assert!(outdated(&set, &quantities));
    set.evaluate(&[0.1; 6], &mut quantities)?;
    set.activate(rod)?;
    // H alone: c and G are still those of before.
    set.effective_hessian(&[0.1; 6], &[0.0; 3], &mut quantities)?;
    assert!(outdated(&set, &quantities));
    Ok(())
}

/// Misuse: other sets, wrong counts, numbers that are none, refused input; the set stays what it was.
#[test]
fn changes_that_cannot_be_are_refused() -> Outcome {
    let (mut builder, mut others) = (ConstraintSet::builder(6), ConstraintSet::builder(6));
    let tie = builder.add("tie", Equal::new([0, 1, 2]))?;
    let slope = builder.add("root", Driven::new([(0, 1.0)], |t| (1.0 + t).sqrt()))?;
    let foreign = others.add("tie", Equal::new([0, 1]))?;
    let (mut set, other) = (builder.build()?, others.build()?);
    let mut quantities = set.allocate();
    set.evaluate(&[0.5; 6], &mut quantities)?;
    let before = quantities.clone();
    assert_eq!(set.remove(foreign), Err(EditError::Foreign));
    assert_eq!(set.deactivate(foreign), Err(EditError::Foreign));
    assert!(matches!(set.set_rhs(tie, &[1.0]), Err(EditError::Count { found: 1, expected: 2, .. })));
    let refused = set.set_rhs(tie, &[1.0, f64::NAN]).expect_err("no number");
    assert!(refused.to_string().contains("tie"), "{refused}");
    let refused = set.replace(tie, Equal::new([0, 9])).expect_err("no such DOF");
    assert!(matches!(&refused, ReplaceError::Add(_)) && refused.to_string().contains("tie"), "{refused}");
    set.evaluate(&[0.5; 6], &mut quantities)?;
    assert_eq!(quantities, before);
    assert!(other.rows_of(tie).is_err() && other.linearised(&quantities, &[]).is_err());

    // One that rests is not asked when time moves on, but when it is to come back.
    set.deactivate(slope)?;
    set.set_time(-3.0)?;
    let refused = set.activate(slope).expect_err("no root");
    assert!(matches!(&refused, EditError::Time(_)) && refused.to_string().contains("root"), "{refused}");
    assert!(!set.is_active(slope)?);
    set.set_rhs(slope, &[0.25])?;
    set.activate(slope)?;
    set.evaluate(&[0.5; 6], &mut quantities)?;
    assert_eq!((quantities.c(), set.constraints()), ([0.0, 0.0, 0.25].as_slice(), 2));
    set.remove(slope)?;
    assert_eq!(set.remove(slope), Err(EditError::Gone { place: 1 }));
    assert_eq!((set.constraints(), set.equations()), (1, 2));
    Ok(())
}
