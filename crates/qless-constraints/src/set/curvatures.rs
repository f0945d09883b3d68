//! The numbers of the Hessians of one type: multiples of the weights where c is quadratic, else by its formula, for several at once.

use std::ops::Range;

use super::homogeneous::Homogeneous;
use crate::constraint::Nonlinear;

impl<Q: Nonlinear> Homogeneous<Q> {
    /// Numbers of each constraint's Hessian that the weight of its one equation multiplies; 0 where there is more to it.
    pub const UNITS: usize = {
        let mut most = 0;
        let mut k = 0;
        while k < Q::NUMBERS.len() && Q::QUADRATIC && Q::PARTS.len() == 1 {
            most = if Q::NUMBERS[k] < most { most } else { Q::NUMBERS[k] + 1 };
            k += 1;
        }
        most
    };

    /// The numbers of the Hessians of constraints in some runs, one after the other.
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

    /// `w` times what it multiplies.
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
        let rows = Q::PARTS.len();
        let mut rest = out;
        let w = w[run.start * rows..run.end * rows].chunks_exact(rows);
        for (((i, item), w), &numbers) in run.clone().zip(&self.items[run.clone()]).zip(w).zip(&self.numbers[run]) {
            let own;
            (own, rest) = rest.split_at_mut(numbers as usize);
            item.hessian(self.gather(i..i + 1, u, room), w, own);
        }
    }

    fn curvatures_together(&self, run: Range<usize>, u: &[f64], w: &[f64], out: &mut [f64], room: &mut [f64]) {
        let rows = Q::PARTS.len();
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
