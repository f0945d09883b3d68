//! Tangents of one iterate, over kept rows that are independent there, and the check that they support the model.
//!
//! Rows that were independent where they were chosen may be dependent elsewhere; rows that differ only by the rounding of G are always
//! dependent. The null vector of the tangent shows which rows these are.
//!
//! In equilibrium the tangent must resist every admissible motion by more than rounding. A bar without force, for example, has a transverse
//! stiffness from the rounding of its strain.
//!
//! Let y be the vector with the smallest `|A y|`, and A' the tangent after a change of u and lambda by their next correction, and of u in
//! its last places. The support is rounding if `|A' y - A y| > |A y| / 2`. Cost: two evaluations, if some motion is resisted weakly.

use super::super::saddle::{Saddle, SaddleEntries, large, largest, norm};
use super::super::state::Unknowns;
use super::super::{Model, StepFailure};
use super::{CHANGES, Corrector};
use crate::common::{random, times};

/// Added to the scaled diagonal if the tangent is singular.
const ADDED: f64 = 1e-3;

/// Rows are dependent, but it is not known which.
const NO_FACTORS: &str =
    "it is singular, and its factorization fails even after regularisation; look for dependent equations";

/// Cause of a singular tangent.
enum SingularCause {
    /// DOFs of a motion without resistance.
    Motion(Vec<usize>),
    /// Dependent rows, ascending; empty if they are not known.
    Rows(Vec<usize>),
}

/// A part, its factored tangent, and the DOFs of a motion without resistance, if there is one.
pub(super) type RegularTangent = (usize, Saddle, Option<Vec<usize>>);

impl<M: Model> Corrector<'_, M> {
    /// The factored tangents of parts, ascending, over independent rows. A part without one fails.
    pub(super) fn regular(&mut self, parts: &[usize]) -> Result<Vec<RegularTangent>, StepFailure> {
        let (mut open, mut done) = (parts.to_vec(), Vec::new());
        while !open.is_empty() {
            let mut asking = Vec::new();
            for part in open {
                match self.tangent(part) {
                    Ok((saddle, None)) => done.push((part, saddle, None)),
                    Ok((saddle, Some(SingularCause::Motion(dofs)))) => done.push((part, saddle, Some(dofs))),
                    Ok((_, Some(SingularCause::Rows(dependent)))) => asking.push((part, dependent)),
                    Err(failure) => self.all[part].fail(failure),
                }
            }
            open = self.separate(asking)?;
        }
        done.sort_by_key(|(part, ..)| *part);
        Ok(done)
    }

    /// Gives parts the rows that are independent here; if a part had these rows before, removes one. Rows that differ by the rounding of G
    /// count as independent in the units of their entries, so that they would be chosen again. Whether the removed row holds is checked at
    /// the end.
    fn separate(&mut self, asking: Vec<(usize, Vec<usize>)>) -> Result<Vec<usize>, StepFailure> {
        let may = |part: usize| !self.all[part].rows.is_thinned && self.all[part].changes < CHANGES;
        let choice = if asking.iter().any(|(part, _)| may(*part)) { Some(self.choose()?) } else { None };
        let mut open = Vec::new();
        for (part, dependent) in asking {
            let own = &mut self.all[part];
            if let Some(choice) = choice.as_ref().filter(|_| !own.rows.is_thinned && own.changes < CHANGES) {
                own.changes += 1;
                if own.rows.renew(&self.parts.list[part].rows, choice) {
                    open.push(part);
                    continue;
                }
            }
            // As in an analysis, the last of dependent rows is removed.
            match dependent.last() {
                Some(&last) => {
                    own.rows.leave_out(last);
                    open.push(part);
                }
                None => own.fail(StepFailure::Solver(NO_FACTORS.to_owned())),
            }
        }
        Ok(open)
    }

    /// The factored tangent of a part at the last evaluation; a singular one is regularised.
    fn tangent(&mut self, part: usize) -> Result<(Saddle, Option<SingularCause>), StepFailure> {
        let (entries, free) = (self.entries(part), &self.parts.list[part].free);
        let pattern = &mut self.factoring[part].pattern;
        let saddle = Saddle::new(&entries, free.len(), 0.0, pattern).map_err(StepFailure::Solver)?;
        let Some(null) = saddle.null_vector(pattern) else { return Ok((saddle, None)) };
        let dofs = if null.is_empty() { Vec::new() } else { large(&null, free.len()) };
        if !dofs.is_empty() {
            let saddle = Saddle::new(&entries, free.len(), ADDED, pattern).map_err(StepFailure::Solver)?;
            return Ok((saddle, Some(SingularCause::Motion(dofs.into_iter().map(|i| free[i]).collect()))));
        }
        // The kept rows are independent in the units of the analysis, so scaling starts from these units now.
        if !self.factoring[part].in_units {
            self.factoring[part].in_units = true;
            return self.tangent(part);
        }
        let rows = &self.all[part].rows.list;
        let dependent = largest(null.get(free.len()..).unwrap_or_default()).map(|r| rows[r]);
        Ok((saddle, Some(SingularCause::Rows(dependent.collect()))))
    }

    pub(super) fn entries(&self, part: usize) -> SaddleEntries {
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
        let in_units = self.factoring[part].in_units;
        let units = if in_units { free.iter().map(|&j| rows.units()[j]).collect() } else { Vec::new() };
        SaddleEntries { size: free.len() + rows.list.len(), stiff, list, units }
    }
}

/// A singular value below this needs a check; the largest entries are one.
const LITTLE: f64 = 1e-8;
/// Support is rounding if it changes by more than this fraction.
const CHANGES_BY: f64 = 0.5;
/// Relative perturbation of u.
const OFF: f64 = 4.0 * f64::EPSILON;

/// A part, and the motion with the least resistance.
struct SoftPart {
    place: usize,
    y: Vec<f64>,
}

impl<M: Model> Corrector<'_, M> {
    /// The tangents of parts in equilibrium. A part fails if its tangent does not resist every admissible motion.
    pub fn check_support(&mut self, parts: &[usize], x: &Unknowns) -> Result<Vec<(usize, Saddle)>, StepFailure> {
        let before: Vec<_> = parts.iter().map(|&part| self.all[part].rows.clone()).collect();
        let found = self.regular(parts)?;
        let unsupported = self.by_rounding(&found, x)?;
        parts.iter().zip(before).for_each(|(&part, rows)| self.all[part].rows = rows);
        let mut list = Vec::new();
        for ((part, saddle, motion), none) in found.into_iter().zip(unsupported) {
            match motion.or(none) {
                Some(dofs) => self.all[part].fail(StepFailure::Unsupported(dofs)),
                None => list.push((part, saddle)),
            }
        }
        Ok(list)
    }

    /// For each tangent, the DOFs of a motion that only rounding resists.
    fn by_rounding(&mut self, found: &[RegularTangent], x: &Unknowns) -> Result<Vec<Option<Vec<usize>>>, StepFailure> {
        let of = |(place, (_, saddle, motion)): (usize, &RegularTangent)| {
            motion.is_none().then(|| saddle.softest(LITTLE)).flatten().map(|y| SoftPart { place, y })
        };
        let soft: Vec<SoftPart> = found.iter().enumerate().filter_map(of).collect();
        let mut motions = vec![None; found.len()];
        if soft.is_empty() {
            return Ok(motions);
        }
        let mut off = x.clone();
        soft.iter().for_each(|soft| self.put_off(&mut off, x, &found[soft.place]));
        self.state.evaluate(self.model, self.set, &off, self.loads)?;
        for SoftPart { place, y } in soft {
            let (part, saddle, _) = &found[place];
            let here = times(&saddle.a, &y);
            let there = saddle.applied(&self.entries(*part), &y);
            let change: Vec<f64> = there.iter().zip(&here).map(|(there, here)| there - here).collect();
            let is_firm = norm(&change) <= CHANGES_BY * norm(&here);
            if !is_firm {
                let free = &self.parts.list[*part].free;
                let dofs: Vec<usize> = large(&y, free.len()).into_iter().map(|i| free[i]).collect();
                // If multipliers dominate y, rows are nearly dependent; that is not a free motion.
                motions[place] = Some(dofs).filter(|dofs| !dofs.is_empty());
            }
        }
        self.state.evaluate(self.model, self.set, x, self.loads)?;
        Ok(motions)
    }

    /// Perturbs a part by its next correction and by the last places of its coordinates.
    fn put_off(&self, off: &mut Unknowns, x: &Unknowns, (part, saddle, _): &RegularTangent) {
        self.advance(off, *part, &saddle.solve(&self.rhs(*part, x)), (1.0, 1.0));
        for (k, &j) in (0..).zip(&self.parts.list[*part].free) {
            off.u[j] += OFF * random(k) * (x.u[j].abs() + self.model.coordinate(j).abs());
        }
    }
}
