//! T, G and g of a block from `C P = Q [R1 R2]` on its independent rows:
//! `u_s = -R1^-1 R2 u_q - R1^-1 Q^T C_p u_p + R1^-1 Q^T b` (Eq. 23-26).

use crate::Csr;
use crate::factor::backend::faer::Faer;
use crate::factor::backend::{Backend, BackendError, Factor, SMALL};
use crate::factor::block::Block;
use crate::factor::block::tableau::Tableau;
use crate::factor::lu::{self, LuError, SparseLu};
use crate::factor::solver::{NOISE, SlaveSolver};
use crate::input::scale::ldexp;
use crate::presolve::basis::{Kept, Solved};

/// A row of T is zero, and its slave fixed, if all its entries are below this many units in the last place times the condition ...
const ZERO_UNITS: f64 = 8.0;
/// ... and below this limit, for any condition.
const ZERO_LIMIT: f64 = 1e-8;

/// Bound of the entries of T. Column pivoting meets it in practice; otherwise slaves are exchanged.
const GROWTH: f64 = 4.0;

/// Solves the kept rows of a block for their slaves; a sparse factorization may allocate `memory` bytes.
pub(crate) fn solve(block: &Block, kept: &Kept, memory: usize) -> Result<Solved, BackendError> {
    let zero = (ZERO_UNITS * f64::EPSILON / kept.nearness.sigma).clamp(NOISE, ZERO_LIMIT);
    let rows: Vec<usize> = kept.rows.iter().filter_map(|row| block.rows.binary_search(row).ok()).collect();
    let (r, n) = (rows.len(), block.matrix.cols);
    if r.saturating_mul(n) > SMALL
        && let Some(LuRelation { slaves, masters, columns, constant }) =
            relation_by_lu(block, &rows, &kept.order, memory)?
    {
        let (relation, width) = (columns.transposed(), columns.rows());
        let row = |(i, &constant)| relation.row(i).chain([(width, constant)]).collect();
        let rows_of_x: Vec<_> = constant.iter().enumerate().map(row).collect();
        let cleaning = Cleaning { block, kept: &rows, slaves: &slaves, masters: &masters, zero };
        return Ok(solved(block, &slaves, &masters, cleaning.run(&rows_of_x)));
    }
    let (columns, rhs) = kept_columns(block, &rows);
    let factor = Faer.factor(&columns, &rhs, 0.0)?;
    let tableau = relate(block, &rows, &factor)?;
    let rows_of_x: Vec<Vec<(usize, f64)>> =
        (0..tableau.basic.len()).map(|i| tableau.row(i).iter().copied().enumerate().collect()).collect();
    let cleaning = Cleaning { block, kept: &rows, slaves: &tableau.basic, masters: &tableau.free, zero };
    Ok(solved(block, &tableau.basic, &tableau.free, cleaning.run(&rows_of_x)))
}

/// The DOFs that may become slaves, so that the slaves are those of [`solve`]: all DOFs if sparse LU chooses the slaves.
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

/// The relation of a factor, after refinement.
fn relate(block: &Block, kept: &[usize], factor: &Factor) -> Result<Tableau, BackendError> {
    let mut tableau = relation_by_qr(block, factor);
    tableau.limit(GROWTH);
    // Among equally good slaves the earlier DOF is preferred: users tend to write the slave first.
    tableau.prefer(|candidate, holder| candidate < holder);
    refine(block, kept, &mut tableau)?;
    Ok(tableau)
}

/// The kept rows by columns, and `[C_p b]` of them, dense.
fn kept_columns(block: &Block, kept: &[usize]) -> (Csr, Vec<f64>) {
    let (r, k) = (kept.len(), block.prescribed.len());
    let mut rhs = vec![0.0; r * (k + 1)];
    for (position, &i) in kept.iter().enumerate() {
        block.fixed.row(i).for_each(|(c, v)| rhs[c * r + position] = v);
        rhs[k * r + position] = block.rhs[i];
    }
    (block.select(kept).transposed(), rhs)
}

/// `u_s` by masters, prescribed DOFs and the constant.
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

/// Exponents of the DOFs of a block and powers of its rows in one choice of units: those of `matrix`, or balanced ones.
struct Units<'a> {
    block: &'a Block,
    is_balanced: bool,
}

impl<'a> Units<'a> {
    /// The two choices of units; only one if they are equal.
    fn all(block: &'a Block) -> impl Iterator<Item = Self> {
        let both = block.balanced.iter().any(|&unit| unit != 0);
        [false, true].into_iter().take(1 + usize::from(both)).map(move |is_balanced| Self { block, is_balanced })
    }

    fn dof(&self, j: u32) -> i32 {
        if self.is_balanced { self.block.balanced[j as usize] } else { 0 }
    }

    fn row(&self, i: usize) -> i32 {
        if self.is_balanced { self.block.balanced_row(i) } else { 0 }
    }

    /// The size of 1 in each column of the relation: of masters, and of prescribed DOFs by their largest coefficients.
    fn sizes(&self, masters: &[u32]) -> Vec<f64> {
        let mut prescribed = vec![0.0_f64; self.block.prescribed.len()];
        for i in 0..self.block.fixed.rows() {
            let power = self.row(i);
            self.block.fixed.row(i).for_each(|(c, v)| prescribed[c] = prescribed[c].max(ldexp(v.abs(), power)));
        }
        masters.iter().map(|&j| ldexp(1.0, self.dof(j))).chain(prescribed.into_iter().map(|size| 1.0 / size)).collect()
    }
}

/// Drops entries of the relation `u_s = X [u_q; u_p; 1]` that are rounding, where the equations hold without them.
///
/// Entries are small in any units, beside the others of their row; those of masters, of prescribed DOFs and constants apart. The units of a
/// row do not decide alone: a column of X is rounded only if every equation holds without its small entries, so that the sum of the terms of
/// an equation in the column stays rounding of them.
struct Cleaning<'a> {
    block: &'a Block,
    kept: &'a [usize],
    slaves: &'a [u32],
    masters: &'a [u32],
    zero: f64,
}

impl Cleaning<'_> {
    /// Rows of X by slave, each with its column numbers in ascending order; the constant is the last column.
    fn run(&self, rows: &[Vec<(usize, f64)>]) -> (Csr, Vec<f64>) {
        let width = self.masters.len() + self.block.prescribed.len();
        let mut is_large = self.large_in_rows(rows);
        let is_needed = self.columns_that_need_all(rows, &is_large);
        is_large.iter_mut().zip(rows).for_each(|(is_large, row)| {
            is_large.iter_mut().zip(row).for_each(|(is_large, (c, v))| *is_large |= is_needed[*c] && *v != 0.0);
        });
        let mut relation = Csr::empty(width);
        let mut constant = vec![0.0; rows.len()];
        for ((row, is_large), constant) in rows.iter().zip(&is_large).zip(&mut constant) {
            let kept = || row.iter().zip(is_large).filter(|(_, is_large)| **is_large).map(|(entry, _)| *entry);
            relation.append(kept().filter(|&(c, _)| c < width));
            *constant = kept().find(|&(c, _)| c == width).map_or(0.0, |(_, v)| v);
        }
        (relation, constant)
    }

    /// Entries that are more than rounding beside the others of their row, in some units.
    fn large_in_rows(&self, rows: &[Vec<(usize, f64)>]) -> Vec<Vec<bool>> {
        let (q, p) = (self.masters.len(), self.block.prescribed.len());
        let side = |c: usize| usize::from(c >= q);
        let mut is_large: Vec<Vec<bool>> = rows.iter().map(|row| vec![false; row.len()]).collect();
        for units in Units::all(self.block) {
            let sizes = units.sizes(self.masters);
            let sides = self.kept.iter().map(|&i| ldexp(self.block.rhs[i].abs(), units.row(i))).filter(|&b| b > 0.0);
            let least_side = NOISE * sides.reduce(f64::min).unwrap_or(0.0);
            for ((row, &slave), is_large) in rows.iter().zip(self.slaves).zip(&mut is_large) {
                let unit = -units.dof(slave);
                let size = |&(c, v): &(usize, f64)| ldexp(v.abs() * sizes.get(c).unwrap_or(&1.0), unit);
                let mut largest = [0.0_f64; 2];
                let entries = row.iter().filter(|(c, _)| *c < q + p);
                entries.for_each(|entry| largest[side(entry.0)] = largest[side(entry.0)].max(size(entry)));
                let least = largest.map(|largest| if largest <= self.zero { self.zero } else { NOISE * largest });
                is_large.iter_mut().zip(row).for_each(|(is_large, entry)| {
                    let least = if entry.0 < q + p { least[side(entry.0)] } else { least_side };
                    *is_large |= size(entry) > least;
                });
            }
        }
        is_large
    }

    /// The columns in which some equation does not hold without the small entries.
    fn columns_that_need_all(&self, rows: &[Vec<(usize, f64)>], is_large: &[Vec<bool>]) -> Vec<bool> {
        let (q, p) = (self.masters.len(), self.block.prescribed.len());
        let mut is_rounded = vec![false; q + p + 1];
        rows.iter().zip(is_large).for_each(|(row, is_large)| {
            row.iter().zip(is_large).for_each(|((c, v), is_large)| is_rounded[*c] |= !is_large && *v != 0.0);
        });
        let mut is_needed = vec![false; q + p + 1];
        if !is_rounded.contains(&true) {
            return is_needed;
        }
        let mut place = vec![Err(0); self.block.dofs.len()];
        self.masters.iter().zip(0..).for_each(|(&j, c)| place[j as usize] = Err(c));
        self.slaves.iter().zip(0..).for_each(|(&j, s)| place[j as usize] = Ok(s));
        let mut sums = vec![(0.0_f64, 0.0_f64); q + p + 1];
        for &i in self.kept {
            let mut add = |c: usize, term: f64| {
                if is_rounded[c] {
                    sums[c] = (sums[c].0 + term, sums[c].1 + term.abs());
                }
            };
            for (j, v) in self.block.matrix.row(i) {
                match place[j] {
                    Err(c) => add(c, v),
                    Ok(s) => {
                        let large = rows[s].iter().zip(&is_large[s]).filter(|(_, is_large)| **is_large);
                        large.for_each(|(&(c, x), _)| add(c, v * x));
                    }
                }
            }
            self.block.fixed.row(i).for_each(|(c, v)| add(q + c, v));
            add(q + p, -self.block.rhs[i]);
            for (sum, is_needed) in sums.iter_mut().zip(&mut is_needed) {
                let (sum, size) = std::mem::take(sum);
                *is_needed |= sum.abs() > NOISE * size;
            }
        }
        is_needed
    }
}

/// Residuals up to this, relative to the terms of the equation, need no refinement.
const GOOD: f64 = 1e-14;

/// One step of iterative refinement, unless it makes the residual larger.
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

/// `C_S X - B` by columns, and the largest entry relative to the magnitudes of its terms.
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

/// The relation of a block by sparse LU.
struct LuRelation {
    /// DOFs of the block.
    slaves: Vec<u32>,
    masters: Vec<u32>,
    /// A row for each master, then for each prescribed DOF; columns as `slaves`.
    columns: Csr,
    /// By slave.
    constant: Vec<f64>,
}

/// `kept` are independent rows, `order` is fill-reducing. None if the LU factorization does not find the rows independent.
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
