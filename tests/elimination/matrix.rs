//! Random sparse matrices in all supported storage formats.

use qless::elimination::Storage;
use qless_scenes::Rng;

use super::dense::Dense;

/// Compressed lines with indices from a base of 0 or 1.
pub struct Held {
    pub starts: Vec<i64>,
    pub index: Vec<i32>,
    pub values: Vec<f64>,
}

/// A matrix with about a third of its entries, optionally symmetric.
pub fn random(n: usize, symmetric: bool, rng: &mut Rng) -> Dense {
    let mut k = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..n {
            if i == j || rng.below(3) == 0 {
                k[i][j] = rng.real() - 0.5;
            }
        }
    }
    if symmetric {
        (0..n).for_each(|i| (0..i).for_each(|j| k[i][j] = k[j][i]));
    }
    k
}

/// The stored entries by rows or by columns; some lines are unsorted, some entries are split in two.
pub fn held(k: &Dense, by_columns: bool, storage: Storage, base: usize, rng: &mut Rng) -> Held {
    let n = k.len();
    let mut held = Held { starts: vec![base as i64], index: Vec::new(), values: Vec::new() };
    for line in 0..n {
        let mut entries = Vec::new();
        for other in 0..n {
            let (i, j) = if by_columns { (other, line) } else { (line, other) };
            let stored = match storage {
                Storage::Full => true,
                Storage::Lower => j <= i,
                Storage::Upper => j >= i,
            };
            if !stored || k[i][j] == 0.0 {
                continue;
            }
            if rng.below(20) == 0 {
                entries.push((other, 0.25 * k[i][j]));
                entries.push((other, 0.75 * k[i][j]));
            } else {
                entries.push((other, k[i][j]));
            }
        }
        if rng.below(10) == 0 {
            rng.shuffle(&mut entries);
        }
        for (other, value) in entries {
            held.index.push((other + base) as i32);
            held.values.push(value);
        }
        held.starts.push((held.index.len() + base) as i64);
    }
    held
}
