//! `C_S x = b` on the kept rows and the slaves of one block, again and again.
//!
//! Small blocks: dense QR with Q, and a step of refinement. Large ones: as T was found, by seminormal equations.

use crate::Csr;
use crate::basis::Basis;
use crate::block::large::Solver;
use crate::block::{Block, pick};
use crate::qr::faer::Faer;
use crate::qr::sparse::Sparse;
use crate::qr::{Backend, BackendError, Factor, SMALL};
use crate::scale::ldexp;

/// The kept rows and the slaves of a block.
pub struct Square {
    /// Exponents of the kept rows.
    exponents: Vec<i32>,
    solver: Way,
}

enum Way {
    /// C_S by rows, and its factor, which holds Q^T in place of right-hand sides.
    Dense(Csr, Factor),
    Sparse(Solver),
}

impl Square {
    /// Block `k` of the basis, factored.
    pub fn new(block: &Block, basis: &Basis, k: usize, memory: usize) -> Result<Self, BackendError> {
        let place = |row: &u32| block.rows.binary_search(row).ok();
        let kept: Vec<usize> = basis.blocks[k].rows.iter().filter_map(place).collect();
        let slaves = basis.slaves()[basis.rows_of(k)].iter();
        let slaves: Vec<usize> = slaves.filter_map(|slave| block.dofs.binary_search(slave).ok()).collect();
        let mut rows = Csr::empty(block.matrix.cols);
        kept.iter().for_each(|&i| rows.push_row(block.matrix.row(i)));
        let by_column = rows.transpose();
        let columns = pick::columns(&by_column, slaves.iter().copied());
        let r = slaves.len();
        let solver = if r.saturating_mul(r) > SMALL {
            let factor = full(Sparse { memory }.factor(&columns, &[], 0.0)?, r)?;
            Way::Sparse(Solver::new(&by_column, &slaves, &factor))
        } else {
            let mut identity = vec![0.0; r * r];
            (0..r).for_each(|i| identity[i * r + i] = 1.0);
            let factor = full(Faer.factor(&columns, &identity, 0.0)?, r)?;
            Way::Dense(columns.transpose(), factor)
        };
        Ok(Self { exponents: kept.iter().map(|&i| block.exponents[i]).collect(), solver })
    }

    /// One number for each slave; `b` has one for each kept row.
    pub fn solve(&self, mut b: Vec<f64>) -> Vec<f64> {
        b.iter_mut().zip(&self.exponents).for_each(|(b, &shift)| *b = ldexp(*b, shift));
        match &self.solver {
            Way::Dense(c, factor) => dense(c, factor, &b),
            Way::Sparse(solver) => {
                let mut right = Csr::empty(b.len());
                right.push_row(b.into_iter().enumerate());
                let solved = solver.solve(&right);
                let mut x = vec![0.0; self.exponents.len()];
                solved.row(0).for_each(|(i, v)| x[i] = v);
                x
            }
        }
    }
}

/// The slaves were chosen so that this does not happen.
fn full(factor: Factor, r: usize) -> Result<Factor, BackendError> {
    if factor.rank == r {
        return Ok(factor);
    }
    let message = format!("{} of {r} slaves of a block are independent", factor.rank);
    Err(BackendError::Failed { backend: "refresher", message })
}

fn dense(c: &Csr, factor: &Factor, b: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0; b.len()];
    let mut left = b.to_vec();
    for _ in 0..2 {
        let mut z = vec![0.0; b.len()];
        for (column, &v) in factor.rhs.chunks_exact(b.len().max(1)).zip(&left) {
            z.iter_mut().zip(column).for_each(|(z, q)| *z += v * q);
        }
        factor.solve(&z).iter().zip(&factor.order).for_each(|(v, &k)| x[k] += v);
        for (i, left) in left.iter_mut().enumerate() {
            *left = b[i] - c.row(i).map(|(j, v)| v * x[j]).sum::<f64>();
        }
    }
    x
}
