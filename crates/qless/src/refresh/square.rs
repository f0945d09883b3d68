//! `C_S x = b` on the kept rows and the slaves of one block, again and again, by sparse LU.

use crate::basis::Basis;
use crate::block::Block;
use crate::block::lu;
use crate::block::solver::Solver;
use crate::qr::BackendError;
use crate::scale::ldexp;

/// The kept rows and the slaves of a block.
pub struct Square {
    /// Exponents of the kept rows.
    exponents: Vec<i32>,
    solver: Solver,
    /// Where each slave of the basis stands in a solution.
    place: Vec<u32>,
}

impl Square {
    /// Block `k` of the basis, factored.
    pub fn new(block: &Block, basis: &Basis, k: usize, memory: usize) -> Result<Self, BackendError> {
        let part = &basis.blocks[k];
        let kept: Vec<usize> = part.rows.iter().filter_map(|row| block.rows.binary_search(row).ok()).collect();
        let slaves = basis.slaves()[basis.rows_of(k)].iter();
        let slaves: Vec<usize> = slaves.filter_map(|slave| block.dofs.binary_search(slave).ok()).collect();
        let mut number = vec![u32::MAX; block.matrix.cols];
        slaves.iter().zip(0..).for_each(|(&j, i)| number[j] = i);
        let rows = block.select(&kept);
        let order: Vec<usize> = part.order.iter().map(|&i| i as usize).collect();
        let lu = lu::factor(&rows, &order, |j| number[j] != u32::MAX, memory)
            .map_err(|error| error.of_block("refresher", &rows, memory))?;
        let mut place = vec![0; slaves.len()];
        lu.slaves.iter().zip(0..).for_each(|(&j, step)| place[number[j as usize] as usize] = step);
        let exponents = kept.iter().map(|&i| block.exponents[i]).collect();
        Ok(Self { exponents, solver: Solver::new(&rows, lu), place })
    }

    /// One number for each slave; `b` has one for each kept row.
    pub fn solve(&self, mut b: Vec<f64>) -> Vec<f64> {
        b.iter_mut().zip(&self.exponents).for_each(|(b, &shift)| *b = ldexp(*b, shift));
        let x = self.solver.solve_dense(&b);
        self.place.iter().map(|&step| x[step as usize]).collect()
    }
}
