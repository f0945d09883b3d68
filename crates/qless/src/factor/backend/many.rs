//! `R1^-1 Z` and `R1^-T Z` for a slab of vectors at once: each number of R is read once for all of them.
//!
//! In the widest registers that the processor has; nothing is added in another order, so that the bits are the same in all.

#![allow(clippy::inline_always, reason = "code for wider registers must be inlined where they are switched on")]

use pulp::{Arch, NullaryFnOnce};

use super::Factor;

/// Vectors of a slab.
pub(crate) const WIDTH: usize = 16;

/// `W` vectors, number by number.
pub(crate) type Slab<const W: usize = WIDTH> = Vec<[f64; W]>;

impl Factor {
    /// `Z <- R1^-1 Z`.
    pub(crate) fn solve_slab<const W: usize>(&self, z: &mut Slab<W>) {
        Arch::new().dispatch(Upward { r: self, z });
    }

    /// `Z <- R1^-T Z`.
    pub(crate) fn solve_slab_transposed<const W: usize>(&self, z: &mut Slab<W>) {
        Arch::new().dispatch(Downward { r: self, z });
    }

    /// `R1 Z`.
    pub(crate) fn times_slab(&self, z: &Slab) -> Slab {
        let mut out = vec![[0.0; WIDTH]; self.rank];
        Arch::new().dispatch(Product { r: self, z, out: &mut out });
        out
    }

    /// Row i of R1: places, the diagonal first, and values.
    #[inline(always)]
    fn live(&self, i: usize) -> (&[u32], &[f64]) {
        let range = self.r.start[i]..self.r.start[i + 1];
        let places = &self.r.col[range.clone()];
        let count = places.partition_point(|&j| (j as usize) < self.rank);
        (&places[..count], &self.r.val[range][..count])
    }
}

struct Upward<'a, const W: usize> {
    r: &'a Factor,
    z: &'a mut [[f64; W]],
}

impl<const W: usize> NullaryFnOnce for Upward<'_, W> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for i in (0..self.r.rank).rev() {
            let (places, values) = self.r.live(i);
            let (before, rest) = self.z.split_at_mut(i + 1);
            let mut own = before[i];
            for (&j, &v) in places[1..].iter().zip(&values[1..]) {
                subtract(&mut own, v, &rest[j as usize - i - 1]);
            }
            divide(&mut own, values[0]);
            before[i] = own;
        }
    }
}

struct Downward<'a, const W: usize> {
    r: &'a Factor,
    z: &'a mut [[f64; W]],
}

impl<const W: usize> NullaryFnOnce for Downward<'_, W> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for i in 0..self.r.rank {
            let (places, values) = self.r.live(i);
            let (before, rest) = self.z.split_at_mut(i + 1);
            divide(&mut before[i], values[0]);
            let own = before[i];
            for (&j, &v) in places[1..].iter().zip(&values[1..]) {
                subtract(&mut rest[j as usize - i - 1], v, &own);
            }
        }
    }
}

struct Product<'a> {
    r: &'a Factor,
    z: &'a [[f64; WIDTH]],
    out: &'a mut [[f64; WIDTH]],
}

impl NullaryFnOnce for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (i, sum) in self.out.iter_mut().enumerate() {
            let (places, values) = self.r.live(i);
            for (&j, &v) in places.iter().zip(values) {
                subtract(sum, -v, &self.z[j as usize]);
            }
        }
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

/// Slabs of which vector k of `count` has the numbers `of(k, i)`.
pub(crate) fn slabs(count: usize, length: usize, of: impl Fn(usize, usize) -> f64) -> Vec<Slab> {
    let number = |k: usize, i: usize| if k < count { of(k, i) } else { 0.0 };
    let slab = |first: usize| (0..length).map(|i| std::array::from_fn(|c| number(first + c, i))).collect();
    (0..count).step_by(WIDTH).map(slab).collect()
}
