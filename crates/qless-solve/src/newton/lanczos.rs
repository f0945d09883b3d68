//! The lowest eigenpair of each diagonal block of a symmetric operator, by Lanczos' method. Blocks belong to connected parts.
//!
//! All parts are iterated together: one vector holds a Krylov vector of each part, so that one application of the operator serves all.
//! Scalar products, norms and termination are separate.

use faer::{Mat, Side};

use crate::common::random;

/// Largest number of Krylov vectors. Parts with fewer unknowns are solved exactly.
const VECTORS: usize = 60;

/// The lowest eigenvalue of each part, none for a part without unknowns, and the unit eigenvectors.
pub struct LowestEigenpairs {
    pub values: Vec<Option<f64>>,
    pub vectors: Vec<f64>,
}

/// The part of each unknown, and the number of parts. Unknowns without a part stay zero.
pub struct KrylovParts {
    pub part_of: Vec<Option<usize>>,
    pub parts: usize,
}

/// Krylov vectors, their images, and the number of vectors of each part.
struct KrylovBasis {
    basis: Vec<Vec<f64>>,
    images: Vec<Vec<f64>>,
    counts: Vec<usize>,
}

pub fn lowest<E>(apply: impl Fn(&[f64]) -> Result<Vec<f64>, E>, numbers: &KrylovParts) -> Result<LowestEigenpairs, E> {
    let krylov = KrylovBasis::new(apply, numbers)?;
    let pairs: Vec<Option<(f64, Vec<f64>)>> = krylov.projected(numbers).iter().map(lowest_of_matrix).collect();
    let mut vectors = vec![0.0; numbers.part_of.len()];
    for (k, basis) in krylov.basis.iter().enumerate() {
        numbers.each(|i, part| {
            let part = pairs[part].as_ref().and_then(|(_, vector)| vector.get(k));
            part.into_iter().for_each(|x| vectors[i] += x * basis[i]);
        });
    }
    Ok(LowestEigenpairs { values: pairs.into_iter().map(|pair| pair.map(|(value, _)| value)).collect(), vectors })
}

impl KrylovBasis {
    fn new<E>(apply: impl Fn(&[f64]) -> Result<Vec<f64>, E>, numbers: &KrylovParts) -> Result<Self, E> {
        let (mut next, sizes) = numbers.start();
        let mut all = Self { basis: Vec::new(), images: Vec::new(), counts: vec![0; numbers.parts] };
        while all.basis.len() < VECTORS {
            let before = numbers.norms(&next);
            (0..2).for_each(|_| all.basis.iter().for_each(|b| numbers.subtract(&mut next, b)));
            let norms = numbers.norms(&next);
            let (k, mut goes_on) = (all.basis.len(), vec![false; numbers.parts]);
            for part in 0..numbers.parts {
                let new = norms[part] > 1e-10 * before[part] && k < sizes[part];
                goes_on[part] = new && all.counts[part] == k;
                all.counts[part] += usize::from(goes_on[part]);
            }
            if !goes_on.contains(&true) {
                break;
            }
            numbers.each(|i, part| next[i] = if goes_on[part] { next[i] / norms[part] } else { 0.0 });
            let image = apply(&next)?;
            all.basis.push(std::mem::replace(&mut next, image.clone()));
            all.images.push(image);
        }
        Ok(all)
    }

    /// `B^T A B` of each part.
    fn projected(&self, numbers: &KrylovParts) -> Vec<Mat<f64>> {
        let mut all: Vec<Mat<f64>> = self.counts.iter().map(|&k| Mat::zeros(k, k)).collect();
        for (i, basis) in self.basis.iter().enumerate() {
            for (j, image) in self.images.iter().enumerate() {
                numbers.each(|n, part| {
                    if i.max(j) < self.counts[part] {
                        all[part][(i, j)] += basis[n] * image[n];
                    }
                });
            }
        }
        all
    }
}

fn lowest_of_matrix(matrix: &Mat<f64>) -> Option<(f64, Vec<f64>)> {
    let k = matrix.nrows();
    if k == 0 {
        return None;
    }
    let eigen = matrix.self_adjoint_eigen(Side::Lower).ok()?;
    let smallest = (0..k).min_by(|&a, &b| eigen.S()[a].total_cmp(&eigen.S()[b]))?;
    Some((eigen.S()[smallest], (0..k).map(|j| eigen.U()[(j, smallest)]).collect()))
}

impl KrylovParts {
    /// Calls `visit(index, part)` for each unknown with a part.
    pub fn each(&self, mut visit: impl FnMut(usize, usize)) {
        self.part_of.iter().enumerate().for_each(|(i, part)| part.iter().for_each(|&part| visit(i, part)));
    }

    /// The start vector, which depends on the index of an unknown within its part, and the number of unknowns of each part.
    fn start(&self) -> (Vec<f64>, Vec<usize>) {
        let (mut first, mut sizes) = (vec![0.0; self.part_of.len()], vec![0; self.parts]);
        self.each(|i, part| {
            first[i] = random(sizes[part] as u64);
            sizes[part] += 1;
        });
        (first, sizes)
    }

    fn dots(&self, a: &[f64], b: &[f64]) -> Vec<f64> {
        let mut dots = vec![0.0; self.parts];
        self.each(|i, part| dots[part] += a[i] * b[i]);
        dots
    }

    fn norms(&self, a: &[f64]) -> Vec<f64> {
        self.dots(a, a).into_iter().map(f64::sqrt).collect()
    }

    /// Subtracts from `a` its projection on the unit vector `b`.
    fn subtract(&self, a: &mut [f64], b: &[f64]) {
        let dots = self.dots(a, b);
        self.each(|i, part| a[i] -= dots[part] * b[i]);
    }
}
