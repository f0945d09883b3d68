//! Computes T, G and g of a block from the QR factorization `C P = Q [R1 R2]` of its independent rows:
//! `u_s = -R1^-1 R2 u_q - R1^-1 Q^T C_p u_p + R1^-1 Q^T b` (Eq. 23-26 of the paper).

use super::rounding::{Cleaning, zero};
use crate::Csr;
use crate::factor::backend::faer::Faer;
use crate::factor::backend::{Backend, BackendError, Factor, SMALL};
use crate::factor::block::Block;
use crate::factor::block::tableau::Tableau;
use crate::factor::lu::{self, LuError, SparseLu};
use crate::factor::solver::SlaveSolver;
use crate::presolve::basis::{Kept, Solved};

/// Bound of the entries of T of a block. Column pivoting meets it in practice; otherwise slaves are exchanged.
const GROWTH: f64 = 4.0;

/// Solves the kept rows of a block for their slaves; a sparse factorization may allocate `memory` bytes.
pub(crate) fn solve(block: &Block, kept: &Kept, memory: usize) -> Result<Solved, BackendError> {
    let zero = zero(kept.nearness.sigma);
    let rows: Vec<usize> = kept.rows.iter().filter_map(|row| block.rows.binary_search(row).ok()).collect();
    let (r, n) = (rows.len(), block.matrix.cols);
    if r.saturating_mul(n) > SMALL
        && let Some(LuRelation { slaves, masters, columns, constant }) =
            relation_by_lu(block, &rows, &kept.order, memory)?
    {
        let (relation, width) = (columns.transposed(), columns.rows());
        let row = |(i, &constant)| relation.row(i).chain([(width, constant)]).collect();
        let rows_of_x: Vec<_> = constant.iter().enumerate().map(row).collect();
        let cleaning = Cleaning { block, kept: &rows, slaves: &slaves, masters: &masters, zero, is_small: false };
        return Ok(solved(block, &slaves, &masters, cleaning.run(&rows_of_x)));
    }
    let (columns, rhs) = kept_columns(block, &rows);
    let factor = Faer.factor(&columns, &rhs, 0.0)?;
    let tableau = relate(block, &rows, &factor)?;
    let rows_of_x: Vec<Vec<(usize, f64)>> =
        (0..tableau.basic.len()).map(|i| tableau.row(i).iter().copied().enumerate().collect()).collect();
    let cleaning =
        Cleaning { block, kept: &rows, slaves: &tableau.basic, masters: &tableau.free, zero, is_small: true };
    Ok(solved(block, &tableau.basic, &tableau.free, cleaning.run(&rows_of_x)))
}

/// The DOFs among which a sparse LU has to search so that it chooses the slaves of [`solve`]: all DOFs of a large block, in which `solve`
/// uses the same LU, and only these slaves in a small block.
pub(crate) fn may_be_slaves(block: &Block, kept: &Kept, memory: usize) -> Result<Vec<bool>, BackendError> {
    if kept.rows.len().saturating_mul(block.matrix.cols) > SMALL {
        return Ok(vec![true; block.dofs.len()]);
    }
    let slaves = solve(block, kept, memory)?.slaves;
    Ok(block.dofs.iter().map(|j| slaves.contains(j)).collect())
}

fn solved(block: &Block, slaves: &[u32], masters: &[u32], (relation, constant): (Csr, Vec<f64>)) -> Solved {
    let dof = |k: &u32| block.dofs[*k as usize];
    Solved {
        slaves: slaves.iter().map(dof).collect(),
        others: masters.iter().map(dof).chain(block.prescribed.iter().copied()).collect(),
        relation,
        constant,
    }
}

/// Expresses the slaves by a QR factorization, exchanges slaves to bound the entries of T, and refines the result.
fn relate(block: &Block, kept: &[usize], factor: &Factor) -> Result<Tableau, BackendError> {
    let mut tableau = relation_by_qr(block, factor);
    tableau.limit(GROWTH);
    // Among equally good slaves the earlier DOF is preferred: users tend to write the slave first.
    tableau.prefer(|candidate, holder| candidate < holder);
    refine(block, kept, &mut tableau)?;
    Ok(tableau)
}

/// The kept rows by columns, and the dense matrix `[C_p b]` of these rows, where C_p are the columns of the prescribed DOFs.
fn kept_columns(block: &Block, kept: &[usize]) -> (Csr, Vec<f64>) {
    let (r, k) = (kept.len(), block.prescribed.len());
    let mut rhs = vec![0.0; r * (k + 1)];
    for (position, &i) in kept.iter().enumerate() {
        block.fixed.row(i).for_each(|(c, v)| rhs[c * r + position] = v);
        rhs[k * r + position] = block.rhs[i];
    }
    (block.select(kept).transposed(), rhs)
}

/// Expresses the slaves by masters, prescribed DOFs and a constant.
fn relation_by_qr(block: &Block, factor: &Factor) -> Tableau {
    let (r, k) = (factor.rank, block.prescribed.len());
    let masters = factor.all_coefficients();
    let fixed: Vec<_> = (0..=k).map(|c| factor.solved(&factor.rhs[c * r..(c + 1) * r])).collect();
    let width = masters.len() + k + 1;
    let mut data = vec![0.0; r * width];
    for i in 0..r {
        let row = &mut data[i * width..(i + 1) * width];
        masters.iter().chain(&fixed[..k]).enumerate().for_each(|(j, column)| row[j] = -column[i]);
        row[width - 1] = fixed[k][i];
    }
    let position = |j: &usize| *j as u32;
    Tableau {
        basic: factor.order[..r].iter().map(position).collect(),
        free: factor.order[r..].iter().map(position).collect(),
        width,
        data,
    }
}

/// Residuals up to this, relative to the terms of the equation, need no refinement.
const GOOD: f64 = 1e-14;

/// One step of iterative refinement of the tableau; it is undone if it makes the residual larger.
fn refine(block: &Block, kept: &[usize], tableau: &mut Tableau) -> Result<(), BackendError> {
    let (rest, worst) = residual(block, kept, tableau);
    if worst <= GOOD {
        return Ok(());
    }
    let factor = Faer.factor(&slave_columns(block, kept, tableau), &rest, 0.0)?;
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
    if residual(block, kept, tableau).1 > worst {
        tableau.data = before;
    }
    Ok(())
}

/// `C_S X - [-C_M -C_p b]` by columns, and its largest entry relative to the magnitudes of the terms. X is the tableau; C_S, C_M and C_p
/// are the columns of slaves, masters and prescribed DOFs.
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

/// The columns of the slaves in the kept rows.
fn slave_columns(block: &Block, kept: &[usize], tableau: &Tableau) -> Csr {
    let all = block.select(kept).transposed();
    let mut columns = Csr::empty(kept.len());
    tableau.basic.iter().for_each(|&j| columns.append(all.row(j as usize)));
    columns
}

/// The relation of a block by sparse LU.
struct LuRelation {
    /// The slaves, as numbers of DOFs within the block.
    slaves: Vec<u32>,
    masters: Vec<u32>,
    /// Rows: one for each master, then one for each prescribed DOF. Columns: the slaves, in the order of `slaves`.
    columns: Csr,
    /// The constant of each slave.
    constant: Vec<f64>,
}

/// Solves the independent rows `kept` for their slaves; `order` is a fill-reducing order of them. None if the LU factorization does not
/// find the rows independent.
fn relation_by_lu(
    block: &Block,
    kept: &[usize],
    order: &[u32],
    memory: usize,
) -> Result<Option<LuRelation>, BackendError> {
    let rows = block.select(kept);
    let order: Vec<usize> = order.iter().map(|&k| k as usize).collect();
    let Some(lu) = independent_lu(&rows, &order, |_| true, memory)? else { return Ok(None) };
    let solver = SlaveSolver::new(&rows, lu);
    let slaves = solver.slaves().to_vec();
    let mut is_slave = vec![false; block.matrix.cols];
    slaves.iter().for_each(|&j| is_slave[j as usize] = true);
    let masters: Vec<u32> = (0..block.matrix.cols as u32).filter(|&j| !is_slave[j as usize]).collect();
    let columns = solver.solve(&right_sides(block, kept, &rows, &masters));
    let b: Vec<f64> = kept.iter().map(|&i| block.rhs[i]).collect();
    let constant = solver.solve_dense(&b);
    Ok(Some(LuRelation { slaves, masters, columns, constant }))
}

/// [`lu::factor`]; None if the rows are not independent.
pub(super) fn independent_lu(
    rows: &Csr,
    order: &[usize],
    may: impl Fn(usize) -> bool,
    memory: usize,
) -> Result<Option<SparseLu>, BackendError> {
    match lu::factor(rows, order, may, memory) {
        Ok(lu) => Ok(Some(lu)),
        Err(LuError::Dependent) => Ok(None),
        Err(error) => Err(error.of_block("sparse LU", rows, memory)),
    }
}

/// `-[C_M C_p]` by columns, where C_M are the columns of masters and C_p those of prescribed DOFs.
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
