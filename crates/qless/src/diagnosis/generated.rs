//! Generated boundary conditions: free DOFs that the equations fix to a value (section 2.2, Figure 6).
//!
//! DOF s is fixed iff it does not move in any vector of the null space of the free part of C. Two random vectors show this without T:
//! u_s is then zero to rounding, and for any other s it is zero with probability zero.

use std::collections::{BTreeMap, HashSet};

use crate::Csr;
use crate::diagnosis::certificate::{CertificateTerm, History};
use crate::diagnosis::nullspace_probe::{InverseEstimate, ProbeSample, RandomKeys, probe};
use crate::factor::backend::sparse;
use crate::factor::backend::{Backend, BackendError};
use crate::factor::block::Block;
use crate::factor::block::dependent::NO_PIVOT;
use crate::factor::lu;
use crate::factor::solver::SlaveSolver;
use crate::input::components::Labels;
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, free, ldexp};
use crate::presolve::basis::{Basis, RowOrigin};

/// A sum that cancels to this fraction of its terms is zero.
const NOISE: f64 = 1e-11;

/// Fixed DOFs, ascending by the user's numbers.
#[derive(Default)]
pub(crate) struct Generated {
    /// The user's numbers and the values.
    pub values: Vec<(usize, f64)>,
    /// The local numbers.
    pub dofs: Vec<u32>,
}

/// The DOFs of `fixed` that also stay at rest in a second probe, with other random values of the masters; ascending by the user's numbers.
pub(crate) fn find(
    mut fixed: Vec<u32>,
    system: LocalSystem,
    basis: &Basis,
    history: &History,
    scaling: &Scaling,
    keys: &RandomKeys,
) -> Vec<u32> {
    if fixed.is_empty() {
        return fixed;
    }
    let again: HashSet<u32> = probe(system, basis, history, scaling, keys, ProbeSample::Second, InverseEstimate::Bound)
        .immobile
        .into_iter()
        .collect();
    fixed.retain(|j| again.contains(j));
    fixed.sort_unstable_by_key(|&j| system.numbering.dofs[j as usize]);
    fixed
}

/// The values `G u_p + g` of fixed DOFs. `is_kept` is true for the independent equations; solving them again may use `memory` bytes.
pub(crate) fn evaluate(
    dofs: Vec<u32>,
    system: LocalSystem,
    basis: &Basis,
    scaling: &Scaling,
    is_kept: impl Fn(usize) -> bool,
    memory: usize,
) -> Generated {
    if dofs.is_empty() {
        return Generated::default();
    }
    let mut u = basis.particular(system, scaling);
    solve_again(system, scaling, is_kept, memory, &mut u);
    let named = |&j: &u32| (system.numbering.dofs[j as usize] as usize, u[j as usize]);
    Generated { values: dofs.iter().map(named).collect(), dofs }
}

/// If u misses the right-hand side of an equation by more than the rounding of its own terms, solves the kept equations of the component
/// again, all together and with a step of refinement. An elimination row by row loses small terms beside large ones.
fn solve_again(system: LocalSystem, scaling: &Scaling, is_kept: impl Fn(usize) -> bool, memory: usize, u: &mut [f64]) {
    let missed = |i: usize, u: &[f64]| {
        let b = system.rhs()[i];
        let parts = system.row(i).map(|(j, v)| v * u[j]);
        let (sum, size) = parts.fold((-b, b.abs()), |(sum, size), part| (sum + part, size.max(part.abs())));
        if b == 0.0 { 0.0 } else { sum.abs() / size }
    };
    let kept: Vec<usize> = (0..system.equations()).filter(|&i| is_kept(i)).collect();
    if !kept.iter().any(|&i| missed(i, u) > NOISE) {
        return;
    }
    let labels = Labels::of(system);
    let mut of_label: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    kept.iter().for_each(|&i| of_label.entry(labels.of_row[i]).or_default().push(i));
    let worst = |rows: &[usize], u: &[f64]| rows.iter().map(|&i| missed(i, u)).fold(0.0, f64::max);
    for rows in of_label.into_values().filter(|rows| worst(rows, u) > NOISE).collect::<Vec<_>>() {
        let mut dofs: Vec<usize> = rows.iter().flat_map(|&i| free(system, i)).map(|(j, _)| j).collect();
        dofs.sort_unstable();
        dofs.dedup();
        let (mut matrix, mut rhs) = (Csr::empty(dofs.len()), Vec::new());
        for &i in &rows {
            let place = |j: usize| dofs.binary_search(&j).unwrap_or_default();
            matrix.append(free(system, i).map(|(j, v)| (place(j), scaling.entry(i, j, v))));
            let given = system.row(i).filter(|&(j, _)| !system.free()[j]).map(|(j, v)| v * u[j]);
            rhs.push(ldexp(system.rhs()[i] - given.sum::<f64>(), scaling.row[i]));
        }
        // DOFs do not ascend within equations; transposing twice sorts them.
        let matrix = matrix.transposed().transposed();
        let Ok(order) = sparse::order(&matrix) else { continue };
        let Ok(lu) = lu::factor(&matrix, &order, |_| true, memory) else { continue };
        let solver = SlaveSolver::new(&matrix, lu);
        let (before, old) = (worst(&rows, u), dofs.iter().map(|&j| u[j]).collect::<Vec<f64>>());
        dofs.iter().for_each(|&j| u[j] = 0.0);
        for (&slave, x) in solver.slaves().iter().zip(solver.solve_dense(&rhs)) {
            let j = dofs[slave as usize];
            u[j] = ldexp(x, scaling.col(j));
        }
        // A solution that is not better, or not finite, is discarded.
        let is_better = worst(&rows, u) < before;
        if !is_better {
            dofs.iter().zip(old).for_each(|(&j, old)| u[j] = old);
        }
    }
}

/// The remainder of a vector after subtracting equations; the keys are (result of [`times`], DOF).
struct GeneratedRemainder {
    parts: BTreeMap<(u32, u32), f64>,
}

impl GeneratedRemainder {
    fn add(&mut self, time: u32, dof: u32, value: f64) {
        *self.parts.entry((time, dof)).or_default() += value;
    }
}

/// Expresses vectors, such as the unit vector `e_s` of a fixed DOF s, by the kept equations: `e_s = sum_i c_i row_i` over the free DOFs.
pub(crate) struct Explainer<'a> {
    pub system: LocalSystem<'a>,
    pub basis: &'a Basis,
    pub blocks: &'a [Block],
    pub history: &'a History,
    pub scaling: &'a Scaling,
    pub backend: &'a dyn Backend,
    /// The result of [`times`].
    pub time: &'a [u32],
}

/// The row of the basis that defines each DOF; for DOFs of block k, the number of rows plus k; `u32::MAX` for other masters and prescribed
/// DOFs.
pub(crate) fn times(basis: &Basis, dofs: usize) -> Vec<u32> {
    let mut time = vec![u32::MAX; dofs];
    basis.slaves().iter().zip(0..).for_each(|(&slave, t)| time[slave as usize] = t);
    for (block, t) in basis.blocks.iter().zip(basis.rows() as u32..) {
        block.dofs.iter().for_each(|&j| time[j as usize] = t);
    }
    time
}

impl Explainer<'_> {
    /// Expresses a vector of free DOFs (local) as a combination of the kept equations, if it is one.
    pub fn because(&self, vector: impl IntoIterator<Item = (u32, f64)>) -> Result<Vec<CertificateTerm>, BackendError> {
        let parts = vector.into_iter().map(|(j, value)| ((self.time[j as usize], j), value)).collect();
        let mut rest = GeneratedRemainder { parts };
        let (mut own, mut of_steps, mut of_blocks) = (Vec::new(), Vec::new(), Vec::new());
        while let Some((&(time, dof), &value)) = rest.parts.first_key_value() {
            if time == u32::MAX {
                break;
            }
            match self.basis.origin(time as usize) {
                RowOrigin::Block(block) => of_blocks.extend(self.take_block(&mut rest, block)?),
                part => {
                    rest.parts.pop_first();
                    let t = time as usize;
                    let terms = self.basis.row(self.system, t).entries();
                    terms.for_each(|(j, v)| rest.add(self.time[j as usize], j, value * v));
                    if part == RowOrigin::Peeled {
                        let row = self.basis.peeled[t];
                        let coefficient = value / self.system.coefficient(row as usize, dof);
                        own.push(CertificateTerm { row: row as usize, coefficient });
                    } else {
                        let step = t - self.basis.peeled.len();
                        let pivot = ldexp(self.basis.pivot_of_step(step), -self.scaling.col(dof as usize));
                        of_steps.push((step as u32, value / pivot));
                    }
                }
            }
        }
        own.extend(self.history.combination(&of_steps, &of_blocks, 0));
        own.retain(|term| term.coefficient != 0.0);
        own.sort_unstable_by_key(|term| term.row);
        Ok(own)
    }

    /// Removes the remainder in all DOFs of one block at once: `C_kept^T y = rest`.
    fn take_block(&self, rest: &mut GeneratedRemainder, k: usize) -> Result<Vec<(u32, f64)>, BackendError> {
        let (block, solved) = (&self.blocks[k], &self.basis.blocks[k]);
        let mut right = vec![0.0; block.dofs.len()];
        for (position, &dof) in block.dofs.iter().enumerate() {
            if let Some(value) = rest.parts.remove(&(self.time[dof as usize], dof)) {
                right[position] = ldexp(value, self.scaling.col(dof as usize));
            }
        }
        let mut columns = Csr::empty(block.dofs.len());
        let kept: Vec<usize> = solved.rows.iter().filter_map(|row| block.rows.binary_search(row).ok()).collect();
        kept.iter().for_each(|&i| columns.append(block.matrix.row(i)));
        let factor = self.backend.factor(&columns, &right, NO_PIVOT)?;
        let y = factor.solved(&factor.rhs);
        let largest = y.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        let terms = y.iter().zip(&factor.order).filter(|(v, _)| v.abs() > NOISE * largest);
        Ok(terms.map(|(v, &i)| (block.rows[kept[i]], ldexp(*v, block.exponents[kept[i]]))).collect())
    }
}
