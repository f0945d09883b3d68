//! Springs, trusses and beams in any units, in two tied parts.

use faer::sparse::{SparseColMat, Triplet};
use qless::{ConstraintSystem, SystemBuilder};

use super::Random;
use crate::linkages::Outcome;

/// Factors of lengths and forces.
#[derive(Clone, Copy, Debug)]
pub struct Units {
    pub length: f64,
    pub force: f64,
}

pub const PLAIN: Units = Units { length: 1.0, force: 1.0 };

/// Stiffness, loads and constraints.
pub struct Model {
    pub k: SparseColMat<usize, f64>,
    pub f: Vec<f64>,
    pub system: ConstraintSystem,
    pub name: String,
}

/// The defect of a model that is to be unsupported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lack {
    Nothing,
    /// The first part is not supported.
    Ground,
    /// One tie of the second part is missing.
    Tie,
    /// One DOF has no stiffness.
    Stiffness,
}

/// Modification of the stiffness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Symmetric,
    Unsymmetric,
    Indefinite,
}

/// Entries of the stiffness, to be summed.
struct Assembly {
    dofs: usize,
    entries: Vec<Triplet<usize, usize, f64>>,
    /// Exponent of length in the unit of each DOF: 1 for translations, 0 for rotations.
    powers: Vec<i32>,
}

impl Assembly {
    fn new() -> Self {
        Self { dofs: 0, entries: Vec::new(), powers: Vec::new() }
    }

    fn dof(&mut self, power: i32) -> usize {
        self.powers.push(power);
        self.dofs += 1;
        self.dofs - 1
    }

    fn element<const N: usize>(&mut self, dofs: [usize; N], k: [[f64; N]; N]) {
        for (i, row) in dofs.iter().zip(k) {
            self.entries.extend(dofs.iter().zip(row).map(|(j, v)| Triplet::new(*i, *j, v)));
        }
    }

    fn spring(&mut self, i: usize, j: usize, s: f64) {
        self.element([i, j], [[s, -s], [-s, s]]);
    }
}

/// DOFs of a part at the ground, and at the tie.
struct Part {
    ground: Vec<usize>,
    tie: Vec<usize>,
}

/// A tree of springs of decimal stiffness plus a few more; one DOF at the ground, two at the tie.
fn springs(a: &mut Assembly, random: &mut Random) -> Part {
    let count = 6 + random.below(20);
    let dofs: Vec<usize> = (0..count).map(|_| a.dof(1)).collect();
    for i in 1..count {
        a.spring(dofs[i], dofs[random.below(i)], (1 + random.below(9)) as f64 / 10.0);
    }
    for _ in 0..count / 2 {
        let (i, j) = (random.below(count), random.below(count));
        if i != j {
            a.spring(dofs[i], dofs[j], 10_f64.powf(random.between(-2.0, 2.0)));
        }
    }
    Part { ground: vec![dofs[0]], tie: vec![dofs[count - 1]] }
}

/// A strip of triangles, rotated; two nodes at each end.
fn truss(a: &mut Assembly, random: &mut Random) -> Part {
    let bays = 2 + random.below(6);
    let angle = random.between(0.0, 6.0);
    let nodes: Vec<([f64; 2], [usize; 2])> = (0..2 * bays + 2)
        .map(|i| {
            let (x, y) = ((i / 2) as f64 + random.between(-0.2, 0.2), (i % 2) as f64 + random.between(-0.2, 0.2));
            let at = [x * angle.cos() - y * angle.sin(), x * angle.sin() + y * angle.cos()];
            (at, [a.dof(1), a.dof(1)])
        })
        .collect();
    let mut bar = |i: usize, j: usize| {
        let d = [nodes[j].0[0] - nodes[i].0[0], nodes[j].0[1] - nodes[i].0[1]];
        let length = d[0].hypot(d[1]);
        let s = random.between(0.5, 2.0) / length.powi(3);
        let [p, q] = [nodes[i].1, nodes[j].1];
        let part = |r: usize, c: usize| s * d[r] * d[c];
        let k = std::array::from_fn(|r| {
            std::array::from_fn(|c| if (r < 2) == (c < 2) { part(r % 2, c % 2) } else { -part(r % 2, c % 2) })
        });
        a.element([p[0], p[1], q[0], q[1]], k);
    };
    for b in 0..=bays {
        bar(2 * b, 2 * b + 1);
        if b < bays {
            bar(2 * b, 2 * b + 2);
            bar(2 * b + 1, 2 * b + 3);
            bar(2 * b, 2 * b + 3);
        }
    }
    let of = |i: usize| nodes[i].1;
    Part { ground: [of(0), of(1)].concat(), tie: [of(2 * bays), of(2 * bays + 1)].concat() }
}

/// `l^3 / EI` times the stiffness of a beam element of length h = l: deflection and rotation of both ends.
pub fn beam_element(h: f64) -> [[f64; 4]; 4] {
    [
        [12.0, 6.0 * h, -12.0, 6.0 * h],
        [6.0 * h, 4.0 * h * h, -6.0 * h, 2.0 * h * h],
        [-12.0, -6.0 * h, 12.0, -6.0 * h],
        [6.0 * h, 2.0 * h * h, -6.0 * h, 4.0 * h * h],
    ]
}

/// A beam of deflections and rotations, in units of length.
fn beam(a: &mut Assembly, random: &mut Random, units: Units) -> Part {
    let count = 3 + random.below(25);
    let nodes: Vec<[usize; 2]> = (0..=count).map(|_| [a.dof(1), a.dof(0)]).collect();
    for i in 0..count {
        let h = random.between(0.5, 1.5) * units.length;
        // Forces are in plain units; those of the whole matrix are applied later. Lengths are in the entries here.
        let s = random.between(0.5, 5.0) * (units.length / h).powi(3);
        a.element(
            [nodes[i][0], nodes[i][1], nodes[i + 1][0], nodes[i + 1][1]],
            beam_element(h).map(|row| row.map(|v| s * v)),
        );
    }
    Part { ground: nodes[0].to_vec(), tie: nodes[count].to_vec() }
}

/// Two parts of one family: the first on the ground, the second tied to it redundantly and with gaps.
pub fn model(case: usize, kind: Kind, lack: Lack, units: Units) -> Outcome<Model> {
    let random = &mut Random::new(case);
    let mut a = Assembly::new();
    let family = case % 3;
    let part = |a: &mut Assembly, random: &mut Random| match family {
        0 => springs(a, random),
        1 => truss(a, random),
        _ => beam(a, random, units),
    };
    let (first, second) = (part(&mut a, random), part(&mut a, random));
    let slack = a.dof(1);
    if lack != Lack::Stiffness {
        a.spring(slack, 0, 0.3);
    }
    let mut builder = SystemBuilder::new(a.dofs);
    // A truss has four ties and needs three; the missing ones are both ties of one node.
    let of = |i: usize| if family == 1 { i / 2 } else { i };
    let missing = if lack == Lack::Tie { of(random.below(first.tie.len())) } else { usize::MAX };
    let pairs = first.tie.iter().zip(&second.ground).enumerate().filter(|(i, _)| of(*i) != missing);
    for (i, (&p, &q)) in pairs {
        let gap = random.between(-0.1, 0.1) * units.length.powi(a.powers[p]);
        builder.equation([(p, 1.0), (q, -1.0)], gap);
        if i % 2 == 0 {
            builder.equation([(p, -3.0), (q, 3.0)], -3.0 * gap);
        }
    }
    let whole = lack != Lack::Ground;
    for &j in first.ground.iter().filter(|_| whole) {
        builder.prescribe(j, random.between(-0.1, 0.1) * units.length.powi(a.powers[j]));
    }
    let scale = units.force / units.length;
    let mut entries: Vec<_> =
        a.entries.iter().map(|entry| Triplet::new(entry.row, entry.col, scale * entry.val)).collect();
    disturbed(&mut entries, a.dofs, kind, lack, random);
    let f: Vec<f64> =
        (0..a.dofs).map(|j| random.between(-1.0, 1.0) * units.force * units.length.powi(1 - a.powers[j])).collect();
    let k = SparseColMat::try_new_from_triplets(a.dofs, a.dofs, &entries)?;
    Ok(Model { k, f, system: builder.build()?, name: format!("case {case}, {kind:?}, {lack:?}, {units:?}") })
}

fn disturbed(entries: &mut Vec<Triplet<usize, usize, f64>>, dofs: usize, kind: Kind, lack: Lack, random: &mut Random) {
    let mut diagonal = vec![0.0; dofs];
    entries.iter().filter(|entry| entry.row == entry.col).for_each(|entry| diagonal[entry.row] += entry.val);
    match kind {
        Kind::Symmetric => {}
        // Minus a mass matrix times a frequency in the middle of the spectrum.
        Kind::Indefinite if lack == Lack::Nothing => {
            entries.extend((0..dofs).map(|j| Triplet::new(j, j, -0.37 * random.between(0.9, 1.1) * diagonal[j])));
        }
        Kind::Indefinite => entries.iter_mut().for_each(|entry| entry.val = -entry.val),
        // Rows multiplied by factors; zero stiffness stays zero.
        Kind::Unsymmetric => {
            let factors: Vec<f64> = (0..dofs).map(|_| random.between(0.7, 1.3)).collect();
            entries.iter_mut().for_each(|entry| entry.val *= factors[entry.row]);
        }
    }
}

/// `max |a - b| / max |b|`, with each DOF in its unit of energy.
pub fn off(model: &Model, a: &[f64], b: &[f64]) -> f64 {
    let energy = |j: usize, u: f64| u.abs() * model.k.get(j, j).map_or(0.0, |k| k.abs().sqrt());
    let size = (0..b.len()).fold(0.0, |most: f64, j| most.max(energy(j, b[j])));
    (0..b.len()).fold(0.0, |most: f64, j| most.max(energy(j, a[j] - b[j]))) / size
}

/// Nine pairs of units.
pub fn all_units() -> impl Iterator<Item = Units> {
    let scales = [1e-6, 1.0, 1e6];
    scales.into_iter().flat_map(move |length| scales.map(|force| Units { length, force }))
}
