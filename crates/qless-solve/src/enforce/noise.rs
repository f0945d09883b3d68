//! Entries of T that are rounding.
//!
//! ```text
//! R T S, the largest number of each row and column being 1 (Ruiz 2001)        real: above 2^-40
//! ```
//!
//! T comes out of a factorization, which leaves some `eps` of its numbers where it has zeros. A stiffness that a master feels through such entries
//! alone is none: in sizes of terms they count as what they are the rounding of. Where the numbers of a row are in other units, R and S show it.
//! Cost: a pass over T, and a dozen where entries are small.

use qless::Csr;

use super::support::WRONG;

/// What is smaller in every unit is rounding.
const NOISE: f64 = 1.0 / (1_u64 << 40) as f64;
/// Passes; each takes the root of what is missing.
const SWEEPS: usize = 12;

/// The units of rows and columns, where any entry is small in its row.
#[derive(Debug)]
pub struct Noise {
    scales: Option<(Vec<f64>, Vec<f64>)>,
}

impl Noise {
    pub fn new(t: &Csr) -> Self {
        let is_small = |i: usize| {
            let sizes = t.row(i).map(|(_, v)| v.abs()).filter(|v| *v > 0.0);
            let (least, most) = sizes.fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
            least < NOISE * most
        };
        Self { scales: (0..t.rows()).any(is_small).then(|| equilibrated(t)) }
    }

    /// The size of the terms that an entry was made of: its own, or that of which it is the rounding.
    pub fn size(&self, row: usize, col: usize, value: f64) -> f64 {
        let Some((of_row, of_col)) = &self.scales else { return value.abs() };
        let unit = 1.0 / (of_row[row] * of_col[col]);
        if value.abs() > NOISE * unit { value.abs() } else { unit.min(value.abs() / WRONG) }
    }
}

fn equilibrated(t: &Csr) -> (Vec<f64>, Vec<f64>) {
    let (mut of_row, mut of_col) = (vec![1.0; t.rows()], vec![1.0; t.cols()]);
    for _ in 0..SWEEPS {
        let (mut rows, mut cols) = (vec![0.0_f64; t.rows()], vec![0.0_f64; t.cols()]);
        for i in 0..t.rows() {
            for (j, v) in t.row(i) {
                let v = of_row[i] * v.abs() * of_col[j];
                rows[i] = rows[i].max(v);
                cols[j] = cols[j].max(v);
            }
        }
        let halve = |scales: &mut [f64], most: &[f64]| {
            scales
                .iter_mut()
                .zip(most)
                .filter(|(_, most)| **most > 0.0)
                .for_each(|(scale, most)| *scale /= most.sqrt());
        };
        halve(&mut of_row, &rows);
        halve(&mut of_col, &cols);
    }
    (of_row, of_col)
}
