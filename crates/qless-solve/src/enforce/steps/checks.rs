//! Checks of a step: the model is supported, forces are in balance, and independent equations are satisfied.
//!
//! If all DOFs of an equation are zero up to rounding, its residual has no scale. Its terms therefore count as at least [`FLOOR`] times
//! what they would be if every DOF of its connected part were as large as the largest one, in units that spread from K along the equations.
//! Cost: one pass over C; the units are computed only if an equation fails by its own terms.

use qless::elimination::EliminationError;
use qless::{ConstraintSystem, Elimination, Kind};

use super::super::refinement::{FLOOR, MeasuredEquations, RefinementGoal, refine};
use super::super::singularity::{SHIFTS, SupportVerdict, check_support, null_motion};
use super::super::solver::{Solver, SolverError};
use super::super::{EnforceError, FreeMotion, units};
use super::Steps;
use super::terms::{StepEquations, sizes_of_dofs};

/// Most solves, including refinements.
const REFINEMENTS: usize = 6;

impl<S: Solver> Steps<S> {
    /// Fails if the model is not supported, whether or not its factorization succeeded.
    pub(super) fn check_model(&mut self, k: &[f64], factored: Result<(), EnforceError>) -> Result<(), EnforceError> {
        let terms = StepEquations::new(&self.elimination, &self.pattern, k, (&self.parts, &self.noise));
        let units = terms.units().to_vec();
        let failed = match factored {
            Err(error) => error,
            Ok(()) => match check_support(&terms, &mut |r: &[f64]| backsolve(&mut self.solver, r)) {
                Ok(SupportVerdict::Supported(_)) => return Ok(()),
                Ok(SupportVerdict::Mechanism(motion, resistance)) => {
                    return Err(unsupported(&terms, &motion, resistance));
                }
                Err(error) => error,
            },
        };
        if let Some(alone) = without_terms(&terms) {
            return Err(unsupported(&terms, &alone, 0.0));
        }
        for shift in SHIFTS {
            self.condensed.condense_matrix_into(&self.elimination, k, &mut self.k_q)?;
            if self.factor(shift, &units).is_err() {
                continue;
            }
            let terms = StepEquations::new(&self.elimination, &self.pattern, k, (&self.parts, &self.noise));
            if let Some((motion, resistance)) = null_motion(&terms, &mut |r: &[f64]| backsolve(&mut self.solver, r)) {
                return Err(unsupported(&terms, &motion, resistance));
            }
        }
        // The factors of a shifted matrix must not be used for K.
        Err(failed)
    }

    /// The unknowns, refined until every row is in balance, and their units.
    pub(super) fn solve_balanced(&mut self, k: &[f64], f: &[f64]) -> Result<(Vec<f64>, Vec<f64>), EnforceError> {
        let mut load = vec![0.0; self.condensed.unknowns()];
        self.condensed.load_into(&self.elimination, k, f, &mut load)?;
        let mut constant = vec![0.0; self.elimination.dofs()];
        self.elimination.expand_into(&vec![0.0; load.len()], &mut constant)?;
        let terms = StepEquations::new(&self.elimination, &self.pattern, k, (&self.parts, &self.noise));
        let sizes = terms.size_of_load(f, &constant);
        let solver = &mut self.solver;
        let refined = refine(
            &terms,
            &mut |r: &[f64]| backsolve(solver, r),
            (&load, &sizes),
            &RefinementGoal::balance(REFINEMENTS),
        )?;
        if refined.share > 1.0 {
            let row = format!("the forces on DOF {}", self.elimination.masters()[refined.row]);
            return Err(EnforceError::OutOfBalance { row, imbalance: refined.imbalance });
        }
        Ok((refined.x, terms.units().to_vec()))
    }
}

/// The motion of a single unknown without any stiffness; K_q may not even have its diagonal entry.
fn without_terms(terms: &StepEquations) -> Option<Vec<f64>> {
    let sizes = terms.size(terms.units());
    let alone = |q: usize| {
        let mut motion = vec![0.0; sizes.len()];
        motion[q] = 1.0;
        terms.apply(&motion).iter().all(|force| *force == 0.0).then_some(motion)
    };
    (0..sizes.len()).filter(|&q| sizes[q] == 0.0).find_map(alone)
}

/// `K_q^-1 r`; an error if it is not finite.
fn backsolve(solver: &mut impl Solver, r: &[f64]) -> Result<Vec<f64>, EnforceError> {
    let mut x = r.to_vec();
    if !x.is_empty() {
        solver.solve(&mut x)?;
    }
    if x.iter().all(|x| x.is_finite()) { Ok(x) } else { Err(SolverError("a pivot is zero".into()).into()) }
}

/// The error with the free motion of all DOFs.
fn unsupported(terms: &StepEquations, motion: &[f64], resistance: f64) -> EnforceError {
    let units = terms.spread_units();
    EnforceError::Unsupported(FreeMotion::new(&terms.moved(motion), &units, resistance))
}

/// Largest residual of an equation relative to its terms; T itself satisfies the equations to 1e-10.
const MET: f64 = 1e-9;

/// Fails if u violates an equation; x are the unknowns, with their units.
pub fn check_equations(elimination: &Elimination, (x, units): (&[f64], &[f64]), u: &[f64]) -> Result<(), EnforceError> {
    let (sizes, mut levels) = (sizes_of_dofs(elimination, x), None);
    let system = elimination.analysis().ok_or(EliminationError::NoEquations)?.system();
    for i in (0..system.equations()).filter(|&i| elimination.kinds()[i] == Kind::Independent) {
        let (mut residual, mut size) = (-elimination.rhs()[i], elimination.rhs()[i].abs());
        for (j, v) in system.matrix().row(i) {
            residual += v * u[j];
            size += v.abs() * sizes[j];
        }
        let is_met = |size: f64| residual.abs() <= MET * size;
        if !is_met(size) {
            let levels = levels.get_or_insert_with(|| levelled(elimination, system, units, &sizes));
            let level = system.matrix().row(i).map(|(j, v)| v.abs() * levels[j]).sum::<f64>();
            if !is_met(FLOOR * level) {
                return Err(EnforceError::OutOfBalance {
                    row: system.equation_label(i),
                    imbalance: residual.abs() / size,
                });
            }
        }
    }
    Ok(())
}

/// Each DOF as large as the largest of its connected part; zero if it is prescribed.
fn levelled(elimination: &Elimination, system: &ConstraintSystem, of_masters: &[f64], sizes: &[f64]) -> Vec<f64> {
    let n = elimination.dofs();
    let mut free = vec![true; n];
    elimination.prescribed().iter().for_each(|&j| free[j] = false);
    let rows = 0..system.equations();
    let terms: Vec<_> = rows.flat_map(|i| system.matrix().row(i).map(move |(j, v)| (n + i, j, v))).collect();
    let terms = || terms.iter().copied().filter(|&(_, j, v)| free[j] && v != 0.0);
    let parts = units::parts(n + system.equations(), terms().map(|(i, j, _)| (i, j)));
    let (mut units, mut has_unit) = (vec![0.0; parts.len()], vec![false; parts.len()]);
    elimination.masters().iter().zip(of_masters).for_each(|(&j, &unit)| (units[j], has_unit[parts[j]]) = (unit, true));
    // A component without a unit gets the unit 1.
    (0..n).filter(|&j| parts[j] == j && !has_unit[j]).for_each(|j| units[j] = 1.0);
    units::spread(&mut units, terms());
    let mut largest = vec![0.0_f64; parts.len()];
    let known = |j: &usize| free[*j] && units[*j] > 0.0;
    (0..n).filter(known).for_each(|j| largest[parts[j]] = largest[parts[j]].max(sizes[j] / units[j]));
    (0..n).map(|j| if free[j] { units[j] * largest[parts[j]] } else { 0.0 }).collect()
}
