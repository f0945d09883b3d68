/// Heat flows through hanging nodes and mortar ties.
mod conduction;
/// Beams and shells that pull on a solid.
mod tension;

use std::array::from_fn;

use faer::sparse::{SparseColMat, Triplet};
use qless_constraints::ConstraintSet;
use qless_constraints::types::{Face, MortarTie, Multipliers, Point, Shape, Surface};
use qless_solve::enforce::Problem;

use crate::linkages::Outcome;

pub const MODULUS: f64 = 3.0;
pub const POISSON: f64 = 0.3;

/// A block of `cells` x `cells` x 1 elements with eight nodes on the unit square, from z to z + 1.
pub struct Block {
    pub cells: usize,
    pub z: f64,
    pub first: usize,
}

impl Block {
    pub fn side(&self) -> usize {
        self.cells + 1
    }

    pub fn nodes(&self) -> Vec<Point> {
        let at = |i: usize| [i % self.side(), i / self.side() % self.side()].map(|k| k as f64 / self.cells as f64);
        let level = |i: usize| self.z + (i / (self.side() * self.side())) as f64;
        let node = |i: usize| Point::new(from_fn(|k| 3 * (self.first + i) + k), [at(i)[0], at(i)[1], level(i)]);
        (0..2 * self.side() * self.side()).map(node).collect()
    }

    /// Squares of the lower (0) or the upper (1) surface.
    pub fn surface(&self, level: usize) -> Surface<3> {
        let face = |k: usize| {
            let a = level * self.side() * self.side() + k / self.cells * self.side() + k % self.cells;
            Face::new(Shape::Quad4, [a, a + 1, a + 1 + self.side(), a + self.side()])
        };
        Surface { nodes: self.nodes(), faces: (0..self.cells * self.cells).map(face).collect() }
    }

    pub fn stiffness(&self) -> Vec<Triplet<usize, usize, f64>> {
        let (nodes, [lower, upper]) = (self.nodes(), [0, 1].map(|level| self.surface(level).faces));
        let element = |(a, b): (&Face, &Face)| {
            let nodes: Vec<Point> = a.nodes.iter().chain(&b.nodes).map(|&i| nodes[i]).collect();
            brick(&nodes)
        };
        lower.iter().zip(&upper).flat_map(element).collect()
    }

    /// A traction of size one along z on a surface.
    fn load(&self, level: usize, sign: f64, f: &mut [f64]) {
        let share = sign / (4 * self.cells * self.cells) as f64;
        self.surface(level)
            .faces
            .iter()
            .flat_map(|face| &face.nodes)
            .for_each(|i| f[3 * (self.first + i) + 2] += share);
    }
}

/// `K = int B^T E B dV` of a box with eight nodes, lower side first, each in order around.
fn brick(nodes: &[Point]) -> Vec<Triplet<usize, usize, f64>> {
    let corner = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let sign = |a: usize| [corner[a % 4][0], corner[a % 4][1], if a < 4 { -1.0 } else { 1.0 }];
    let half: [f64; 3] = from_fn(|k| (nodes[6].at[k] - nodes[0].at[k]) / 2.0);
    let (shear, lame) =
        (MODULUS / (2.0 + 2.0 * POISSON), MODULUS * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON)));
    let mut entries = Vec::new();
    for gauss in 0..8 {
        let xi: [f64; 3] = sign(gauss).map(|s| s / 3.0_f64.sqrt());
        let slope = |a: usize| -> [f64; 3] {
            let part = |k: usize| f64::midpoint(1.0, sign(a)[k] * xi[k]);
            from_fn(|k| sign(a)[k] / 2.0 / half[k] * part((k + 1) % 3) * part((k + 2) % 3))
        };
        let volume = half[0] * half[1] * half[2];
        for (a, b) in (0..8).flat_map(|a| (0..8).map(move |b| (a, b))) {
            let (p, q) = (slope(a), slope(b));
            let both: f64 = (0..3).map(|k| p[k] * q[k]).sum();
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                let diagonal = if i == j { shear * both } else { 0.0 };
                let value = volume * (lame * p[i] * q[j] + shear * p[j] * q[i] + diagonal);
                entries.push(Triplet::new(nodes[a].dofs[i], nodes[b].dofs[j], value));
            }
        }
    }
    entries
}

/// Uniform tension passes the interface without disturbance (Puso 2004, Sec. 5), whichever side is the slave.
#[test]
fn tension_passes_meshes_that_do_not_match() -> Outcome {
    let kinds = [Multipliers::Standard, Multipliers::Dual];
    for (cells, multipliers) in [[2, 3], [3, 2], [4, 3]].into_iter().flat_map(|cells| kinds.map(|kind| (cells, kind))) {
        let lower = Block { cells: cells[0], z: 0.0, first: 0 };
        let upper = Block { cells: cells[1], z: 1.0, first: lower.nodes().len() };
        let nodes = [lower.nodes(), upper.nodes()].concat();
        let dofs = 3 * nodes.len();
        let k = SparseColMat::try_new_from_triplets(dofs, dofs, &[lower.stiffness(), upper.stiffness()].concat())?;
        let mut f = vec![0.0; dofs];
        lower.load(0, -1.0, &mut f);
        upper.load(1, 1.0, &mut f);
        let mut builder = ConstraintSet::builder(dofs);
        let tie = MortarTie { slave: lower.surface(1), master: upper.surface(0), multipliers, tolerance: 1e-12 };
        builder.add("interface", tie)?;
        let set = builder.build().expect("few DOFs");
        // Supports of the rigid motions: three, two and one DOF at three corners.
        let [b, c] = [lower.cells, lower.cells * lower.side()];
        let held: Vec<_> = [0, 1, 2, 3 * b + 1, 3 * b + 2, 3 * c + 2].into_iter().map(|dof| (dof, 0.0)).collect();
        let mut evaluation = set.allocate();
        set.evaluate(&vec![0.0; set.dofs()], &mut evaluation)?;
        let system = set.linearised(&evaluation, &held)?;
        let solution = Problem::new(&k, &f, &system)?.transformation()?;
        for node in &nodes {
            let [x, y, z] = node.at;
            let truth = [-POISSON * x, -POISSON * y, z].map(|u| u / MODULUS);
            for axis in 0..3 {
                let u = solution.u[node.dofs[axis]];
                assert!((u - truth[axis]).abs() < 1e-12, "{:?}, {axis}: {u}, {}", node.at, truth[axis]);
            }
        }
    }
    Ok(())
}
