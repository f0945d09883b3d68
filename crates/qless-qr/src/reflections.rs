//! `Q = H_1 H_2 ... H_F`: the Householder reflections of all fronts, and how to apply them. Q itself is never formed.
//!
//! A row of A keeps its number from the front that assembles it to the front that finishes it. Reflection t of a front is
//! `I - tau v v^T` on the front's rows from `first[t]` on. After all fronts, row k of `Q^T A P` is row `row[k]` of A: first
//! the r rows of R, then the rows for which no column is left.
//!
//! Cost: memory for all v ([`Symbolic::memory_of_q`](crate::Symbolic::memory_of_q)); four operations for each number of v and each vector
//! to which Q is applied (Davis 2011, Sec. 3.4). These vectors are handled eight at a time, in parallel. The result for one vector is the
//! same to the last bit, whichever other vectors there are. The inner loops use the widest registers of the processor.

#![allow(clippy::inline_always, reason = "code for wider registers must be inlined where they are switched on")]

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// The reflections of one front.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Reflections {
    /// For each row of the front, its row of A.
    pub rows: Vec<u32>,
    /// For each reflection, the first row of the front that it changes.
    pub first: Vec<u32>,
    /// End of each reflection's vector in `v`.
    pub end: Vec<usize>,
    pub tau: Vec<f64>,
    /// The vectors of all reflections, each with its leading 1.
    pub v: Vec<f64>,
}

impl Reflections {
    pub fn clear(&mut self) {
        self.first.clear();
        self.end.clear();
        self.tau.clear();
        self.v.clear();
    }

    pub fn push(&mut self, first: usize, tau: f64, v: &[f64]) {
        self.first.push(first as u32);
        self.tau.push(tau);
        self.v.extend_from_slice(v);
        self.end.push(self.v.len());
    }

    /// First row, factor tau and vector v of reflection t.
    fn get(&self, t: usize) -> (usize, f64, &[f64]) {
        let from = if t == 0 { 0 } else { self.end[t - 1] };
        (self.first[t] as usize, self.tau[t], &self.v[from..self.end[t]])
    }
}

/// Q as the reflections of all fronts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Q {
    /// For each row of `Q^T A P`, the row of A that becomes it: a permutation.
    pub row: Vec<u32>,
    /// Fronts with reflections, children before parents.
    pub fronts: Vec<Reflections>,
}

/// Number of vectors to which each reflection is applied together, so that it is read from memory once for all of them.
const TOGETHER: usize = 8;

impl Q {
    /// `Q^T B` in place, B m x k by columns.
    pub fn apply_transposed(&self, b: &mut [f64]) {
        self.in_groups(b, |q, group, other| {
            q.fronts.iter().for_each(|front| front.apply(group, q.row.len(), other, false));
            for column in group.chunks_exact_mut(q.row.len()) {
                other.clear();
                other.extend(q.row.iter().map(|&i| column[i as usize]));
                column.copy_from_slice(other);
            }
        });
    }

    /// `Q B` in place, B m x k by columns.
    pub fn apply(&self, b: &mut [f64]) {
        self.in_groups(b, |q, group, other| {
            for column in group.chunks_exact_mut(q.row.len()) {
                other.clear();
                other.extend_from_slice(column);
                q.row.iter().zip(&*other).for_each(|(&i, &v)| column[i as usize] = v);
            }
            q.fronts.iter().rev().for_each(|front| front.apply(group, q.row.len(), other, true));
        });
    }

    fn in_groups(&self, b: &mut [f64], work: impl Fn(&Self, &mut [f64], &mut Vec<f64>) + Sync) {
        let size = TOGETHER * self.row.len();
        if b.len() > size {
            b.par_chunks_mut(size).for_each(|group| work(self, group, &mut Vec::new()));
        } else if !b.is_empty() {
            work(self, b, &mut Vec::new());
        }
    }
}

impl Reflections {
    /// Applies the reflections to the rows of this front, in columns of length m.
    fn apply(&self, b: &mut [f64], m: usize, local: &mut Vec<f64>, backwards: bool) {
        local.clear();
        for column in b.chunks_exact(m) {
            local.extend(self.rows.iter().map(|&i| column[i as usize]));
        }
        Arch::new().dispatch(FrontReflections { front: self, columns: &mut local[..], backwards });
        for (column, reflected) in b.chunks_exact_mut(m).zip(local.chunks_exact(self.rows.len())) {
            self.rows.iter().zip(reflected).for_each(|(&i, &v)| column[i as usize] = v);
        }
    }
}

/// Applies all reflections of a front in sequence.
struct FrontReflections<'a> {
    front: &'a Reflections,
    columns: &'a mut [f64],
    backwards: bool,
}

impl WithSimd for FrontReflections<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { front, columns, backwards } = self;
        let count = front.tau.len();
        for at in 0..count {
            let (row, tau, v) = front.get(if backwards { count - 1 - at } else { at });
            Reflect { v, tau, columns: &mut *columns, stride: front.rows.len(), row }.with_simd(simd);
        }
    }
}

/// `c <- c - tau v (v^T c)` for all columns c, four at a time. Each column has length `stride`; the reflection acts on its
/// rows from `row` on.
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

/// Computes `v^T v` for the vector v that it holds.
pub(super) struct SquaredNorm<'a>(pub &'a [f64]);

impl WithSimd for SquaredNorm<'_> {
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
