//! `peak(f) = max(peaks of the children one after the other, what they left + what f leaves)` and a front, in bytes.
//!
//! Sequentially a child runs beside what its elder siblings left. In parallel all children of a front may be at their
//! peaks at once, each with a buffer as large as the largest front below; one after the other they share one. Whatever
//! the values, a front leaves at most `min(rows, outer columns)` rows: what all pivots dead leave.

use super::{Forecast, Shape};
use crate::numeric::PANEL;
use crate::pattern::NONE;
use crate::symbolic::Symbolic;

const NUMBER: usize = size_of::<f64>();
pub(crate) const INDEX: usize = size_of::<u32>();
/// Book-keeping of a front beside its arrays.
const EACH: usize = 512;

/// A front with k right-hand sides, and its staircase.
pub(crate) fn front_bytes(shape: &Shape, k: usize) -> usize {
    let panel = PANEL.min(shape.rows).min(shape.cols);
    let work = panel * (shape.rows + 3 * panel + 2 * (shape.cols + k));
    NUMBER * (shape.rows * (shape.cols + k) + work) + 6 * INDEX * (shape.cols + shape.rows)
}

/// What a front keeps for its parent.
pub(crate) fn waiting_bytes(shape: &Shape, k: usize) -> usize {
    NUMBER * (shape.left_entries + shape.left_rows * k) + INDEX * (shape.left_cols + shape.left_rows)
}

/// What a front keeps to the end.
pub(crate) fn out_bytes(shape: &Shape, k: usize) -> usize {
    NUMBER * (shape.entries + (shape.rank + 1) * k) + 2 * INDEX * shape.cols + EACH
}

/// What a front keeps of Q, of so many rows, reflections and numbers of their vectors.
pub(crate) fn reflection_bytes(rows: usize, turns: usize, turned: usize) -> usize {
    NUMBER * turned + (INDEX + 2 * NUMBER) * turns + INDEX * rows
}

/// Room for the reflections of a front while it is eliminated.
pub(crate) fn kept_bytes(shape: &Shape) -> usize {
    NUMBER * shape.rows * shape.rows.min(shape.cols)
}

impl Forecast {
    /// What Q takes beside the rest: all that is kept, the largest room for it, the names of what waits.
    pub fn bytes_of_q(&self, symbolic: &Symbolic) -> usize {
        let kept: usize = self.shapes.iter().map(|shape| reflection_bytes(shape.rows, shape.turns, shape.turned)).sum();
        let room = self.shapes.iter().map(kept_bytes).max().unwrap_or(0);
        let waiting: usize = self.shapes.iter().map(|shape| INDEX * shape.left_rows).sum();
        kept + room + waiting + INDEX * symbolic.rows
    }

    pub fn bytes(&self, symbolic: &Symbolic, k: usize, worst: bool) -> usize {
        // More right-hand sides than any memory holds would lead beyond what can be counted.
        let k = k.min((usize::MAX >> 13) / (symbolic.rows + symbolic.cols + 2));
        let worst_shapes = if worst { at_worst(symbolic) } else { Vec::new() };
        let shapes = if worst { &worst_shapes } else { &self.shapes };
        let peeled = symbolic.pattern.start[symbolic.peeled];
        let entries = peeled + shapes.iter().map(|shape| shape.entries).sum::<usize>();
        let rank = symbolic.peeled + shapes.iter().map(|shape| shape.rank).sum::<usize>();
        let kept: usize = shapes.iter().map(|shape| out_bytes(shape, k)).sum();
        let result = (NUMBER + INDEX) * entries + NUMBER * (2 * rank + 1 + (rank + 2) * k + symbolic.cols);
        let places = 2 * INDEX * symbolic.cols;
        places + kept + result.max(peak(symbolic, shapes, k, false))
    }

    /// As [`Forecast::bytes`] with every column alive, for any number of threads.
    pub fn bytes_in_parallel(&self, symbolic: &Symbolic, k: usize) -> usize {
        let parallel = peak(symbolic, &self.shapes, k, true);
        self.bytes(symbolic, k, false) + parallel + INDEX * symbolic.cols * rayon::current_num_threads()
    }
}

/// The most that fronts and what waits for a parent hold together.
fn peak(symbolic: &Symbolic, shapes: &[Shape], k: usize, parallel: bool) -> usize {
    let fronts = &symbolic.fronts;
    let mut buffer: Vec<usize> = shapes.iter().map(|shape| front_bytes(shape, k)).collect();
    let largest = buffer.iter().copied().max().unwrap_or(0);
    let mut peaks = vec![0; shapes.len()];
    for f in 0..shapes.len() {
        let (mut waiting, mut one_by_one, mut together) = (0, 0, 0);
        for child in fronts.children.list(f).iter().map(|&child| child as usize) {
            one_by_one = one_by_one.max(waiting + peaks[child]);
            together += peaks[child];
            waiting += waiting_bytes(&shapes[child], k);
            buffer[f] = buffer[f].max(buffer[child]);
        }
        let own = waiting + waiting_bytes(&shapes[f], k);
        peaks[f] = if parallel { together.max(own + buffer[f]) } else { one_by_one.max(own) };
    }
    let roots = (0..shapes.len()).filter(|&f| fronts.parent[f] == NONE).map(|f| peaks[f]);
    if parallel { roots.sum() } else { largest + roots.max().unwrap_or(0) }
}

/// Shapes that hold whatever columns are dependent by their values.
pub(crate) fn at_worst(symbolic: &Symbolic) -> Vec<Shape> {
    let fronts = &symbolic.fronts;
    let mut shapes: Vec<Shape> = Vec::with_capacity(fronts.len());
    for f in 0..fronts.len() {
        let (from, end, outer) = symbolic.front_columns(f);
        let pivots = (end - from) as usize;
        let below: usize = fronts.children.list(f).iter().map(|&child| shapes[child as usize].left_rows).sum();
        let rows = symbolic.front_rows(f).len() + below;
        let (rank, left) = (rows.min(pivots), rows.min(outer.len()));
        let cols = pivots + outer.len();
        let entries = rank * cols - rank * rank.saturating_sub(1) / 2;
        let left_entries = left * outer.len() - left * left.saturating_sub(1) / 2;
        let left_cols = if left == 0 { 0 } else { outer.len() };
        let (turns, turned) = (rows.min(cols), rows * rows.min(cols));
        shapes.push(Shape { rows, cols, rank, entries, left_rows: left, left_cols, left_entries, turns, turned });
    }
    shapes
}
