//! Computes multipliers lambda and reactions for the solution u of any solver: `C_S^T lambda = (f - K u)_S`. The index S denotes the
//! slaves.

use super::{Elimination, EliminationError, EliminationSource};
use crate::common::argument::numbers;
use crate::factor::backend::BackendError;
use crate::factor::backend::sparse::order;
use crate::factor::lu;
use crate::factor::solver::SlaveSolver;
use crate::input::numbering::Numbering;
use crate::input::scale::{balanced_where, ldexp};
use crate::{ArgumentError, Csr, Kind, SystemBuilder};

/// Factors of `C_S`, the independent equations in the columns of the slaves.
pub(super) struct MultiplierFactors {
    /// The independent equations.
    equations: Vec<usize>,
    solver: SlaveSolver,
    /// Exponents of the scaling of the equations, so that the factorization does not depend on units.
    of_equations: Vec<i32>,
    /// Exponents of the scaling of the slaves.
    of_slaves: Vec<i32>,
}

impl MultiplierFactors {
    fn new(known: &EliminationSource, slaves: &[usize]) -> Result<Self, BackendError> {
        let system = known.analysis.system();
        // An update changes b and u_p only, so the independent equations stay the same.
        let equations: Vec<usize> =
            (0..known.rhs.len()).filter(|&i| known.analysis.kinds()[i] == Kind::Independent).collect();
        let place = |(j, v): (usize, f64)| slaves.binary_search(&j).ok().map(|k| (k, v));
        // A system needs at least one DOF, even if there are no slaves.
        let mut square = SystemBuilder::new(slaves.len().max(1));
        equations.iter().for_each(|&i| _ = square.equation(system.matrix().row(i).filter_map(place), 0.0));
        let failed = |message: String| BackendError::Failed { backend: "multipliers", message };
        let square = square.build().map_err(|error| failed(error.to_string()))?;
        // The scaling balances the columns of the slaves only, because the factorization contains no masters.
        let (numbering, ..) = Numbering::new(&square);
        let scaling = balanced_where(numbering.view(&square, square.rhs()), |_| true);
        let mut of_slaves = vec![0; slaves.len()];
        numbering.dofs.iter().enumerate().for_each(|(l, &k)| of_slaves[k as usize] = scaling.col(l));
        let mut rows = Csr::empty(slaves.len());
        for (row, exponent) in scaling.row.iter().enumerate() {
            rows.append(square.matrix().row(row).map(|(k, v)| (k, ldexp(v, exponent + of_slaves[k]))));
        }
        let of_equations = scaling.row;
        let memory = known.analysis.options.memory;
        let order = order(&rows).map_err(|error| failed(error.to_string()))?;
        let factors = lu::factor(&rows, &order, |_| true, memory);
        let factors = factors.map_err(|error| error.of_block("multipliers", &rows, memory))?;
        Ok(Self { equations, solver: SlaveSolver::new(&rows, factors), of_equations, of_slaves })
    }
}

impl Elimination {
    /// lambda of `K u + C^T lambda = f`, by equation, from `residual = f - K u` for the solution u of any solver. It is zero for dependent
    /// equations. The first call factors the equations in the columns of the slaves.
    ///
    /// ```
    /// use qless::{Elimination, Options, SystemBuilder};
    /// // u0 = u1 with residual forces 1 and -1: the tie transfers the force 1.
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    /// let elimination = Elimination::new(&builder.build()?, &Options::default())?;
    /// assert_eq!(elimination.multipliers(&[1.0, -1.0])?, [1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EliminationError::NoEquations`], [`EliminationError::Argument`] for a wrong length or a number that is not finite,
    /// [`EliminationError::Backend`].
    pub fn multipliers(&self, residual: &[f64]) -> Result<Vec<f64>, EliminationError> {
        numbers("the residual", residual, self.dofs())?;
        let of_slaves: Vec<f64> = self.slaves().iter().map(|&j| residual[j]).collect();
        let known = self.equations.as_ref().ok_or(EliminationError::NoEquations)?;
        let mut all = vec![0.0; known.rhs.len()];
        let factored = if let Some(factored) = known.multipliers.get() {
            factored
        } else {
            let made = MultiplierFactors::new(known, self.slaves())?;
            known.multipliers.get_or_init(|| made)
        };
        let scaled = |&k: &u32| ldexp(of_slaves[k as usize], factored.of_slaves[k as usize]);
        let by_step: Vec<f64> = factored.solver.slaves().iter().map(scaled).collect();
        let lambda = factored.solver.solve_transposed(&by_step);
        for ((&i, &exponent), lambda) in factored.equations.iter().zip(&factored.of_equations).zip(lambda) {
            let lambda = ldexp(lambda, exponent);
            if !lambda.is_finite() {
                return Err(ArgumentError::Overflow { what: "lambda", place: i }.into());
            }
            all[i] = lambda;
        }
        Ok(all)
    }

    /// The reactions `C^T lambda - (f - K u)` at the prescribed DOFs, in the order of [`Elimination::prescribed`].
    ///
    /// # Errors
    /// [`EliminationError::NoEquations`], [`EliminationError::Argument`] for wrong lengths or numbers that are not finite.
    pub fn reactions(&self, residual: &[f64], multipliers: &[f64]) -> Result<Vec<f64>, EliminationError> {
        let known = self.equations.as_ref().ok_or(EliminationError::NoEquations)?;
        numbers("the residual", residual, self.dofs())?;
        numbers("the list of multipliers", multipliers, known.rhs.len())?;
        let mut forces = vec![0.0; self.dofs()];
        let matrix = known.analysis.system().matrix();
        for (i, lambda) in multipliers.iter().enumerate().filter(|(_, lambda)| **lambda != 0.0) {
            matrix.row(i).for_each(|(j, v)| forces[j] += v * lambda);
        }
        Ok(self.prescribed().iter().map(|&j| forces[j] - residual[j]).collect())
    }

    /// The nonzero forces on fixed DOFs, as `(DOF, force)`. The constraints carry these forces, so they do not change u.
    ///
    /// # Errors
    /// [`EliminationError::NoEquations`], [`EliminationError::Argument`] for a wrong length or a number that is not finite.
    pub fn loads_without_effect(&self, forces: &[f64]) -> Result<Vec<(usize, f64)>, EliminationError> {
        let known = self.equations.as_ref().ok_or(EliminationError::NoEquations)?;
        numbers("the list of forces", forces, self.dofs())?;
        let fixed = known.analysis.generated().iter().map(|&(j, _)| (j, forces[j]));
        Ok(fixed.filter(|&(_, force)| force != 0.0).collect())
    }
}
