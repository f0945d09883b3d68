//! The files of a reduction as another program would use them: sparse triangular solves, and C itself for the proof.

use std::fs;
use std::path::Path;

use qless_io::matrix_market::Triplets;

use super::harness::Place;

/// A number between -1 and 1.
pub fn random(seed: u64) -> f64 {
    let mixed = (seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ (mixed >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Adds `sign A x` to y.
fn add_product(y: &mut [f64], sign: f64, a: &Triplets, x: &[f64]) {
    a.entries.iter().for_each(|&(i, j, v)| y[i] += sign * v * x[j]);
}

/// A case folder.
pub struct Case {
    pub c: Triplets,
    pub b: Vec<f64>,
    /// From 0.
    pub prescribed: Vec<(usize, f64)>,
    units: bool,
}

impl Case {
    pub fn read(place: &Place, folder: &str) -> Self {
        let c = matrix(&place.path(folder).join("C.mtx"));
        Self { c, b: numbers(&place.path(folder).join("b.txt")), prescribed: Vec::new(), units: false }
    }

    /// Rotations in radians beside lengths, and equations in units of their own.
    pub fn mix_units(&mut self) {
        self.units = true;
        let of_columns: Vec<f64> = (0..self.c.columns).map(|j| self.column_unit(j)).collect();
        let row = |i: usize| [1.0, 1e4, 3e-3][i % 3];
        self.c.entries.iter_mut().for_each(|(i, j, v)| *v *= row(*i) * of_columns[*j]);
        self.b.iter_mut().enumerate().for_each(|(i, b)| *b *= row(i));
    }

    /// Coefficients of DOF j, times its value, are of one size.
    pub fn column_unit(&self, j: usize) -> f64 {
        if self.units { [1.0, 1e-5, 1.0, 7e4][(j ^ (j >> 3)) % 4] } else { 1.0 }
    }

    pub fn write(&self, place: &Place, folder: &str) {
        let from_one = |&(i, j, v): &(usize, usize, f64)| (i + 1, j + 1, v);
        let entries: Vec<_> = self.c.entries.iter().map(from_one).collect();
        let prescribed: Vec<_> = self.prescribed.iter().map(|&(j, v)| (j + 1, v)).collect();
        place.case(folder, [self.c.rows, self.c.columns], &entries, &self.b, &prescribed);
    }

    pub fn times(&self, u: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.c.rows];
        add_product(&mut sum, 1.0, &self.c, u);
        sum
    }

    /// The largest of `|C u - b|`, relative to the parts of its equation.
    pub fn residual(&self, u: &[f64]) -> f64 {
        let mut size: Vec<f64> = self.b.iter().map(|b| b.abs()).collect();
        self.c.entries.iter().for_each(|&(i, j, v)| size[i] += (v * u[j]).abs());
        let sums = self.times(u).into_iter().zip(&self.b).zip(size);
        sums.map(|((sum, b), size)| if sum == *b { 0.0 } else { (sum - b).abs() / size }).fold(0.0, f64::max)
    }

    pub fn prescribed_values(&self, dofs: &[usize]) -> Vec<f64> {
        dofs.iter().map(|j| self.prescribed.iter().find(|(k, _)| k == j).expect("prescribed").1).collect()
    }
}

/// Everything that `reduce` wrote; indices from 0.
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

/// A block in factor form.
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

    /// C_M, C_p and b are the user's to the last bit; `U^T L^T` gives C_S back.
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
            // Relative to the largest part of the equation, each DOF in its unit.
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

/// Solves by rows, in the order in which each needs only those before.
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

/// Without columns too, as G is where nothing is prescribed.
fn matrix(path: &Path) -> Triplets {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut lines = text.lines().skip(1).map(|line| line.split(' ').collect::<Vec<_>>());
    let whole = |text: &str| text.parse::<usize>().expect("a whole number");
    let sizes = lines.next().expect("sizes");
    let entries: Vec<_> = lines.map(|e| (whole(e[0]) - 1, whole(e[1]) - 1, e[2].parse().expect("a number"))).collect();
    assert_eq!(entries.len(), whole(sizes[2]), "{}", path.display());
    Triplets { rows: whole(sizes[0]), columns: whole(sizes[1]), entries }
}

fn numbers(path: &Path) -> Vec<f64> {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.lines().map(|line| line.parse().expect("a number")).collect()
}

fn indices(path: &Path) -> Vec<usize> {
    numbers(path).iter().map(|&number| number as usize - 1).collect()
}
