//! `L^T K L u_q = -L^T K u_0` by conjugate gradients: each rank multiplies by its own part of the condensed matrix.

use std::error::Error;

use qless::Options;
use qless::elimination::{CondensedPattern, PrescribedDofs, Storage};
use qless_mpi::{DistributedElimination, Ranks, agree, exact_sum};

use crate::cell::Cell;
use crate::constraints::{Constraints, Gradient, dofs_of};
use crate::hexahedron::{SIZE, stiffness};

/// Relative residual at which the iteration ends.
const TOLERANCE: f64 = 1e-12;

/// The hexahedra of one rank, condensed.
pub struct Model<'a> {
    ranks: &'a dyn Ranks,
    pub map: DistributedElimination,
    pub constraints: Constraints,
    /// The block of each hexahedron, and the places of its DOFs among the local DOFs.
    hexahedra: Vec<(usize, [usize; SIZE])>,
    /// The stiffness of the hexahedra of each block.
    stiffness: [Vec<f64>; 2],
    condensed: CondensedPattern,
    k_q: Vec<f64>,
    /// `-L^T K u_0` of this rank.
    load: Vec<f64>,
}

impl<'a> Model<'a> {
    /// The cell without a displacement gradient. Collective.
    pub fn new(cell: &Cell, ranks: &'a dyn Ranks) -> Result<Self, Box<dyn Error>> {
        let constraints = agree(ranks, Constraints::new(cell, ranks).map_err(|error| qless_mpi::Error::of(ranks, &error)))?;
        let map = DistributedElimination::new(ranks, &constraints.share, &Options::default())?;
        let place = |dof: u64| map.dofs().binary_search(&dof).expect("it was asked for");
        let owned = cell.hexahedra_in(cell.owned(ranks.rank(), ranks.size()));
        let hexahedra: Vec<_> = owned
            .map(|corners| {
                let dofs = corners.map(|node| dofs_of(cell, node).map(place));
                (corners[0].block, std::array::from_fn(|k| dofs[k / 3][k % 3]))
            })
            .collect();
        let stiffness = cell.blocks.map(|block| stiffness(block.edges(), block.young));
        let dofs = |e: usize| hexahedra[e].1;
        let condensed = map.local().condensed_for_elements(hexahedra.len(), dofs, Storage::Full, PrescribedDofs::Eliminated);
        let condensed = agree(ranks, condensed.map_err(|error| qless_mpi::Error::of(ranks, &error)))?;
        let (k_q, load) = (vec![0.0; condensed.nnz()], vec![0.0; condensed.unknowns()]);
        Ok(Self { ranks, map, constraints, hexahedra, stiffness, condensed, k_q, load })
    }

    /// Sets the mean displacement gradient of the cell. Collective.
    pub fn stretch(&mut self, e: &Gradient) -> Result<(), Box<dyn Error>> {
        self.constraints.stretch(e);
        self.map.update(self.ranks, &self.constraints.share, &Options::default())?;
        let Self { ranks, map, hexahedra, stiffness, condensed, k_q, load, .. } = self;
        let element = |e: usize, matrix: &mut [f64], _: &mut [f64]| matrix.copy_from_slice(&stiffness[hexahedra[e].0]);
        let dofs = |e: usize| hexahedra[e].1;
        let done = condensed.assemble(map.local(), hexahedra.len(), dofs, k_q, load, element);
        Ok(agree(*ranks, done.map_err(|error| qless_mpi::Error::of(*ranks, &error)))?)
    }

    /// Solves for u_q; returns the number of iterations. Collective.
    pub fn solve(&self, u_q: &mut [f64]) -> Result<usize, String> {
        let dot = |a: &[f64], b: &[f64]| exact_sum(self.ranks, a.iter().zip(b).map(|(a, b)| a * b));
        let diagonal = self.summed(&self.diagonal());
        let scaled = |r: &[f64]| -> Vec<f64> { r.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
        let load = self.summed(&self.load);
        let product = self.product(u_q);
        let mut r: Vec<f64> = load.iter().zip(&product).map(|(f, product)| f - product).collect();
        let mut z = scaled(&r);
        let (mut p, mut rz) = (z.clone(), dot(&r, &z));
        let enough = TOLERANCE * TOLERANCE * dot(&load, &scaled(&load));
        for iteration in 0..10_000 {
            if rz <= enough {
                return Ok(iteration);
            }
            let product = self.product(&p);
            let step = rz / dot(&p, &product);
            u_q.iter_mut().zip(&p).for_each(|(u, p)| *u += step * p);
            r.iter_mut().zip(&product).for_each(|(r, product)| *r -= step * product);
            z = scaled(&r);
            let before = std::mem::replace(&mut rz, dot(&r, &z));
            p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + rz / before * *p);
        }
        Err(format!("conjugate gradients do not converge: {rz:e} where {enough:e} is enough"))
    }

    /// `L^T K L x`. Collective.
    fn product(&self, x: &[f64]) -> Vec<f64> {
        let mut local = vec![0.0; self.condensed.unknowns()];
        self.map.gather_into(self.ranks, x, &mut local, &mut || ());
        let (starts, index) = (self.condensed.starts(), self.condensed.index());
        let row = |range: &[u32]| {
            let entries = range[0] as usize..range[1] as usize;
            let terms = index[entries.clone()].iter().zip(&self.k_q[entries]);
            terms.map(|(&q, value)| value * local[q as usize]).sum()
        };
        self.summed(&starts.windows(2).map(row).collect::<Vec<f64>>())
    }

    fn diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.condensed.unknowns()];
        let entries = self.condensed.entries().zip(&self.k_q);
        entries.filter(|((row, column), _)| row == column).for_each(|((row, _), value)| diagonal[row] = *value);
        diagonal
    }

    /// Sums the contributions of all ranks to the masters, at their owners. Collective.
    fn summed(&self, local: &[f64]) -> Vec<f64> {
        let mut masters = vec![0.0; self.map.masters().len()];
        self.map.sum_into(self.ranks, local, &mut masters);
        masters
    }

    /// u on the local DOFs. Collective.
    pub fn expanded(&self, u_q: &[f64]) -> Vec<f64> {
        let mut u = vec![0.0; self.map.dofs().len()];
        self.map.expand_into(self.ranks, u_q, &mut u);
        u
    }

    /// `K u` of this rank's hexahedra.
    fn forces(&self, u: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; u.len()];
        for (block, dofs) in &self.hexahedra {
            for (&i, row) in dofs.iter().zip(self.stiffness[*block].chunks_exact(SIZE)) {
                forces[i] += dofs.iter().zip(row).map(|(&j, k)| k * u[j]).sum::<f64>();
            }
        }
        forces
    }

    /// The mean stress in balance with u, by virtual work: the cell has volume 1, and `S_ij` is the work of `K u` on any motion that the
    /// constraints allow at `E_ij = 1`. Collective; the cell is then at rest.
    pub fn mean_stress(&mut self, u: &[f64]) -> Result<Gradient, Box<dyn Error>> {
        let forces = self.forces(u);
        let at_rest = vec![0.0; self.map.masters().len()];
        let mut stress = [[0.0; 3]; 3];
        for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
            let mut unit = [[0.0; 3]; 3];
            unit[i][j] = 1.0;
            self.stretch(&unit)?;
            let motion = self.expanded(&at_rest);
            stress[i][j] = exact_sum(self.ranks, forces.iter().zip(&motion).map(|(f, u)| f * u));
        }
        self.stretch(&[[0.0; 3]; 3])?;
        Ok(stress)
    }
}
