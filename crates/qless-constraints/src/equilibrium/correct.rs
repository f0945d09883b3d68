//! Newton's method at one load: `[K + H, G^T; G, 0] [du; lambda' - lambda] = -[r; c]`, with H of the present multipliers.
//!
//! Length of a step, by the natural test of affine invariance (Deuflhard, Newton Methods for Nonlinear Problems, NLEQ-ERR): the next
//! correction with the same matrix, `A^-1 F(x + t dx)`, is shorter than dx by a quarter of t. Where a stiff direction (an axis, a
//! rod) bends, forces rise for a step while the error falls: the residual itself would forbid that step.

use super::pattern::Pattern;
use super::rows::Rows;
use super::saddle::Saddle;
use super::state::{State, Unknowns};
use super::{EquilibriumOptions, Failure, Iterate, Model};
use crate::ConstraintSet;

/// Steps shorter than this are none.
const SHORTEST: f64 = 1e-4;
/// Changes of the kept rows within one load step.
pub const CHANGES: usize = 4;
/// So near to the tolerance, rounding decides what a shorter step would bring.
const NEAR: f64 = 1e3;

/// Constraint values above this part of those before no longer fall.
const FALLS: f64 = 0.5;

/// One load step.
pub struct Corrector<'a, M> {
    pub model: &'a mut M,
    pub set: &'a ConstraintSet,
    pub options: &'a EquilibriumOptions,
    pub loads: &'a [f64],
    /// DOFs and their values.
    pub prescribed: &'a [(usize, f64)],
    pub free: &'a [usize],
    pub state: &'a mut State,
    pub iterates: Vec<Iterate>,
    /// Times that the kept rows changed.
    pub changes: usize,
    /// That of the last tangent.
    pub pattern: &'a mut Pattern,
    /// Whether scales of DOFs start from their units: where displacements and rotations are as different as their units, only these find those that fit.
    pub in_units: &'a mut bool,
}

impl<M: Model> Corrector<'_, M> {
    /// Finds equilibrium from x; the kept rows may change on the way.
    pub fn run(&mut self, x: &mut Unknowns, rows: &mut Rows) -> Result<(), Failure> {
        let (mut length, mut loose) = (1.0, None);
        for _ in 0..=self.options.iterations {
            let found = self.look(x, rows, (length, loose.is_some()))?;
            if self.balanced(x, found) {
                if self.all_hold(rows) {
                    return Ok(());
                }
                self.change(rows)?;
                continue;
            }
            let before = rows.list().to_vec();
            let (saddle, motion) = self.regular(rows)?;
            if before != rows.list() {
                continue;
            }
            // Multipliers alone may make the tangent regular: a chain without tension.
            let only_multipliers = motion.is_some() && loose.is_none() && !rows.list().is_empty();
            loose = motion;
            let dx = saddle.solve(&self.rhs(x, rows));
            let found = if only_multipliers { Ok(0.0) } else { self.length(&saddle, x, rows, (&dx, length)) };
            length = found.map_err(|failure| failure.or_unsupported(loose.as_ref()))?;
            *x = self.moved(x, rows, &dx, (length, if only_multipliers { 1.0 } else { length }));
            if !only_multipliers {
                self.prescribed.iter().for_each(|&(j, v)| x.u[j] = v);
            }
        }
        Err(Failure::NoConvergence.or_unsupported(loose.as_ref()))
    }

    /// Evaluates at x, and lists what is out of balance.
    fn look(&mut self, x: &mut Unknowns, rows: &Rows, (length, regularised): (f64, bool)) -> Result<Iterate, Failure> {
        x.multipliers.iter_mut().enumerate().filter(|(r, _)| !rows.kept(*r)).for_each(|(_, lambda)| *lambda = 0.0);
        self.state.evaluate(self.model, self.set, x, self.loads)?;
        let force = self.state.force(self.free, self.options.tolerance);
        let kept = |state: &State| f64::EPSILON * state.constraint(rows.list().iter().copied());
        let mut constraint = kept(self.state);
        if self.iterates.last().is_some_and(|last| constraint > FALLS * last.constraint) {
            self.state.settle(self.set, &x.u);
            constraint = kept(self.state);
        }
        let iterate = Iterate { force, constraint, length, regularised };
        self.iterates.push(iterate);
        Ok(iterate)
    }

    fn balanced(&self, x: &Unknowns, found: Iterate) -> bool {
        self.arrived(x)
            && found.force <= self.options.tolerance
            && found.constraint <= f64::EPSILON * self.options.roundings
    }

    /// Whether the prescribed DOFs have their values.
    fn arrived(&self, x: &Unknowns) -> bool {
        self.prescribed.iter().all(|&(j, v)| x.u[j] == v)
    }

    /// Rows that are left out too: a row that follows from others may be off by what rounding of those makes of it.
    fn all_hold(&self, rows: &Rows) -> bool {
        let limit = self.options.roundings;
        let holds = |r: usize| self.state.constraints[r] <= limit || self.state.follows(r, rows.because(r), limit);
        (0..self.set.equations()).filter(|&r| !rows.kept(r)).all(holds)
    }

    /// Keeps other rows, those that are independent here.
    fn change(&mut self, rows: &mut Rows) -> Result<(), Failure> {
        self.changes += 1;
        if self.changes > CHANGES || !rows.renew(self.set, &self.state.quantities, self.prescribed, self.options)? {
            let violated = |&r: &usize| self.state.constraints[r] > self.options.roundings;
            return Err(Failure::Conflict((0..self.set.equations()).filter(violated).collect()));
        }
        Ok(())
    }

    /// `-F` on free DOFs and kept rows; what prescribed DOFs have yet to move goes to the right-hand side.
    fn rhs(&self, x: &Unknowns, rows: &Rows) -> Vec<f64> {
        let (g, h) = (self.state.quantities.g(), self.state.quantities.h());
        let mut force: Vec<f64> = self.state.residual.clone();
        let mut c = self.state.quantities.c().to_vec();
        if !self.arrived(x) {
            let mut ahead = vec![0.0; self.set.dofs()];
            self.prescribed.iter().for_each(|&(j, v)| ahead[j] = v - x.u[j]);
            self.state.assembly.entries().for_each(|(i, j, v)| force[i] += v * ahead[j]);
            (0..h.rows()).for_each(|i| h.row(i).for_each(|(j, v)| force[i] += v * ahead[j]));
            (0..g.rows()).for_each(|r| g.row(r).for_each(|(j, v)| c[r] += v * ahead[j]));
        }
        self.free.iter().map(|&j| -force[j]).chain(rows.list().iter().map(|&r| -c[r])).collect()
    }

    /// How far to go; all the way while prescribed DOFs move, and where only rounding is left.
    fn length(
        &mut self,
        saddle: &Saddle,
        x: &Unknowns,
        rows: &Rows,
        (dx, last): (&[f64], f64),
    ) -> Result<f64, Failure> {
        let now = self.iterates.last().copied().unwrap_or_default();
        let near = now.force <= NEAR * self.options.tolerance
            && now.constraint <= NEAR * f64::EPSILON * self.options.roundings;
        if near || !self.arrived(x) {
            return Ok(1.0);
        }
        let size = saddle.length(dx);
        let mut t = if last > 0.0 { (4.0 * last).min(1.0) } else { 1.0 };
        while t >= SHORTEST {
            t = match self.next_correction(saddle, x, rows, (dx, t)) {
                Ok(next) if saddle.length(&next) <= (1.0 - 0.25 * t) * size => return Ok(t),
                Ok(next) => {
                    let off: Vec<f64> = next.iter().zip(dx).map(|(a, b)| a - (1.0 - t) * b).collect();
                    (0.5 * size * t * t / saddle.length(&off)).clamp(0.1 * t, 0.5 * t)
                }
                Err(Failure::Model(_) | Failure::NotFinite { .. }) => 0.25 * t,
                Err(other) => return Err(other),
            };
        }
        Err(Failure::NoConvergence)
    }

    /// `-A^-1 F(x + t dx)`; the forces, c and G of x are lost.
    fn next_correction(
        &mut self,
        saddle: &Saddle,
        x: &Unknowns,
        rows: &Rows,
        (dx, t): (&[f64], f64),
    ) -> Result<Vec<f64>, Failure> {
        let trial = self.moved(x, rows, dx, (t, t));
        self.state.balance(self.model, self.set, &trial, self.loads)?;
        Ok(saddle.solve(&self.rhs(&trial, rows)))
    }

    fn moved(&self, x: &Unknowns, rows: &Rows, dx: &[f64], (t, of_multipliers): (f64, f64)) -> Unknowns {
        let mut x = x.clone();
        self.free.iter().zip(dx).for_each(|(&j, dx)| x.u[j] += t * dx);
        let multipliers = rows.list().iter().zip(&dx[self.free.len()..]);
        multipliers.for_each(|(&r, dx)| x.multipliers[r] += of_multipliers * dx);
        x
    }
}
