//! Whether the tangent in equilibrium resists every motion that the constraints allow, and not by rounding: a bar without force has, across it,
//! what rounding makes of its strain.
//!
//! With y the motion that A makes smallest, and A' the tangent where u and lambda are off by what the residual leaves of them and by their last
//! places, that is where `|A' y - A y| > |A y| / 2`. Costs two evaluations, and only where a motion is resisted by little.

use super::super::saddle::{Saddle, large, norm, times};
use super::super::state::Unknowns;
use super::super::{Failure, Model};
use super::Corrector;
use super::tangent::Regular;
use crate::common::random;

/// A singular value below this is little, where the largest entries are one.
const LITTLE: f64 = 1e-8;
/// Support that changes by more than this part of it is none.
const CHANGES_BY: f64 = 0.5;
/// How far u is off, in sizes of its terms.
const OFF: f64 = 4.0 * f64::EPSILON;

/// A part, and the motion that its tangent resists least.
struct Soft {
    place: usize,
    y: Vec<f64>,
}

impl<M: Model> Corrector<'_, M> {
    /// The tangents of parts in equilibrium; a part fails whose tangent does not resist every motion that the constraints allow.
    pub fn supported(&mut self, parts: &[usize], x: &Unknowns) -> Result<Vec<(usize, Saddle)>, Failure> {
        let before: Vec<_> = parts.iter().map(|&part| self.all[part].rows.clone()).collect();
        let found = self.regular(parts)?;
        let unsupported = self.by_rounding(&found, x)?;
        parts.iter().zip(before).for_each(|(&part, rows)| self.all[part].rows = rows);
        let mut list = Vec::new();
        for ((part, saddle, motion), none) in found.into_iter().zip(unsupported) {
            match motion.or(none) {
                Some(dofs) => self.all[part].fail(Failure::Unsupported(dofs)),
                None => list.push((part, saddle)),
            }
        }
        Ok(list)
    }

    /// DOFs of motions that are resisted by rounding only, by tangent.
    fn by_rounding(&mut self, found: &[Regular], x: &Unknowns) -> Result<Vec<Option<Vec<usize>>>, Failure> {
        let of = |(place, (_, saddle, motion)): (usize, &Regular)| {
            motion.is_none().then(|| saddle.softest(LITTLE)).flatten().map(|y| Soft { place, y })
        };
        let soft: Vec<Soft> = found.iter().enumerate().filter_map(of).collect();
        let mut motions = vec![None; found.len()];
        if soft.is_empty() {
            return Ok(motions);
        }
        let mut off = x.clone();
        soft.iter().for_each(|soft| self.put_off(&mut off, x, &found[soft.place]));
        self.state.evaluate(self.model, self.set, &off, self.loads)?;
        for Soft { place, y } in soft {
            let (part, saddle, _) = &found[place];
            let here = times(saddle.matrix(), &y);
            let there = saddle.applied(&self.entries(*part), &y);
            let change: Vec<f64> = there.iter().zip(&here).map(|(there, here)| there - here).collect();
            let is_firm = norm(&change) <= CHANGES_BY * norm(&here);
            if !is_firm {
                let free = &self.parts.list[*part].free;
                let dofs: Vec<usize> = large(&y, free.len()).into_iter().map(|i| free[i]).collect();
                // Where multipliers hold most of y, rows are nearly dependent: that is no motion.
                motions[place] = Some(dofs).filter(|dofs| !dofs.is_empty());
            }
        }
        self.state.evaluate(self.model, self.set, x, self.loads)?;
        Ok(motions)
    }

    /// Moves a part by its next correction, and by the last places of what its DOFs add to.
    fn put_off(&self, off: &mut Unknowns, x: &Unknowns, (part, saddle, _): &Regular) {
        self.advance(off, *part, &saddle.solve(&self.rhs(*part, x)), (1.0, 1.0));
        for (k, &j) in (0..).zip(&self.parts.list[*part].free) {
            off.u[j] += OFF * random(k) * (x.u[j].abs() + self.model.coordinate(j).abs());
        }
    }
}
