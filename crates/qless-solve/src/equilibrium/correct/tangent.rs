//! The tangents of one iterate, over kept rows that do not depend on one another there.
//!
//! Rows that were independent where they were chosen may depend on one another elsewhere, and rows that differ by the rounding of G only always
//! do: the null vector of the tangent says which.

use super::super::saddle::{Entries, Saddle, large, largest};
use super::super::{Failure, Model};
use super::{CHANGES, Corrector};

/// On the scaled diagonal where the tangent is singular on the way.
const ADDED: f64 = 1e-3;

/// Where rows depend on one another, and nobody can tell which.
const NO_FACTORS: &str =
    "it is singular, and has no factors even with something added; look for equations that depend on one another";

/// Why a tangent is singular.
enum Singular {
    /// DOFs of a motion that nothing resists.
    Motion(Vec<usize>),
    /// Kept rows that depend on one another, ascending; none where nobody can tell which.
    Rows(Vec<usize>),
}

/// A part, its factored tangent, and the DOFs of a motion that nothing resists, if there is one.
pub(super) type Regular = (usize, Saddle, Option<Vec<usize>>);

impl<M: Model> Corrector<'_, M> {
    /// The factored tangents of parts, ascending, over rows that do not depend on one another. A part that has none fails.
    pub(super) fn regular(&mut self, parts: &[usize]) -> Result<Vec<Regular>, Failure> {
        let (mut open, mut done) = (parts.to_vec(), Vec::new());
        while !open.is_empty() {
            let mut asking = Vec::new();
            for part in open {
                match self.tangent(part) {
                    Ok((saddle, None)) => done.push((part, saddle, None)),
                    Ok((saddle, Some(Singular::Motion(dofs)))) => done.push((part, saddle, Some(dofs))),
                    Ok((_, Some(Singular::Rows(dependent)))) => asking.push((part, dependent)),
                    Err(failure) => self.all[part].fail(failure),
                }
            }
            open = self.separate(asking)?;
        }
        done.sort_by_key(|(part, ..)| *part);
        Ok(done)
    }

    /// Keeps other rows, those that are independent here; where these are the same, one less. Rows that differ by the rounding of G only are
    /// independent where DOFs are measured by their entries, and stay so. Whether the one that goes holds is seen at the end.
    fn separate(&mut self, asking: Vec<(usize, Vec<usize>)>) -> Result<Vec<usize>, Failure> {
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
                None => own.fail(Failure::Solver(NO_FACTORS.to_owned())),
            }
        }
        Ok(open)
    }

    /// The factored tangent of a part at the last evaluation, with something added if it is singular.
    fn tangent(&mut self, part: usize) -> Result<(Saddle, Option<Singular>), Failure> {
        let (entries, free) = (self.entries(part), &self.parts.list[part].free);
        let pattern = &mut self.factoring[part].pattern;
        let saddle = Saddle::new(&entries, free.len(), 0.0, pattern).map_err(Failure::Solver)?;
        let Some(null) = saddle.null_vector(pattern) else { return Ok((saddle, None)) };
        let dofs = if null.is_empty() { Vec::new() } else { large(&null, free.len()) };
        if !dofs.is_empty() {
            let saddle = Saddle::new(&entries, free.len(), ADDED, pattern).map_err(Failure::Solver)?;
            return Ok((saddle, Some(Singular::Motion(dofs.into_iter().map(|i| free[i]).collect()))));
        }
        // The kept rows were independent where they were chosen, in units.
        if !self.factoring[part].in_units {
            self.factoring[part].in_units = true;
            return self.tangent(part);
        }
        let rows = self.all[part].rows.list();
        let dependent = largest(null.get(free.len()..).unwrap_or_default()).map(|r| rows[r]);
        Ok((saddle, Some(Singular::Rows(dependent.collect()))))
    }

    pub(super) fn entries(&self, part: usize) -> Entries {
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
        Entries { size: free.len() + rows.list().len(), stiff, list, units }
    }
}
