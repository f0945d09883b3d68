//! The methods of [`Problem`]: one per equation, the same for all, or elimination for sparse blocks and multipliers for the others.
//!
//! A block is a connected component of independent equations and free DOFs. Its fill is predicted before any product is formed: an entry
//! `K_ij` becomes up to `t_i t_j` entries of `T^T K T`, where `t_i` is the number of entries in row i of T.

use faer::sparse::SparseColMat;
use qless::ArgumentError;
use qless::common::DisjointSets;

use super::condensation::elimination_of;
use super::matrix::{entries, from_triplets};
use super::problem::{Problem, Solution};
use super::refinement::BALANCED;
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

    /// Replaces independent equations by stiff springs, `lambda = D (C u - b)`. The error falls as 1 / factor. If the factor is so large
    /// that K loses digits in `K + C^T D C`, the same springs are solved as `[K C^T; C -1/D]`.
    ///
    /// # Errors
    /// As [`Problem::enforce`]; u may differ from the exact solution by a fraction of `accuracy`.
    pub fn penalty(&self, factor: f64, accuracy: f64) -> Result<Solution, EnforceError> {
        self.all(Method::Penalty { factor }, accuracy)
    }

    /// Penalty with multipliers that take over the forces of the springs: `lambda += D (C u - b)`, until the forces are in balance and
    /// every equation holds to `tolerance`, relative to its terms. Springs that close less than nine tenths of a gap per step are replaced
    /// by multipliers at once.
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

/// How a block of equations is enforced; the caller may change `eliminate`.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockPlan {
    /// The equations, ascending.
    pub rows: Vec<usize>,
    /// Predicted fill: number of entries of `T^T K T` per entry of K on slaves of the block, at most.
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
        let block_of = self.blocks();
        let mut names: Vec<usize> = block_of.iter().copied().filter(|&b| b != NONE).collect();
        names.sort_unstable();
        names.dedup();
        let fills = self.fills(&block_of)?;
        let mut plans: Vec<BlockPlan> = names
            .iter()
            .map(|&b| BlockPlan { rows: Vec::new(), fill: fills[b], eliminate: fills[b] <= limit })
            .collect();
        for &row in &self.kept {
            let free = self.free_dofs(row).next();
            let name = free.map_or(0, |dof| names.partition_point(|&b| b < block_of[dof]));
            plans[name].rows.push(row);
        }
        plans.retain(|plan| !plan.rows.is_empty());
        Ok(plans)
    }

    fn free_dofs(&self, row: usize) -> impl Iterator<Item = usize> + '_ {
        let prescribed = self.system.prescribed();
        let free = move |dof: &usize| prescribed.binary_search_by_key(dof, |&(j, _)| j).is_err();
        self.system.matrix().row(row).map(|(dof, _)| dof).filter(free)
    }

    /// The block of each DOF, named by its smallest DOF; [`NONE`] if no equation has the DOF.
    fn blocks(&self) -> Vec<usize> {
        let mut sets = DisjointSets::new(self.system.dofs());
        let mut acts = vec![false; self.system.dofs()];
        for &row in &self.kept {
            let mut first = None;
            for dof in self.free_dofs(row) {
                acts[dof] = true;
                sets.join(*first.get_or_insert(dof), dof);
            }
        }
        (0..acts.len()).map(|dof| if acts[dof] { sets.root(dof) } else { NONE }).collect()
    }

    /// The predicted fill of each block, indexed by its smallest DOF.
    fn fills(&self, block_of: &[usize]) -> Result<Vec<f64>, EnforceError> {
        let elimination = elimination_of(self.system, &self.kept)?;
        let reduction = elimination.reduction();
        let mut weight = vec![1.0; self.system.dofs()];
        let mut slave = vec![false; self.system.dofs()];
        for (i, &dof) in reduction.slaves().iter().enumerate() {
            weight[dof] = reduction.t().row(i).len() as f64;
            slave[dof] = true;
        }
        for block in reduction.factored() {
            let mean = block.predicted() as f64 / block.slaves().len() as f64;
            block.slaves().iter().for_each(|&dof| weight[dof] = mean);
        }
        let (mut after, mut before) = (vec![0.0; weight.len()], vec![0.0; weight.len()]);
        for (i, j, _) in entries(&self.k) {
            for dof in [i, j].into_iter().take(if i == j { 1 } else { 2 }).filter(|&dof| slave[dof]) {
                after[block_of[dof]] += weight[i] * weight[j];
                before[block_of[dof]] += 1.0;
            }
        }
        Ok(after.iter().zip(before).map(|(a, b): (&f64, f64)| if b > 0.0 { a / b } else { 0.0 }).collect())
    }
}

/// Marks a DOF without equations.
const NONE: usize = usize::MAX;
