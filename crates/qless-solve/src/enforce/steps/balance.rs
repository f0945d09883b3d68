//! What the forces of a step must meet: a support, and balance.

use super::super::equations::{Equations, Goal, settle};
use super::super::solver::{Solver, SolverError};
use super::super::support::{SHIFTS, Verdict, judged, loose};
use super::super::{EnforceError, Motion};
use super::Steps;
use super::terms::Terms;

/// Solutions and refinements at most.
const REFINEMENTS: usize = 6;

impl<S: Solver> Steps<S> {
    /// Refuses a model that nothing holds, whether its factorization failed or not.
    pub(super) fn held(&mut self, k: &[f64], factored: Result<(), EnforceError>) -> Result<(), EnforceError> {
        let terms = Terms::new(&self.map, &self.pattern, k, (&self.parts, &self.noise));
        let units = terms.units().to_vec();
        let failed = match factored {
            Err(error) => error,
            Ok(()) => match judged(&terms, &mut |r: &[f64]| solved(&mut self.solver, r)) {
                Ok(Verdict::Held(_)) => return Ok(()),
                Ok(Verdict::Loose(motion, held)) => return Err(unsupported(&terms, &motion, held)),
                Err(error) => error,
            },
        };
        if let Some(alone) = without_terms(&terms) {
            return Err(unsupported(&terms, &alone, 0.0));
        }
        for shift in SHIFTS {
            self.condensed.condense_matrix_into(&self.map, k, &mut self.k_q)?;
            if self.factor(shift, &units).is_err() {
                continue;
            }
            let terms = Terms::new(&self.map, &self.pattern, k, (&self.parts, &self.noise));
            if let Some((motion, held)) = loose(&terms, &mut |r: &[f64]| solved(&mut self.solver, r)) {
                return Err(unsupported(&terms, &motion, held));
            }
        }
        // The factors of a shifted matrix are none of K.
        Err(failed)
    }

    /// The unknowns, refined until every row is in balance, and their units.
    pub(super) fn balanced(&mut self, k: &[f64], f: &[f64]) -> Result<(Vec<f64>, Vec<f64>), EnforceError> {
        let mut load = vec![0.0; self.condensed.unknowns()];
        self.condensed.load_into(&self.map, k, f, &mut load)?;
        let mut constant = vec![0.0; self.map.dofs()];
        self.map.expand_into(&vec![0.0; load.len()], &mut constant)?;
        let terms = Terms::new(&self.map, &self.pattern, k, (&self.parts, &self.noise));
        let sizes = terms.size_of_load(f, &constant);
        let solver = &mut self.solver;
        let settled = settle(&terms, &mut |r: &[f64]| solved(solver, r), (&load, &sizes), &Goal::balance(REFINEMENTS))?;
        if settled.share > 1.0 {
            let row = format!("the forces on DOF {}", self.map.masters()[settled.row]);
            return Err(EnforceError::OutOfBalance { row, imbalance: settled.imbalance });
        }
        Ok((settled.x, terms.units().to_vec()))
    }
}

/// The motion of one unknown that no entry of K feels: its place in K_q may not even be there.
fn without_terms(terms: &Terms) -> Option<Vec<f64>> {
    let sizes = terms.size(terms.units());
    let alone = |q: usize| {
        let mut motion = vec![0.0; sizes.len()];
        motion[q] = 1.0;
        terms.apply(&motion).iter().all(|force| *force == 0.0).then_some(motion)
    };
    (0..sizes.len()).filter(|&q| sizes[q] == 0.0).find_map(alone)
}

/// `K_q^-1 r`, if it is one.
fn solved(solver: &mut impl Solver, r: &[f64]) -> Result<Vec<f64>, EnforceError> {
    let mut x = r.to_vec();
    if !x.is_empty() {
        solver.solve(&mut x)?;
    }
    if x.iter().all(|x| x.is_finite()) { Ok(x) } else { Err(SolverError("a pivot is zero".into()).into()) }
}

/// The motion of all DOFs.
fn unsupported(terms: &Terms, motion: &[f64], held: f64) -> EnforceError {
    let units = terms.spread_units();
    EnforceError::Unsupported(Motion::new(&terms.moved(motion), &units, held))
}
