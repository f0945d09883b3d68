//! What each front will be: rows, columns, rank, work, if every column that the pattern lets live does live.
//!
//! The numeric phase is run on leading columns alone: column k of a front has the rows that begin at or before it,
//! `stair(k)`, and takes one of them off if any is left (`stair(k) > g`): 4 (stair(k) - g) (c - k) operations.

mod bytes;

use super::fronts::Fronts;
use crate::pattern::NONE;
use crate::symbolic::Symbolic;

pub(crate) use bytes::{INDEX, front_bytes, kept_bytes, out_bytes, reflection_bytes, waiting_bytes};

/// Sizes of one front.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Shape {
    /// Rows assembled.
    pub rows: usize,
    /// Columns, pivotal ones included.
    pub cols: usize,
    /// Rows of R.
    pub rank: usize,
    /// Entries of those rows.
    pub entries: usize,
    /// Rows left to the parent, their columns, their entries.
    pub left_rows: usize,
    pub left_cols: usize,
    pub left_entries: usize,
    /// Reflections and the numbers of their vectors.
    pub turns: usize,
    pub turned: usize,
}

/// Sizes and work of all fronts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Forecast {
    pub shapes: Vec<Shape>,
    pub flops: Vec<f64>,
    /// Of whole subtrees.
    pub work: Vec<f64>,
    /// Entries of R, peeled rows included.
    pub entries: usize,
}

impl Forecast {
    pub fn new(symbolic: &Symbolic) -> Self {
        let fronts = &symbolic.fronts;
        let mut run = Run::new(symbolic);
        (0..fronts.len()).for_each(|f| run.front(symbolic, f));
        let work = summed(fronts, &run.flops, &run.shapes);
        let peeled = symbolic.pattern.start[symbolic.peeled];
        let entries = peeled + run.shapes.iter().map(|shape| shape.entries).sum::<usize>();
        Self { shapes: run.shapes, flops: run.flops, work, entries }
    }
}

/// Work of each subtree, with an allowance for moving numbers.
fn summed(fronts: &Fronts, flops: &[f64], shapes: &[Shape]) -> Vec<f64> {
    let moved = shapes.iter().map(|shape| 500.0 + 8.0 * (shape.rows * shape.cols) as f64);
    let mut work: Vec<f64> = flops.iter().zip(moved).map(|(flops, moved)| flops + moved).collect();
    for f in 0..fronts.len() {
        if fronts.parent[f] != NONE {
            work[fronts.parent[f] as usize] += work[f];
        }
    }
    work
}

/// Columns of what a front leaves, and for each row where in them it begins.
#[derive(Default)]
struct Remainder {
    columns: Vec<u32>,
    lead: Vec<u32>,
}

struct Run {
    shapes: Vec<Shape>,
    flops: Vec<f64>,
    left: Vec<Remainder>,
    place: Vec<u32>,
    columns: Vec<u32>,
    begins: Vec<usize>,
}

impl Run {
    fn new(symbolic: &Symbolic) -> Self {
        let count = symbolic.fronts.len();
        let left = (0..count).map(|_| Remainder::default()).collect();
        Self {
            shapes: Vec::with_capacity(count),
            flops: Vec::with_capacity(count),
            left,
            place: vec![NONE; symbolic.cols],
            columns: Vec::new(),
            begins: Vec::new(),
        }
    }

    fn front(&mut self, symbolic: &Symbolic, f: usize) {
        let (from, end, outer) = symbolic.front_columns(f);
        let pivots = (end - from) as usize;
        let children = symbolic.fronts.children.list(f);
        let below: Vec<Remainder> =
            children.iter().map(|&child| std::mem::take(&mut self.left[child as usize])).collect();
        self.mark(symbolic, f, &below);
        let Self { place, columns, begins, .. } = self;
        columns.clear();
        columns.extend(from..end);
        columns.extend(outer.iter().filter(|&&column| place[column as usize] == 0));
        columns.iter().zip(0..).for_each(|(&column, k)| place[column as usize] = k);
        begins.clear();
        begins.resize(columns.len(), 0);
        for i in symbolic.front_rows(f) {
            begins[place[symbolic.pattern.list(i)[0] as usize] as usize] += 1;
        }
        for left in &below {
            left.lead.iter().for_each(|&at| begins[place[left.columns[at as usize] as usize] as usize] += 1);
        }
        columns.iter().for_each(|&column| place[column as usize] = NONE);
        let (shape, flops, left) = eliminated(begins, columns, pivots);
        self.shapes.push(shape);
        self.flops.push(flops);
        self.left[f] = left;
    }

    /// Marks the columns that some row of the front reaches.
    fn mark(&mut self, symbolic: &Symbolic, f: usize, below: &[Remainder]) {
        let rows = symbolic.front_rows(f);
        let (from, to) = (symbolic.pattern.start[rows.start], symbolic.pattern.start[rows.end]);
        symbolic.pattern.index[from..to].iter().for_each(|&column| self.place[column as usize] = 0);
        below.iter().flat_map(|left| &left.columns).for_each(|&column| self.place[column as usize] = 0);
    }
}

/// The elimination of a front whose column k has `begins[k]` rows that begin there.
fn eliminated(begins: &[usize], columns: &[u32], pivots: usize) -> (Shape, f64, Remainder) {
    let cols = columns.len();
    let (mut stair, mut g, mut flops) = (0, 0, 0.0);
    let mut shape = Shape { cols, ..Shape::default() };
    let mut lead = Vec::new();
    for k in 0..cols {
        stair += begins[k];
        if stair > g {
            if stair > g + 1 {
                flops += 4.0 * (stair - g) as f64 * (cols - k) as f64;
                shape.turns += 1;
                shape.turned += stair - g;
            }
            g += 1;
            if k < pivots {
                shape.rank += 1;
                shape.entries += cols - k;
            } else {
                lead.push(k as u32);
            }
        }
    }
    shape.rows = stair;
    let first = lead.first().map_or(cols, |&k| k as usize);
    lead.iter_mut().for_each(|k| *k -= first as u32);
    shape.left_rows = lead.len();
    shape.left_cols = if lead.is_empty() { 0 } else { cols - first };
    shape.left_entries = lead.iter().map(|&k| shape.left_cols - k as usize).sum();
    (shape, flops, Remainder { columns: columns[first..].to_vec(), lead })
}
