//! The backend `gauss` on six hundred random sparse matrices, tall, wide and rank-deficient: `W A P = [R1 R2; 0 0]`, its consequences, and
//! the rank of dense QR with column pivoting.

use qless::Csr;
use qless::backend::faer::Faer;
use qless::backend::gauss::Gauss;
use qless::backend::{Backend, BackendError, Factor};

const GAUSS: Gauss = Gauss { memory: usize::MAX };
const TOLERANCE: f64 = 1e-9;

/// A small repeatable generator (xorshift).
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(0x9E37_79B9_7F4A_7C15 ^ (seed + 1).wrapping_mul(0xD1B5_4A32_D192_ED03))
    }

    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 33) as usize % n
    }

    fn signed(&mut self) -> f64 {
        self.below(2001) as f64 / 1000.0 - 1.0
    }
}

/// A by columns.
type Columns = Vec<Vec<f64>>;

fn zero(columns: &mut Columns, random: &mut Random) {
    let j = random.below(columns.len());
    columns[j].fill(0.0);
}

fn duplicate(columns: &mut Columns, random: &mut Random) {
    let (from, to) = (random.below(columns.len()), random.below(columns.len()));
    columns[to] = columns[from].clone();
}

fn combine_columns(columns: &mut Columns, random: &mut Random) {
    let [a, b, to] = [(); 3].map(|()| random.below(columns.len()));
    columns[to] = columns[a].iter().zip(&columns[b]).map(|(a, b)| 2.0 * a - 0.3 * b).collect();
}

fn combine_rows(columns: &mut Columns, random: &mut Random) {
    let [a, b, to] = [(); 3].map(|()| random.below(columns[0].len()));
    columns.iter_mut().for_each(|column| column[to] = 0.7 * column[a] + column[b]);
}

/// Every fourth matrix is large enough for fill; up to a fifth of its rows and columns become dependent.
fn matrix(seed: u64) -> Columns {
    let mut random = Random::new(seed);
    let most = if seed.is_multiple_of(4) { 90 } else { 20 };
    let (rows, cols) = (1 + random.below(most), 1 + random.below(most));
    let filled = [15, 50, 150, 400, 1000][random.below(5)];
    let entry = |random: &mut Random| if random.below(1000) < filled { random.signed() } else { 0.0 };
    let mut columns: Columns = (0..cols).map(|_| (0..rows).map(|_| entry(&mut random)).collect()).collect();
    for _ in 0..random.below(rows.min(cols) / 5 + 3) {
        [zero, duplicate, combine_columns, combine_rows][random.below(4)](&mut columns, &mut random);
    }
    columns
}

fn sparse(columns: &Columns) -> Csr {
    let mut a = Csr::empty(columns[0].len());
    columns.iter().for_each(|column| {
        a.push_row(column.iter().copied().enumerate().filter(|&(_, v)| v != 0.0)).expect("ascending");
    });
    a
}

fn largest(x: impl IntoIterator<Item = f64>) -> f64 {
    x.into_iter().fold(0.0, |most, v| most.max(v.abs()))
}

/// `x - sum y_k a_order[k]`, largest entry.
fn left(columns: &Columns, factor: &Factor, y: &[f64], x: &[f64]) -> f64 {
    let sum = |i: usize| y.iter().zip(&factor.order).map(|(y, &j)| y * columns[j][i]).sum::<f64>();
    largest((0..x.len()).map(|i| x[i] - sum(i)))
}

fn check_shape(factor: &Factor, n: usize, name: &str) {
    let mut order = factor.order.clone();
    order.sort_unstable();
    assert!(order.into_iter().eq(0..n), "{name}: P");
    assert_eq!((factor.r.rows(), factor.r.cols()), (factor.rank, n), "{name}: shape of R");
    for i in 0..factor.rank {
        let row: Vec<_> = factor.r.row(i).collect();
        assert!(row[0].0 == i && row.is_sorted_by(|a, b| a.0 < b.0), "{name}: row {i} of R is {row:?}");
        // The pivot rule: at least half the largest entry of the row.
        assert!(2.0 * row[0].1.abs() >= largest(row.iter().map(|e| e.1)), "{name}: pivot {i} of {row:?}");
    }
}

/// B = I gives the first r rows of W: `W A P = [R1 R2]` entry by entry.
fn check_transform(a: &Csr, columns: &Columns, name: &str) {
    let m = a.cols();
    let identity: Vec<f64> = (0..m * m).map(|k| f64::from(u8::from(k / m == k % m))).collect();
    let factor = GAUSS.factor(a, &identity, TOLERANCE).expect(name);
    let r = factor.rank;
    let growth = 1.0 + largest(factor.rhs.iter().copied());
    for i in 0..r {
        let mut row: Vec<f64> = vec![0.0; factor.order.len()];
        factor.r.row(i).for_each(|(k, v)| row[k] = v);
        for (k, &j) in factor.order.iter().enumerate() {
            let product: f64 = (0..m).map(|c| factor.rhs[c * r + i] * columns[j][c]).sum();
            assert!(
                (product - row[k]).abs() <= 1e-13 * growth * m as f64,
                "{name}: ({i}, {k}) is {product}, not {}",
                row[k]
            );
        }
    }
}

fn check(seed: u64) {
    let (name, columns) = (format!("seed {seed}"), matrix(seed));
    let (a, m, n) = (sparse(&columns), columns[0].len(), columns.len());
    let mut random = Random::new(seed + 5000);
    let x: Vec<f64> = (0..n).map(|_| random.signed()).collect();
    let mut rhs = a.transpose().expect("few columns").times(&x).expect("a number for each");
    rhs.extend((0..m).map(|_| random.signed()));
    let factor = GAUSS.factor(&a, &rhs, TOLERANCE).expect(&name);
    let dense = Faer.factor(&a, &rhs, TOLERANCE).expect(&name);
    assert_eq!(factor.rank, dense.rank, "{name}, {m} x {n}: rank");
    assert!(factor.dropped <= 1e-12, "{name}: dropped {}", factor.dropped);
    check_shape(&factor, n, &name);
    for (y, k) in factor.coefficients().expect("as made").iter().zip(factor.rank..) {
        let (rest, size) = (left(&columns, &factor, y, &columns[factor.order[k]]), 1.0 + largest(y.iter().copied()));
        assert!(rest <= 1e-13 * size * m as f64, "{name}: column {k} leaves {rest:e} of {size}");
    }
    let solution = factor.solve(&factor.rhs[..factor.rank]).expect("as long as R1");
    let (rest, size) = (left(&columns, &factor, &solution, &rhs[..m]), 1.0 + largest(solution.iter().copied()));
    assert!(rest <= 1e-13 * size * m as f64, "{name}: b leaves {rest:e} of {size}");
    assert!(factor.rest[0] <= 1e-12 * n as f64, "{name}: rest {:e} of b in the range", factor.rest[0]);
    assert_eq!(factor.rest[1] > TOLERANCE, dense.rest[1] > TOLERANCE, "{name}: {:?} {:?}", factor.rest, dense.rest);
    check_transform(&a, &columns, &name);
}

#[test]
fn identities_hold_and_ranks_agree() {
    (0..600).for_each(check);
}

/// The matrices have the shapes and ranks that the test above needs.
#[test]
fn the_matrices_are_of_every_kind() {
    let kind = |seed: u64| {
        let a = sparse(&matrix(seed));
        let rank = Faer.factor(&a, &[], TOLERANCE).expect("small").rank;
        (a.cols().cmp(&a.rows()), rank < a.cols().min(a.rows()))
    };
    let mut kinds: Vec<_> = (0..600).map(kind).collect();
    kinds.sort_unstable();
    for kinds in kinds.chunk_by(|a, b| a == b).filter(|kinds| kinds[0].0.is_ne()) {
        assert!(kinds.len() >= 40, "{} of {:?}", kinds.len(), kinds[0]);
    }
}

/// Integer matrices of low rank: remainders of dependent rows are rounding, and must not become pivots at 2e-14 of the largest entry.
#[test]
fn rounding_is_no_pivot() {
    for seed in 0..300 {
        let mut random = Random::new(seed);
        let (m, n, rank) = (6 + random.below(30), 6 + random.below(30), 1 + random.below(5));
        let mut whole = |count: usize| (0..count).map(|_| random.below(15) as f64 - 7.0).collect::<Vec<_>>();
        let (u, v) = (whole(m * rank), whole(rank * n));
        let entry = |i: usize, j: usize| (0..rank).map(|k| u[i * rank + k] * v[k * n + j]).sum();
        let a = sparse(&(0..n).map(|j| (0..m).map(|i| entry(i, j)).collect()).collect());
        let found = GAUSS.factor(&a, &[], 2e-14 * largest(a.values().iter().copied())).expect("small");
        let dense = Faer.factor(&a, &[], TOLERANCE).expect("small");
        assert_eq!(found.rank, dense.rank, "seed {seed}, {m} x {n}, rank {rank}");
    }
}

/// The memory for a band of 1e5 rows and 1.5e5 columns follows its nonzeros: 150 MB would not hold one dense row in a thousand.
#[test]
fn a_long_band_stays_sparse() {
    let (m, n) = (100_000, 150_000);
    let mut random = Random::new(3);
    let mut rows = Csr::empty(n);
    (0..m).for_each(|i| {
        rows.push_row((0..8).map(|k| (3 * i / 2 + k, random.signed() + 1e-4)).filter(|&(j, _)| j < n))
            .expect("ascending");
    });
    let factor =
        Gauss { memory: 150 << 20 }.factor(&rows.transpose().expect("few columns"), &[], 1e-10).expect("it fits");
    assert_eq!(factor.rank, m);
    assert!(factor.r.nnz() < 3 * rows.nnz(), "{} entries from {}", factor.r.nnz(), rows.nnz());
}

/// The elimination stops if fill exceeds the limit; every sufficient limit gives the same bits.
#[test]
fn more_memory_than_allowed_is_refused() {
    let mut random = Random::new(11);
    let columns: Columns =
        (0..60).map(|_| (0..80).map(|_| if random.below(9) == 0 { random.signed() } else { 0.0 }).collect()).collect();
    let a = sparse(&columns);
    let whole = GAUSS.factor(&a, &[1.0; 80], 1e-10).expect("no limit");
    let (mut refused, mut memory) = (0, 256);
    loop {
        match (Gauss { memory }).factor(&a, &[1.0; 80], 1e-10) {
            Ok(factor) => break assert_eq!(factor, whole),
            Err(BackendError::OverLimit { backend: "gauss", rows: 80, cols: 60, needed, limit }) => {
                assert!(limit == memory && needed > memory, "{needed} of {limit}");
            }
            Err(other) => panic!("{other}"),
        }
        refused += 1;
        memory += 256;
    }
    // At least the bytes of A and R, and at most two and a half times as much, since what is freed no longer counts.
    let least = 16 * a.nnz() + 12 * whole.r.nnz();
    assert!(refused > 10 && (least..5 * least / 2).contains(&memory), "{memory} bytes for {least}");
}
