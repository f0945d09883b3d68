//! `G du = -c` analysed: `du_s = T du_q + g`. Where G is constant, a new c needs no new factorization.
//!
//! A step is `du_q = 0`: of T nothing is needed, and along a chain of bodies it is as large as the square of their number. Connected
//! parts stay factors. Prescribed DOFs have their values from the start, so that their increments are zero.

use std::sync::Arc;

use qless::{Analysis, Form, Options, Reduction, ReductionError, Refresher, analyse};

use super::parts::Columns;
use super::{NewtonError, NewtonOptions, units};
use crate::{ConstraintSet, Quantities};

/// T may have entries up to this: masters stay where they are, so that T does not enter a step.
const GROWTH: f64 = 1e6;

/// The linearised equations at one iterate.
pub struct Linearisation {
    pub analysis: Arc<Analysis>,
    /// Made when c is new for the first time.
    refresher: Option<Refresher>,
    /// Made when a step is wanted.
    reduction: Option<Reduction>,
    /// Of prescribed DOFs.
    increments: Vec<f64>,
    /// `du_j = s_j y_j`: what was analysed are equations for y.
    pub units: Vec<f64>,
}

impl Linearisation {
    /// Linearises and analyses; DOFs in `held` do not move.
    pub fn new(
        set: &ConstraintSet,
        quantities: &Quantities,
        (held, of): (&[(usize, f64)], &Columns),
        (step, options): (usize, &NewtonOptions),
    ) -> Result<Self, NewtonError> {
        options.analysis.validate().map_err(|source| NewtonError::Analysis { step, source: source.into() })?;
        let increments: Vec<(usize, f64)> = held.iter().map(|&(j, v)| (j, 0.0 * v)).collect();
        let units = units(set, quantities, of).map_err(|source| NewtonError::Argument { step, source })?;
        let system = set
            .linearised_in(&units, quantities, &increments)
            .map_err(|source| NewtonError::System { step, source })?;
        // Along a chain the end moves by its length where the first hinge turns: to avoid that, slaves would have to be looked for far away.
        let loose = Options { growth: options.analysis.growth.max(GROWTH), ..options.analysis.clone() };
        let analysis = analyse(&system, &loose).map_err(|source| NewtonError::Analysis { step, source })?;
        let increments = vec![0.0; held.len()];
        Ok(Self { analysis: Arc::new(analysis), refresher: None, reduction: None, increments, units })
    }

    /// The same G with another c; nothing if that cannot be had without a new analysis.
    pub fn refreshed(mut self, quantities: &Quantities) -> Option<Self> {
        let rhs: Vec<f64> = quantities.c().iter().map(|c| -c).collect();
        let mut reduction = self.take().ok()?;
        let made = || Refresher::new(Arc::clone(&self.analysis)).ok();
        let refresher = self.refresher.take().or_else(made)?;
        refresher.refresh(&rhs, &self.increments, &mut reduction).ok()?;
        self.refresher = Some(refresher);
        self.reduction = Some(reduction);
        Some(self)
    }

    /// du with masters staying where they are.
    pub fn step(&mut self, step: usize) -> Result<Vec<f64>, NewtonError> {
        let reduction = self.take().map_err(|source| NewtonError::Reduction { step, source })?;
        let du = reduction.expand(&vec![0.0; reduction.masters().len()], &self.increments);
        let mut du = du.map_err(|source| NewtonError::Argument { step, source })?;
        du.iter_mut().zip(&self.units).for_each(|(du, unit)| *du *= unit);
        self.reduction = Some(reduction);
        Ok(du)
    }

    fn take(&mut self) -> Result<Reduction, ReductionError> {
        self.reduction.take().map_or_else(|| self.analysis.reduction_in(Form::Factored), Ok)
    }
}
