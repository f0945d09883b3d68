//! `[T G g] = C_S^-1 [-C_M -C_p b]` from the user's equations for slaves that are chosen, component by component.
//!
//! What presolve and exchanges have left of T may have lost digits. The slaves it led to are good all the same: with them T is
//! computed anew, by sparse LU with a step of refinement.

use super::{Reduction, ReductionError};
use crate::Csr;
use crate::block::lu;
use crate::block::solver::Solver;
use crate::components::Labels;
use crate::local::Local;
use crate::qr::BackendError;
use crate::scale::{Scaling, ldexp};

/// What each DOF is.
#[derive(Clone, Copy)]
enum Role {
    /// Place among the slaves.
    Slave(u32),
    /// Place among the masters.
    Master(u32),
    /// Place among the prescribed DOFs.
    Prescribed(u32),
}

/// Rows of T, G and g of the components that hold the `rows`, computed anew.
pub(super) fn compute(
    local: Local,
    reduction: &mut Reduction,
    independent: &[bool],
    scaling: &Scaling,
    rows: &[usize],
    memory: usize,
) -> Result<(), ReductionError> {
    let labels = Labels::of(local);
    let mut wanted = vec![false; labels.count];
    rows.iter().for_each(|&i| wanted[labels.of_row[i] as usize] = true);
    let equations: Vec<usize> =
        (0..local.equations()).filter(|&i| independent[i] && wanted[labels.of_row[i] as usize]).collect();
    let roles = roles(local, reduction);
    let part = Part::new(local, &equations, &roles, scaling);
    let order = crate::qr::sparse::order(&part.slaves.transpose())?;
    let lu = lu::factor(&part.slaves, &order, |_| true, memory)
        .map_err(|error| error.of_block("sparse LU", &part.slaves, memory))?;
    let solver = Solver::new(&part.slaves, lu);
    let (columns, g) = (solver.solve(&part.right), solver.solve_dense(&part.rhs));
    part.write(reduction, &solver, &columns.transpose(), &g);
    Ok(())
}

fn roles(local: Local, reduction: &Reduction) -> Vec<Role> {
    let dofs = &local.numbering.dofs;
    let role = |&j: &u32| {
        let find = |list: &[usize]| list.binary_search(&(j as usize)).ok().map(|place| place as u32);
        let free = || find(&reduction.slaves).map(Role::Slave).or_else(|| find(&reduction.masters).map(Role::Master));
        free().unwrap_or_else(|| Role::Prescribed(find(&reduction.prescribed).unwrap_or_default()))
    };
    dofs.iter().map(role).collect()
}

/// Some components, with numbers of their own; scaled.
struct Part {
    /// C_S by rows: slaves in ascending order.
    slaves: Csr,
    /// `-[C_M C_p]` by columns.
    right: Csr,
    rhs: Vec<f64>,
    /// Places in the reduction of the slaves, and exponents of their scaling, ...
    places: Vec<(u32, i32)>,
    /// ... the same of the columns of `right`: masters, then prescribed DOFs.
    others: Vec<(Role, i32)>,
}

impl Part {
    fn new(local: Local, equations: &[usize], roles: &[Role], scaling: &Scaling) -> Self {
        let mut dofs: Vec<u32> = equations.iter().flat_map(|&i| local.parts(i).0).copied().collect();
        dofs.sort_unstable();
        dofs.dedup();
        let mut number = vec![0; roles.len()];
        let (mut places, mut others) = (Vec::new(), Vec::new());
        for &j in &dofs {
            let (role, exponent) = (roles[j as usize], scaling.col(j as usize));
            if let Role::Slave(place) = role {
                number[j as usize] = places.len();
                places.push((place, exponent));
            } else {
                number[j as usize] = others.len();
                others.push((role, exponent));
            }
        }
        let (mut slaves, mut rest) = (Csr::empty(places.len()), Csr::empty(others.len()));
        let is_slave = |j: usize| matches!(roles[j], Role::Slave(_));
        for &i in equations {
            let scaled = |(j, v): (usize, f64)| (number[j], scaling.entry(i, j, v));
            slaves.push_row(local.row(i).filter(|&(j, _)| is_slave(j)).map(scaled));
            rest.push_row(local.row(i).filter(|&(j, _)| !is_slave(j)).map(scaled).map(|(j, v)| (j, -v)));
        }
        let rhs = equations.iter().map(|&i| ldexp(local.rhs()[i], scaling.row[i])).collect();
        Self { slaves, right: rest.transpose(), rhs, places, others }
    }

    /// Replaces rows of the reduction; row k of `solved` belongs to the slave of step k.
    fn write(&self, reduction: &mut Reduction, solver: &Solver, solved: &Csr, g: &[f64]) {
        let mut step = vec![u32::MAX; reduction.slaves.len()];
        for (&slave, k) in solver.slaves().iter().zip(0..) {
            let (place, exponent) = self.places[slave as usize];
            step[place as usize] = k;
            reduction.g[place as usize] = ldexp(g[k as usize], exponent);
        }
        let exponent = |k: u32| self.places[solver.slaves()[k as usize] as usize].1;
        let row = |k: u32, column: &dyn Fn(Role) -> Option<u32>| {
            let entry = |(c, v): (usize, f64)| {
                let (role, own) = self.others[c];
                Some((column(role)? as usize, ldexp(v, exponent(k) - own)))
            };
            let mut entries: Vec<_> = solved.row(k as usize).filter_map(entry).collect();
            entries.sort_unstable_by_key(|&(j, _)| j);
            entries
        };
        let free = |role| if let Role::Master(place) = role { Some(place) } else { None };
        let fixed = |role| if let Role::Prescribed(place) = role { Some(place) } else { None };
        replace(&mut reduction.t, &step, &|k| row(k, &free));
        replace(&mut reduction.g_matrix, &step, &|k| row(k, &fixed));
    }
}

/// Row i becomes `row(step[i])` where there is such a step.
fn replace(matrix: &mut Csr, step: &[u32], row: &dyn Fn(u32) -> Vec<(usize, f64)>) {
    let mut new = Csr::empty(matrix.cols);
    for (i, &k) in step.iter().enumerate() {
        match k {
            u32::MAX => new.push_row(matrix.row(i)),
            k => new.push_row(row(k)),
        }
    }
    *matrix = new;
}

impl From<BackendError> for ReductionError {
    fn from(error: BackendError) -> Self {
        Self::Backend(error)
    }
}
