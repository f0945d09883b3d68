//! Where a step starts: the rows that are not redundant there, the branch of the mechanism, and rotations that only constraints know.

use super::super::Model;
use super::super::branch::{Branch, Turn};
use super::super::failure::Failure;
use super::super::rows::Rows;
use super::Path;
use crate::newton::{self, NewtonError, NewtonOptions};

/// Steps of Newton's method on the constraints, to see which rows are redundant.
const LOOK: usize = 10;

impl<M: Model> Path<'_, M> {
    /// Rotation vectors that nobody but the constraints knows.
    pub(super) fn loose_rotations(&mut self) -> Vec<[usize; 3]> {
        let evaluated = self.state.balance(self.model, self.course.set(), &self.at, &self.start.loads).is_ok();
        let mut known = self.state.assembly.known();
        self.target.prescribed.iter().for_each(|&(j, _)| known[j] = true);
        let loads = self.start.loads.iter().zip(self.target.loads);
        known.iter_mut().zip(loads).for_each(|(known, (a, b))| *known |= *a != 0.0 || *b != 0.0);
        let mut vectors = self.course.set().rotation_vectors();
        vectors.retain(|vector| evaluated && vector.iter().all(|&dof| !known[dof]));
        vectors
    }

    /// The rows of the next step, and the branch on which it starts.
    pub(super) fn origin(&mut self, prescribed: &[(usize, f64)]) -> Result<Rows, Failure> {
        (self.branch, self.turn) = (None, Turn::default());
        let (rows, holds) = match self.rows.clone() {
            Some(rows) => (rows, true),
            None => self.rows_at_start(prescribed)?,
        };
        if self.rows.is_some() && self.driven {
            self.course.set().evaluate(&self.at.u, &mut self.state.quantities)?;
        }
        self.rank = (self.driven && holds).then(|| rows.list().len());
        if self.driven && holds {
            self.branch = Branch::new(&self.state.quantities, &rows, &self.free, &mut self.of_branch);
        }
        Ok(rows)
    }

    /// Rows where the constraints hold nearest to the start, which is evaluated; where that is not found in a few steps, at the start, and `false`.
    fn rows_at_start(&mut self, prescribed: &[(usize, f64)]) -> Result<(Rows, bool), Failure> {
        let held: Vec<(usize, f64)> = prescribed.iter().map(|&(j, _)| (j, self.at.u[j])).collect();
        let near = self.consistent(&held, LOOK);
        let holds = near.is_ok();
        let u = match near.or_else(|_| self.consistent(prescribed, LOOK)) {
            Err(Failure::Constraints(NewtonError::NoConvergence { .. })) => self.at.u.clone(),
            other => other?,
        };
        Ok((self.rows_at(&u, prescribed)?, holds))
    }

    pub(super) fn rows_at(&mut self, u: &[f64], prescribed: &[(usize, f64)]) -> Result<Rows, Failure> {
        let set = self.course.set();
        set.evaluate(u, &mut self.state.quantities)?;
        let before = self.rows.as_ref().map_or(&[][..], |rows| rows.list());
        Rows::new(set, &self.state.quantities, prescribed, (self.options, before))
    }

    /// The nearest configuration that satisfies the constraints.
    pub(super) fn consistent(&self, prescribed: &[(usize, f64)], steps: usize) -> Result<Vec<f64>, Failure> {
        let (tolerance, analysis) = (self.options.roundings, self.options.analysis.clone());
        let options = NewtonOptions { tolerance, steps, analysis };
        let found = newton::solve(self.course.set(), &self.at.u, prescribed, &options);
        found.map(|found| found.u).map_err(Failure::Constraints)
    }
}
