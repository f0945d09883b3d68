//! `u_s = C_S^-1 (b - C_M u_q - C_p u_p)` for blocks too large for a dense array: sparse LU chooses the slaves and solves for T.
//!
//! T comes from C and the slaves of the factors in one go, column by column, with a step of refinement. Where C is sparse the cost
//! is that of the numbers that are there.

use crate::Csr;
use crate::factor::backend::BackendError;
use crate::factor::block::Block;
use crate::factor::lu::{self, LuError};
use crate::factor::solver::Solver;

/// A block's slaves by its masters.
pub(super) struct Large {
    /// DOFs of the block.
    pub slaves: Vec<u32>,
    pub masters: Vec<u32>,
    /// A row for each master, then for each prescribed DOF; columns as `slaves`.
    pub columns: Csr,
    /// One number for each slave.
    pub constant: Vec<f64>,
}

/// `kept` are independent rows, `order` is one that fills little. None where the factors do not find them independent.
pub(super) fn relation(
    block: &Block,
    kept: &[usize],
    order: &[u32],
    memory: usize,
) -> Result<Option<Large>, BackendError> {
    let rows = block.select(kept);
    let order: Vec<usize> = order.iter().map(|&k| k as usize).collect();
    let lu = match lu::factor(&rows, &order, |_| true, memory) {
        Ok(lu) => lu,
        Err(LuError::Dependent) => return Ok(None),
        Err(error) => return Err(error.of_block("sparse LU", &rows, memory)),
    };
    let solver = Solver::new(&rows, lu);
    let slaves = solver.slaves().to_vec();
    let mut is_slave = vec![false; block.matrix.cols];
    slaves.iter().for_each(|&j| is_slave[j as usize] = true);
    let masters: Vec<u32> = (0..block.matrix.cols as u32).filter(|&j| !is_slave[j as usize]).collect();
    let columns = solver.solve(&right_sides(block, kept, &rows, &masters));
    let b: Vec<f64> = kept.iter().map(|&i| block.rhs[i]).collect();
    let constant = solver.solve_dense(&b);
    Ok(Some(Large { slaves, masters, columns, constant }))
}

/// `-[C_M C_p]` by columns.
fn right_sides(block: &Block, kept: &[usize], rows: &Csr, masters: &[u32]) -> Csr {
    let by_column = rows.transposed();
    let mut right = Csr::empty(kept.len());
    masters.iter().for_each(|&j| right.append(by_column.row(j as usize).map(|(i, v)| (i, -v))));
    let mut fixed = Csr::empty(block.prescribed.len());
    kept.iter().for_each(|&i| fixed.append(block.fixed.row(i).map(|(c, v)| (c, -v))));
    let fixed = fixed.transposed();
    (0..block.prescribed.len()).for_each(|c| right.append(fixed.row(c)));
    right
}
