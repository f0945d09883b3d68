//! `Q^T F = [R; echelon]`: elimination of a dense front F whose column k is zero below row `stair(k)`.
//!
//! Step k reflects rows g..stair(k) so that column k vanishes below row g; then g grows by one. A pivotal column is
//! dependent if the 2-norm of its part in those rows is at most the tolerance (Heath 1982); it takes no row. Neither does
//! any other column whose part is zero. Large fronts apply the reflections of a panel at once by matrix products,
//! `C <- (I - V T^T V^T) C` (Schreiber, Van Loan 1989).

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use pulp::Arch;

use crate::reflections::{Reflect, Reflections, SquaredNorm};

/// Width of the widest panel.
pub(crate) const PANEL: usize = 48;
/// (entries of the front, width of its panels). Fronts with fewer entries are eliminated column by column.
const WIDTHS: [(usize, usize); 3] = [(2_000_000, PANEL), (60_000, 32), (2_500, 16)];

/// A dense front, `rows` x (`cols` + right-hand sides), by columns.
pub(crate) struct DenseFront<'a> {
    pub values: &'a mut [f64],
    pub rows: usize,
    pub cols: usize,
    pub pivots: usize,
    pub stair: &'a [u32],
    pub tolerance: f64,
}

/// Buffers of the elimination, reused from front to front, and its results.
#[derive(Default)]
pub(crate) struct ReflectionBuffers {
    v: Vec<f64>,
    tau: Vec<f64>,
    t: Vec<f64>,
    w: Vec<f64>,
    /// First column of each row of the echelon.
    pub lead: Vec<u32>,
    /// Norm of the column parts that were treated as zero.
    pub dropped: f64,
    /// The reflections of the front, if Q is kept.
    pub kept: Option<Reflections>,
}

impl ReflectionBuffers {
    pub fn new(keep_q: bool) -> Self {
        Self { kept: keep_q.then(Reflections::default), ..Self::default() }
    }
}

impl DenseFront<'_> {
    pub fn eliminate(&mut self, arch: Arch, work: &mut ReflectionBuffers) {
        work.lead.clear();
        work.dropped = 0.0;
        if let Some(kept) = &mut work.kept {
            kept.clear();
        }
        let size = self.rows * self.cols;
        let panel = WIDTHS.iter().find(|&&(least, _)| size >= least).map_or(self.cols, |&(_, width)| width);
        let mut k = 0;
        while k < self.cols && work.lead.len() < self.rows {
            let end = self.cols.min(k + panel);
            self.panel(arch, work, k, end);
            k = end;
        }
    }

    /// Eliminates columns k..end, then updates all columns behind them.
    fn panel(&mut self, arch: Arch, work: &mut ReflectionBuffers, k: usize, end: usize) {
        let top = work.lead.len();
        let height = (self.stair[end - 1] as usize).saturating_sub(top);
        work.v.clear();
        work.tau.clear();
        let whole = end == self.cols;
        let reach = if whole { self.values.len() } else { end * self.rows };
        for j in k..end {
            if self.reflector(arch, work, j, top, height) {
                let from = work.v.len() - height + (work.lead.len() - 1 - top);
                let v = &work.v[from..from + self.stair[j] as usize + 1 - work.lead.len()];
                let columns = &mut self.values[(j + 1) * self.rows..reach];
                let (tau, row) = (work.tau[work.tau.len() - 1], work.lead.len() - 1);
                if let Some(kept) = &mut work.kept {
                    kept.push(row, tau, v);
                }
                arch.dispatch(Reflect { v, tau, columns, stride: self.rows, row });
            }
        }
        if !whole && !work.tau.is_empty() {
            let ReflectionBuffers { v, tau, t, w, .. } = work;
            let columns = &mut self.values[end * self.rows..];
            Panel { v, tau, height }.apply(columns, self.rows, top, t, w);
        }
    }

    /// Gives column j a row unless it is dependent, and appends the reflection's vector to V. Returns whether there is a
    /// reflection to apply.
    fn reflector(&mut self, arch: Arch, work: &mut ReflectionBuffers, j: usize, top: usize, height: usize) -> bool {
        let (g, end) = (work.lead.len(), self.stair[j] as usize);
        if end <= g {
            return false;
        }
        let column = &mut self.values[j * self.rows + g..j * self.rows + end];
        let norm = norm(arch, column);
        if norm == 0.0 || (j < self.pivots && norm <= self.tolerance) {
            work.dropped = if j < self.pivots { work.dropped.hypot(norm) } else { work.dropped };
            return false;
        }
        work.lead.push(j as u32);
        if column.len() == 1 {
            return false;
        }
        let alpha = column[0];
        let beta = if alpha > 0.0 { -norm } else { norm };
        let base = work.v.len();
        work.v.resize(base + height, 0.0);
        let v = &mut work.v[base + g - top..];
        v[0] = 1.0;
        // Divide: the reciprocal overflows for the smallest numbers.
        v[1..].iter_mut().zip(&column[1..]).for_each(|(v, a)| *v = a / (alpha - beta));
        column[0] = beta;
        work.tau.push((beta - alpha) / beta);
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

/// The reflections of a panel: `V` (h x w by columns) and their factors.
pub(super) struct Panel<'a> {
    pub v: &'a [f64],
    pub tau: &'a [f64],
    pub height: usize,
}

impl Panel<'_> {
    /// T, upper triangular: `T_jj = tau_j`, `T_:j = -tau_j T V^T v_j` above.
    fn triangle(&self, t: &mut Vec<f64>) {
        let w = self.tau.len();
        t.clear();
        t.resize(2 * w * w, 0.0);
        let (t, gram) = t.split_at_mut(w * w);
        let v = MatRef::from_column_major_slice(self.v, self.height, w);
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

    /// Applies the transposed reflections to rows `row..row + height` of columns of length `stride`.
    pub fn apply(&self, columns: &mut [f64], stride: usize, row: usize, t: &mut Vec<f64>, w: &mut Vec<f64>) {
        let (width, count) = (self.tau.len(), columns.len() / stride);
        self.triangle(t);
        w.clear();
        w.resize(2 * width * count, 0.0);
        let (first, second) = w.split_at_mut(width * count);
        let v = MatRef::from_column_major_slice(self.v, self.height, width);
        let t = MatRef::from_column_major_slice(&t[..width * width], width, width);
        let all = MatMut::from_column_major_slice_mut(columns, stride, count);
        let mut c = all.subrows_mut(row, self.height);
        let mut first = MatMut::from_column_major_slice_mut(first, width, count);
        let mut second = MatMut::from_column_major_slice_mut(second, width, count);
        matmul(first.as_mut(), Accum::Replace, v.transpose(), c.as_ref(), 1.0, Par::Seq);
        matmul(second.as_mut(), Accum::Replace, t.transpose(), first.as_ref(), 1.0, Par::Seq);
        matmul(c.as_mut(), Accum::Add, v, second.as_ref(), -1.0, Par::Seq);
    }
}
