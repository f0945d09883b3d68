//! The methods: one for each equation, and the same for all by name.

use faer::sparse::SparseColMat;
use qless::ArgumentError;

use super::super::equations::BALANCED;
use super::super::matrix::{entries, from_triplets};
use super::super::{BlockPlan, EnforceError, Method, run};
use super::{Problem, Solution};

impl Problem<'_> {
    /// One method for each equation, in one solve; those of redundant equations do not matter.
    ///
    /// `accuracy` is what may be left of equations with springs: for penalties the share of u by which it may differ from the exact
    /// one, for augmented equations `|C_i u - b_i|` relative to its terms. Elimination and multipliers leave rounding alone.
    ///
    /// ```
    /// use faer::sparse::{SparseColMat, Triplet};
    /// use qless::SystemBuilder;
    /// use qless_solve::enforce::{Method, Problem};
    /// // Four springs to the ground in a row of ties, one of each kind, under a load of 10: stiffness 1 + 2 + 3 + 4.
    /// let diagonal: Vec<_> = (0..4).map(|j| Triplet::new(j, j, 1.0 + j as f64)).collect();
    /// let k = SparseColMat::try_new_from_triplets(4, 4, &diagonal)?;
    /// let mut builder = SystemBuilder::new(4);
    /// for j in 0..3 {
    ///     builder.equation([(j, 1.0), (j + 1, -1.0)], 0.0);
    /// }
    /// let system = builder.build()?;
    /// let problem = Problem::new(&k, &[10.0, 0.0, 0.0, 0.0], &system)?;
    /// let methods = [Method::Elimination, Method::Multiplier, Method::Augmented { factor: 1e4 }];
    /// let solution = problem.enforce(&methods, 1e-12)?;
    /// assert!(solution.u.iter().all(|u| (u - 1.0).abs() < 1e-12));
    /// assert!((solution.multipliers[0] - 9.0).abs() < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EnforceError::Unsupported`] with the motion that nothing holds; [`EnforceError::PenaltyTooSmall`] with a factor that would do;
    /// [`EnforceError::NoConvergence`] where rounding leaves more of augmented equations than was asked for;
    /// [`EnforceError::OutOfBalance`] where it leaves more than 1e-10 of the terms of a row, or no digit of u;
    /// [`EnforceError::Doubtful`] where u depends on whether an equation is redundant, and that is in doubt;
    /// [`EnforceError::OutOfRange`] where the solution leaves the range of doubles; [`EnforceError::Argument`] for a list of the wrong
    /// length, [`EnforceError::Factor`] for the factor of any equation, [`EnforceError::Accuracy`].
    pub fn enforce(&self, methods: &[Method], accuracy: f64) -> Result<Solution, EnforceError> {
        let (found, expected) = (methods.len(), self.system.equations());
        if found != expected {
            return Err(ArgumentError::WrongLength { what: "the list of methods", found, expected }.into());
        }
        methods.iter().try_for_each(|method| method.checked())?;
        if !(accuracy > 0.0 && accuracy.is_finite()) {
            return Err(EnforceError::Accuracy(accuracy));
        }
        run::run(self, methods, accuracy)
    }

    fn all(&self, method: Method, accuracy: f64) -> Result<Solution, EnforceError> {
        self.enforce(&vec![method; self.system.equations()], accuracy)
    }

    /// All slaves eliminated: `K* = T^T K T`, `f* = T^T (f - K u_0)` (Eq. 7-9).
    ///
    /// Connected parts of which T would fill ([`qless::Form::Auto`]) get multipliers in the same matrix: the solution is the same.
    ///
    /// # Errors
    /// As [`Problem::enforce`].
    pub fn transformation(&self) -> Result<Solution, EnforceError> {
        self.all(Method::Elimination, BALANCED)
    }

    /// A multiplier for each independent equation (Eq. 10).
    ///
    /// # Errors
    /// As [`Problem::enforce`].
    pub fn lagrange(&self) -> Result<Solution, EnforceError> {
        self.all(Method::Multiplier, BALANCED)
    }

    /// Independent equations as stiff springs; `lambda = D (C u - b)`. What the springs leave falls as 1 / factor; where the factor is so large
    /// that rounding of `K + C^T D C` shows, the same springs are solved beside K instead of in it.
    ///
    /// # Errors
    /// As [`Problem::enforce`], where u may differ from the exact one by a share of `accuracy`.
    pub fn penalty(&self, factor: f64, accuracy: f64) -> Result<Solution, EnforceError> {
        self.all(Method::Penalty { factor }, accuracy)
    }

    /// Penalty with multipliers that take over step by step: `lambda += D (C u - b)`, until every equation holds to
    /// `tolerance`, relative to its terms, and the forces are in balance. Springs of which a step closes less than nine tenths of a gap are
    /// replaced by multipliers at once.
    ///
    /// # Errors
    /// As [`Problem::enforce`].
    pub fn augmented(&self, factor: f64, tolerance: f64) -> Result<Solution, EnforceError> {
        self.all(Method::Augmented { factor }, tolerance)
    }

    /// Elimination of the blocks that are planned so, as in [`Problem::transformation`], multipliers on the others ([`Problem::plan`]).
    ///
    /// # Errors
    /// [`EnforceError::Plan`] if the plan does not have each independent equation once, and as [`Problem::enforce`].
    pub fn mixed(&self, plan: &[BlockPlan]) -> Result<Solution, EnforceError> {
        let mut planned: Vec<usize> = plan.iter().flat_map(|block| block.rows.iter().copied()).collect();
        planned.sort_unstable();
        if planned != self.kept {
            return Err(EnforceError::Plan { planned: planned.len(), kept: self.kept.len() });
        }
        let mut methods = vec![Method::Multiplier; self.system.equations()];
        let eliminated = plan.iter().filter(|block| block.eliminate).flat_map(|block| &block.rows);
        eliminated.for_each(|&row| methods[row] = Method::Elimination);
        self.enforce(&methods, BALANCED)
    }

    /// Lagrange's matrix `[K C^T; C 0]` on the DOFs that are not prescribed, for the equations `rows` (Eq. 10); not scaled.
    ///
    /// With a redundant equation among them it is singular, whatever K is.
    ///
    /// # Errors
    /// [`EnforceError::Argument`] for a row that is not there, another [`EnforceError`] if the matrix does not fit into memory.
    pub fn lagrange_matrix(&self, rows: &[usize]) -> Result<SparseColMat<usize, f64>, EnforceError> {
        let count = self.system.equations();
        if let Some(&found) = rows.iter().find(|&&row| row >= count) {
            return Err(ArgumentError::OutOfRange { what: "equation", found, count }.into());
        }
        let n = self.system.dofs();
        let mut free = vec![true; n];
        self.system.prescribed().iter().for_each(|&(j, _)| free[j] = false);
        let of_row = |(i, &row): (usize, &usize)| self.system.matrix().row(row).map(move |(j, v)| (n + i, j, v));
        let border = rows.iter().enumerate().flat_map(of_row).flat_map(|(i, j, v)| [(i, j, v), (j, i, v)]);
        free.resize(n + rows.len(), true);
        let place: Vec<usize> =
            free.iter().scan(0, |next, &free| Some(std::mem::replace(next, *next + usize::from(free)))).collect();
        let size = free.iter().filter(|free| **free).count();
        let all = entries(&self.k).chain(border).filter(|&(i, j, _)| free[i] && free[j]);
        from_triplets(size, size, all.map(|(i, j, v)| (place[i], place[j], v)))
    }
}
