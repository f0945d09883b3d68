//! `C Pi = Q [R1 R2]`, `T = -R1^-1 R2` and exchanges until `max |T_ij| <= f`: strong rank-revealing QR, dense.
//!
//! Gu and Eisenstat (SIAM J. Sci. Comput. 17 (1996) 848): column pivoting first, then a column of R1 and one of R2
//! change places as long as that raises `|det R1|` by more than f. The remainder of C behind the rank is zero, so the
//! factor of an exchange is `|T_ij|`.

use qless::ConstraintSystem;

/// `max |T_ij|` after column pivoting and after the exchanges.
pub struct Dense {
    pub pivoted: f64,
    pub strong: f64,
    pub exchanges: usize,
}

/// Free columns with rows of Euclidean length 1.
fn columns(system: &ConstraintSystem) -> Vec<Vec<f64>> {
    let mut columns = vec![vec![0.0; system.equations()]; system.dofs()];
    let free = |j: usize| system.prescribed().iter().all(|&(p, _)| p != j);
    for i in 0..system.equations() {
        let row = || system.matrix().row(i).filter(|&(j, _)| free(j));
        let length = norm(&row().map(|(_, v)| v).collect::<Vec<_>>());
        row().for_each(|(j, v)| columns[j][i] = v / length);
    }
    (0..system.dofs()).filter(|&j| free(j)).map(|j| std::mem::take(&mut columns[j])).collect()
}

fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(a, b)| a * b).sum()
}

/// The largest `|T_ij|` and its position; 0 for an empty T.
fn largest(t: &[Vec<f64>]) -> (f64, usize, usize) {
    let all = t.iter().enumerate().flat_map(|(i, row)| row.iter().enumerate().map(move |(j, v)| (v.abs(), i, j)));
    all.fold((0.0, 0, 0), |a, b| if b.0 > a.0 { b } else { a })
}

/// For a system of known rank.
pub fn strong_rrqr(system: &ConstraintSystem, rank: usize, bound: f64) -> Dense {
    strong(columns(system), rank, bound)
}

fn strong(mut a: Vec<Vec<f64>>, rank: usize, bound: f64) -> Dense {
    (0..rank).for_each(|k| eliminate(&mut a, k));
    let mut t = relation(&a, rank);
    let pivoted = largest(&t).0;
    let mut exchanges = 0;
    loop {
        let (strong, i, j) = largest(&t);
        if strong <= bound || exchanges > 10_000 {
            return Dense { pivoted, strong, exchanges };
        }
        exchange(&mut t, i, j);
        exchanges += 1;
    }
}

/// Moves the longest remaining column to place k and reflects it onto the k-th axis (Householder).
fn eliminate(a: &mut [Vec<f64>], k: usize) {
    let length = |column: &Vec<f64>| norm(&column[k..]);
    let longest = (k..a.len()).max_by(|&x, &y| length(&a[x]).total_cmp(&length(&a[y]))).expect("rank is at most n");
    a.swap(k, longest);
    let mut v = a[k][k..].to_vec();
    v[0] += norm(&v).copysign(v[0]);
    let square = dot(&v, &v);
    for column in &mut a[k..] {
        let factor = 2.0 * dot(&v, &column[k..]) / square;
        column[k..].iter_mut().zip(&v).for_each(|(x, v)| *x -= factor * v);
    }
}

/// `-R1^-1 R2`, row by row from the last.
fn relation(a: &[Vec<f64>], rank: usize) -> Vec<Vec<f64>> {
    let mut t = vec![Vec::new(); rank];
    for i in (0..rank).rev() {
        let entry = |c: usize| -a[rank + c][i] - (i + 1..rank).map(|k| a[k][i] * t[k][c]).sum::<f64>();
        let row = (0..a.len() - rank).map(|c| entry(c) / a[i][i]).collect();
        t[i] = row;
    }
    t
}

/// `u_j = (u_i - sum_{l != j} T_il u_l) / T_ij` put into all other rows.
fn exchange(t: &mut [Vec<f64>], i: usize, j: usize) {
    let pivot = t[i][j];
    let new: Vec<f64> = (0..t[i].len()).map(|l| if l == j { 1.0 / pivot } else { -t[i][l] / pivot }).collect();
    for (_, row) in t.iter_mut().enumerate().filter(|&(k, _)| k != i) {
        let factor = std::mem::take(&mut row[j]);
        row.iter_mut().zip(&new).for_each(|(x, v)| *x += factor * v);
    }
    t[i] = new;
}

#[test]
fn an_exchange_and_its_reverse() {
    // u_0 = 8 v, u_1 = 4 v, u_2 = 2 v; then v = u_0 / 8.
    let mut t = vec![vec![8.0], vec![4.0], vec![2.0]];
    exchange(&mut t, 0, 0);
    assert_eq!(t, [[0.125], [0.5], [0.25]]);
    exchange(&mut t, 0, 0);
    assert_eq!(t, [[8.0], [4.0], [2.0]]);
}

/// `0.9585^i (e_i - 0.285 sum_{j > i} e_j)`, columns shorter by 1e-6 each, so that column pivoting keeps their order.
#[test]
fn exchanges_undo_what_column_pivoting_leaves_of_kahans_matrix() {
    let n = 60;
    let entry = |i: usize, j: usize| {
        0.9585_f64.powi(i as i32) * [0.0, 1.0, -0.285][1 + usize::from(j > i) - usize::from(j < i)]
    };
    let column = |j: usize| (0..n - 1).map(|i| entry(i, j) * (1.0 - 1e-6 * j as f64)).collect();
    let dense = strong((0..n).map(column).collect(), n - 1, 10.0);
    assert!(dense.pivoted > 1e5 && dense.strong <= 10.0, "{} and {}", dense.pivoted, dense.strong);
    assert!(dense.exchanges > 0);
}
