//! Loops over the items of one type: values, Jacobian, rounding bounds and Hessian numbers.
//!
//! If the Hessian is a constant times the weight, its numbers for a weight of 1 are computed once.

use std::ops::Range;

use crate::equations::dof_uses::{UncertainDofs, bound};
use crate::equations::nonlinear::typed::TypedBatch;
use crate::nonlinear::Nonlinear;
use crate::scalar::Bounded;

impl<Q: Nonlinear> TypedBatch<Q> {
    /// N is the number of DOFs of every item, so that loops have a fixed length.
    pub(super) fn evaluate_fixed<const N: usize>(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let rows = Q::EQUATION_NAMES.len();
        let items = self.items.iter().zip(self.dofs.as_chunks::<N>().0);
        let outputs = c.chunks_exact_mut(rows).zip(g.chunks_exact_mut(rows * N));
        for ((item, dofs), (c, g)) in items.zip(outputs) {
            let mut local = [0.0; N];
            (0..N).for_each(|k| local[k] = u[dofs[k] as usize]);
            item.value_and_jacobian(&local, c, g);
        }
    }

    pub(super) fn evaluate_any(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let rows = Q::EQUATION_NAMES.len();
        let (mut room, mut rest) = (vec![0.0; self.widest], g);
        for ((i, item), c) in self.items.iter().enumerate().zip(c.chunks_exact_mut(rows)) {
            let own;
            let local = self.gather(i..i + 1, u, &mut room);
            (own, rest) = rest.split_at_mut(rows * local.len());
            item.value_and_jacobian(local, c, own);
        }
    }

    /// The bounds of one item, in the order of its DOFs.
    pub(super) fn rounding_of(&self, i: usize, known: &UncertainDofs, c: &mut [f64], g: &mut [f64]) {
        let u: Vec<Bounded> = self.dofs(i).iter().map(|&j| known.dof(j)).collect();
        let zero = Bounded::from(0.0);
        let (mut value, mut slopes) = (vec![zero; c.len()], vec![zero; g.len()]);
        self.items[i].jacobian_in(&u, &mut value, &mut slopes);
        c.iter_mut().zip(value).for_each(|(c, of)| *c = bound(of));
        g.iter_mut().zip(slopes).for_each(|(g, of)| *g = bound(of));
    }

    /// Number of distinct Hessian numbers per item if the Hessian is a constant times the weight; otherwise 0.
    pub const UNITS: usize = {
        let mut most = 0;
        let mut k = 0;
        while k < Q::NUMBERS.len() && Q::QUADRATIC && Q::EQUATION_NAMES.len() == 1 {
            most = if Q::NUMBERS[k] < most { most } else { Q::NUMBERS[k] + 1 };
            k += 1;
        }
        most
    };

    /// Hessian numbers as multiples of the weights.
    pub(super) fn multiples(&self, run: Range<usize>, w: &[f64], out: &mut [f64]) {
        let units = self.units.get_or_init(|| self.for_weights_of_one());
        let (units, w) = (&units[run.start * Self::UNITS..run.end * Self::UNITS], &w[run]);
        if Self::UNITS == 1 {
            out.iter_mut().zip(units).zip(w).for_each(|((out, unit), w)| *out = w * unit);
        } else {
            let items = out.chunks_exact_mut(Self::UNITS).zip(units.chunks_exact(Self::UNITS));
            items
                .zip(w)
                .for_each(|((out, units), w)| out.iter_mut().zip(units).for_each(|(out, unit)| *out = w * unit));
        }
    }

    fn for_weights_of_one(&self) -> Box<[f64]> {
        let mut units = vec![0.0; self.items.len() * Self::UNITS];
        let each = units.chunks_exact_mut(Self::UNITS);
        self.items.iter().zip(each).for_each(|(item, units)| item.hessian(&[], &[1.0], units));
        units.into()
    }

    pub(super) fn curvatures_of(&self, run: Range<usize>, u: &[f64], w: &[f64], out: &mut [f64], room: &mut [f64]) {
        let rows = Q::EQUATION_NAMES.len();
        let mut rest = out;
        let w = w[run.start * rows..run.end * rows].chunks_exact(rows);
        for (((i, item), w), &numbers) in run.clone().zip(&self.items[run.clone()]).zip(w).zip(&self.numbers[run]) {
            let own;
            (own, rest) = rest.split_at_mut(numbers as usize);
            item.hessian(self.gather(i..i + 1, u, room), w, own);
        }
    }
}
