//! Tangents of one iterate, over kept rows that are independent there, and the check that they support the model.
//!
//! Rows that were independent where they were chosen may be dependent elsewhere; rows that differ only by the rounding of G are always
//! dependent. The null vector of the tangent shows which rows are dependent, and the last of them is left out. At the end of the iteration,
//! the left-out row is checked: it must hold too.
//!
//! In equilibrium the tangent must resist every admissible motion by more than rounding. A bar without force, for example, has a transverse
//! stiffness from the rounding of its strain.
//!
//! Let A be the scaled tangent, and y the vector with the smallest `|A y|`. Let A' be the tangent after a small change: u and lambda change
//! by their next correction, and u also in its last places. The support is rounding if `|A' y - A y| > |A y| / 10`: then not one digit of
//! it is known. Cost: two evaluations.

use super::corrector::Corrector;
use super::saddle::{SINGULAR, Saddle, SaddleEntries, largest, norm};
use super::state::{ULPS, Unknowns};
use super::{EquilibriumError, Model};
use crate::common::{HALF_DIGITS, random, times};

/// This number is added to the scaled diagonal if the tangent is singular. The motion without resistance then moves a thousand times as far
/// as it would against the stiffness of the model: the step-length search shortens it.
const ADDED: f64 = 1e-3;

/// Message if rows are dependent, but it is not known which.
const NO_FACTORS: &str =
    "it is singular, and its factorization fails even after regularisation; look for dependent equations";

/// A factored tangent, and the DOFs of a motion without resistance, if there is one.
type RegularTangent = (Saddle, Option<Vec<usize>>);

impl<M: Model> Corrector<'_, M> {
    /// The factored tangent of a part at the last evaluation, over independent rows. A tangent that does not resist some motion is
    /// regularised.
    pub fn regular_tangent(&mut self, part: usize) -> Result<RegularTangent, EquilibriumError> {
        loop {
            let entries = self.entries(part);
            let pattern = &mut self.patterns[part];
            let saddle = Saddle::new(&entries, 0.0, pattern).map_err(EquilibriumError::solver)?;
            if saddle.softest.1 >= SINGULAR || entries.units.is_empty() {
                return Ok((saddle, None));
            }
            let dofs = self.motion(part, &saddle.softest.0);
            if !dofs.is_empty() {
                let pattern = &mut self.patterns[part];
                let saddle = Saddle::new(&entries, ADDED, pattern).map_err(EquilibriumError::solver)?;
                return Ok((saddle, Some(dofs)));
            }
            let dependent = largest(saddle.softest.0.get(entries.free..).unwrap_or_default());
            // As in an analysis, the last of dependent rows is removed.
            let last = dependent.into_iter().max().ok_or_else(|| EquilibriumError::solver(NO_FACTORS.to_owned()))?;
            self.all[part].rows.list.remove(last);
        }
    }

    /// The DOFs that move most in the vector y; none if multipliers dominate y.
    fn motion(&self, part: usize, y: &[f64]) -> Vec<usize> {
        let free = &self.parts.list[part].free;
        let size = |y: &[f64]| y.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
        let (of_dofs, of_rows) = y.split_at(free.len().min(y.len()));
        if 10.0 * size(of_dofs) < size(of_rows) {
            Vec::new()
        } else {
            largest(of_dofs).into_iter().map(|i| free[i]).collect()
        }
    }

    fn entries(&self, part: usize) -> SaddleEntries {
        let (free, rows) = (&self.parts.list[part].free, &self.all[part].rows);
        let place = |j: usize| self.parts.place(part, j);
        let (g, h) = (self.state.evaluation.g(), self.state.evaluation.h());
        let stiffness =
            |(i, &dof): (usize, &usize)| self.state.assembly.row(dof).filter_map(move |(j, v)| Some((i, place(j)?, v)));
        let mut list: Vec<_> = free.iter().enumerate().flat_map(stiffness).collect();
        let stiff = list.len();
        let bent = |(i, &dof): (usize, &usize)| {
            h.row(dof).chain(self.state.moments_of(dof)).filter_map(move |(j, v)| Some((i, place(j)?, v)))
        };
        list.extend(free.iter().enumerate().flat_map(bent));
        let border = (free.len()..)
            .zip(&rows.list)
            .flat_map(|(r, &row)| g.row(row).filter_map(move |(j, v)| Some((r, place(j)?, v))));
        list.extend(border.flat_map(|(r, j, v)| [(r, j, v), (j, r, v)]));
        let units = free.iter().map(|&j| rows.units()[j]).chain(rows.list.iter().map(|_| 1.0)).collect();
        SaddleEntries { units, free: free.len(), stiff, list }
    }

    /// Computes the tangents of parts in equilibrium. A part fails if its tangent does not resist every admissible motion. A part needs no
    /// check if the smallest singular value of its scaled tangent is larger than the square root of eps.
    pub fn check_support(&mut self, parts: &[usize], x: &Unknowns) -> Result<Vec<(usize, Saddle)>, EquilibriumError> {
        let (mut firm, mut found, mut off) = (Vec::new(), Vec::new(), x.clone());
        for &part in parts {
            let before = self.all[part].rows.clone();
            match self.regular_tangent(part) {
                Ok((saddle, None)) if saddle.softest.1 >= HALF_DIGITS => firm.push((part, saddle)),
                Ok((saddle, None)) => {
                    self.put_off(&mut off, x, part, &saddle.solve(&self.rhs(part)));
                    let entries_before = times(&saddle.a, &saddle.softest.0);
                    found.push((part, saddle, entries_before, self.all[part].rows.clone()));
                }
                Ok((_, Some(dofs))) => self.all[part].fail(EquilibriumError::Unsupported { factor: 0.0, dofs }),
                Err(failure) => self.all[part].fail(failure),
            }
            self.all[part].rows = before;
        }
        if found.is_empty() {
            return Ok(firm);
        }
        self.state.evaluate(self.model, self.set, &off, &self.end.loads)?;
        for (part, saddle, here, rows) in found {
            let before = std::mem::replace(&mut self.all[part].rows, rows);
            let there = saddle.applied(&self.entries(part), &saddle.softest.0);
            self.all[part].rows = before;
            let change: Vec<f64> = there.iter().zip(&here).map(|(there, here)| there - here).collect();
            // If multipliers dominate the softest vector, `dofs` is empty: rows are nearly dependent, and the model has no free motion.
            let dofs = self.motion(part, &saddle.softest.0);
            if norm(&change) > 0.1 * norm(&here) && !dofs.is_empty() {
                self.all[part].fail(EquilibriumError::Unsupported { factor: 0.0, dofs });
            } else {
                firm.push((part, saddle));
            }
        }
        self.state.evaluate(self.model, self.set, x, &self.end.loads)?;
        Ok(firm)
    }

    /// Perturbs a part by its next correction and by the last places of its coordinates.
    fn put_off(&self, off: &mut Unknowns, x: &Unknowns, part: usize, dx: &[f64]) {
        self.advance(off, part, dx, (1.0, 1.0));
        for (k, &j) in (0..).zip(&self.parts.list[part].free) {
            off.u[j] += ULPS * random(k) * (x.u[j].abs() + self.model.coordinate(j).abs());
        }
    }
}
