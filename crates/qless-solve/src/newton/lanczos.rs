//! The lowest eigenpair of each diagonal block of a symmetric operator, by Lanczos' method. Blocks belong to connected parts.
//!
//! All parts are iterated together: one vector holds a Krylov vector of each part, so that one application of the operator serves all. Each
//! part has its own scalar products, norms and termination.

use faer::{Mat, Side};

use crate::common::random;

/// Largest number of Krylov vectors. Parts with fewer unknowns are solved exactly; in others a negative eigenvalue is found long before
/// its vector is accurate.
const VECTORS: usize = 60;

/// The part of each unknown, and the number of parts. Vectors stay zero at unknowns without a part.
pub struct KrylovParts {
    pub part_of: Vec<Option<usize>>,
    pub parts: usize,
}

/// For each part, the lowest eigenvalue (none without unknowns); and one vector that holds the unit eigenvectors of all parts.
pub fn lowest<E>(
    apply: impl Fn(&[f64]) -> Result<Vec<f64>, E>,
    numbers: &KrylovParts,
) -> Result<(Vec<Option<f64>>, Vec<f64>), E> {
    let mut sizes = vec![0; numbers.parts];
    let mut next = vec![0.0; numbers.part_of.len()];
    numbers.each(|i, part| (next[i], sizes[part]) = (random(sizes[part] as u64), sizes[part] + 1));
    let (mut basis, mut images, mut counts) = (Vec::<Vec<f64>>::new(), Vec::<Vec<f64>>::new(), vec![0; numbers.parts]);
    while basis.len() < VECTORS {
        let before = numbers.dots(&next, &next);
        (0..2).for_each(|_| basis.iter().for_each(|b| numbers.subtract(&mut next, b)));
        let after = numbers.dots(&next, &next);
        let k = basis.len();
        // If the image lies in the span of the basis vectors, only rounding is left of it after their projections are subtracted.
        let is_new = |part: usize| after[part].sqrt() > 1e3 * f64::EPSILON * before[part].sqrt();
        let open: Vec<bool> = (0..numbers.parts).map(|p| counts[p] == k && k < sizes[p] && is_new(p)).collect();
        if !open.contains(&true) {
            break;
        }
        counts.iter_mut().zip(&open).for_each(|(count, &open)| *count += usize::from(open));
        numbers.each(|i, part| next[i] = if open[part] { next[i] / after[part].sqrt() } else { 0.0 });
        images.push(apply(&next)?);
        basis.push(std::mem::replace(&mut next, images[k].clone()));
    }
    let mut projected: Vec<Mat<f64>> = counts.iter().map(|&k| Mat::zeros(k, k)).collect();
    for (i, j) in (0..basis.len()).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let dots = numbers.dots(&basis[i], &images[j]);
        (0..numbers.parts).filter(|&p| i < counts[p]).for_each(|p| projected[p][(i, j)] = dots[p]);
    }
    let pairs: Vec<Option<(f64, Vec<f64>)>> = projected.iter().map(lowest_of_matrix).collect();
    let mut vectors = vec![0.0; numbers.part_of.len()];
    for (k, basis) in basis.iter().enumerate() {
        let factor = |part: usize| pairs[part].as_ref().and_then(|(_, vector)| vector.get(k));
        numbers.each(|i, part| vectors[i] += factor(part).map_or(0.0, |x| x * basis[i]));
    }
    Ok((pairs.into_iter().map(|pair| pair.map(|(value, _)| value)).collect(), vectors))
}

fn lowest_of_matrix(matrix: &Mat<f64>) -> Option<(f64, Vec<f64>)> {
    if matrix.nrows() == 0 {
        return None;
    }
    // Eigenvalues are in ascending order, so the first one is the lowest.
    let eigen = matrix.self_adjoint_eigen(Side::Lower).ok()?;
    Some((eigen.S()[0], (0..matrix.nrows()).map(|j| eigen.U()[(j, 0)]).collect()))
}

impl KrylovParts {
    /// Calls `visit(index, part)` for each unknown with a part.
    pub fn each(&self, mut visit: impl FnMut(usize, usize)) {
        self.part_of.iter().enumerate().for_each(|(i, part)| part.iter().for_each(|&part| visit(i, part)));
    }

    fn dots(&self, a: &[f64], b: &[f64]) -> Vec<f64> {
        let mut dots = vec![0.0; self.parts];
        self.each(|i, part| dots[part] += a[i] * b[i]);
        dots
    }

    /// Subtracts from `a` its projection on the unit vector `b`.
    fn subtract(&self, a: &mut [f64], b: &[f64]) {
        let dots = self.dots(a, b);
        self.each(|i, part| a[i] -= dots[part] * b[i]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lowest eigenvalues of random symmetric blocks in any unit, whose unknowns alternate, are those of the dense blocks, and the
    /// vectors are their eigenvectors.
    #[test]
    fn lowest_eigenpairs_are_those_of_dense_blocks() {
        for seed in 0..40_usize {
            let sizes = [1 + seed, 1 + 7 * seed % 25, 2];
            let unit = 2_f64.powi([0, 60, -60][seed % 3]);
            let blocks: Vec<Mat<f64>> = sizes
                .iter()
                .enumerate()
                .map(|(part, &n)| {
                    let entry = |i: usize, j: usize| {
                        unit * random((seed * 100_000 + part * 10_000 + i.max(j) * 100 + i.min(j)) as u64)
                    };
                    Mat::from_fn(n, n, entry)
                })
                .collect();
            let mut places: Vec<(usize, usize)> =
                sizes.iter().enumerate().flat_map(|(part, &n)| (0..n).map(move |i| (i, part))).collect();
            places.sort_unstable();
            let at = |i: usize, part: usize| places.iter().position(|&place| place == (i, part)).expect("an unknown");
            let apply = |x: &[f64]| -> Result<Vec<f64>, ()> {
                let row =
                    |&(i, part): &(usize, usize)| (0..sizes[part]).map(|j| blocks[part][(i, j)] * x[at(j, part)]).sum();
                Ok(places.iter().map(row).collect())
            };
            let numbers = KrylovParts { part_of: places.iter().map(|&(_, part)| Some(part)).collect(), parts: 3 };
            let (values, vector) = lowest(apply, &numbers).expect("the operator does not fail");
            let image = apply(&vector).expect("it does not fail");
            for (part, &n) in sizes.iter().enumerate() {
                let dense = blocks[part].self_adjoint_eigenvalues(Side::Lower).expect("small")[0];
                let value = values[part].expect("the part has unknowns");
                assert!(
                    (value - dense).abs() < 1e-9 * unit * n as f64,
                    "seed {seed}, part {part}: {value}, dense {dense}"
                );
                for k in (0..n).map(|i| at(i, part)) {
                    let off = (image[k] - value * vector[k]).abs();
                    assert!(off < 1e-5 * unit, "seed {seed}, part {part}: the vector is off by {off:e}");
                }
                let length = (0..n).map(|i| vector[at(i, part)].powi(2)).sum::<f64>().sqrt();
                assert!((length - 1.0).abs() < 1e-9, "seed {seed}, part {part}: length {length}");
            }
        }
    }
}
