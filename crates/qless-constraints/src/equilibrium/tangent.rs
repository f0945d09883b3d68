//! The tangent of one iterate, over kept rows that do not depend on one another there.
//!
//! Rows that were independent where they were chosen may depend on one another elsewhere, and rows that differ by the rounding of G only always
//! do: the null vector of the tangent says which.

use super::correct::{CHANGES, Corrector};
use super::rows::Rows;
use super::saddle::{Entries, Saddle, large, largest};
use super::{Failure, Model};

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

impl<M: Model> Corrector<'_, M> {
    /// The factored tangent over rows that do not depend on one another, and the DOFs of a motion that nothing resists, if there is one.
    pub fn regular(&mut self, rows: &mut Rows) -> Result<(Saddle, Option<Vec<usize>>), Failure> {
        loop {
            let (saddle, singular) = self.tangent(rows)?;
            match singular {
                None => return Ok((saddle, None)),
                Some(Singular::Motion(dofs)) => return Ok((saddle, Some(dofs))),
                Some(Singular::Rows(dependent)) => self.part(rows, &dependent)?,
            }
        }
    }

    /// Keeps other rows, those that are independent here; where these are the same, one less. Rows that differ by the rounding of G only are
    /// independent where DOFs are measured by their entries, and stay so. Whether the one that goes holds is seen at the end.
    fn part(&mut self, rows: &mut Rows, dependent: &[usize]) -> Result<(), Failure> {
        if !rows.is_thinned() && self.changes < CHANGES {
            self.changes += 1;
            if rows.renew(self.set, &self.state.quantities, self.prescribed, self.options)? {
                return Ok(());
            }
        }
        // Of rows that say the same the last one goes, as in an analysis.
        let last = dependent.last().ok_or_else(|| Failure::Solver(NO_FACTORS.to_owned()))?;
        rows.leave_out(*last);
        Ok(())
    }

    /// The factored tangent at the last evaluation, with something added if it is singular.
    fn tangent(&mut self, rows: &Rows) -> Result<(Saddle, Option<Singular>), Failure> {
        let (entries, free) = (self.entries(rows), self.free.len());
        let saddle = Saddle::new(&entries, free, 0.0, self.pattern).map_err(Failure::Solver)?;
        let Some(null) = saddle.null_vector(self.pattern) else { return Ok((saddle, None)) };
        let dofs = if null.is_empty() { Vec::new() } else { large(&null, free) };
        if !dofs.is_empty() {
            let saddle = Saddle::new(&entries, free, ADDED, self.pattern).map_err(Failure::Solver)?;
            return Ok((saddle, Some(Singular::Motion(dofs.into_iter().map(|i| self.free[i]).collect()))));
        }
        // The kept rows were independent where they were chosen, in units.
        if !*self.in_units {
            *self.in_units = true;
            return self.tangent(rows);
        }
        let dependent = largest(null.get(free..).unwrap_or_default()).map(|r| rows.list()[r]);
        Ok((saddle, Some(Singular::Rows(dependent.collect()))))
    }

    fn entries(&self, rows: &Rows) -> Entries {
        let (n, place) = (self.free.len(), self.places());
        let (g, h) = (self.state.quantities.g(), self.state.quantities.h());
        let free = |(i, j, v): (usize, usize, f64)| Some((place[i]?, place[j]?, v));
        let mut list: Vec<_> = self.state.assembly.entries().filter_map(free).collect();
        let stiff = list.len();
        list.extend((0..h.rows()).flat_map(|i| h.row(i).map(move |(j, v)| (i, j, v))).filter_map(free));
        let border = rows.list().iter().enumerate().flat_map(|(r, &row)| {
            let place = &place;
            g.row(row).filter_map(move |(j, v)| Some((n + r, place[j]?, v)))
        });
        list.extend(border.flat_map(|(r, j, v)| [(r, j, v), (j, r, v)]));
        let units = if *self.in_units { self.free.iter().map(|&j| rows.units()[j]).collect() } else { Vec::new() };
        Entries { size: n + rows.list().len(), stiff, list, units }
    }

    /// The place of each DOF among the free ones.
    fn places(&self) -> Vec<Option<usize>> {
        let mut place = vec![None; self.set.dofs()];
        self.free.iter().enumerate().for_each(|(i, &j)| place[j] = Some(i));
        place
    }

    /// Whether the tangent at the equilibrium resists every motion that the constraints allow.
    pub fn supported(&mut self, rows: &Rows) -> Result<Saddle, Failure> {
        let (saddle, motion) = self.regular(&mut rows.clone())?;
        motion.map_or(Ok(saddle), |dofs| Err(Failure::Unsupported(dofs)))
    }
}
