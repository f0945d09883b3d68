//! `R1^-1 Z` and `R1^-T Z` for many vectors at once: each entry of R is read once for all of them.
//!
//! The loops use the widest SIMD registers of the processor. The order of additions does not depend on their width, so the result is
//! the same to the last bit on every processor.

#![allow(clippy::inline_always, reason = "code must be inlined into the function that enables wider registers")]

use pulp::Arch;

use super::Factor;

/// Number of vectors in a slab.
pub(crate) const WIDTH: usize = 16;

/// `W` vectors, stored entry by entry.
pub(crate) type Slab<const W: usize = WIDTH> = Vec<[f64; W]>;

impl Factor {
    /// `Z <- R1^-1 Z`.
    pub(crate) fn solve_slab<const W: usize>(&self, z: &mut Slab<W>) {
        Arch::new().dispatch(
            #[inline(always)]
            || {
                for i in (0..self.rank).rev() {
                    let (places, values) = self.row_of_r1(i);
                    let (before, rest) = z.split_at_mut(i + 1);
                    let mut own = before[i];
                    for (&j, &v) in places[1..].iter().zip(&values[1..]) {
                        subtract(&mut own, v, &rest[j as usize - i - 1]);
                    }
                    divide(&mut own, values[0]);
                    before[i] = own;
                }
            },
        );
    }

    /// `Z <- R1^-T Z`.
    pub(crate) fn solve_slab_transposed<const W: usize>(&self, z: &mut Slab<W>) {
        Arch::new().dispatch(
            #[inline(always)]
            || {
                for i in 0..self.rank {
                    let (places, values) = self.row_of_r1(i);
                    let (before, rest) = z.split_at_mut(i + 1);
                    divide(&mut before[i], values[0]);
                    let own = before[i];
                    for (&j, &v) in places[1..].iter().zip(&values[1..]) {
                        subtract(&mut rest[j as usize - i - 1], v, &own);
                    }
                }
            },
        );
    }

    /// `R1 Z`.
    pub(crate) fn times_slab(&self, z: &Slab) -> Slab {
        let mut out = vec![[0.0; WIDTH]; self.rank];
        Arch::new().dispatch(
            #[inline(always)]
            || {
                for (i, sum) in out.iter_mut().enumerate() {
                    let (places, values) = self.row_of_r1(i);
                    for (&j, &v) in places.iter().zip(values) {
                        subtract(sum, -v, &z[j as usize]);
                    }
                }
            },
        );
        out
    }

    /// Row i of R1: columns, the diagonal first, and values.
    #[inline(always)]
    fn row_of_r1(&self, i: usize) -> (&[u32], &[f64]) {
        let range = self.r.start[i]..self.r.start[i + 1];
        let places = &self.r.col[range.clone()];
        let count = places.partition_point(|&j| (j as usize) < self.rank);
        (&places[..count], &self.r.val[range][..count])
    }
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
