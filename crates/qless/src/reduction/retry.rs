//! `[T G g] = C_S^-1 [-C_M -C_p b]` from the user's equations for slaves that are chosen, component by component.
//!
//! What presolve and exchanges have left of T may have lost digits. The slaves it led to are good all the same: with them T is
//! computed anew, by sparse LU with a step of refinement.

use super::{Reduction, ReductionError};
use crate::Csr;
use crate::factor::backend::BackendError;
use crate::factor::lu;
use crate::factor::solver::SlaveSolver;
use crate::input::components::Labels;
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, ldexp};

/// What each DOF is.
#[derive(Clone, Copy)]
enum RetriedRole {
    /// Place among the slaves.
    Slave(u32),
    /// Place among the masters.
    Master(u32),
    /// Place among the prescribed DOFs.
    Prescribed(u32),
}

/// Rows of T, G and g of some components (labels, ascending), computed anew; those that cannot be are left out.
pub(super) fn compute(
    local: LocalSystem,
    reduction: &Reduction,
    (independent, labels): (&[bool], &Labels),
    scaling: &Scaling,
    wanted: &[u32],
    memory: usize,
) -> Vec<Option<Row>> {
    let mut equations = vec![Vec::new(); wanted.len()];
    for i in (0..local.equations()).filter(|&i| independent[i]) {
        if let Ok(place) = wanted.binary_search(&labels.of_row[i]) {
            equations[place].push(i);
        }
    }
    let roles = roles(local, reduction);
    let mut rows = vec![None; reduction.slaves.len()];
    for equations in equations {
        let part = RetriedComponent::new(local, &equations, &roles, scaling);
        let Ok(order) = crate::factor::backend::sparse::order(&part.slaves) else { continue };
        let Ok(lu) = lu::factor(&part.slaves, &order, |_| true, memory) else { continue };
        let solver = SlaveSolver::new(&part.slaves, lu);
        let (columns, g) = (solver.solve(&part.right), solver.solve_dense(&part.rhs));
        part.write(&mut rows, &solver, &columns.transposed(), &g);
    }
    rows
}

/// A row of T, one of G, and a number of g.
pub(super) type Row = (Vec<(usize, f64)>, Vec<(usize, f64)>, f64);

fn roles(local: LocalSystem, reduction: &Reduction) -> Vec<RetriedRole> {
    let dofs = &local.numbering.dofs;
    let role = |&j: &u32| {
        let find = |list: &[usize]| list.binary_search(&(j as usize)).ok().map(|place| place as u32);
        let free = || {
            find(&reduction.slaves)
                .map(RetriedRole::Slave)
                .or_else(|| find(&reduction.masters).map(RetriedRole::Master))
        };
        free().unwrap_or_else(|| RetriedRole::Prescribed(find(&reduction.prescribed).unwrap_or_default()))
    };
    dofs.iter().map(role).collect()
}

/// Some components, with numbers of their own; scaled.
struct RetriedComponent {
    /// C_S by rows: slaves in ascending order.
    slaves: Csr,
    /// `-[C_M C_p]` by columns.
    right: Csr,
    rhs: Vec<f64>,
    /// Places in the reduction of the slaves, and exponents of their scaling, ...
    places: Vec<(u32, i32)>,
    /// ... the same of the columns of `right`: masters, then prescribed DOFs.
    others: Vec<(RetriedRole, i32)>,
}

impl RetriedComponent {
    fn new(local: LocalSystem, equations: &[usize], roles: &[RetriedRole], scaling: &Scaling) -> Self {
        let mut dofs: Vec<u32> = equations.iter().flat_map(|&i| local.parts(i).0).copied().collect();
        dofs.sort_unstable();
        dofs.dedup();
        let mut number = vec![0; roles.len()];
        let (mut places, mut others) = (Vec::new(), Vec::new());
        for &j in &dofs {
            let (role, exponent) = (roles[j as usize], scaling.col(j as usize));
            if let RetriedRole::Slave(place) = role {
                number[j as usize] = places.len();
                places.push((place, exponent));
            } else {
                number[j as usize] = others.len();
                others.push((role, exponent));
            }
        }
        let (mut slaves, mut rest) = (Csr::empty(places.len()), Csr::empty(others.len()));
        let is_slave = |j: usize| matches!(roles[j], RetriedRole::Slave(_));
        for &i in equations {
            let scaled = |(j, v): (usize, f64)| (number[j], scaling.entry(i, j, v));
            slaves.append(local.row(i).filter(|&(j, _)| is_slave(j)).map(scaled));
            rest.append(local.row(i).filter(|&(j, _)| !is_slave(j)).map(scaled).map(|(j, v)| (j, -v)));
        }
        let rhs = equations.iter().map(|&i| ldexp(local.rhs()[i], scaling.row[i])).collect();
        // Local numbers do not ascend within rows: transposing twice sorts them.
        Self { slaves: slaves.transposed().transposed(), right: rest.transposed(), rhs, places, others }
    }

    /// Rows of the reduction, by place; row k of `solved` belongs to the slave of step k.
    fn write(&self, rows: &mut [Option<Row>], solver: &SlaveSolver, solved: &Csr, g: &[f64]) {
        for (k, &slave) in solver.slaves().iter().enumerate() {
            let (place, exponent) = self.places[slave as usize];
            let (mut t, mut g_matrix) = (Vec::new(), Vec::new());
            for (c, v) in solved.row(k) {
                let (role, own) = self.others[c];
                let value = ldexp(v, exponent - own);
                match role {
                    RetriedRole::Prescribed(column) => g_matrix.push((column as usize, value)),
                    RetriedRole::Master(column) | RetriedRole::Slave(column) => t.push((column as usize, value)),
                }
            }
            t.sort_unstable_by_key(|&(j, _)| j);
            g_matrix.sort_unstable_by_key(|&(j, _)| j);
            rows[place as usize] = Some((t, g_matrix, ldexp(g[k], exponent)));
        }
    }
}

/// Puts the rows that there are into the reduction.
pub(super) fn replace(reduction: &mut Reduction, rows: &[Option<Row>]) {
    let (mut t, mut g_matrix) = (Csr::empty(reduction.t.cols), Csr::empty(reduction.g_matrix.cols));
    for (i, row) in rows.iter().enumerate() {
        if let Some((of_t, of_g, g)) = row {
            t.append(of_t.iter().copied());
            g_matrix.append(of_g.iter().copied());
            reduction.g[i] = *g;
        } else {
            t.append(reduction.t.row(i));
            g_matrix.append(reduction.g_matrix.row(i));
        }
    }
    (reduction.t, reduction.g_matrix) = (t, g_matrix);
}

impl From<BackendError> for ReductionError {
    fn from(error: BackendError) -> Self {
        Self::Backend(error)
    }
}
