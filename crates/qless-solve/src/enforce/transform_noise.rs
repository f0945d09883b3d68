//! Entries of T that are rounding, recognised by their size in an equilibrated T:
//!
//! ```text
//! R T S, the largest number of each row and column being 1 (Ruiz 2001)        real: above 2^-40
//! ```
//!
//! A factorization leaves entries of relative size `eps` where T has zeros. A master that only such entries connect to K has no stiffness.
//! R and S are needed because the entries of a row may have different units. Cost: one pass over T, and a dozen if some entries are small.

use qless::Csr;

use super::equations::WRONG;

/// Equilibrated entries up to this size are rounding: far above what `eps` becomes in thousands of steps, far below what a user means.
const NOISE: f64 = 1.0 / (1_u64 << 40) as f64;
/// Passes of equilibration: each takes square roots, so that a dozen brings any ratio of doubles (2^2048) to below two.
const SWEEPS: usize = 12;

/// Row and column scales of T; none if no entry is small in its row.
#[derive(Debug)]
pub struct TransformNoise(Option<(Vec<f64>, Vec<f64>)>);

impl TransformNoise {
    pub fn new(t: &Csr) -> Self {
        let is_small = |i: usize| {
            let sizes = t.row(i).map(|(_, v)| v.abs()).filter(|v| *v > 0.0);
            let (least, most) = sizes.fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
            least < NOISE * most
        };
        Self((0..t.rows()).any(is_small).then(|| equilibrated(t)))
    }

    /// Size of the terms of an entry: its own, or that of the number whose rounding it is.
    pub fn size(&self, row: usize, col: usize, value: f64) -> f64 {
        let Some((of_row, of_col)) = &self.0 else { return value.abs() };
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
        for (scales, most) in [(&mut of_row, rows), (&mut of_col, cols)] {
            let pairs = scales.iter_mut().zip(most).filter(|(_, most)| *most > 0.0);
            pairs.for_each(|(scale, most)| *scale /= most.sqrt());
        }
    }
    (of_row, of_col)
}
