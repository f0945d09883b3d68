//! Eliminate where T stays sparse, multipliers where it would fill: a choice for each block of equations.
//!
//! A block is a connected component of independent equations and free DOFs. Its fill is predicted before any product is formed:
//! an entry `K_ij` becomes up to `t_i t_j` entries of `T^T K T`, where `t_i` is the number of entries in row i of T.

use super::condensation::map_of;
use super::matrix::entries;
use super::scale::root;
use super::{EnforceError, Problem};

/// How a block of equations is to be enforced; a caller may change `eliminate`.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockPlan {
    /// The equations, ascending.
    pub rows: Vec<usize>,
    /// Entries of `T^T K T` that come from entries of K on slaves of the block, at most, per such entry.
    pub fill: f64,
    /// Whether slaves are eliminated; otherwise each equation gets a multiplier.
    pub eliminate: bool,
}

impl Problem<'_> {
    /// Eliminates the blocks whose predicted fill is at most `limit`, such as 10.
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
    /// [`EnforceError::Limit`] for a limit that is no number or negative, another [`EnforceError`] if the independent equations cannot be
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

    /// The block of each DOF, named by its smallest DOF; none where no equation acts.
    fn blocks(&self) -> Vec<usize> {
        let mut parent: Vec<usize> = (0..self.system.dofs()).collect();
        let mut acts = vec![false; self.system.dofs()];
        for &row in &self.kept {
            let mut first = None;
            for dof in self.free_dofs(row) {
                acts[dof] = true;
                let (a, b) = (root(&mut parent, *first.get_or_insert(dof)), root(&mut parent, dof));
                parent[a.max(b)] = a.min(b);
            }
        }
        (0..parent.len()).map(|dof| if acts[dof] { root(&mut parent, dof) } else { NONE }).collect()
    }

    /// The predicted fill of each block, by its name.
    fn fills(&self, block_of: &[usize]) -> Result<Vec<f64>, EnforceError> {
        let map = map_of(self.system, &self.kept)?;
        let reduction = map.reduction();
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

/// A DOF that no equation acts on.
const NONE: usize = usize::MAX;
