//! `Q^T F = [R; echelon]` of a front whose column k is zero below row `stair(k)`, with Heath's test on pivotal columns.
//!
//! Step k reflects rows g..stair(k) so that column k vanishes below row g; then g grows by one. A pivotal column whose
//! part in those rows is at most the tolerance is dependent and takes no row, nor does another column that is zero there.

use pulp::Arch;

use super::block::Panel;
use super::reflect::{Reflect, Square};
use crate::q::Reflections;

/// The widest panel.
pub(crate) const PANEL: usize = 48;
/// Panels of so many columns for fronts of at least so many entries; smaller ones are eliminated column by column.
const WIDTHS: [(usize, usize); 3] = [(2_000_000, PANEL), (60_000, 32), (2_500, 16)];

/// A front, `rows` x (`cols` + right-hand sides) by columns.
pub(crate) struct Dense<'a> {
    pub values: &'a mut [f64],
    pub rows: usize,
    pub cols: usize,
    pub pivots: usize,
    pub stair: &'a [u32],
    pub tolerance: f64,
}

/// Memory for reflections, reused from front to front.
#[derive(Default)]
pub(crate) struct Work {
    v: Vec<f64>,
    tau: Vec<f64>,
    t: Vec<f64>,
    w: Vec<f64>,
    /// Column in which each row of the echelon begins.
    pub lead: Vec<u32>,
    /// Norm of the parts treated as zero.
    pub dropped: f64,
    /// The reflections of the front, if they are to be kept.
    pub kept: Option<Reflections>,
}

impl Work {
    pub fn new(keep_q: bool) -> Self {
        Self { kept: keep_q.then(Reflections::default), ..Self::default() }
    }
}

impl Dense<'_> {
    pub fn eliminate(&mut self, arch: Arch, work: &mut Work) {
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

    /// Eliminates columns k..end, then updates all behind them.
    fn panel(&mut self, arch: Arch, work: &mut Work, k: usize, end: usize) {
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
            let Work { v, tau, t, w, .. } = work;
            let columns = &mut self.values[end * self.rows..];
            Panel { v, tau, height }.apply(columns, self.rows, top, t, w);
        }
    }

    /// Takes a row for column j if it needs one; whether there is a reflection to apply. Its vector is appended to V.
    fn reflector(&mut self, arch: Arch, work: &mut Work, j: usize, top: usize, height: usize) -> bool {
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
        // Not by the reciprocal, which overflows for the smallest numbers.
        v[1..].iter_mut().zip(&column[1..]).for_each(|(v, a)| *v = a / (alpha - beta));
        column[0] = beta;
        work.tau.push((beta - alpha) / beta);
        true
    }
}

/// The 2-norm; scaled where squares would overflow or vanish.
fn norm(arch: Arch, x: &[f64]) -> f64 {
    let square = arch.dispatch(Square(x));
    if square > 1e-280 && square < 1e280 {
        return square.sqrt();
    }
    scaled_norm(x)
}

/// The 2-norm of any finite numbers.
pub(crate) fn scaled_norm(x: &[f64]) -> f64 {
    let largest = x.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
    if largest == 0.0 { 0.0 } else { largest * x.iter().map(|v| (v / largest).powi(2)).sum::<f64>().sqrt() }
}
