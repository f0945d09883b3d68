//! One wrong number is found: it is in every explanation of a conflict, and first among the repairs.

use qless::common::SplitMix64;
use qless::explanation::{Member, Number};
use qless::{Analysis, ConstraintSystem, Options, SystemBuilder, analyse};

fn below(random: &mut SplitMix64, n: usize) -> usize {
    (random.next() % n as u64) as usize
}

/// Equations and prescribed values of a model, before one of the numbers is spoiled.
#[derive(Default)]
struct Model {
    dofs: usize,
    equations: Vec<(Vec<(usize, f64)>, f64)>,
    prescribed: Vec<(usize, f64)>,
}

impl Model {
    fn system(&self) -> ConstraintSystem {
        let mut builder = SystemBuilder::new(self.dofs);
        self.equations.iter().for_each(|(terms, b)| _ = builder.equation(terms.iter().copied(), *b));
        self.prescribed.iter().for_each(|&(dof, value)| builder.prescribe(dof, value));
        builder.build().expect("valid")
    }

    fn shuffle(&mut self, random: &mut SplitMix64) {
        (1..self.equations.len()).rev().for_each(|k| self.equations.swap(k, below(random, k + 1)));
    }

    /// Makes a number wrong.
    fn spoil(&mut self, number: Number, by: f64) {
        match number {
            Number::RightHandSide(row) => self.equations[row].1 += by,
            Number::Prescribed(dof) => {
                self.prescribed.iter_mut().filter(|given| given.0 == dof).for_each(|given| given.1 += by);
            }
            _ => unreachable!("there are two kinds of numbers"),
        }
    }
}

/// Equal neighbours on a grid of nodes, as ties give them.
fn ties(random: &mut SplitMix64) -> Model {
    let n = 3 + below(random, 4);
    let right = (0..n * n).filter(|k| k % n + 1 < n).map(|k| (k, k + 1));
    let down = (0..n * (n - 1)).map(|k| (k, k + n));
    let tie = |(a, b)| (vec![(a, 1.0), (b, -1.0)], 0.0);
    Model { dofs: n * n, equations: right.chain(down).map(tie).collect(), prescribed: Vec::new() }
}

/// A periodic cell of n x n nodes in one direction: opposite nodes differ by the strain, corners and edges are tied in several ways.
fn periodic_cell(random: &mut SplitMix64) -> Model {
    let n = 3 + below(random, 4);
    let node = |x: usize, y: usize| x * n + y;
    let strain = [0.01, 0.02, 0.005][below(random, 3)];
    let mut equations = Vec::new();
    for k in 0..n {
        equations.push((vec![(node(n - 1, k), 1.0), (node(0, k), -1.0)], strain));
        equations.push((vec![(node(k, n - 1), 1.0), (node(k, 0), -1.0)], 0.0));
    }
    // The corners once more, diagonally, and the edge in between.
    equations.push((vec![(node(n - 1, n - 1), 1.0), (node(0, 0), -1.0)], strain));
    equations.push((vec![(node(n - 1, 0), 1.0), (node(0, n - 1), -1.0)], strain));
    Model { dofs: n * n, equations, prescribed: vec![(node(0, 0), 0.0)] }
}

/// Nodes of a rigid body in the plane, with two displacements each, of a reference node with two displacements and a rotation. All nodes are
/// moved as the body moves, which is far more than it needs.
fn rigid_body(random: &mut SplitMix64) -> Model {
    let nodes = 5 + below(random, 6);
    let mut place = || [1.0 + below(random, 9) as f64, 1.0 + below(random, 9) as f64];
    let places: Vec<[f64; 2]> = (0..nodes).map(|_| place()).collect();
    let reference = 2 * nodes;
    let mut model = Model { dofs: reference + 3, ..Model::default() };
    for (k, [x, y]) in places.iter().enumerate() {
        model.equations.push((vec![(2 * k, 1.0), (reference, -1.0), (reference + 2, *y)], 0.0));
        model.equations.push((vec![(2 * k + 1, 1.0), (reference + 1, -1.0), (reference + 2, -x)], 0.0));
        // The motion of the body: a translation by (0.1, 0.2) and a rotation by 0.01.
        model.prescribed.push((2 * k, 0.1 - 0.01 * y));
        model.prescribed.push((2 * k + 1, 0.2 + 0.01 * x));
    }
    model
}

/// The number of a member.
fn number(member: Member) -> Number {
    match member {
        Member::Equation { row, .. } => Number::RightHandSide(row),
        Member::Prescribed { dof, .. } => Number::Prescribed(dof),
        _ => unreachable!("there are two kinds of members"),
    }
}

/// Whether all conflicts name a number, as their own row or in their explanation.
fn all_name(analysis: &Analysis, wrong: Number) -> bool {
    let conflicts: Vec<_> = analysis.dependent().iter().filter(|d| d.kind == qless::Kind::Conflicting).collect();
    assert!(!conflicts.is_empty());
    let names = |row: usize| {
        let members = analysis.explain(row).expect("a row").expect("dependent").members;
        Number::RightHandSide(row) == wrong || members.into_iter().any(|member| number(member) == wrong)
    };
    conflicts.iter().all(|d| names(d.row))
}

#[test]
fn a_wrong_number_is_explained_and_repaired() {
    let families: [fn(&mut SplitMix64) -> Model; 3] = [ties, periodic_cell, rigid_body];
    let (mut models, mut first) = (0, 0);
    for seed in 0..300_u64 {
        let random = &mut SplitMix64::new(seed);
        let mut model = families[seed as usize % 3](random);
        model.shuffle(random);
        let right = analyse(&model.system(), &Options::default()).expect("an analysis");
        assert!(right.dependent().iter().all(|d| d.kind == qless::Kind::Redundant), "the model of seed {seed}");
        // A number that has a part in a redundant equation: other numbers are data, and no one can know that they are wrong.
        let explained =
            right.dependent().iter().map(|d| (d.row, right.explain(d.row).expect("a row").expect("dependent")));
        let checked: Vec<Number> = explained
            .flat_map(|(row, explanation)| {
                explanation.members.into_iter().map(number).chain([Number::RightHandSide(row)]).collect::<Vec<_>>()
            })
            .filter(|&number| seed % 3 != 2 || matches!(number, Number::Prescribed(_)))
            .collect();
        let wrong = checked[below(random, checked.len())];
        let by = [0.001, 0.5, -0.03, 1.25][below(random, 4)];
        model.spoil(wrong, by);
        let system = model.system();
        let analysis = analyse(&system, &Options::default()).expect("an analysis");
        assert!(all_name(&analysis, wrong), "seed {seed}: {wrong:?}");
        let repairs = analysis.repairs().expect("repairs");
        let [repair] = &repairs[..] else { panic!("seed {seed}: {repairs:?}") };
        models += 1;
        first += usize::from(repair.ways[0].len() == 1 && repair.ways[0][0].number == wrong);
        // Every way cures.
        for way in &repair.ways {
            let mut mended =
                Model { dofs: model.dofs, equations: model.equations.clone(), prescribed: model.prescribed.clone() };
            way.iter().for_each(|change| mended.spoil(change.number, change.to - change.from));
            let mended = analyse(&mended.system(), &Options::default()).expect("an analysis");
            assert!(mended.dependent().iter().all(|d| d.kind == qless::Kind::Redundant), "seed {seed}: {way:?}");
        }
    }
    assert!(first * 200 >= models * 190, "{first} of {models}");
    println!("{first} of {models}");
}

#[test]
fn two_wrong_numbers_need_two_changes() {
    let random = &mut SplitMix64::new(7);
    for _ in 0..50 {
        let mut model = periodic_cell(random);
        let n = model.equations.len();
        let (a, b) = (n - 1, n - 2);
        model.spoil(Number::RightHandSide(a), 0.1);
        model.spoil(Number::RightHandSide(b), 0.3);
        let analysis = analyse(&model.system(), &Options::default()).expect("an analysis");
        let repairs = analysis.repairs().expect("repairs");
        let mut changed: Vec<Number> =
            repairs.iter().flat_map(|repair| repair.ways[0].iter().map(|change| change.number)).collect();
        changed.sort_unstable();
        assert_eq!(changed, [Number::RightHandSide(b), Number::RightHandSide(a)]);
    }
}
