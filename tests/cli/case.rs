//! Reads and changes a case without qless, and evaluates its equations.

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
pub fn add_product(y: &mut [f64], sign: f64, a: &Triplets, x: &[f64]) {
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

    /// Changes the units: rotations in radians beside lengths, and scaled equations.
    pub fn mix_units(&mut self) {
        self.units = true;
        let of_columns: Vec<f64> = (0..self.c.columns).map(|j| self.column_unit(j)).collect();
        let row = |i: usize| [1.0, 1e4, 3e-3][i % 3];
        self.c.entries.iter_mut().for_each(|(i, j, v)| *v *= row(*i) * of_columns[*j]);
        self.b.iter_mut().enumerate().for_each(|(i, b)| *b *= row(i));
    }

    /// Scales such that coefficients times values have about the same size.
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

/// The matrix may have no columns, as G without prescribed DOFs.
pub fn matrix(path: &Path) -> Triplets {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut lines = text.lines().skip(1).map(|line| line.split(' ').collect::<Vec<_>>());
    let whole = |text: &str| text.parse::<usize>().expect("a whole number");
    let sizes = lines.next().expect("sizes");
    let entries: Vec<_> = lines.map(|e| (whole(e[0]) - 1, whole(e[1]) - 1, e[2].parse().expect("a number"))).collect();
    assert_eq!(entries.len(), whole(sizes[2]), "{}", path.display());
    Triplets { rows: whole(sizes[0]), columns: whole(sizes[1]), entries }
}

pub fn numbers(path: &Path) -> Vec<f64> {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.lines().map(|line| line.parse().expect("a number")).collect()
}

pub fn indices(path: &Path) -> Vec<usize> {
    numbers(path).iter().map(|&number| number as usize - 1).collect()
}
