//! Forecast of the size, work and memory of each front, before any values are known.
//!
//! The forecast simulates the numeric phase with patterns instead of values, for the case that no column is dependent by its values. In a
//! front with c columns, `stair(k)` rows begin at column k or before it. If `stair(k) > g`, where g rows are already eliminated, column k
//! takes one more row and costs `4 (stair(k) - g) (c - k)` operations.
//!
//! Memory: `peak(f) = max(peaks of the children one after the other, their contributions + that of f)` plus one front.
//! Sequentially, a child runs while the contributions of its elder siblings wait, and all children share one buffer of
//! the size of the largest front below. In parallel, all children may reach their peaks at once. For any values, a front
//! leaves at most `min(rows, outer columns)` rows to its parent, namely if all its pivotal columns are dependent.

use super::Symbolic;
use super::fronts::Fronts;
use crate::lists::NONE;
use crate::staircase::{PANEL, TASK};

/// Sizes of one front.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FrontShape {
    /// Number of assembled rows.
    pub rows: usize,
    /// Number of columns, pivotal ones included.
    pub cols: usize,
    /// Number of rows of R from this front.
    pub rank: usize,
    /// Number of entries of the front's rows of R.
    pub entries: usize,
    /// Number of rows of the contribution to the parent; the next two fields are its numbers of columns and entries.
    pub passed_rows: usize,
    pub passed_cols: usize,
    pub passed_entries: usize,
    /// Number of reflections; the next field is the total length of their vectors.
    pub reflections: usize,
    pub vector_entries: usize,
}

/// Sizes and work of all fronts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Forecast {
    pub shapes: Vec<FrontShape>,
    pub flops: Vec<f64>,
    /// Work of the subtree below each front, the front included.
    pub work: Vec<f64>,
    /// Operations on the longest path from a leaf to a root, which no number of threads shortens.
    pub span: f64,
    /// Number of entries of R, including peeled rows.
    pub entries: usize,
}

impl Forecast {
    pub fn new(symbolic: &Symbolic) -> Self {
        let fronts = &symbolic.fronts;
        let mut run = FrontSimulation::new(symbolic);
        (0..fronts.len()).for_each(|f| run.front(symbolic, f));
        let work = summed(fronts, &run.flops, &run.shapes);
        let span = longest(fronts, run.serial);
        let peeled = symbolic.pattern.start[symbolic.peeled];
        let entries = peeled + run.shapes.iter().map(|shape| shape.entries).sum::<usize>();
        Self { shapes: run.shapes, flops: run.flops, work, span, entries }
    }
}

/// Work of each subtree in operations, with an allowance for memory traffic.
fn summed(fronts: &Fronts, flops: &[f64], shapes: &[FrontShape]) -> Vec<f64> {
    let moved = shapes.iter().map(|shape| 500.0 + 8.0 * (shape.rows * shape.cols) as f64);
    let mut work: Vec<f64> = flops.iter().zip(moved).map(|(flops, moved)| flops + moved).collect();
    for f in 0..fronts.len() {
        if fronts.parent[f] != NONE {
            work[fronts.parent[f] as usize] += work[f];
        }
    }
    work
}

/// The sum of the numbers of fronts along the longest path from a leaf to a root.
fn longest(fronts: &Fronts, mut serial: Vec<f64>) -> f64 {
    let mut below = vec![0.0_f64; serial.len()];
    for f in 0..fronts.len() {
        serial[f] += below[f];
        if let Some(parent) = below.get_mut(fronts.parent[f] as usize) {
            *parent = parent.max(serial[f]);
        }
    }
    serial.into_iter().fold(0.0, f64::max)
}

/// Pattern of a contribution: its columns and, for each row, the index of its first column.
#[derive(Default)]
struct ContributionPattern {
    columns: Vec<u32>,
    lead: Vec<u32>,
}

struct FrontSimulation {
    shapes: Vec<FrontShape>,
    flops: Vec<f64>,
    /// Operations of each front that must run one after the other.
    serial: Vec<f64>,
    contribution: Vec<ContributionPattern>,
    place: Vec<u32>,
    columns: Vec<u32>,
    begins: Vec<usize>,
}

impl FrontSimulation {
    fn new(symbolic: &Symbolic) -> Self {
        let count = symbolic.fronts.len();
        let contribution = (0..count).map(|_| ContributionPattern::default()).collect();
        Self {
            shapes: Vec::with_capacity(count),
            flops: Vec::with_capacity(count),
            serial: Vec::with_capacity(count),
            contribution,
            place: vec![NONE; symbolic.cols],
            columns: Vec::new(),
            begins: Vec::new(),
        }
    }

    fn front(&mut self, symbolic: &Symbolic, f: usize) {
        let (from, end, outer) = symbolic.front_columns(f);
        let pivots = (end - from) as usize;
        let children = symbolic.fronts.children.list(f);
        let below: Vec<ContributionPattern> =
            children.iter().map(|&child| std::mem::take(&mut self.contribution[child as usize])).collect();
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
        for child in &below {
            child.lead.iter().for_each(|&at| begins[place[child.columns[at as usize] as usize] as usize] += 1);
        }
        columns.iter().for_each(|&column| place[column as usize] = NONE);
        let (shape, [flops, serial], contribution) = eliminated(begins, columns, pivots);
        self.shapes.push(shape);
        self.flops.push(flops);
        self.serial.push(if flops > TASK as f64 { serial } else { flops });
        self.contribution[f] = contribution;
    }

    /// Marks the columns in which the front has entries.
    fn mark(&mut self, symbolic: &Symbolic, f: usize, below: &[ContributionPattern]) {
        let rows = symbolic.front_rows(f);
        let (from, to) = (symbolic.pattern.start[rows.start], symbolic.pattern.start[rows.end]);
        symbolic.pattern.index[from..to].iter().for_each(|&column| self.place[column as usize] = 0);
        below.iter().flat_map(|child| &child.columns).for_each(|&column| self.place[column as usize] = 0);
    }
}

/// Size, operations and contribution of a front with `begins[k]` rows that begin at column k. The second number of operations counts those
/// that must run one after the other: a reflection is applied to half of its own panel on average, and to the next panel. The columns
/// behind are updated at the same time on other threads.
fn eliminated(begins: &[usize], columns: &[u32], pivots: usize) -> (FrontShape, [f64; 2], ContributionPattern) {
    let cols = columns.len();
    let (mut stair, mut g, mut flops, mut serial) = (0, 0, 0.0, 0.0);
    let mut shape = FrontShape { cols, ..FrontShape::default() };
    let mut lead = Vec::new();
    for k in 0..cols {
        stair += begins[k];
        if stair > g {
            if stair > g + 1 {
                flops += 4.0 * (stair - g) as f64 * (cols - k) as f64;
                serial += 4.0 * (stair - g) as f64 * (cols - k).min(3 * PANEL / 2) as f64;
                shape.reflections += 1;
                shape.vector_entries += stair - g;
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
    shape.passed_rows = lead.len();
    shape.passed_cols = if lead.is_empty() { 0 } else { cols - first };
    shape.passed_entries = lead.iter().map(|&k| shape.passed_cols - k as usize).sum();
    (shape, [flops, serial], ContributionPattern { columns: columns[first..].to_vec(), lead })
}

const NUMBER: usize = size_of::<f64>();
pub(crate) const INDEX: usize = size_of::<u32>();
/// Allowance for a front's bookkeeping besides its arrays.
const EACH: usize = 512;

/// Working memory of a front with k right-hand sides.
pub(crate) fn front_bytes(shape: &FrontShape, k: usize) -> usize {
    let panel = PANEL.min(shape.rows).min(shape.cols);
    let work = panel * (2 * shape.rows + 4 * panel + 2 * (shape.cols + k));
    NUMBER * (shape.rows * (shape.cols + k) + work) + 6 * INDEX * (shape.cols + shape.rows)
}

/// Memory of the contribution to the parent.
pub(crate) fn waiting_bytes(shape: &FrontShape, k: usize) -> usize {
    NUMBER * (shape.passed_entries + shape.passed_rows * k) + INDEX * (shape.passed_cols + shape.passed_rows)
}

/// Memory of a front's rows of R, which stay until all fronts are done.
pub(crate) fn out_bytes(shape: &FrontShape, k: usize) -> usize {
    NUMBER * (shape.entries + (shape.rank + 1) * k) + 2 * INDEX * shape.cols + EACH
}

/// Memory of the stored reflections of a front.
pub(crate) fn reflection_bytes(rows: usize, reflections: usize, vector_entries: usize) -> usize {
    NUMBER * vector_entries + (INDEX + 2 * NUMBER) * reflections + INDEX * rows
}

/// Memory for the reflections of a front during its elimination.
pub(crate) fn kept_bytes(shape: &FrontShape) -> usize {
    NUMBER * shape.rows * shape.rows.min(shape.cols)
}

impl Forecast {
    /// Additional memory for Q: stored reflections, the largest working memory for them, row numbers of contributions.
    pub fn bytes_of_q(&self, symbolic: &Symbolic) -> usize {
        let kept: usize =
            self.shapes.iter().map(|shape| reflection_bytes(shape.rows, shape.reflections, shape.vector_entries)).sum();
        let room = self.shapes.iter().map(kept_bytes).max().unwrap_or(0);
        let waiting: usize = self.shapes.iter().map(|shape| INDEX * shape.passed_rows).sum();
        kept + room + waiting + INDEX * symbolic.rows
    }

    pub fn bytes(&self, symbolic: &Symbolic, k: usize, worst: bool) -> usize {
        // Bounds k so that the sums below cannot overflow; no memory holds that many right-hand sides.
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

    /// Like [`Forecast::bytes`] without dependent columns, for a run on all threads of the current pool.
    pub fn bytes_in_parallel(&self, symbolic: &Symbolic, k: usize) -> usize {
        let parallel = peak(symbolic, &self.shapes, k, true);
        self.bytes(symbolic, k, false) + parallel + INDEX * symbolic.cols * rayon::current_num_threads()
    }
}

/// Peak memory of fronts and waiting contributions.
fn peak(symbolic: &Symbolic, shapes: &[FrontShape], k: usize, parallel: bool) -> usize {
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

/// Upper bounds of all sizes, for any number of columns that are dependent by their values.
pub(crate) fn at_worst(symbolic: &Symbolic) -> Vec<FrontShape> {
    let fronts = &symbolic.fronts;
    let mut shapes: Vec<FrontShape> = Vec::with_capacity(fronts.len());
    for f in 0..fronts.len() {
        let (from, end, outer) = symbolic.front_columns(f);
        let pivots = (end - from) as usize;
        let below: usize = fronts.children.list(f).iter().map(|&child| shapes[child as usize].passed_rows).sum();
        let rows = symbolic.front_rows(f).len() + below;
        let (rank, passed_rows) = (rows.min(pivots), rows.min(outer.len()));
        let cols = pivots + outer.len();
        let entries = rank * cols - rank * rank.saturating_sub(1) / 2;
        let passed_entries = passed_rows * outer.len() - passed_rows * passed_rows.saturating_sub(1) / 2;
        let passed_cols = if passed_rows == 0 { 0 } else { outer.len() };
        let (reflections, vector_entries) = (rows.min(cols), rows * rows.min(cols));
        shapes.push(FrontShape {
            rows,
            cols,
            rank,
            entries,
            passed_rows,
            passed_cols,
            passed_entries,
            reflections,
            vector_entries,
        });
    }
    shapes
}
