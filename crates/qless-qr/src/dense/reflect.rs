//! `c <- c - tau v (v^T c)` for four columns at a time, and `v^T v`, in the widest registers the processor has.

#![allow(clippy::inline_always, reason = "code for wider registers must be inlined where they are switched on")]

use pulp::{Simd, WithSimd};

/// The columns of `columns` (each `stride` long), from row `row` on over the length of v.
pub(crate) struct Reflect<'a> {
    pub v: &'a [f64],
    pub tau: f64,
    pub columns: &'a mut [f64],
    pub stride: usize,
    pub row: usize,
}

impl WithSimd for Reflect<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { v, tau, columns, stride, row } = self;
        let mut fours = columns.chunks_exact_mut(4 * stride);
        for four in &mut fours {
            let (ab, cd) = four.split_at_mut(2 * stride);
            let (a, b) = ab.split_at_mut(stride);
            let (c, d) = cd.split_at_mut(stride);
            let end = row + v.len();
            reflect_four(simd, v, tau, [&mut a[row..end], &mut b[row..end], &mut c[row..end], &mut d[row..end]]);
        }
        for column in fours.into_remainder().chunks_exact_mut(stride) {
            reflect_one(simd, v, tau, &mut column[row..row + v.len()]);
        }
    }
}

#[inline(always)]
fn reflect_one<S: Simd>(simd: S, v: &[f64], tau: f64, c: &mut [f64]) {
    let (head, tail) = S::as_simd_f64s(v);
    let (c_head, c_tail) = S::as_mut_simd_f64s(c);
    let last = simd.partial_load_f64s(tail);
    let mut c_last = simd.partial_load_f64s(c_tail);
    let mut sum = simd.mul_f64s(last, c_last);
    for (v, c) in head.iter().zip(&*c_head) {
        sum = simd.mul_add_e_f64s(*v, *c, sum);
    }
    let scale = simd.splat_f64s(-tau * simd.reduce_sum_f64s(sum));
    for (v, c) in head.iter().zip(&mut *c_head) {
        *c = simd.mul_add_e_f64s(*v, scale, *c);
    }
    c_last = simd.mul_add_e_f64s(last, scale, c_last);
    simd.partial_store_f64s(c_tail, c_last);
}

#[inline(always)]
fn reflect_four<S: Simd>(simd: S, v: &[f64], tau: f64, columns: [&mut [f64]; 4]) {
    let (head, tail) = S::as_simd_f64s(v);
    let [a, b, c, d] = columns;
    let (a, a_tail) = S::as_mut_simd_f64s(a);
    let (b, b_tail) = S::as_mut_simd_f64s(b);
    let (c, c_tail) = S::as_mut_simd_f64s(c);
    let (d, d_tail) = S::as_mut_simd_f64s(d);
    let last = simd.partial_load_f64s(tail);
    let (a_last, b_last) = (simd.partial_load_f64s(a_tail), simd.partial_load_f64s(b_tail));
    let (c_last, d_last) = (simd.partial_load_f64s(c_tail), simd.partial_load_f64s(d_tail));
    let (mut sum_a, mut sum_b) = (simd.mul_f64s(last, a_last), simd.mul_f64s(last, b_last));
    let (mut sum_c, mut sum_d) = (simd.mul_f64s(last, c_last), simd.mul_f64s(last, d_last));
    for ((((v, a), b), c), d) in head.iter().zip(&*a).zip(&*b).zip(&*c).zip(&*d) {
        sum_a = simd.mul_add_e_f64s(*v, *a, sum_a);
        sum_b = simd.mul_add_e_f64s(*v, *b, sum_b);
        sum_c = simd.mul_add_e_f64s(*v, *c, sum_c);
        sum_d = simd.mul_add_e_f64s(*v, *d, sum_d);
    }
    let scale_a = simd.splat_f64s(-tau * simd.reduce_sum_f64s(sum_a));
    let scale_b = simd.splat_f64s(-tau * simd.reduce_sum_f64s(sum_b));
    let scale_c = simd.splat_f64s(-tau * simd.reduce_sum_f64s(sum_c));
    let scale_d = simd.splat_f64s(-tau * simd.reduce_sum_f64s(sum_d));
    for ((((v, a), b), c), d) in head.iter().zip(a).zip(b).zip(c).zip(d) {
        *a = simd.mul_add_e_f64s(*v, scale_a, *a);
        *b = simd.mul_add_e_f64s(*v, scale_b, *b);
        *c = simd.mul_add_e_f64s(*v, scale_c, *c);
        *d = simd.mul_add_e_f64s(*v, scale_d, *d);
    }
    simd.partial_store_f64s(a_tail, simd.mul_add_e_f64s(last, scale_a, a_last));
    simd.partial_store_f64s(b_tail, simd.mul_add_e_f64s(last, scale_b, b_last));
    simd.partial_store_f64s(c_tail, simd.mul_add_e_f64s(last, scale_c, c_last));
    simd.partial_store_f64s(d_tail, simd.mul_add_e_f64s(last, scale_d, d_last));
}

/// `v^T v`.
pub(super) struct Square<'a>(pub &'a [f64]);

impl WithSimd for Square<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (head, tail) = S::as_simd_f64s(self.0);
        let last = simd.partial_load_f64s(tail);
        let mut sum = simd.mul_f64s(last, last);
        for v in head {
            sum = simd.mul_add_e_f64s(*v, *v, sum);
        }
        simd.reduce_sum_f64s(sum)
    }
}
