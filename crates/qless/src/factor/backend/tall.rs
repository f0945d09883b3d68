//! QR of a tall matrix and SVD of a small one, on one thread, so that bits never depend on threads.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::householder::{
    apply_block_householder_sequence_on_the_left_in_place_scratch as apply_scratch,
    apply_block_householder_sequence_on_the_left_in_place_with_conj as apply,
};
use faer::linalg::qr::no_pivoting::factor::{qr_in_place, qr_in_place_scratch, recommended_block_size};
use faer::linalg::svd::{ComputeSvdVectors, SvdParams, svd, svd_scratch};
use faer::{Conj, Mat, Par, Spec};

/// `A = Q R`, m x k with m >= k.
pub(crate) struct Tall {
    a: Mat<f64>,
    coefficients: Mat<f64>,
}

impl Tall {
    pub fn new(mut a: Mat<f64>) -> Self {
        let (m, k) = a.shape();
        let block = recommended_block_size::<f64>(m, k);
        let mut coefficients = Mat::zeros(block, k.min(m));
        let params = Spec::default();
        let mut room = MemBuffer::new(qr_in_place_scratch::<f64>(m, k, block, Par::Seq, params));
        qr_in_place(a.as_mut(), coefficients.as_mut(), Par::Seq, MemStack::new(&mut room), params);
        Self { a, coefficients }
    }

    /// The first k columns of Q.
    pub fn basis(&self) -> Mat<f64> {
        let (m, k) = self.a.shape();
        let mut q = Mat::identity(m, k);
        let mut room = MemBuffer::new(apply_scratch::<f64>(m, self.coefficients.nrows(), k));
        let stack = MemStack::new(&mut room);
        apply(self.a.as_ref(), self.coefficients.as_ref(), Conj::No, q.as_mut(), Par::Seq, stack);
        q
    }

    /// R, k x k.
    pub fn triangle(&self) -> Mat<f64> {
        let k = self.a.ncols();
        Mat::from_fn(k, k, |i, j| if i <= j { self.a[(i, j)] } else { 0.0 })
    }
}

/// Singular values, descending, and right singular vectors of a small square matrix. By the QR algorithm at every size: dividing and
/// conquering, which faer takes from 128 rows on, was seen to give a value of 2e-5 for a zero among many.
pub(crate) fn singular(a: &Mat<f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let k = a.ncols();
    let mut params = Spec::<SvdParams, f64>::default();
    params.config.recursion_threshold = usize::MAX;
    let (mut values, mut vectors) = (Diag::zeros(k), Mat::zeros(k, k));
    let (none, all) = (ComputeSvdVectors::No, ComputeSvdVectors::Full);
    let mut room = MemBuffer::new(svd_scratch::<f64>(k, k, none, all, Par::Seq, params));
    let stack = MemStack::new(&mut room);
    svd(a.as_ref(), values.as_mut(), None, Some(vectors.as_mut()), Par::Seq, stack, params).ok()?;
    Some((values.column_vector().iter().copied().collect(), vectors))
}
