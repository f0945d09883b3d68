//! The tangents of one iterate, over kept rows that do not depend on one another there.
//!
//! KeptRows that were independent where they were chosen may depend on one another elsewhere, and rows that differ by the rounding of G only always
//! do: the null vector of the tangent says which.
//! @@ equilibrium/correct/support.rs
//! Whether the tangent in equilibrium resists every motion that the constraints allow, and not by rounding: a bar without force has, across it,
//! what rounding makes of its strain.
//!
//! With y the motion that A makes smallest, and A' the tangent where u and lambda are off by what the residual leaves of them and by their last
//! places, that is where `|A' y - A y| > |A y| / 2`. Costs two evaluations, and only where a motion is resisted by little.

use super::super::saddle::{Saddle, SaddleEntries, large, largest, norm, times};
use super::super::state::Unknowns;
use super::super::{Model, StepFailure};
use super::{CHANGES, Corrector};
use crate::common::random;

/// On the scaled diagonal where the tangent is singular on the way.
const ADDED: f64 = 1e-3;

/// Where rows depend on one another, and nobody can tell which.
const NO_FACTORS: &str =
    "it is singular, and has no factors even with something added; look for equations that depend on one another";

/// Why a tangent is singular.
enum SingularCause {
    /// DOFs of a motion that nothing resists.
    Motion(Vec<usize>),
    /// Kept rows that depend on one another, ascending; none where nobody can tell which.
    Rows(Vec<usize>),
}

/// A part, its factored tangent, and the DOFs of a motion that nothing resists, if there is one.
pub(super) type RegularTangent = (usize, Saddle, Option<Vec<usize>>);

impl<M: Model> Corrector<'_, M> {
    /// The factored tangents of parts, ascending, over rows that do not depend on one another. A part that has none fails.
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

    /// Keeps other rows, those that are independent here; where these are the same, one less. KeptRows that differ by the rounding of G only are
    /// independent where DOFs are measured by their entries, and stay so. Whether the one that goes holds is seen at the end.
    fn separate(&mut self, asking: Vec<(usize, Vec<usize>)>) -> Result<Vec<usize>, StepFailure> {
        let may = |part: usize| !self.all[part].rows.is_thinned() && self.all[part].changes < CHANGES;
        let choice = if asking.iter().any(|(part, _)| may(*part)) { Some(self.choose()?) } else { None };
        let mut open = Vec::new();
        for (part, dependent) in asking {
            let own = &mut self.all[part];
            if let Some(choice) = choice.as_ref().filter(|_| !own.rows.is_thinned() && own.changes < CHANGES) {
                own.changes += 1;
                if own.rows.renew(&self.parts.list[part].rows, choice) {
                    open.push(part);
                    continue;
                }
            }
            // Of rows that say the same the last one goes, as in an analysis.
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

    /// The factored tangent of a part at the last evaluation, with something added if it is singular.
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
        // The kept rows were independent where they were chosen, in units.
        if !self.factoring[part].in_units {
            self.factoring[part].in_units = true;
            return self.tangent(part);
        }
        let rows = self.all[part].rows.list();
        let dependent = largest(null.get(free.len()..).unwrap_or_default()).map(|r| rows[r]);
        Ok((saddle, Some(SingularCause::Rows(dependent.collect()))))
    }

    pub(super) fn entries(&self, part: usize) -> SaddleEntries {
        let (free, rows) = (&self.parts.list[part].free, &self.all[part].rows);
        let place = |j: usize| self.parts.place(part, j);
        let (g, h) = (self.state.quantities.g(), self.state.quantities.h());
        let stiffness =
            |(i, &dof): (usize, &usize)| self.state.assembly.row(dof).filter_map(move |(j, v)| Some((i, place(j)?, v)));
        let mut list: Vec<_> = free.iter().enumerate().flat_map(stiffness).collect();
        let stiff = list.len();
        let bent = |(i, &dof): (usize, &usize)| h.row(dof).filter_map(move |(j, v)| Some((i, place(j)?, v)));
        list.extend(free.iter().enumerate().flat_map(bent));
        let border = (free.len()..)
            .zip(rows.list())
            .flat_map(|(r, &row)| g.row(row).filter_map(move |(j, v)| Some((r, place(j)?, v))));
        list.extend(border.flat_map(|(r, j, v)| [(r, j, v), (j, r, v)]));
        let in_units = self.factoring[part].in_units;
        let units = if in_units { free.iter().map(|&j| rows.units()[j]).collect() } else { Vec::new() };
        SaddleEntries { size: free.len() + rows.list().len(), stiff, list, units }
    }
}

/// A singular value below this is little, where the largest entries are one.
const LITTLE: f64 = 1e-8;
/// Support that changes by more than this part of it is none.
const CHANGES_BY: f64 = 0.5;
/// How far u is off, in sizes of its terms.
const OFF: f64 = 4.0 * f64::EPSILON;

/// A part, and the motion that its tangent resists least.
struct SoftPart {
    place: usize,
    y: Vec<f64>,
}

impl<M: Model> Corrector<'_, M> {
    /// The tangents of parts in equilibrium; a part fails whose tangent does not resist every motion that the constraints allow.
    pub fn supported(&mut self, parts: &[usize], x: &Unknowns) -> Result<Vec<(usize, Saddle)>, StepFailure> {
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

    /// DOFs of motions that are resisted by rounding only, by tangent.
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
    fn put_off(&self, off: &mut Unknowns, x: &Unknowns, (part, saddle, _): &RegularTangent) {
        self.advance(off, *part, &saddle.solve(&self.rhs(*part, x)), (1.0, 1.0));
        for (k, &j) in (0..).zip(&self.parts.list[*part].free) {
            off.u[j] += OFF * random(k) * (x.u[j].abs() + self.model.coordinate(j).abs());
        }
    }
}
