//! `u_s = C_S^-1 (b - C_M u_q - C_p u_p)` for blocks too large for a dense array, with well-conditioned slaves.
//!
//! Column by column by the seminormal equations `R_S^T R_S x = C_S^T c` with a step of refinement (Bjorck 1987), so that neither Q
//! nor a dense right-hand side is needed; several columns at a time, so that R is read once for all of them. Where C is
//! sparse the cost is that of the numbers that are there. What is rounding is dropped from each column at once.
//! Slaves and masters change places later, in the reduction, where T is sparse too.

use rayon::prelude::*;

use super::Block;
use super::pick;
use super::slaves::NOISE;
use crate::Csr;
use crate::qr::{Backend, BackendError, Factor};

/// Columns solved together.
const LANES: usize = 8;
/// Units in the last place, times the condition, that a column may be off by.
const ROUNDING: f64 = 8.0;

type Lanes = [f64; LANES];

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

/// None where no well-conditioned slaves were found.
pub(super) fn relation(
    block: &Block,
    kept: &[usize],
    backend: &dyn Backend,
    tolerance: f64,
) -> Result<Option<Large>, BackendError> {
    let mut rows = Csr::empty(block.matrix.cols);
    kept.iter().for_each(|&i| rows.push_row(block.matrix.row(i)));
    let by_column = rows.transpose();
    let Some((slaves, factor)) = pick::slaves(&by_column, backend, tolerance)? else { return Ok(None) };
    let mut is_slave = vec![false; block.matrix.cols];
    slaves.iter().for_each(|&j| is_slave[j] = true);
    let masters: Vec<usize> = (0..block.matrix.cols).filter(|&j| !is_slave[j]).collect();
    let mut right = pick::columns(&by_column, masters.iter().copied());
    right.val.iter_mut().for_each(|v| *v = -*v);
    let mut fixed = Csr::empty(block.prescribed.len());
    kept.iter().for_each(|&i| fixed.push_row(block.fixed.row(i).map(|(c, v)| (c, -v))));
    let fixed = fixed.transpose();
    (0..block.prescribed.len()).for_each(|c| right.push_row(fixed.row(c)));
    let mut b = Csr::empty(kept.len());
    b.push_row(kept.iter().enumerate().map(|(position, &i)| (position, block.rhs[i])));
    let solver = Solver::new(&by_column, &slaves, &factor);
    let (columns, of_b) = (solver.solve(&right), solver.solve(&b));
    let mut constant = vec![0.0; slaves.len()];
    of_b.row(0).for_each(|(i, v)| constant[i] = v);
    let numbers = |all: Vec<usize>| all.into_iter().map(|j| j as u32).collect();
    Ok(Some(Large { slaves: numbers(slaves), masters: numbers(masters), columns, constant }))
}

/// `C_S x = c` for many sparse c.
pub(crate) struct Solver {
    /// C_S by columns, in the order of R.
    c: Csr,
    /// Place among the slaves of each column of R.
    order: Vec<usize>,
    /// R by rows and by columns.
    rows: Csr,
    by_column: Csr,
    /// What is less than this part of the largest number of a column is rounding.
    noise: f64,
}

/// Arrays of one thread; zero between columns.
struct Work {
    right: Vec<Lanes>,
    x: Vec<Lanes>,
    y: Vec<Lanes>,
}

impl Solver {
    /// `factor` is that of the columns of the slaves, of full rank.
    pub fn new(c: &Csr, slaves: &[usize], factor: &Factor) -> Self {
        let sigma = factor.smallest_singular_value().0;
        Self {
            c: pick::columns(c, factor.order.iter().map(|&k| slaves[k])),
            order: factor.order.clone(),
            by_column: factor.r.transpose(),
            rows: factor.r.clone(),
            noise: NOISE.max(ROUNDING * f64::EPSILON / sigma),
        }
    }

    /// Row k of the result is the solution for row k of `right`.
    pub fn solve(&self, right: &Csr) -> Csr {
        let chunks = right.rows().div_ceil(LANES);
        let zero = || vec![[0.0; LANES]; self.order.len()];
        let work = || Work { right: zero(), x: zero(), y: zero() };
        let solved: Vec<Vec<Vec<(usize, f64)>>> =
            (0..chunks).into_par_iter().map_init(work, |work, chunk| self.chunk(right, chunk, work)).collect();
        let mut all = Csr::empty(self.order.len());
        solved.into_iter().flatten().take(right.rows()).for_each(|column| all.push_row(column));
        all
    }

    fn chunk(&self, right: &Csr, chunk: usize, work: &mut Work) -> Vec<Vec<(usize, f64)>> {
        let columns = chunk * LANES..right.rows().min((chunk + 1) * LANES);
        for (lane, k) in columns.enumerate() {
            right.row(k).for_each(|(i, v)| work.right[i][lane] = v);
        }
        // The second time for what the first has left.
        for _ in 0..2 {
            self.normal(work);
        }
        let mut out = vec![Vec::new(); LANES];
        for (lane, out) in out.iter_mut().enumerate() {
            let largest = work.x.iter().fold(0.0, |most: f64, x| most.max(x[lane].abs()));
            let entries = work.x.iter().zip(&self.order).map(|(x, &place)| (place, x[lane]));
            out.extend(entries.filter(|&(_, v)| v.abs() > self.noise * largest));
            out.sort_unstable_by_key(|&(place, _)| place);
        }
        [&mut work.right, &mut work.x].into_iter().for_each(|part| part.fill([0.0; LANES]));
        out
    }

    /// `x <- x + R^-1 R^-T C_S^T right`, and what that leaves of the right-hand sides.
    fn normal(&self, Work { right, x, y }: &mut Work) {
        for (k, y) in y.iter_mut().enumerate() {
            *y = [0.0; LANES];
            self.c.row(k).for_each(|(i, v)| subtract(y, -v, &right[i]));
        }
        for k in 0..y.len() {
            let mut row = self.rows.row(k);
            let diagonal = row.next().map_or(1.0, |(_, v)| v);
            if let Some(value) = divide(&mut y[k], diagonal) {
                row.for_each(|(j, v)| subtract(&mut y[j], v, &value));
            }
        }
        for k in (0..y.len()).rev() {
            let (_, diagonal) = self.by_column.row(k).last().expect("R has a diagonal");
            if let Some(value) = divide(&mut y[k], diagonal) {
                let above = self.by_column.row(k).len() - 1;
                self.by_column.row(k).take(above).for_each(|(i, v)| subtract(&mut y[i], v, &value));
                subtract(&mut x[k], -1.0, &value);
                self.c.row(k).for_each(|(i, v)| subtract(&mut right[i], v, &value));
            }
        }
    }
}

/// `y <- y - factor x`.
#[inline]
fn subtract(y: &mut Lanes, factor: f64, x: &Lanes) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y -= factor * x);
}

/// `y <- y / diagonal`; none if y is zero.
#[inline]
fn divide(y: &mut Lanes, diagonal: f64) -> Option<Lanes> {
    if y.iter().all(|&v| v == 0.0) {
        return None;
    }
    y.iter_mut().for_each(|v| *v /= diagonal);
    Some(*y)
}
