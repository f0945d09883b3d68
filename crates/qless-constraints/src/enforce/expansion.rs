//! `u = T q + u_0` (Eq. 6): all DOFs from those that are left when the slaves of some equations are eliminated.

use qless::{ConstraintSystem, Options, Reduction, SystemBuilder, analyse};

use super::EnforceError;
use super::matrix::{Matrix, from_triplets};

/// The expansion for some independent equations; prescribed DOFs are in `u_0`.
pub struct Expansion {
    /// T, n x q.
    pub t: Matrix,
    /// `u_0`, length n.
    pub constant: Vec<f64>,
    /// Slaves, one for each equation.
    pub slaves: Vec<usize>,
}

impl Expansion {
    /// Eliminates the slaves of `rows`; with no rows, T only picks the DOFs that are not prescribed.
    pub fn new(system: &ConstraintSystem, rows: &[usize]) -> Result<Self, EnforceError> {
        let reduction = reduction(system, rows)?;
        let t = from_triplets(system.dofs(), reduction.masters.len(), triplets(&reduction))?;
        let values: Vec<f64> = system.prescribed().iter().map(|&(_, value)| value).collect();
        let constant = reduction.expand(&vec![0.0; reduction.masters.len()], &values);
        Ok(Self { t, constant, slaves: reduction.slaves })
    }
}

/// The reduction of some equations of a system.
pub fn reduction(system: &ConstraintSystem, rows: &[usize]) -> Result<Reduction, EnforceError> {
    let mut builder = SystemBuilder::new(system.dofs());
    rows.iter().for_each(|&row| {
        builder.equation(system.matrix().row(row), system.rhs()[row]);
    });
    system.prescribed().iter().for_each(|&(dof, value)| builder.prescribe(dof, value));
    let part = builder.build()?;
    Ok(analyse(&part, &Options::default())?.reduction(&part)?)
}

/// T of the slaves, and the masters themselves.
pub fn triplets(reduction: &Reduction) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
    let slaves = reduction.slaves.iter().enumerate();
    let of_slaves = slaves.flat_map(|(i, &dof)| reduction.t.row(i).map(move |(q, v)| (dof, q, v)));
    of_slaves.chain(reduction.masters.iter().enumerate().map(|(q, &dof)| (dof, q, 1.0)))
}
