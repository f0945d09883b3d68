//! `G du = -c` analysed: `du_s = T du_q + g`. Where G is constant, a new c needs no new analysis until a step is wanted.
//!
//! A step is `du_q = 0`: of T nothing is needed, and along a chain of bodies it is as large as the square of their number. Connected
//! parts stay factors. Prescribed DOFs have their values from the start, so that their increments are zero.

use qless::{Analysis, Form, Options, analyse};

use super::parts::Columns;
use super::{NewtonError, NewtonOptions, units};
use qless_constraints::{ConstraintSet, Quantities};

/// T may have entries up to this: masters stay where they are, so that T does not enter a step.
const GROWTH: f64 = 1e6;

/// The linearised equations at one iterate.
pub struct Linearisation {
    pub analysis: Analysis,
    /// Whether c is still that of the iterate: which equations are independent depends on G alone, a step does not.
    pub current: bool,
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
        let growth = options.analysis.growth.max(GROWTH);
        // Columns are in units already: what moves little for c is no slave, or steps are as large as it is small.
        let loose = Options { growth, balance: false, ..options.analysis.clone() };
        let analysis = analyse(&system, &loose).map_err(|source| NewtonError::Analysis { step, source })?;
        let increments = vec![0.0; held.len()];
        Ok(Self { analysis, current: true, increments, units })
    }

    /// The same G, for another c.
    pub fn outdated(self) -> Self {
        Self { current: false, ..self }
    }

    /// du with masters staying where they are.
    pub fn step(&self, step: usize) -> Result<Vec<f64>, NewtonError> {
        let reduction = self.analysis.reduction_in(Form::Factored);
        let reduction = reduction.map_err(|source| NewtonError::Reduction { step, source })?;
        let du = reduction.expand(&vec![0.0; reduction.masters().len()], &self.increments);
        let mut du = du.map_err(|source| NewtonError::Argument { step, source })?;
        du.iter_mut().zip(&self.units).for_each(|(du, unit)| *du *= unit);
        Ok(du)
    }
}
