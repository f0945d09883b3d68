//! One wrong number is found: it is in every explanation of a conflict, and first among the repairs. Every repair that is shown holds.

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

    /// Sets a number.
    fn set(&mut self, number: Number, to: f64) {
        match number {
            Number::RightHandSide(row) => self.equations[row].1 = to,
            Number::Prescribed(dof) => {
                self.prescribed.iter_mut().filter(|given| given.0 == dof).for_each(|given| given.1 = to);
            }
            _ => unreachable!("there are two kinds of numbers"),
        }
    }

    /// Changes units: all values by one factor, and each equation by a factor of its own.
    fn rescale(&mut self, values: f64, mut factor: impl FnMut() -> f64) {
        self.prescribed.iter_mut().for_each(|given| given.1 *= values);
        for (terms, b) in &mut self.equations {
            let factor = factor();
            terms.iter_mut().for_each(|term| term.1 *= factor);
            *b *= values * factor;
        }
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

/// A chain of springs between two supports: displacements `u_k - u_(k+1) = c_k f_k` with compliances of 1e-15 to 1e-6, and forces in
/// balance. One equation is the sum of others.
fn springs(random: &mut SplitMix64) -> Model {
    let n = 2 + below(random, 4);
    let force = |k: usize| n + 1 + k;
    let mut model = Model { dofs: 2 * n + 1, ..Model::default() };
    let mut compliance = || (1 + below(random, 99)) as f64 / 10.0 * 10_f64.powi(-(6 + below(random, 10) as i32));
    let compliances: Vec<f64> = (0..n).map(|_| compliance()).collect();
    for (k, &c) in compliances.iter().enumerate() {
        model.equations.push((vec![(k, 1.0), (k + 1, -1.0), (force(k), -c)], 0.0));
    }
    model.equations.extend((1..n).map(|k| (vec![(force(k - 1), 1.0), (force(k), -1.0)], 0.0)));
    let all = compliances.iter().enumerate().map(|(k, c)| (force(k), -c));
    model.equations.push(([(0, 1.0), (n, -1.0)].into_iter().chain(all).collect(), 0.0));
    let first = model.equations[0].0.iter().map(|&(j, a)| (j, 1000.0 * a));
    model.equations.push((first.collect(), 0.0));
    model.prescribed = vec![(0, 0.0), (n, 0.0)];
    if below(random, 2) == 0 {
        model.prescribed.push((force(0), 0.0));
    }
    model
}

fn conflicts(analysis: &Analysis) -> Vec<usize> {
    analysis.dependent().iter().filter(|d| d.kind == qless::Kind::Conflicting).map(|d| d.row).collect()
}

/// Law: with the numbers of a way as printed, the conflicts that it cures are gone, and no other equation has become conflicting.
#[test]
fn every_way_holds_as_printed() {
    let families: [fn(&mut SplitMix64) -> Model; 4] = [ties, periodic_cell, rigid_body, springs];
    let (mut systems, mut ways, mut without) = (0, 0, 0);
    for seed in 0..2_000_u64 {
        let random = &mut SplitMix64::new(seed);
        let mut model = families[seed as usize % 4](random);
        model.shuffle(random);
        let values = 10_f64.powi(below(random, 19) as i32 - 9);
        if seed % 3 != 0 {
            model.rescale(values, || 10_f64.powi(below(random, 13) as i32 - 6));
        }
        for _ in 0..=below(random, 3) {
            let numbers = model.equations.len() + model.prescribed.len();
            let place = below(random, numbers);
            let number = match place.checked_sub(model.equations.len()) {
                None => Number::RightHandSide(place),
                Some(k) => Number::Prescribed(model.prescribed[k].0),
            };
            let wrong = [1.0, 0.3, -2.5e-7, 1e9, 123.456][below(random, 5)];
            model.spoil(number, values * wrong);
        }
        let analysis = analyse(&model.system(), &Options::default()).expect("an analysis");
        let before = conflicts(&analysis);
        systems += usize::from(!before.is_empty());
        for repair in analysis.repairs().expect("repairs") {
            without += usize::from(repair.ways.is_empty());
            for way in &repair.ways {
                let mut mended =
                    Model { equations: model.equations.clone(), prescribed: model.prescribed.clone(), ..model };
                way.iter().for_each(|of| mended.set(of.number, of.to.to_string().parse().expect("a number")));
                let after = conflicts(&analyse(&mended.system(), &Options::default()).expect("an analysis"));
                let is_cured = repair.conflicts.iter().all(|row| !after.contains(row));
                assert!(is_cured && after.iter().all(|row| before.contains(row)), "seed {seed}: {way:?}: {after:?}");
                ways += 1;
            }
        }
    }
    println!("{systems} systems, {ways} ways, {without} repairs without a way");
    assert!(systems >= 1_000 && ways > 2 * systems && without * 100 <= systems, "{systems} {ways} {without}");
}

/// `1e12 u0 - u1 = 0`, `u1 = 1`, and u0 = 2 is prescribed: u0 must be 1e-12, which `2 + change` rounds to other digits.
#[test]
fn a_new_value_has_its_own_digits() {
    let mut builder = SystemBuilder::new(2);
    builder.equation([(0, 1e12), (1, -1.0)], 0.0);
    builder.equation([(1, 1.0)], 1.0);
    builder.prescribe(0, 2.0);
    let analysis = analyse(&builder.build().expect("valid"), &Options::default()).expect("an analysis");
    let ways = analysis.repairs().expect("repairs").remove(0).ways;
    let values: Vec<f64> = ways.iter().map(|way| way[0].to).collect();
    assert_eq!(values, [1e-12, 2e12, 2e12]);
}

/// A loop of ties has as many ways as equations; the cost of each must not grow with their number.
#[test]
fn a_long_loop_has_a_repair() {
    let n = 100_000;
    let mut builder = SystemBuilder::new(n);
    for k in 0..n {
        builder.equation([(k, 1.0), ((k + 1) % n, -1.0)], if k == 70_000 { 1.0 } else { 0.0 });
    }
    let analysis = analyse(&builder.build().expect("valid"), &Options::default()).expect("an analysis");
    let repair = analysis.repairs().expect("repairs").remove(0);
    let first = repair.ways[0][0];
    assert_eq!((first.number, first.from, first.to), (Number::RightHandSide(70_000), 1.0, 0.0));
    assert_eq!(repair.count, n);
}

/// `u_k + 4 u_(k+1) + u_(k+2) = b_k` fixes all DOFs if two are prescribed. The effects of far numbers decay by 3.7 for each equation: a
/// number 20 equations away cures the conflict only if it becomes 1e11, and is no way.
#[test]
fn no_way_is_far_larger_than_all_numbers() {
    for seed in 0..200 {
        let mut random = SplitMix64::new(seed);
        let n = 30 + below(&mut random, 60);
        let mut builder = SystemBuilder::new(n + 2);
        for k in 0..n {
            builder.equation([(k, 1.0), (k + 1, 4.0), (k + 2, 1.0)], below(&mut random, 19) as f64 - 9.0);
        }
        [0, n + 1].into_iter().for_each(|dof| builder.prescribe(dof, 0.0));
        let at = 1 + below(&mut random, n);
        builder.equation([(at, 1.0)], 5.0);
        let analysis = analyse(&builder.build().expect("valid"), &Options::default()).expect("an analysis");
        let repairs = analysis.repairs().expect("repairs");
        let changes = repairs.iter().flat_map(|repair| &repair.ways).flatten();
        let largest = changes.fold(0.0, |most: f64, change| most.max(change.to.abs()));
        assert!(largest > 0.0 && largest < 1e11, "{seed}: {largest:e}");
    }
}
