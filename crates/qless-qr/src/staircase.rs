//! `Q^T F = [R; echelon]`: elimination of a dense front F whose column k is zero below row `stair(k)`.
//!
//! Step k reflects rows g..stair(k), where g rows are already eliminated, so that column k vanishes below row g; then g grows by one. A
//! pivotal column is dependent if the 2-norm of its part in those rows is at most the tolerance (Heath 1982); it takes no row. Any other
//! column whose part is zero takes no row either. Large fronts apply the reflections of a panel at once by matrix products,
//! `C <- (I - V T^T V^T) C` (Schreiber, Van Loan 1989). While the reflections of a panel are applied to the columns behind the next panel,
//! another thread eliminates the next panel.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use pulp::Arch;
use rayon::prelude::*;

use crate::reflections::{Reflect, Reflections, SquaredNorm};

/// Largest number of columns in a panel of a large front.
pub(crate) const PANEL: usize = 48;
/// Pairs (number of entries, panel width), in descending order. A front with at least this number of entries has panels of this width.
/// Smaller fronts are eliminated column by column.
const WIDTHS: [(usize, usize); 3] = [(2_000_000, PANEL), (60_000, 32), (2_500, 16)];
/// Number of columns in one matrix product. It is fixed, so that the result is the same to the last bit for every number of threads.
const TOGETHER: usize = 64;
/// Smallest number of operations of a parallel task. They take a tenth of a millisecond, many times as long as waking a thread.
pub(crate) const TASK: usize = 500_000;

/// The shape of a dense front: its values are `rows` x (`cols` + right-hand sides), by columns.
pub(crate) struct DenseFront<'a> {
    pub rows: usize,
    pub cols: usize,
    pub pivots: usize,
    pub stair: &'a [u32],
    pub tolerance: f64,
}

/// Buffers of the elimination, reused from front to front.
#[derive(Default)]
pub(crate) struct ReflectionBuffers {
    /// The panel whose reflections are applied, and the next one, which is eliminated meanwhile.
    panels: [Panel; 2],
    products: Vec<f64>,
}

/// Results of the elimination of one front.
#[derive(Default)]
pub(crate) struct Echelon {
    /// First column of each row of the echelon.
    pub lead: Vec<u32>,
    /// Norm of the column parts that were treated as zero.
    pub dropped: f64,
    /// The reflections of the front, if Q is kept.
    pub kept: Option<Reflections>,
}

impl DenseFront<'_> {
    /// Eliminates all columns of `values`; the right-hand sides after them are only updated.
    pub fn eliminate(&self, arch: Arch, values: &mut [f64], work: &mut ReflectionBuffers, echelon: &mut Echelon) {
        echelon.lead.clear();
        echelon.dropped = 0.0;
        if let Some(kept) = &mut echelon.kept {
            kept.clear();
        }
        let ReflectionBuffers { panels: [panel, next], products } = work;
        let size = self.rows * self.cols;
        let width = WIDTHS.iter().find(|&&(least, _)| size >= least).map_or(self.cols, |&(_, width)| width);
        let mut end = self.cols.min(width);
        if end == self.cols {
            return self.panel(arch, 0..end, values, panel, echelon);
        }
        let (first, mut behind) = values.split_at_mut(end * self.rows);
        self.panel(arch, 0..end, first, panel, echelon);
        panel.close();
        while !behind.is_empty() {
            let columns = end..self.cols.min(end + width);
            let (near, far) = behind.split_at_mut(columns.len() * self.rows);
            let room = 2 * panel.tau.len();
            products.clear();
            products.resize(room * (near.len() + far.len()) / self.rows, 0.0);
            let (of_near, of_far) = products.split_at_mut(room * columns.len());
            let panel_now = &*panel;
            let mut eliminate_next = || {
                panel_now.apply(near, self.rows, of_near);
                self.panel(arch, columns.clone(), near, next, echelon);
                next.close();
            };
            let update = |(columns, products): (&mut [f64], &mut [f64])| panel_now.apply(columns, self.rows, products);
            let size = (TOGETHER * self.rows, (TOGETHER * room).max(1));
            if panel_now.operations(far.len() / self.rows) > 2 * TASK && rayon::current_num_threads() > 1 {
                let update_far = || far.par_chunks_mut(size.0).zip(of_far.par_chunks_mut(size.1)).for_each(update);
                rayon::join(eliminate_next, update_far);
            } else {
                eliminate_next();
                far.chunks_mut(size.0).zip(of_far.chunks_mut(size.1)).for_each(update);
            }
            std::mem::swap(panel, next);
            (end, behind) = (columns.end, far);
            if columns.is_empty() {
                break;
            }
        }
    }

    /// Eliminates the columns `columns`, with which `values` begins, and updates the columns after them.
    fn panel(&self, arch: Arch, columns: Range<usize>, values: &mut [f64], panel: &mut Panel, echelon: &mut Echelon) {
        panel.clear(echelon.lead.len(), columns.end.checked_sub(1).map_or(0, |last| self.stair[last] as usize));
        for (k, j) in columns.enumerate() {
            let (column, behind) = values[k * self.rows..].split_at_mut(self.rows);
            if self.reflector(arch, j, column, panel, echelon) {
                let row = echelon.lead.len() - 1;
                let from = panel.v.len() - panel.height + row - panel.top;
                let v = &panel.v[from..from + self.stair[j] as usize - row];
                let tau = panel.tau[panel.tau.len() - 1];
                if let Some(kept) = &mut echelon.kept {
                    kept.push(row, tau, v);
                }
                arch.dispatch(Reflect { v, tau, columns: behind, stride: self.rows, row });
            }
        }
    }

    /// Gives column j a row unless it is dependent, and appends the reflection's vector to the panel. Returns whether there is a
    /// reflection to apply.
    fn reflector(&self, arch: Arch, j: usize, column: &mut [f64], panel: &mut Panel, echelon: &mut Echelon) -> bool {
        let (g, end) = (echelon.lead.len(), self.stair[j] as usize);
        if end <= g {
            return false;
        }
        let column = &mut column[g..end];
        let norm = norm(arch, column);
        if norm == 0.0 || (j < self.pivots && norm <= self.tolerance) {
            echelon.dropped = if j < self.pivots { echelon.dropped.hypot(norm) } else { echelon.dropped };
            return false;
        }
        echelon.lead.push(j as u32);
        if column.len() == 1 {
            return false;
        }
        let alpha = column[0];
        let beta = if alpha > 0.0 { -norm } else { norm };
        let base = panel.v.len();
        panel.v.resize(base + panel.height, 0.0);
        let v = &mut panel.v[base + g - panel.top..];
        v[0] = 1.0;
        // A division is needed here: the reciprocal of the smallest numbers overflows.
        v[1..].iter_mut().zip(&column[1..]).for_each(|(v, a)| *v = a / (alpha - beta));
        column[0] = beta;
        panel.tau.push((beta - alpha) / beta);
        true
    }
}

/// The 2-norm; scaled if squares would overflow or underflow.
fn norm(arch: Arch, x: &[f64]) -> f64 {
    let square = arch.dispatch(SquaredNorm(x));
    if square > 1e-280 && square < 1e280 {
        return square.sqrt();
    }
    scaled_norm(x)
}

/// The 2-norm without overflow or underflow of the squares.
pub(crate) fn scaled_norm(x: &[f64]) -> f64 {
    let largest = x.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
    if largest == 0.0 { 0.0 } else { largest * x.iter().map(|v| (v / largest).powi(2)).sum::<f64>().sqrt() }
}

/// The reflections of a panel, `I - V T V^T` with V (h x w by columns) on rows `top..top + height`.
#[derive(Default)]
struct Panel {
    v: Vec<f64>,
    tau: Vec<f64>,
    t: Vec<f64>,
    top: usize,
    height: usize,
}

impl Panel {
    fn clear(&mut self, top: usize, end: usize) {
        (self.top, self.height) = (top, end.saturating_sub(top));
        self.v.clear();
        self.tau.clear();
    }

    /// Computes the upper triangular T of the panel's reflections `I - V T V^T`: `T_jj = tau_j`, `T_:j = -tau_j T V^T v_j` above the
    /// diagonal.
    fn close(&mut self) {
        let w = self.tau.len();
        self.t.clear();
        self.t.resize(2 * w * w, 0.0);
        let (t, gram) = self.t.split_at_mut(w * w);
        let v = MatRef::from_column_major_slice(&self.v, self.height, w);
        let product = MatMut::from_column_major_slice_mut(gram, w, w);
        matmul(product, Accum::Replace, v.transpose(), v, 1.0, Par::Seq);
        for j in 0..w {
            let (before, column) = t.split_at_mut(j * w);
            for p in 0..j {
                let factor = -self.tau[j] * gram[j * w + p];
                column[..=p].iter_mut().zip(&before[p * w..]).for_each(|(t, b)| *t += factor * b);
            }
            column[j] = self.tau[j];
        }
    }

    /// Number of operations to apply the reflections of the panel to this many columns.
    fn operations(&self, columns: usize) -> usize {
        4 * self.height * self.tau.len() * columns
    }

    /// Applies the transposed reflections to columns of length `stride`; `products` has room for two numbers for each reflection and
    /// column.
    fn apply(&self, columns: &mut [f64], stride: usize, products: &mut [f64]) {
        let (width, count) = (self.tau.len(), columns.len() / stride);
        if width * count == 0 {
            return;
        }
        let (first, second) = products.split_at_mut(width * count);
        let v = MatRef::from_column_major_slice(&self.v, self.height, width);
        let t = MatRef::from_column_major_slice(&self.t[..width * width], width, width);
        let all = MatMut::from_column_major_slice_mut(columns, stride, count);
        let mut c = all.subrows_mut(self.top, self.height);
        let mut first = MatMut::from_column_major_slice_mut(first, width, count);
        let mut second = MatMut::from_column_major_slice_mut(second, width, count);
        matmul(first.as_mut(), Accum::Replace, v.transpose(), c.as_ref(), 1.0, Par::Seq);
        matmul(second.as_mut(), Accum::Replace, t.transpose(), first.as_ref(), 1.0, Par::Seq);
        matmul(c.as_mut(), Accum::Add, v, second.as_ref(), -1.0, Par::Seq);
    }
}
