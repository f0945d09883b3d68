//! Elastic mechanisms, alone or side by side in one model.

use std::error::Error;

use qless_solve::equilibrium::{Assembly, Model};

use crate::parts_of_newton::mechanism::{Item, Map, Mechanism};
use crate::parts_of_newton::random::{Draw, KINDS, mechanism};

/// Number of kinds.
pub const ALL_KINDS: usize = KINDS + 6;

/// `f = k d + a d^3`, where d is between two DOFs, or that of a DOF named twice.
type Spring = ([usize; 2], [f64; 2]);

/// A mechanism with springs and loads.
#[derive(Clone, Debug)]
pub struct Piece {
    pub mechanism: Mechanism,
    pub springs: Vec<Spring>,
    pub loads: Vec<f64>,
    /// The model rejects larger displacements.
    pub limit: Option<f64>,
}

/// A piece of the given kind, in units of length and force.
pub fn piece(kind: usize, seed: usize, [unit, force]: [f64; 2]) -> Piece {
    let mut draw = Draw(5_000 * (seed * ALL_KINDS + kind) + 77);
    let k = force / unit;
    match kind.checked_sub(KINDS) {
        None => sprung(&mut draw, mechanism(kind, seed, unit), [unit, force]),
        Some(0) => truss(&mut draw, unit, force),
        Some(1) => hanging(&mut draw, unit, force),
        Some(2) => {
            // The same rod twice, on springs.
            let nodes = [(1, [0.0; 2]), (3, [unit, 0.3 * unit])];
            let items = vec![Item::Rod(nodes, None), Item::Rod(nodes, None)];
            let mechanism = Mechanism { items, start: vec![0.0; 5], held: vec![(0, 0.1 * draw.next() * unit)] };
            sprung(&mut draw, mechanism, [unit, force])
        }
        Some(3) => {
            // Without support.
            let springs = vec![([1, 2], [k, 0.0]), ([2, 3], [2.0 * k, 0.0])];
            let mechanism = Mechanism { items: Vec::new(), start: vec![0.0; 4], held: vec![(0, 0.0)] };
            Piece { mechanism, springs, loads: vec![0.0, draw.of(&[0.0, force]), 0.0, 0.0], limit: None }
        }
        Some(4) => {
            // Soft at first: the first correction is much too long, and is rejected.
            let springs = vec![([1, 1], [k, 2e4 * k / unit / unit]), ([1, 2], [k, 0.0])];
            let mechanism = Mechanism { items: Vec::new(), start: vec![0.0; 3], held: vec![(0, 0.1 * unit)] };
            let loads = vec![0.0, (2.0 + draw.next()) * force, 0.0];
            Piece { mechanism, springs, loads, limit: Some(draw.of(&[0.5, 0.2]) * unit) }
        }
        Some(_) => {
            // Snaps through: buckles when it is straight; unstable.
            let items = vec![Item::Arm((1, [unit, 0.0]), [0.0; 2], None)];
            let mechanism = Mechanism { items, start: vec![0.0; 3], held: vec![(0, 0.1 * unit)] };
            let springs = vec![([2, 2], [k, 0.0])];
            let loads = vec![0.0, draw.of(&[-0.4, -3.0, 0.7]) * force, 0.0];
            Piece { mechanism, springs, loads, limit: None }
        }
    }
}

/// Springs to the ground and between neighbours, and loads.
fn sprung(draw: &mut Draw, mechanism: Mechanism, [unit, force]: [f64; 2]) -> Piece {
    let n = mechanism.start.len();
    let k = |draw: &mut Draw| force / unit * (0.1 + draw.next().abs());
    let mut springs: Vec<Spring> = Vec::new();
    for j in 1..n {
        if draw.next() > -0.8 {
            springs.push(([j, j], [k(draw), 0.0]));
        }
        if draw.next() > 0.0 {
            springs.push(([j - 1, j], [k(draw), k(draw) / unit / unit]));
        }
    }
    let size = draw.of(&[0.0, 0.01, 0.3]) * force;
    Piece { loads: draw.some(n, size), mechanism, springs, limit: None }
}

/// A strip of nodes, each with springs to the two before it, without equations.
fn truss(draw: &mut Draw, unit: f64, force: f64) -> Piece {
    let n = draw.of(&[4, 9, 16]);
    let k = |draw: &mut Draw| [force / unit * (1.0 + draw.next().abs()), 3.0 * force / unit.powi(3)];
    let springs = (0..n).flat_map(|j| [1, 2].map(|back| (j, back))).filter(|(j, back)| j >= back);
    let springs = springs.map(|(j, back)| ([j - back, j], k(draw))).collect();
    let mechanism = Mechanism { items: Vec::new(), start: vec![0.0; n], held: vec![(0, 0.3 * draw.next() * unit)] };
    Piece { loads: draw.some(n, force), mechanism, springs, limit: None }
}

/// A chain without stiffness, initially level; tension makes it stiff. Its last node is on a spring.
fn hanging(draw: &mut Draw, unit: f64, force: f64) -> Piece {
    let count = draw.of(&[1, 3, 6]);
    let node = |i: usize| (1 + 2 * i, [(i + 1) as f64 * unit, 0.0]);
    let mut items = vec![Item::Arm(node(0), [0.0; 2], None)];
    items.extend((1..count).map(|i| Item::Rod([node(i - 1), node(i)], None)));
    let n = 1 + 2 * count;
    let mut loads = vec![0.0; n];
    (0..count).for_each(|i| loads[2 + 2 * i] = -force * (1.0 + 0.2 * draw.next()));
    loads[n - 2] = 0.3 * force;
    let springs = vec![([n - 2, n - 2], [0.5 * force / unit, 0.0])];
    let mechanism = Mechanism { items, start: vec![0.0; n], held: vec![(0, 0.0)] };
    Piece { mechanism, springs, loads, limit: None }
}

/// Pieces in one model, with a count of evaluations.
pub struct Pieces<'a> {
    pub all: Vec<(&'a Piece, &'a Map)>,
    pub dofs: usize,
    pub evaluations: usize,
}

impl<'a> Pieces<'a> {
    pub fn new(all: impl Iterator<Item = (&'a Piece, &'a Map)>, dofs: usize) -> Self {
        Self { all: all.collect(), dofs, evaluations: 0 }
    }

    pub fn loads(&self) -> Vec<f64> {
        let mut loads = vec![0.0; self.dofs];
        self.all.iter().for_each(|(piece, map)| piece.loads.iter().zip(*map).for_each(|(f, &j)| loads[j] = *f));
        loads
    }
}

impl Model for Pieces<'_> {
    fn dofs(&self) -> usize {
        self.dofs
    }

    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        for (piece, map) in &self.all {
            for (ends, _) in &piece.springs {
                let ends = ends.map(|j| map[j]);
                ends.iter().for_each(|&i| ends.iter().for_each(|&j| entry(i, j)));
            }
        }
    }

    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.evaluations += 1;
        for (piece, map) in &self.all {
            if piece.limit.is_some_and(|limit| map[1..].iter().any(|&j| u[j].abs() > limit)) {
                return Err("too far".into());
            }
            for &(ends, [k, a]) in &piece.springs {
                let [i, j] = ends.map(|j| map[j]);
                let d = if i == j { u[i] } else { u[j] - u[i] };
                let (f, k) = (k * d + a * d * d * d, k + 3.0 * a * d * d);
                out.force(j, f);
                out.stiffness(j, j, k);
                if i != j {
                    out.force(i, -f);
                    [(i, i, k), (i, j, -k), (j, i, -k)].into_iter().for_each(|(i, j, k)| out.stiffness(i, j, k));
                }
            }
        }
        Ok(())
    }
}
