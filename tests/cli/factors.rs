//! Evaluates the files of a reduction as another program would: by sparse triangular solves.

use std::fs;
use std::path::Path;

use qless_io::matrix_market::Triplets;

use super::case::{Case, add_product, indices, matrix, numbers};
use super::harness::Place;

/// The files that `reduce` wrote; indices from 0.
pub struct Whole {
    pub t: Triplets,
    pub g_matrix: Triplets,
    pub g: Vec<f64>,
    pub slaves: Vec<usize>,
    pub masters: Vec<usize>,
    pub prescribed: Vec<usize>,
    pub blocks: Vec<Factors>,
}

impl Whole {
    pub fn read(place: &Place, folder: &str) -> Self {
        let path = |name: &str| place.path(folder).join(name);
        let matrix = |name: &str| matrix(&path(name));
        let numbered = (1..).map(|k| place.path(folder).join(format!("block{k}_")));
        Self {
            t: matrix("T.mtx"),
            g_matrix: matrix("G.mtx"),
            g: numbers(&path("g.txt")),
            slaves: indices(&path("slaves.txt")),
            masters: indices(&path("masters.txt")),
            prescribed: indices(&path("prescribed.txt")),
            blocks: numbered.map_while(|prefix| Factors::read(&prefix)).collect(),
        }
    }

    /// All DOFs.
    pub fn expand(&self, u_q: &[f64], u_p: &[f64]) -> Vec<f64> {
        let mut u = vec![f64::NAN; self.slaves.len() + self.masters.len() + self.prescribed.len()];
        self.masters.iter().zip(u_q).for_each(|(&j, &v)| u[j] = v);
        self.prescribed.iter().zip(u_p).for_each(|(&j, &v)| u[j] = v);
        let mut of_slaves = self.g.clone();
        add_product(&mut of_slaves, 1.0, &self.t, u_q);
        add_product(&mut of_slaves, 1.0, &self.g_matrix, u_p);
        self.slaves.iter().zip(of_slaves).for_each(|(&j, v)| u[j] = v);
        self.blocks.iter().for_each(|block| block.set_slaves(&mut u));
        u
    }

    pub fn row_is_empty(&self, i: usize) -> bool {
        self.t.entries.iter().chain(&self.g_matrix.entries).all(|&(row, ..)| row != i)
    }
}

/// A factored component.
pub struct Factors {
    pub l: Triplets,
    pub u: Triplets,
    pub c_m: Triplets,
    pub c_p: Triplets,
    pub b: Vec<f64>,
    pub equations: Vec<usize>,
    pub slaves: Vec<usize>,
    pub masters: Vec<usize>,
    pub prescribed: Vec<usize>,
}

impl Factors {
    fn read(prefix: &Path) -> Option<Self> {
        let path = |name: &str| format!("{}{name}", prefix.display());
        let matrix = |name: &str| matrix(Path::new(&path(name)));
        let list = |name: &str| indices(Path::new(&path(name)));
        fs::exists(path("L.mtx")).expect("readable").then(|| Self {
            l: matrix("L.mtx"),
            u: matrix("U.mtx"),
            c_m: matrix("C_M.mtx"),
            c_p: matrix("C_p.mtx"),
            b: numbers(Path::new(&path("b.txt"))),
            equations: list("equations.txt"),
            slaves: list("slaves.txt"),
            masters: list("masters.txt"),
            prescribed: list("prescribed.txt"),
        })
    }

    /// `u_s = C_S^-1 (b - C_M u_q - C_p u_p)`.
    fn set_slaves(&self, u: &mut [f64]) {
        let taken = |dofs: &[usize]| dofs.iter().map(|&j| u[j]).collect::<Vec<_>>();
        let mut right = self.b.clone();
        add_product(&mut right, -1.0, &self.c_m, &taken(&self.masters));
        add_product(&mut right, -1.0, &self.c_p, &taken(&self.prescribed));
        self.slaves.iter().zip(self.solve(&right)).for_each(|(&j, v)| u[j] = v);
    }

    /// `C_S^-1 x = L^-T U^-T x`.
    pub fn solve(&self, x: &[f64]) -> Vec<f64> {
        let transposed = |a: &Triplets| by_rows(a.rows, a.entries.iter().map(|&(i, j, v)| (j, i, v)));
        triangular(
            transposed(&self.l).iter().enumerate().rev(),
            triangular(transposed(&self.u).iter().enumerate(), x.to_vec()),
        )
    }

    /// `T^T f = -C_M^T U^-1 L^-1 f`.
    pub fn transposed_times(&self, f: &[f64]) -> Vec<f64> {
        let rows = |a: &Triplets| by_rows(a.rows, a.entries.iter().copied());
        let y = triangular(rows(&self.l).iter().enumerate(), f.to_vec());
        let y = triangular(rows(&self.u).iter().enumerate().rev(), y);
        let mut sum = vec![0.0; self.masters.len()];
        self.c_m.entries.iter().for_each(|&(i, j, v)| sum[j] -= v * y[i]);
        sum
    }

    pub fn t_times(&self, x: &[f64]) -> Vec<f64> {
        let mut right = vec![0.0; self.b.len()];
        add_product(&mut right, -1.0, &self.c_m, x);
        self.solve(&right)
    }

    /// C_M, C_p and b equal the user's to the last bit; `U^T L^T` is C_S.
    pub fn check_against(&self, case: &Case) {
        let count = self.equations.len();
        assert_eq!([self.l.rows, self.l.columns, self.u.rows, self.u.columns, self.slaves.len()], [count; 5]);
        assert!(self.l.entries.iter().all(|&(i, j, v)| j < i || (i == j && v == 1.0)), "L is lower triangular");
        assert!(self.u.entries.iter().all(|&(i, j, _)| i <= j), "U is upper triangular");
        let place = |list: &[usize], j: usize| list.iter().position(|&k| k == j);
        let mut given = vec![Vec::new(); case.c.rows];
        case.c.entries.iter().for_each(|&(i, j, v)| given[i].push((j, v)));
        for (matrix, dofs) in [(&self.c_m, &self.masters), (&self.c_p, &self.prescribed)] {
            assert_eq!((matrix.rows, matrix.columns), (count, dofs.len()));
            let rows = by_rows(count, matrix.entries.iter().copied());
            for (row, &i) in rows.iter().zip(&self.equations) {
                let mut expected: Vec<_> = given[i].iter().filter_map(|&(j, v)| Some((place(dofs, j)?, v))).collect();
                expected.sort_unstable_by_key(|&(j, _)| j);
                assert_eq!(*row, expected);
            }
        }
        assert!(self.equations.iter().zip(&self.b).all(|(&i, &b)| b == case.b[i]));
        let u = by_rows(count, self.u.entries.iter().map(|&(i, j, v)| (j, i, v)));
        let l = by_rows(count, self.l.entries.iter().map(|&(i, j, v)| (j, i, v)));
        for (k, &i) in self.equations.iter().enumerate() {
            let (mut sum, mut size) = (vec![0.0; count], vec![0.0; count]);
            for &(step, a) in &u[k] {
                l[step].iter().for_each(|&(s, v)| (sum[s], size[s]) = (sum[s] + a * v, size[s] + (a * v).abs()));
            }
            for &(j, v) in &given[i] {
                place(&self.slaves, j).into_iter().for_each(|s| sum[s] -= v);
            }
            // Relative to the largest term of the equation, with each DOF in its unit.
            let unit = |s: usize| case.column_unit(self.slaves[s]);
            let most = (0..count).fold(0.0, |most: f64, s| most.max(size[s] / unit(s)));
            assert!((0..count).all(|s| sum[s].abs() <= 1e-14 * most * unit(s)), "equation {i}");
        }
    }
}

fn by_rows(count: usize, entries: impl Iterator<Item = (usize, usize, f64)>) -> Vec<Vec<(usize, f64)>> {
    let mut rows = vec![Vec::new(); count];
    entries.for_each(|(i, j, v)| rows[i].push((j, v)));
    rows.iter_mut().for_each(|row| row.sort_unstable_by_key(|&(j, _)| j));
    rows
}

/// Solves by rows in an order in which each row needs only earlier unknowns.
fn triangular<'a>(rows: impl Iterator<Item = (usize, &'a Vec<(usize, f64)>)>, mut x: Vec<f64>) -> Vec<f64> {
    for (k, row) in rows {
        let mut diagonal = 0.0;
        let mut rest = x[k];
        for &(j, v) in row {
            if j == k { diagonal = v } else { rest -= v * x[j] }
        }
        x[k] = rest / diagonal;
    }
    x
}
