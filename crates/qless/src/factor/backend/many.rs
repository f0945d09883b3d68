//! Computes `R1^-1 Z` and `R1^-T Z` for several vectors Z at once, so that the triangular factor R1 is read from memory once for all
//! vectors.
//!
//! Rows of one front have the same columns to the right of their triangle. [`ROWS`] such rows are processed together and share the reads of
//! columns and of Z.
//! The loops use the widest SIMD registers of the processor. The order of additions does not depend on their width, so the result is
//! the same to the last bit on every processor.

#![allow(clippy::inline_always, reason = "code must be inlined into the function that enables wider registers")]

use pulp::{Arch, Simd, WithSimd};

use super::Factor;

/// Number of vectors in a slab.
pub(crate) const WIDTH: usize = 16;

/// Number of rows of R1, and number of vectors, that are processed together. With AVX2 they fill half of the SIMD registers.
const ROWS: usize = 4;
const LANES: usize = 8;

/// `W` vectors, stored entry by entry.
pub(crate) type Slab<const W: usize = WIDTH> = Vec<[f64; W]>;

impl Factor {
    /// Solves with the triangular factor R1 in place: `Z <- R1^-1 Z`.
    pub(crate) fn solve_slab<const W: usize>(&self, z: &mut Slab<W>) {
        Arch::new().dispatch(Backward(self, z));
    }

    /// Solves with the transposed triangular factor R1 in place: `Z <- R1^-T Z`.
    pub(crate) fn solve_slab_transposed<const W: usize>(&self, z: &mut Slab<W>) {
        Arch::new().dispatch(Forward(self, z));
    }

    /// The product `R1 Z` of the triangular factor R1 and the vectors Z.
    pub(crate) fn times_slab(&self, z: &Slab) -> Slab {
        Arch::new().dispatch(Product(self, z))
    }

    #[inline(always)]
    fn backward<const W: usize, const L: usize>(&self, z: &mut Slab<W>) {
        let mut end = self.rank;
        while end > 0 {
            let count = if end >= ROWS && self.is_run(end - ROWS) { ROWS } else { 1 };
            end -= count;
            for lane in (0..W).step_by(L) {
                if count == ROWS {
                    self.rows_backward::<ROWS, W, L>(end, lane, z);
                } else {
                    self.rows_backward::<1, W, L>(end, lane, z);
                }
            }
        }
    }

    #[inline(always)]
    fn forward<const W: usize, const L: usize>(&self, z: &mut Slab<W>) {
        let mut first = 0;
        while first < self.rank {
            let count = if first + ROWS <= self.rank && self.is_run(first) { ROWS } else { 1 };
            for lane in (0..W).step_by(L) {
                if count == ROWS {
                    self.rows_forward::<ROWS, W, L>(first, lane, z);
                } else {
                    self.rows_forward::<1, W, L>(first, lane, z);
                }
            }
            first += count;
        }
    }

    /// Returns true if [`ROWS`] rows from `first` on have the same columns to the right of their triangle, as rows of one front do.
    #[inline(always)]
    fn is_run(&self, first: usize) -> bool {
        let is_next = |i: usize| self.row_of_r1(i).0[1..] == *self.row_of_r1(i + 1).0;
        (first..first + ROWS - 1).all(is_next)
    }

    /// A step of the solution `Z <- R1^-1 Z` with the triangular factor R1, for H rows of a run ([`Factor::is_run`]), and for L vectors
    /// from `lane` on.
    #[inline(always)]
    fn rows_backward<const H: usize, const W: usize, const L: usize>(
        &self,
        first: usize,
        lane: usize,
        z: &mut Slab<W>,
    ) {
        let (corner, values, places) = self.run::<H>(first);
        let mut own: [[f64; L]; H] = std::array::from_fn(|r| *some(&z[first + r], lane));
        for (k, &j) in places.iter().enumerate() {
            let x = some(&z[j as usize], lane);
            for r in 0..H {
                subtract(&mut own[r], values[r][k], x);
            }
        }
        for r in (0..H).rev() {
            let (upper, lower) = own.split_at_mut(r + 1);
            for (x, &v) in lower.iter().zip(&corner[r][1..]) {
                subtract(&mut upper[r], v, x);
            }
            divide(&mut upper[r], corner[r][0]);
        }
        (0..H).for_each(|r| z[first + r][lane..lane + L].copy_from_slice(&own[r]));
    }

    /// A step of the solution `Z <- R1^-T Z` with the triangular factor R1, for H rows of a run ([`Factor::is_run`]), and for L vectors
    /// from `lane` on.
    #[inline(always)]
    fn rows_forward<const H: usize, const W: usize, const L: usize>(&self, first: usize, lane: usize, z: &mut Slab<W>) {
        let (corner, values, places) = self.run::<H>(first);
        let mut own: [[f64; L]; H] = std::array::from_fn(|r| *some(&z[first + r], lane));
        for r in 0..H {
            let (upper, lower) = own.split_at_mut(r + 1);
            divide(&mut upper[r], corner[r][0]);
            for (x, &v) in lower.iter_mut().zip(&corner[r][1..]) {
                subtract(x, v, &upper[r]);
            }
        }
        (0..H).for_each(|r| z[first + r][lane..lane + L].copy_from_slice(&own[r]));
        for (k, &j) in places.iter().enumerate() {
            let mut x: [f64; L] = *some(&z[j as usize], lane);
            for r in 0..H {
                subtract(&mut x, values[r][k], &own[r]);
            }
            z[j as usize][lane..lane + L].copy_from_slice(&x);
        }
    }

    /// For H rows of a run: the values in their triangle, by row; the values to the right of the triangle, by row; and the columns of these
    /// values to the right.
    #[inline(always)]
    fn run<const H: usize>(&self, first: usize) -> ([&[f64]; H], [&[f64]; H], &[u32]) {
        let places = &self.row_of_r1(first + H - 1).0[1..];
        let part = |r: usize| self.row_of_r1(first + r).1.split_at(H - r);
        (std::array::from_fn(|r| part(r).0), std::array::from_fn(|r| &part(r).1[..places.len()]), places)
    }

    /// Row i of the triangular factor R1: its columns, of which the diagonal is the first, and its values.
    #[inline(always)]
    fn row_of_r1(&self, i: usize) -> (&[u32], &[f64]) {
        let range = self.r.start[i]..self.r.start[i + 1];
        let places = &self.r.col[range.clone()];
        let is_whole = places.last().is_none_or(|&j| (j as usize) < self.rank);
        let count = if is_whole { places.len() } else { places.partition_point(|&j| (j as usize) < self.rank) };
        (&places[..count], &self.r.val[range][..count])
    }
}

// The triangular solves are structures because a closure would not be inlined into the function that enables wider registers.
struct Backward<'a, const W: usize>(&'a Factor, &'a mut Slab<W>);
struct Forward<'a, const W: usize>(&'a Factor, &'a mut Slab<W>);
struct Product<'a>(&'a Factor, &'a Slab);

impl<const W: usize> WithSimd for Backward<'_, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        if W > LANES { self.0.backward::<W, LANES>(self.1) } else { self.0.backward::<W, W>(self.1) }
    }
}

impl<const W: usize> WithSimd for Forward<'_, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        if W > LANES { self.0.forward::<W, LANES>(self.1) } else { self.0.forward::<W, W>(self.1) }
    }
}

impl WithSimd for Product<'_> {
    type Output = Slab;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Slab {
        let Self(factor, z) = self;
        let mut out = vec![[0.0; WIDTH]; factor.rank];
        for (i, out) in out.iter_mut().enumerate() {
            let (places, values) = factor.row_of_r1(i);
            let mut sum = [0.0; WIDTH];
            for (&j, &v) in places.iter().zip(values) {
                subtract(&mut sum, -v, &z[j as usize]);
            }
            *out = sum;
        }
        out
    }
}

/// L of the W numbers, from `lane` on.
#[inline(always)]
fn some<const W: usize, const L: usize>(of: &[f64; W], lane: usize) -> &[f64; L] {
    of[lane..].first_chunk().expect("W is a multiple of L")
}

/// `a <- a - v b`.
#[inline(always)]
fn subtract<const W: usize>(a: &mut [f64; W], v: f64, b: &[f64; W]) {
    for c in 0..W {
        a[c] -= v * b[c];
    }
}

#[inline(always)]
fn divide<const W: usize>(a: &mut [f64; W], v: f64) {
    for a in a {
        *a /= v;
    }
}

/// Packs `count` vectors into slabs; entry i of vector k is `entry(k, i)`.
pub(crate) fn slabs(count: usize, length: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<Slab> {
    let number = |k: usize, i: usize| if k < count { entry(k, i) } else { 0.0 };
    let slab = |first: usize| (0..length).map(|i| std::array::from_fn(|c| number(first + c, i))).collect();
    (0..count).step_by(WIDTH).map(slab).collect()
}
