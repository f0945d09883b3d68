//! Loops over the items of one type: values, Jacobian, pattern of G, rounding bounds and Hessian numbers.
//!
//! If the Hessian is a constant times the weight, its numbers for a weight of 1 are computed once.

use std::ops::Range;

use crate::equations::coordinates::{UncertainDofs, bound};
use crate::equations::nonlinear::typed::TypedBatch;
use crate::nonlinear::Nonlinear;
use crate::scalar::Bounded;

impl<Q: Nonlinear> TypedBatch<Q> {
    /// Writes c and G.
    pub fn write_values(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        match Q::DOFS {
            2 => self.evaluate_fixed::<2>(u, c, g),
            3 => self.evaluate_fixed::<3>(u, c, g),
            4 => self.evaluate_fixed::<4>(u, c, g),
            6 => self.evaluate_fixed::<6>(u, c, g),
            _ => self.evaluate_any(u, c, g),
        }
        let rows = Q::EQUATION_NAMES.len();
        self.order.restore(|i| self.span(i..i).start * rows, rows, g);
    }

    /// N is the number of DOFs of every item, so that loops have a fixed length.
    fn evaluate_fixed<const N: usize>(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let rows = Q::EQUATION_NAMES.len();
        let items = self.items.iter().zip(self.dofs.as_chunks::<N>().0);
        let outputs = c.chunks_exact_mut(rows).zip(g.chunks_exact_mut(rows * N));
        for ((item, dofs), (c, g)) in items.zip(outputs) {
            let mut local = [0.0; N];
            (0..N).for_each(|k| local[k] = u[dofs[k] as usize]);
            item.value_and_jacobian(&local, c, g);
        }
    }

    fn evaluate_any(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let rows = Q::EQUATION_NAMES.len();
        let ahead = self.ahead();
        let mut room = vec![0.0; ahead * self.widest];
        let mut rest = g;
        for (k, c) in c.chunks_mut(ahead * rows).enumerate() {
            let from = k * ahead;
            let mut local = &mut *self.gather(from..from + c.len() / rows, u, &mut room);
            for (k, c) in c.chunks_mut(Q::AT_ONCE * rows).enumerate() {
                let from = from + k * Q::AT_ONCE;
                let items = from..from + c.len() / rows;
                let (own, of_items);
                (of_items, local) = local.split_at_mut(self.width(items.clone()));
                (own, rest) = rest.split_at_mut(rows * of_items.len());
                Q::values_and_jacobians(&self.items[items], of_items, c, own);
            }
        }
    }

    /// Writes the columns and the ends of the rows of G; the first row starts at `first`.
    pub fn write_columns(&self, first: usize, end: &mut [usize], col: &mut [u32]) {
        if Q::EQUATION_NAMES.len() == 1 && self.order.is_empty() {
            col.copy_from_slice(&self.dofs);
            return (0..end.len()).for_each(|i| end[i] = first + self.span(i..i + 1).end);
        }
        let (mut sorted, mut rest, mut last) = (Vec::new(), col, first);
        let mut ends = end.iter_mut();
        for i in 0..self.items.len() {
            let mut dofs = self.dofs(i);
            if !self.order.is_empty() && !dofs.is_sorted() {
                sorted.clear();
                sorted.extend_from_slice(dofs);
                sorted.sort_unstable();
                dofs = &sorted;
            }
            for end in ends.by_ref().take(Q::EQUATION_NAMES.len()) {
                let own;
                (own, rest) = rest.split_at_mut(dofs.len());
                own.copy_from_slice(dofs);
                last += dofs.len();
                *end = last;
            }
        }
    }

    /// Writes bounds on the rounding errors of c and G.
    pub fn write_rounding(&self, known: &UncertainDofs, c: &mut [f64], g: &mut [f64]) {
        let rows = Q::EQUATION_NAMES.len();
        let mut rest = &mut *g;
        for (i, c) in c.chunks_exact_mut(rows).enumerate() {
            let own;
            (own, rest) = rest.split_at_mut(rows * self.width(i..i + 1));
            self.rounding_of(i, known, c, own);
        }
        self.order.restore(|i| self.span(i..i).start * rows, rows, g);
    }

    /// The bounds of one item, in the order of its DOFs.
    fn rounding_of(&self, i: usize, known: &UncertainDofs, c: &mut [f64], g: &mut [f64]) {
        let u: Vec<Bounded> = self.dofs(i).iter().map(|&j| known.dof(j)).collect();
        let zero = Bounded::from(0.0);
        let (mut value, mut slopes) = (vec![zero; c.len()], vec![zero; g.len()]);
        self.items[i].jacobian_in(&u, &mut value, &mut slopes);
        c.iter_mut().zip(value).for_each(|(c, of)| *c = bound(of));
        g.iter_mut().zip(slopes).for_each(|(g, of)| *g = bound(of));
    }
}

impl<Q: Nonlinear> TypedBatch<Q> {
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

    /// Writes the Hessian numbers of the items in these ranges, one item after the other.
    pub fn write_curvatures(&self, items: &[Range<u32>], u: &[f64], w: &[f64], out: &mut [f64]) {
        let mut room = vec![0.0; self.ahead() * self.widest];
        let mut rest = out;
        for run in items {
            let run = run.start as usize..run.end as usize;
            if Self::UNITS > 0 {
                let own;
                (own, rest) = rest.split_at_mut(run.len() * Self::UNITS);
                self.multiples(run, w, own);
                continue;
            }
            let numbers = self.numbers[run.clone()].iter().map(|&n| n as usize);
            let own;
            (own, rest) = rest.split_at_mut(numbers.sum());
            if Q::AT_ONCE == 1 {
                self.curvatures_one_by_one(run, u, w, own, &mut room);
            } else {
                self.curvatures_together(run, u, w, own, &mut room);
            }
        }
    }

    /// Hessian numbers as multiples of the weights.
    fn multiples(&self, run: Range<usize>, w: &[f64], out: &mut [f64]) {
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

    #[inline]
    fn curvatures_one_by_one(&self, run: Range<usize>, u: &[f64], w: &[f64], out: &mut [f64], room: &mut [f64]) {
        let rows = Q::EQUATION_NAMES.len();
        let mut rest = out;
        let w = w[run.start * rows..run.end * rows].chunks_exact(rows);
        for (((i, item), w), &numbers) in run.clone().zip(&self.items[run.clone()]).zip(w).zip(&self.numbers[run]) {
            let own;
            (own, rest) = rest.split_at_mut(numbers as usize);
            item.hessian(self.gather(i..i + 1, u, room), w, own);
        }
    }

    fn curvatures_together(&self, run: Range<usize>, u: &[f64], w: &[f64], out: &mut [f64], room: &mut [f64]) {
        let rows = Q::EQUATION_NAMES.len();
        let mut rest = out;
        for first in run.clone().step_by(self.ahead()) {
            let all = first..run.end.min(first + self.ahead());
            let mut local = self.gather(all.clone(), u, room);
            for from in all.clone().step_by(Q::AT_ONCE) {
                let items = from..all.end.min(from + Q::AT_ONCE);
                let (own, of_items);
                (own, rest) = rest.split_at_mut(self.numbers[items.clone()].iter().sum::<u32>() as usize);
                (of_items, local) = local.split_at_mut(self.width(items.clone()));
                let w = &w[items.start * rows..items.end * rows];
                Q::second_derivatives(&self.items[items], of_items, w, own);
            }
        }
    }
}
