//! `C^T = [L11; L21] U`, rows in the order of the slaves: sparse LU of independent equations (Gilbert and Peierls 1988).
//!
//! Column k of L and U is an equation. After the earlier equations are eliminated from it, a DOF with one of the largest remaining
//! coefficients becomes its slave, so that `|L_ij|` is bounded by `1 / THRESHOLD`. In practice this also bounds `T^T = -L21 L11^-1`: the
//! columns of the slaves are well-conditioned, because each slave is chosen among all DOFs of its equation. Only operations on nonzeros
//! cost time.

use crate::Csr;
use crate::factor::backend::BackendError;

/// The coefficient of a slave is at least this fraction of the largest one left in its equation among the DOFs that may be slaves.
const THRESHOLD: f64 = 0.9;

/// After the elimination, a number below this fraction of the largest number of its equation is rounding.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// The slaves, and the factors of their columns. Step k eliminates the k-th equation of the order.
#[derive(Clone, Debug)]
pub(crate) struct SparseLu {
    /// The DOF that becomes a slave in each step.
    pub slaves: Vec<u32>,
    /// The equation that is eliminated in each step.
    pub order: Vec<u32>,
    /// The factor L11 of `C^T = [L11; L21] U` by rows, without its diagonal of ones.
    pub l: Csr,
    /// The factor U of `C^T = [L11; L21] U` by rows, without its diagonal.
    pub u: Csr,
    /// The diagonal of the factor U.
    pub diagonal: Vec<f64>,
}

/// Reasons why a factorization fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LuError {
    /// An equation has no DOF left: it depends on earlier equations, or its DOFs may not be slaves.
    Dependent,
    /// The factors need this many bytes, which is more than the limit.
    Memory(usize),
}

impl LuError {
    /// Converts to the error of a backend; `memory` is the limit.
    pub fn of_block(self, backend: &'static str, rows: &Csr, memory: usize) -> BackendError {
        let (rows, cols) = (rows.rows(), rows.cols);
        match self {
            Self::Memory(needed) => BackendError::OverLimit { backend, rows, cols, needed, limit: memory },
            Self::Dependent => {
                let message = format!("the slaves of a block of {rows} x {cols} are not independent");
                BackendError::Failed { backend, message }
            }
        }
    }
}

const NONE: u32 = u32::MAX;

struct LuWork<'a> {
    equations: &'a Csr,
    /// Number of equations of each DOF; [`NONE`] for those that may not be slaves.
    count: Vec<u32>,
    step_of: Vec<u32>,
    /// The start of each column of the factor L, without its diagonal. The next two fields are the DOFs and the values of the entries.
    start: Vec<usize>,
    dofs: Vec<u32>,
    values: Vec<f64>,
    /// The factor U by columns.
    upper: Csr,
    slaves: Vec<u32>,
    diagonal: Vec<f64>,
    /// The current equation, by DOF.
    x: Vec<f64>,
    /// The last step that reached each DOF.
    seen: Vec<u32>,
    /// The DOFs of the current equation, in the order of [`LuWork::reach`].
    reached: Vec<u32>,
    stack: Vec<(u32, usize)>,
}

/// Factors `equations` (r x n, independent) in the fill-reducing `order`, in at most `memory` bytes. Slaves are chosen among the DOFs for
/// which `may` is true.
pub(crate) fn factor(
    equations: &Csr,
    order: &[usize],
    may: impl Fn(usize) -> bool,
    memory: usize,
) -> Result<SparseLu, LuError> {
    let n = equations.cols;
    let mut count = vec![0; n];
    equations.col.iter().for_each(|&j| count[j as usize] += 1);
    (0..n).filter(|&j| !may(j)).for_each(|j| count[j] = NONE);
    let mut work = LuWork {
        equations,
        count,
        step_of: vec![NONE; n],
        start: vec![0],
        dofs: Vec::new(),
        values: Vec::new(),
        upper: Csr::empty(order.len()),
        slaves: Vec::with_capacity(order.len()),
        diagonal: Vec::with_capacity(order.len()),
        x: vec![0.0; n],
        seen: vec![NONE; n],
        reached: Vec::new(),
        stack: Vec::new(),
    };
    for (k, &equation) in order.iter().enumerate() {
        work.reach(k as u32, equation);
        work.eliminate(k, equation)?;
        // The factors L and U exist twice while they are converted from columns to rows.
        let bytes = 32 * (work.values.len() + work.upper.nnz());
        if bytes > memory {
            return Err(LuError::Memory(bytes));
        }
    }
    Ok(work.finish(order))
}

impl LuWork<'_> {
    /// Lists the DOFs that the equation contains after the elimination. Each DOF follows those whose coefficients change when it is
    /// eliminated.
    fn reach(&mut self, k: u32, equation: usize) {
        self.reached.clear();
        for (j, _) in self.equations.row(equation) {
            if self.seen[j] == k {
                continue;
            }
            self.seen[j] = k;
            self.stack.push((j as u32, 0));
            while let Some((dof, next)) = self.stack.pop() {
                let column = self.column(dof);
                let rest = &self.dofs[column.start + next..column.end];
                match rest.iter().position(|&child| self.seen[child as usize] != k) {
                    Some(at) => {
                        let child = rest[at];
                        self.stack.push((dof, next + at + 1));
                        self.seen[child as usize] = k;
                        self.stack.push((child, 0));
                    }
                    None => self.reached.push(dof),
                }
            }
        }
    }

    /// The range of a slave's column in the factor L; empty for a master.
    fn column(&self, dof: u32) -> std::ops::Range<usize> {
        match self.step_of[dof as usize] {
            NONE => 0..0,
            step => self.start[step as usize]..self.start[step as usize + 1],
        }
    }

    fn eliminate(&mut self, k: usize, equation: usize) -> Result<(), LuError> {
        self.equations.row(equation).for_each(|(j, v)| self.x[j] = v);
        let mut column = Vec::new();
        let mut largest = 0.0_f64;
        for at in (0..self.reached.len()).rev() {
            let dof = self.reached[at];
            let value = self.x[dof as usize];
            largest = largest.max(value.abs());
            if self.step_of[dof as usize] != NONE && value != 0.0 {
                for place in self.column(dof) {
                    self.x[self.dofs[place] as usize] -= self.values[place] * value;
                }
                column.push((self.step_of[dof as usize] as usize, value));
            }
        }
        self.upper.append(column);
        self.choose(k, ROUNDING * largest)
    }

    /// Chooses the slave of step k, and stores the rest of the equation as a column of the factor L.
    fn choose(&mut self, k: usize, rounding: f64) -> Result<(), LuError> {
        let left = |&&dof: &&u32| self.step_of[dof as usize] == NONE;
        let may = |&&dof: &&u32| self.count[dof as usize] != NONE;
        let size = |dof: u32| self.x[dof as usize].abs();
        let largest = self.reached.iter().filter(left).filter(may).fold(0.0, |most: f64, &dof| most.max(size(dof)));
        let fit = self.reached.iter().filter(left).filter(may).filter(|&&dof| size(dof) >= THRESHOLD * largest);
        let slave = fit.copied().min_by_key(|&dof| (self.count[dof as usize], dof));
        let Some(slave) = slave.filter(|_| largest > 0.0) else { return Err(LuError::Dependent) };
        let pivot = self.x[slave as usize];
        for &dof in &self.reached {
            let value = std::mem::take(&mut self.x[dof as usize]);
            if self.step_of[dof as usize] == NONE && dof != slave && value.abs() > rounding {
                self.dofs.push(dof);
                self.values.push(value / pivot);
            }
        }
        self.start.push(self.dofs.len());
        self.step_of[slave as usize] = k as u32;
        self.slaves.push(slave);
        self.diagonal.push(pivot);
        Ok(())
    }

    fn finish(self, order: &[usize]) -> SparseLu {
        let mut columns = Csr::empty(order.len());
        for k in 0..order.len() {
            let places = self.start[k]..self.start[k + 1];
            let of_slaves = places.filter(|&place| self.step_of[self.dofs[place] as usize] != NONE);
            columns
                .append(of_slaves.map(|place| (self.step_of[self.dofs[place] as usize] as usize, self.values[place])));
        }
        SparseLu {
            slaves: self.slaves,
            order: order.iter().map(|&i| i as u32).collect(),
            l: columns.transposed(),
            u: self.upper.transposed(),
            diagonal: self.diagonal,
        }
    }
}
