//! Tests the identities that every backend must meet, on blocks of every shape and rank.

use super::{Backend, Factor};
use crate::Csr;

/// A block of known rank.
struct KnownBlock {
    name: &'static str,
    columns: Csr,
    rank: usize,
}

/// A small generator (xorshift), so that every run tests the same numbers.
pub(crate) struct Random(pub u64);

impl Random {
    pub fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 33) as usize % n
    }

    pub fn signed(&mut self) -> f64 {
        self.below(2001) as f64 / 1000.0 - 1.0
    }
}

fn sparse(rows: usize, cols: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut random = Random(seed);
    let entry = |random: &mut Random, diagonal: bool| match (diagonal, random.below(3)) {
        (true, _) => 3.0 + random.signed(),
        (false, 0) => random.signed(),
        _ => 0.0,
    };
    (0..rows).map(|i| (0..cols).map(|j| entry(&mut random, i == j)).collect()).collect()
}

/// Appends k combinations of two rows, which leave the rank as it is.
fn with_combinations(mut rows: Vec<Vec<f64>>, k: usize) -> Vec<Vec<f64>> {
    let m = rows.len();
    for i in 0..k {
        let sum = rows[i % m].iter().zip(&rows[(3 * i + 1) % m]).map(|(a, b)| 2.0 * a - b).collect();
        rows.push(sum);
    }
    rows
}

fn blocks() -> Vec<KnownBlock> {
    let block = |name, rows: &[Vec<f64>], rank| KnownBlock { name, columns: from_dense(rows), rank };
    vec![
        block("square", &sparse(8, 8, 1), 8),
        block("wide", &sparse(6, 15, 2), 6),
        block("tall", &sparse(15, 6, 3), 6),
        block("wide deficient", &with_combinations(sparse(6, 20, 4), 5), 6),
        block("tall deficient", &with_combinations(sparse(5, 7, 5), 9), 5),
        block("duplicate columns", &[vec![1.0, 1.0, 2.0, 0.0], vec![3.0, 3.0, 6.0, 0.0]], 1),
        block("large and deficient", &with_combinations(sparse(60, 90, 6), 25), 60),
        block("one entry", &[vec![0.0, 0.0, 5.0]], 1),
        block("zero column between", &[vec![1.0, 0.0, 2.0], vec![3.0, 0.0, 4.0], vec![5.0, 0.0, 1.0]], 2),
        block("zero column first", &[vec![0.0, 1.0], vec![0.0, 1.0]], 1),
        block("rank one", &[vec![1.0, 2.0, 3.0], vec![2.0, 4.0, 6.0], vec![3.0, 6.0, 9.0]], 1),
        block("singletons", &[vec![2.0, 1.0, 0.0, 1.0], vec![0.0, 3.0, 0.0, 1.0], vec![0.0, 0.0, 0.0, 5.0]], 3),
        block("singletons in one row", &[vec![1.0, 2.0, 3.0], vec![0.0; 3]], 1),
        block("empty rows", &[vec![0.0; 3], vec![1.0, 0.0, 2.0], vec![0.0; 3], vec![3.0, 0.0, 4.0]], 2),
        block("zero", &[vec![0.0; 3], vec![0.0; 3]], 0),
    ]
}

/// Row j of the result is column j of the dense rows.
pub(crate) fn from_dense(rows: &[Vec<f64>]) -> Csr {
    let mut a = Csr::empty(rows[0].len());
    for row in rows {
        a.append(row.iter().copied().enumerate().filter(|&(_, v)| v != 0.0));
    }
    a.transposed()
}

/// Checks a backend on all test blocks.
pub(crate) fn families(backend: &dyn Backend) {
    for block in blocks() {
        let (m, n) = (block.columns.cols, block.columns.rows());
        let x: Vec<f64> = (0..n).map(|j| 1.0 + j as f64).collect();
        let mut rhs = block.columns.transposed().product(&x);
        rhs.extend((0..m).map(|i| if i == 0 { 1e3 } else { 0.0 }));
        let factor = backend.factor(&block.columns, &rhs, 1e-10).expect(block.name);
        assert_eq!(factor.rank, block.rank, "{}: rank", block.name);
        check_shape(&factor, n, block.name);
        check_dependent_columns(&factor, &block.columns, block.name);
        check_solution(&factor, &block.columns, &rhs[..m], block.name);
        if backend.is_orthogonal() {
            check_products(&factor, &block.columns, &rhs, block.name);
        }
    }
}

fn check_shape(factor: &Factor, n: usize, name: &str) {
    let mut order = factor.order.clone();
    order.sort_unstable();
    assert_eq!(order, (0..n).collect::<Vec<_>>(), "{name}: order is a permutation");
    assert_eq!((factor.r.rows(), factor.r.cols), (factor.rank, n), "{name}: shape of R");
    assert_eq!((factor.rhs.len(), factor.rest.len()), (2 * factor.rank, 2), "{name}: shape of W B");
    for i in 0..factor.rank {
        let columns: Vec<_> = factor.r.row(i).map(|(j, _)| j).collect();
        assert_eq!(columns[0], i, "{name}: R is trapezoidal with a diagonal");
        assert!(columns.windows(2).all(|w| w[0] < w[1]), "{name}: columns ascend");
    }
}

/// Checks `a_k = A_1 R1^-1 R2_k` for every dependent column k. A_1 holds the independent columns.
fn check_dependent_columns(factor: &Factor, columns: &Csr, name: &str) {
    for (y, k) in factor.all_coefficients().iter().zip(factor.rank..) {
        let mut rest = column(columns, factor.order[k]);
        for (i, y) in y.iter().enumerate() {
            columns.row(factor.order[i]).for_each(|(row, v)| rest[row] -= y * v);
        }
        let size: f64 = column(columns, factor.order[k]).iter().map(|v| v.abs()).sum();
        assert!(rest.iter().all(|v| v.abs() <= 1e-13 * (1.0 + size)), "{name}: column {k} leaves {rest:?}");
    }
}

/// Checks that `A_1 R1^-1 (W b)` equals b to rounding, for b in the range of A. A_1 holds the independent columns.
fn check_solution(factor: &Factor, columns: &Csr, b: &[f64], name: &str) {
    let z = factor.solved(&factor.rhs[..factor.rank]);
    let mut rest = b.to_vec();
    for (i, z) in z.iter().enumerate() {
        columns.row(factor.order[i]).for_each(|(row, v)| rest[row] -= z * v);
    }
    let size = b.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
    assert!(rest.iter().all(|v| v.abs() <= 1e-12 * size), "{name}: residual {rest:?}");
    assert!(factor.rest[0] <= 1e-12 * size, "{name}: rest {}", factor.rest[0]);
}

/// Checks that an orthogonal W keeps products: `R^T R = (A P)^T A P`, `R^T W b = (A P)^T b`, and `|W b| = |b|`.
fn check_products(factor: &Factor, columns: &Csr, rhs: &[f64], name: &str) {
    let (m, n, rank) = (columns.cols, columns.rows(), factor.rank);
    let by_columns = factor.r.transposed();
    let mut a: Vec<_> = factor.order.iter().map(|&j| column(columns, j)).collect();
    let mut r: Vec<_> = (0..n).map(|k| column(&by_columns, k)).collect();
    a.extend(rhs.chunks(m).map(<[f64]>::to_vec));
    r.extend((0..2).map(|c| factor.rhs[c * rank..(c + 1) * rank].to_vec()));
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let size = dot(&columns.val, &columns.val).sqrt();
    for (i, j) in (0..n + 2).flat_map(|i| (0..n.min(i + 1)).map(move |j| (i, j))) {
        let allowed = (1e-13 * size + 2.0 * factor.dropped) * dot(&a[i], &a[i]).sqrt().max(size);
        assert!((dot(&r[i], &r[j]) - dot(&a[i], &a[j])).abs() <= allowed, "{name}: columns {i} and {j}");
    }
    for (k, rest) in (n..).zip(&factor.rest) {
        let (before, after) = (dot(&a[k], &a[k]), dot(&r[k], &r[k]) + rest * rest);
        assert!((before - after).abs() <= 1e-13 * before, "{name}: right-hand side {}", k - n);
    }
}

fn column(columns: &Csr, j: usize) -> Vec<f64> {
    let mut dense = vec![0.0; columns.cols];
    columns.row(j).for_each(|(i, v)| dense[i] = v);
    dense
}
