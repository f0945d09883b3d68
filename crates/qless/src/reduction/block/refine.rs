//! `X <- X - C_S^-1 (C_S X - B)`: one step of iterative refinement of the slaves' relation.
//!
//! A QR solves each column to rounding relative to the largest number in it; small rows of it inherit that error. One
//! step in the same precision makes the error small in every equation relative to its own parts (Skeel 1980).

use crate::Csr;
use crate::factor::backend::faer::Faer;
use crate::factor::backend::{Backend, BackendError};
use crate::factor::block::Block;
use crate::factor::block::tableau::Tableau;

/// Residuals up to this, relative to the parts of their equation, are left alone.
const GOOD: f64 = 1e-14;

pub(super) fn refine(block: &Block, kept: &[usize], tableau: &mut Tableau) -> Result<(), BackendError> {
    let (residual, worst) = residual(block, kept, tableau);
    if worst <= GOOD {
        return Ok(());
    }
    let factor = Faer.factor(&slave_columns(block, kept, tableau), &residual, 0.0)?;
    let r = kept.len();
    if factor.rank < r {
        return Ok(());
    }
    let before = tableau.data.clone();
    for c in 0..tableau.width {
        let correction = factor.solved(&factor.rhs[c * r..(c + 1) * r]);
        for (k, &i) in factor.order.iter().enumerate() {
            tableau.data[i * tableau.width + c] -= correction[k];
        }
    }
    if self::residual(block, kept, tableau).1 > worst {
        tableau.data = before;
    }
    Ok(())
}

/// `C_S X - B` by columns, and the largest entry relative to the sum of its parts' sizes.
fn residual(block: &Block, kept: &[usize], tableau: &Tableau) -> (Vec<f64>, f64) {
    let (r, width) = (kept.len(), tableau.width);
    let mut slave = vec![usize::MAX; block.dofs.len()];
    tableau.basic.iter().enumerate().for_each(|(i, &j)| slave[j as usize] = i);
    let mut master = vec![usize::MAX; block.dofs.len()];
    tableau.free.iter().enumerate().for_each(|(c, &j)| master[j as usize] = c);
    let mut result = vec![0.0; r * width];
    let mut worst = 0.0_f64;
    let (mut sum, mut size) = (vec![0.0; width], vec![0.0; width]);
    for (position, &i) in kept.iter().enumerate() {
        sum.fill(0.0);
        size.fill(0.0);
        let mut add = |c: usize, part: f64| {
            sum[c] += part;
            size[c] += part.abs();
        };
        for (j, v) in block.matrix.row(i) {
            match slave[j] {
                usize::MAX => add(master[j], v),
                row => tableau.row(row).iter().enumerate().for_each(|(c, x)| add(c, v * x)),
            }
        }
        block.fixed.row(i).for_each(|(c, v)| add(tableau.free.len() + c, v));
        add(width - 1, -block.rhs[i]);
        for c in (0..width).filter(|&c| size[c] > 0.0) {
            worst = worst.max(sum[c].abs() / size[c]);
            result[c * r + position] = sum[c];
        }
    }
    (result, worst)
}

/// The slaves' columns of the kept rows.
fn slave_columns(block: &Block, kept: &[usize], tableau: &Tableau) -> Csr {
    let all = block.select(kept).transposed();
    let mut columns = Csr::empty(kept.len());
    tableau.basic.iter().for_each(|&j| columns.append(all.row(j as usize)));
    columns
}
