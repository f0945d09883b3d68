//! `C_S x = b` on the kept rows and slaves of one block, again and again, by sparse LU.

use crate::factor::backend::BackendError;
use crate::factor::block::Block;
use crate::factor::lu;
use crate::factor::solver::Solver;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::basis::Kept;
use crate::reduction::block::may_be_slaves;

/// The kept rows of a block, solved for slaves.
pub struct Square {
    /// Exponents of the kept rows.
    exponents: Vec<i32>,
    solver: Solver,
    /// Local DOF of each number of a solution, and the exponent of its scaling.
    slaves: Vec<(u32, i32)>,
}

impl Square {
    /// A block, factored.
    pub fn new(block: &Block, kept: &Kept, scaling: &Scaling, memory: usize) -> Result<Self, BackendError> {
        let rows: Vec<usize> = kept.rows.iter().filter_map(|row| block.rows.binary_search(row).ok()).collect();
        let matrix = block.select(&rows);
        let order: Vec<usize> = kept.order.iter().map(|&i| i as usize).collect();
        let may = may_be_slaves(block, kept, memory)?;
        let lu = lu::factor(&matrix, &order, |j| may[j], memory)
            .map_err(|error| error.of_block("refresher", &matrix, memory))?;
        let of = |&j: &u32| (block.dofs[j as usize], scaling.col(block.dofs[j as usize] as usize));
        let slaves = lu.slaves.iter().map(of).collect();
        let exponents = rows.iter().map(|&i| block.exponents[i]).collect();
        Ok(Self { exponents, solver: Solver::new(&matrix, lu), slaves })
    }

    /// Sets the slaves in u (local), all other DOFs of the block being zero; `b` has a number for each kept row.
    pub fn solve(&self, mut b: Vec<f64>, u: &mut [f64]) {
        b.iter_mut().zip(&self.exponents).for_each(|(b, &shift)| *b = ldexp(*b, shift));
        let x = self.solver.solve_dense(&b);
        self.slaves.iter().zip(x).for_each(|(&(j, exponent), x)| u[j as usize] = ldexp(x, exponent));
    }
}
