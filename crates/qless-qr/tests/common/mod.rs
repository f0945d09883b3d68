//! Matrices of every shape and rank, and the identities of their factorizations.
#![allow(dead_code, clippy::return_self_not_must_use, reason = "each test file uses its part")]

pub mod dense;

use qless_qr::{Factor, Matrix as View, Options, SparseRows, Symbolic, Tolerance};

/// A small repeatable generator (xorshift).
pub struct Random(pub u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 33) as usize % n.max(1)
    }

    pub fn signed(&mut self) -> f64 {
        self.below(2001) as f64 / 1000.0 - 1.0
    }
}

pub fn absolute(tolerance: f64) -> Options {
    Options::new().tolerance(Tolerance::Absolute(tolerance))
}

/// The results of a factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    pub rank: usize,
    pub order: Vec<usize>,
    pub r: SparseRows,
    pub rhs: Vec<f64>,
    pub rest: Vec<f64>,
    pub dropped: f64,
}

pub fn found(factor: Factor) -> Found {
    let (rank, dropped) = (factor.rank(), factor.dropped());
    let parts = factor.into_parts();
    Found { rank, order: parts.order, r: parts.r, rhs: parts.rhs, rest: parts.rest, dropped }
}

/// A sparse matrix by columns.
#[derive(Clone, Debug)]
pub struct Matrix {
    pub rows: usize,
    pub cols: usize,
    pub start: Vec<usize>,
    pub index: Vec<u32>,
    pub values: Vec<f64>,
}

impl Matrix {
    pub fn from_columns(rows: usize, columns: &[Vec<(u32, f64)>]) -> Self {
        let mut start = vec![0];
        columns.iter().for_each(|column| start.push(start[start.len() - 1] + column.len()));
        let entries = columns.iter().flatten();
        let (index, values) = entries.copied().unzip();
        Self { rows, cols: columns.len(), start, index, values }
    }

    pub fn column(&self, j: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        (self.start[j]..self.start[j + 1]).map(|at| (self.index[at] as usize, self.values[at]))
    }

    pub fn dense(&self, j: usize) -> Vec<f64> {
        let mut dense = vec![0.0; self.rows];
        self.column(j).for_each(|(i, v)| dense[i] = v);
        dense
    }

    pub fn transposed(&self) -> Self {
        let mut columns = vec![Vec::new(); self.rows];
        (0..self.cols).for_each(|j| self.column(j).for_each(|(i, v)| columns[i].push((j as u32, v))));
        Self::from_columns(self.cols, &columns)
    }

    pub fn analyse(&self) -> Symbolic {
        Symbolic::analyse(self.rows, self.cols, &self.start, &self.index).expect("a pattern")
    }

    pub fn factor(&self, rhs: &[f64], tolerance: f64) -> Found {
        found(self.analyse().factor(&self.values, rhs, absolute(tolerance)).expect("a factorization"))
    }

    pub fn view(&self) -> View<'_> {
        View::by_columns(self.rows, self.cols, &self.start, &self.index, &self.values).expect("a matrix")
    }

    /// Random entries with the given density in thousandths.
    pub fn random(random: &mut Random, rows: usize, cols: usize, density: usize) -> Self {
        let mut column = |_| {
            let keep = (0..rows as u32).filter(|_| random.below(1000) < density).collect::<Vec<_>>();
            keep.into_iter().map(|i| (i, random.signed())).filter(|e| e.1 != 0.0).collect()
        };
        Self::from_columns(rows, &(0..cols).map(&mut column).collect::<Vec<_>>())
    }

    /// Replaces some columns by copies, by sums of two others, or by zeros.
    pub fn spoilt(&self, random: &mut Random, count: usize) -> Self {
        let mut columns: Vec<Vec<(u32, f64)>> =
            (0..self.cols).map(|j| self.column(j).map(|(i, v)| (i as u32, v)).collect()).collect();
        for _ in 0..if self.cols == 0 { 0 } else { count } {
            let (a, b, c) = (random.below(self.cols), random.below(self.cols), random.below(self.cols));
            columns[c] = match random.below(3) {
                0 => columns[a].clone(),
                1 => sum(&columns[a], &columns[b]),
                _ => Vec::new(),
            };
        }
        Self::from_columns(self.rows, &columns)
    }
}

/// Matrices of every kind: square, tall, wide, dense, sparse, with dependent and empty columns and rows, graded, 1 x 1, empty.
pub fn any(seed: u64) -> (Matrix, Random) {
    let mut random = Random::new(seed + 77);
    let largest = [1, 4, 12, 24][random.below(4)] + 1;
    let (rows, cols) = match random.below(3) {
        0 => (largest - 1, largest - 1),
        _ => (random.below(largest), random.below(largest)),
    };
    let density = [60, 150, 400, 1000][random.below(4)];
    let a = Matrix::random(&mut random, rows, cols, density);
    let spoils = random.below(4) * random.below(3);
    let a = a.spoilt(&mut random, spoils);
    let lost = random.below(2) * random.below(3);
    let a = a.transposed().spoilt(&mut random, lost).transposed();
    let grade = [0, 0, 1][random.below(3)];
    let scale = |i: u32| 2.0_f64.powi(-grade * (i as i32 % 12));
    let columns: Vec<Vec<(u32, f64)>> =
        (0..a.cols).map(|j| a.column(j).map(|(i, v)| (i as u32, v * scale(i as u32))).collect()).collect();
    (Matrix::from_columns(a.rows, &columns), random)
}

pub fn multiply(a: &Matrix, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; a.rows];
    (0..a.cols).for_each(|j| a.column(j).for_each(|(i, v)| y[i] += v * x[j]));
    y
}

pub fn minus(x: &[f64], y: &[f64]) -> Vec<f64> {
    x.iter().zip(y).map(|(x, y)| x - y).collect()
}

fn sum(a: &[(u32, f64)], b: &[(u32, f64)]) -> Vec<(u32, f64)> {
    let mut sum = std::collections::BTreeMap::new();
    a.iter().chain(b).for_each(|&(i, v)| *sum.entry(i).or_insert(0.0) += v);
    sum.into_iter().filter(|e| e.1 != 0.0).collect()
}

pub fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(a, b)| a * b).sum()
}

/// Every identity, to a relative accuracy.
pub fn check(a: &Matrix, factor: &Found, rhs: &[f64], name: &str) {
    check_shape(a, factor, rhs, name);
    let n = a.cols;
    let columns: Vec<Vec<f64>> = factor.order.iter().map(|&j| a.dense(j)).collect();
    let mut r = vec![vec![0.0; factor.rank]; n];
    (0..factor.rank).for_each(|i| factor.r.row(i).for_each(|(j, v)| r[j][i] = v));
    let size = columns.iter().map(|c| norm(c)).fold(1e-300, f64::max);
    for p in 0..n {
        for q in 0..=p {
            let slack = 1e-12 * size * size + factor.dropped * (2.0 * size + factor.dropped);
            let gap = dot(&columns[p], &columns[q]) - dot(&r[p], &r[q]);
            assert!(gap.abs() <= slack, "{name}: R^T R at {p}, {q} is off by {gap:e} of {size:e}^2");
        }
    }
    for c in 0..factor.rest.len() {
        let b = &rhs[c * a.rows..(c + 1) * a.rows];
        let z = &factor.rhs[c * factor.rank..(c + 1) * factor.rank];
        let gap = norm(z).hypot(factor.rest[c]) - norm(b);
        assert!(gap.abs() <= 1e-12 * norm(b), "{name}: the norm of Q^T b is off by {gap:e}");
        for p in 0..factor.rank {
            let gap = dot(&r[p], z) - dot(&columns[p], b);
            assert!(gap.abs() <= 1e-11 * size * norm(b), "{name}: A^T b at {p} is off by {gap:e}");
        }
    }
}

pub fn check_shape(a: &Matrix, factor: &Found, rhs: &[f64], name: &str) {
    let mut order = factor.order.clone();
    order.sort_unstable();
    assert_eq!(order, (0..a.cols).collect::<Vec<_>>(), "{name}: the order is a permutation");
    let count = rhs.len().checked_div(a.rows).unwrap_or(0);
    assert_eq!((factor.rhs.len(), factor.rest.len()), (factor.rank * count, count), "{name}: shape of Q^T B");
    assert_eq!(factor.r.start.len(), factor.rank + 1, "{name}: rows of R");
    for i in 0..factor.rank {
        let columns: Vec<usize> = factor.r.row(i).map(|(j, _)| j).collect();
        assert_eq!(columns[0], i, "{name}: row {i} begins on the diagonal");
        assert!(columns.windows(2).all(|w| w[0] < w[1]), "{name}: columns ascend");
    }
}

/// The rank by Gram-Schmidt with column pivoting, twice for accuracy.
pub fn rank(a: &Matrix, tolerance: f64) -> usize {
    let mut columns: Vec<Vec<f64>> = (0..a.cols).map(|j| a.dense(j)).collect();
    let mut rank = 0;
    loop {
        let best = (0..columns.len()).max_by(|&p, &q| norm(&columns[p]).total_cmp(&norm(&columns[q])));
        let Some(best) = best.filter(|&p| norm(&columns[p]) > tolerance) else { return rank };
        let mut pivot = columns.swap_remove(best);
        let size = norm(&pivot);
        pivot.iter_mut().for_each(|v| *v /= size);
        for column in &mut columns {
            for _ in 0..2 {
                let s = dot(&pivot, column);
                column.iter_mut().zip(&pivot).for_each(|(c, p)| *c -= s * p);
            }
        }
        rank += 1;
    }
}
