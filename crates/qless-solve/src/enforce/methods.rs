//! Solves a [`Problem`] with a method for each equation, one method for all, or elimination for sparse blocks and multipliers for the
//! others.
//!
//! A block is a connected component of independent equations and free DOFs. Its fill is predicted before any product is formed: an entry
//! `K_ij` becomes up to `t_i t_j` entries of `T^T K T`, where `t_i` is the number of entries in row i of T.

use std::collections::BTreeMap;

use faer::sparse::SparseColMat;
use qless::ArgumentError;

use super::equations::BALANCED;
use super::matrix::{bordered, entries, from_triplets};
use super::problem::{Problem, Solution};
use super::saddle::elimination_of;
use super::scale::parts;
use super::{EnforceError, Method, solve};

impl Problem<'_> {
    /// Enforces each equation by its own method, in one solve. The methods of redundant equations are ignored.
    ///
    /// `accuracy` bounds the error of equations with springs: the relative error of u for penalties, `|C_i u - b_i|` relative to its terms
    /// for augmented equations. Elimination and multipliers leave rounding only.
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
    /// [`EnforceError::Unsupported`] with the motion that nothing resists; [`EnforceError::PenaltyTooSmall`] with a sufficient factor;
    /// [`EnforceError::NoConvergence`] if rounding keeps augmented equations from the accuracy; [`EnforceError::OutOfBalance`] if rounding
    /// leaves more than 1e-10 of the terms of a row, or no digit of u; [`EnforceError::Doubtful`] if an equation may be redundant or not
    /// and u depends on it; [`EnforceError::OutOfRange`] if the solution leaves the range of doubles; [`EnforceError::Argument`] for a list
    /// of the wrong length; [`EnforceError::Factor`] and [`EnforceError::Accuracy`] for numbers that are not positive.
    pub fn enforce(&self, methods: &[Method], accuracy: f64) -> Result<Solution, EnforceError> {
        let (found, expected) = (methods.len(), self.system.equations());
        if found != expected {
            return Err(ArgumentError::WrongLength { what: "the list of methods", found, expected }.into());
        }
        methods.iter().try_for_each(|method| method.checked())?;
        if !(accuracy > 0.0 && accuracy.is_finite()) {
            return Err(EnforceError::Accuracy(accuracy));
        }
        solve::run(self, methods, accuracy)
    }

    fn all(&self, method: Method, accuracy: f64) -> Result<Solution, EnforceError> {
        self.enforce(&vec![method; self.system.equations()], accuracy)
    }

    /// Eliminates all slaves: `K* = T^T K T`, `f* = T^T (f - K u_0)` (Eq. 7-9).
    ///
    /// Connected parts whose T would fill ([`qless::Form::Auto`]) get multipliers in the same matrix; the solution is the same.
    ///
    /// # Errors
    /// As [`Problem::enforce`].
    pub fn transformation(&self) -> Result<Solution, EnforceError> {
        self.all(Method::Elimination, BALANCED)
    }

    /// Gives each independent equation a multiplier (Eq. 10).
    ///
    /// # Errors
    /// As [`Problem::enforce`].
    pub fn lagrange(&self) -> Result<Solution, EnforceError> {
        self.all(Method::Multiplier, BALANCED)
    }

    /// Replaces independent equations by stiff springs, `lambda = D (C u - b)`. The error falls as 1 / factor. The springs are solved as
    /// `[K C^T; C -1/D]`, so that K loses no digits in `K + C^T D C`.
    ///
    /// # Errors
    /// As [`Problem::enforce`]; the relative error of u may reach `accuracy`.
    pub fn penalty(&self, factor: f64, accuracy: f64) -> Result<Solution, EnforceError> {
        self.all(Method::Penalty { factor }, accuracy)
    }

    /// Computes the limit of the augmented Lagrange steps `lambda += D (C u - b)`, in which multipliers take over the forces of the
    /// springs. Every equation holds to `tolerance`, relative to its terms, for any factor.
    ///
    /// # Errors
    /// As [`Problem::enforce`].
    pub fn augmented(&self, factor: f64, tolerance: f64) -> Result<Solution, EnforceError> {
        self.all(Method::Augmented { factor }, tolerance)
    }

    /// Eliminates the blocks that the plan ([`Problem::plan`]) marks so, as in [`Problem::transformation`]; the others get multipliers.
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

    /// Lagrange's matrix `[K C^T; C 0]` of the equations `rows` on the DOFs that are not prescribed (Eq. 10); not scaled.
    ///
    /// A redundant equation among them makes it singular, whatever K is.
    ///
    /// # Errors
    /// [`EnforceError::Argument`] for a row out of range, another [`EnforceError`] if the matrix does not fit into memory.
    pub fn lagrange_matrix(&self, rows: &[usize]) -> Result<SparseColMat<usize, f64>, EnforceError> {
        let count = self.system.equations();
        if let Some(&found) = rows.iter().find(|&&row| row >= count) {
            return Err(ArgumentError::OutOfRange { what: "equation", found, count }.into());
        }
        let of_row = |(i, &row): (usize, &usize)| self.system.matrix().row(row).map(move |(j, v)| (i, j, v));
        let all = bordered(&self.k, rows.iter().enumerate().flat_map(of_row), &vec![0.0; rows.len()])?;
        let mut place = vec![Some(0); all.nrows()];
        self.system.prescribed().iter().for_each(|&(j, _)| place[j] = None);
        place.iter_mut().flatten().enumerate().for_each(|(next, place)| *place = next);
        let size = place.iter().flatten().count();
        let free = entries(&all).filter_map(|(i, j, v)| Some((place[i]?, place[j]?, v)));
        from_triplets(size, size, free)
    }
}

/// How a block of equations is enforced; the caller may change `eliminate`.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockPlan {
    /// The equations of the block, ascending.
    pub rows: Vec<usize>,
    /// Predicted fill: entries of `T^T K T` per entry of K in the rows and columns of the block's slaves.
    pub fill: f64,
    /// Whether slaves are eliminated; otherwise each equation gets a multiplier.
    pub eliminate: bool,
}

impl Problem<'_> {
    /// Plans elimination for the blocks whose predicted fill is at most `limit`, such as 10, and multipliers for the others.
    ///
    /// ```
    /// use faer::sparse::{SparseColMat, Triplet};
    /// use qless::SystemBuilder;
    /// use qless_solve::enforce::Problem;
    /// let diagonal: Vec<_> = (0..9).map(|j| Triplet::new(j, j, 1.0)).collect();
    /// let k = SparseColMat::try_new_from_triplets(9, 9, &diagonal)?;
    /// let mut builder = SystemBuilder::new(9);
    /// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    /// builder.equation((2..9).map(|j| (j, 1.0)), 1.0);
    /// let system = builder.build()?;
    /// let problem = Problem::new(&k, &[0.0; 9], &system)?;
    /// // The mean of seven DOFs makes 36 entries of one.
    /// let plan = problem.plan(10.0)?;
    /// assert_eq!((plan[0].fill, plan[0].eliminate), (1.0, true));
    /// assert_eq!((plan[1].fill, plan[1].eliminate), (36.0, false));
    /// assert!((problem.mixed(&plan)?.u[4] - 1.0 / 7.0).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EnforceError::Limit`] if the limit is negative or not a number, another [`EnforceError`] if the independent equations cannot be
    /// reduced.
    pub fn plan(&self, limit: f64) -> Result<Vec<BlockPlan>, EnforceError> {
        if limit.is_nan() || limit < 0.0 {
            return Err(EnforceError::Limit(limit));
        }
        let (n, prescribed) = (self.system.dofs(), self.system.prescribed());
        let is_free = |dof: usize| prescribed.binary_search_by_key(&dof, |&(j, _)| j).is_err();
        let terms = self.kept.iter().flat_map(|&row| self.system.matrix().row(row).map(move |(j, _)| (n + row, j)));
        let block = parts(n + self.system.equations(), terms.filter(|&(_, j)| is_free(j)));
        let (length, is_slave) = self.lengths_of_t()?;
        // For each block, the number of entries of T^T K T, and of K in the rows and columns of slaves.
        let mut counts = vec![(0.0, 0.0); n];
        for (i, j, _) in entries(&self.k) {
            for dof in [i, j].into_iter().take(if i == j { 1 } else { 2 }).filter(|&dof| is_slave[dof]) {
                let (after, before): &mut (f64, f64) = &mut counts[block[dof]];
                *after += length[i] * length[j];
                *before += 1.0;
            }
        }
        let mut plans = BTreeMap::<usize, BlockPlan>::new();
        for &row in &self.kept {
            let (after, before) = counts[block[n + row]];
            let fill = if before > 0.0 { after / before } else { 0.0 };
            let new = || BlockPlan { rows: Vec::new(), fill, eliminate: fill <= limit };
            plans.entry(block[n + row]).or_insert_with(new).rows.push(row);
        }
        Ok(plans.into_values().collect())
    }

    /// For each DOF, the number of entries in its row of T, and whether it is a slave. Masters count 1; slaves of a factored block count
    /// the predicted mean.
    fn lengths_of_t(&self) -> Result<(Vec<f64>, Vec<bool>), EnforceError> {
        let elimination = elimination_of(self.system, &self.kept)?;
        let reduction = elimination.reduction();
        let (mut length, mut is_slave) = (vec![1.0; self.system.dofs()], vec![false; self.system.dofs()]);
        for (i, &dof) in reduction.slaves().iter().enumerate() {
            (length[dof], is_slave[dof]) = (reduction.t().row(i).len() as f64, true);
        }
        for block in reduction.factored() {
            let mean = block.predicted() as f64 / block.slaves().len() as f64;
            block.slaves().iter().for_each(|&dof| length[dof] = mean);
        }
        Ok((length, is_slave))
    }
}
