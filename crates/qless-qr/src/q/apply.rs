//! `b <- Q^T b` and `b <- Q b`, front by front; the vectors of a matrix eight at a time, in parallel.
//!
//! What happens to one vector does not depend on the others, so the bits are those of one vector alone.

#![allow(clippy::inline_always, reason = "code for wider registers must be inlined where they are switched on")]

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::{Q, Reflections};
use crate::dense::Reflect;

/// Vectors that go through all fronts together: a reflection is read once for them.
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
    /// Turns the rows of this front in columns of length m.
    fn apply(&self, b: &mut [f64], m: usize, local: &mut Vec<f64>, backwards: bool) {
        local.clear();
        for column in b.chunks_exact(m) {
            local.extend(self.rows.iter().map(|&i| column[i as usize]));
        }
        Arch::new().dispatch(Chain { front: self, columns: &mut local[..], backwards });
        for (column, turned) in b.chunks_exact_mut(m).zip(local.chunks_exact(self.rows.len())) {
            self.rows.iter().zip(turned).for_each(|(&i, &v)| column[i as usize] = v);
        }
    }
}

/// All reflections of a front, one after the other.
struct Chain<'a> {
    front: &'a Reflections,
    columns: &'a mut [f64],
    backwards: bool,
}

impl WithSimd for Chain<'_> {
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
