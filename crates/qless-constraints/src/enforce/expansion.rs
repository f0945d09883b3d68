//! `u = T q + u_0` (Eq. 6): all DOFs from those that are left when the slaves of some equations are eliminated.
//!
//! Where T would fill, nothing is eliminated: the slaves of such a part stay unknowns, and its equations are left for multipliers.
//! The solution is the same; `T^T K T` of a dense T is as large as the square of the masters.

use qless::{ConstraintSystem, Form, Options, Reduction, SystemBuilder, analyse};

use super::EnforceError;
use super::matrix::{Matrix, from_triplets};

/// The expansion for some independent equations; prescribed DOFs are in `u_0`.
pub struct Expansion {
    /// T, n x q.
    pub t: Matrix,
    /// `u_0`, length n.
    pub constant: Vec<f64>,
    /// The equations that are eliminated, ...
    pub rows: Vec<usize>,
    /// ... their slaves, one for each, ...
    pub slaves: Vec<usize>,
    /// ... and the equations that T and `u_0` do not meet.
    pub left: Vec<usize>,
}

impl Expansion {
    /// Eliminates the slaves of `rows` where T stays sparse; with no rows, T only picks the DOFs that are not prescribed.
    pub fn new(system: &ConstraintSystem, rows: &[usize]) -> Result<Self, EnforceError> {
        let reduction = reduction(system, rows)?;
        let mut dense = vec![false; rows.len()];
        reduction.factored().iter().flat_map(qless::FactoredBlock::equations).for_each(|&i| dense[i] = true);
        let side = |dense_ones: bool| {
            let of = rows.iter().zip(&dense).filter(move |(_, dense)| **dense == dense_ones);
            of.map(|(&row, _)| row).collect::<Vec<usize>>()
        };
        let held: Vec<usize> = held(&reduction);
        let is_held = |dof: &usize| held.binary_search(dof).is_ok();
        let t = from_triplets(system.dofs(), reduction.masters().len() + held.len(), triplets(&reduction))?;
        let values: Vec<f64> = system.prescribed().iter().map(|&(_, value)| value).collect();
        let constant = reduction.expand(&vec![0.0; reduction.masters().len()], &values)?;
        let slaves = reduction.slaves().iter().copied().filter(|dof| !is_held(dof)).collect();
        Ok(Self { t, constant, rows: side(false), slaves, left: side(true) })
    }
}

/// The reduction of some equations of a system; parts whose T would fill stay factors.
pub fn reduction(system: &ConstraintSystem, rows: &[usize]) -> Result<Reduction, EnforceError> {
    let mut builder = SystemBuilder::new(system.dofs());
    rows.iter().for_each(|&row| {
        builder.equation(system.matrix().row(row), system.rhs()[row]);
    });
    system.prescribed().iter().for_each(|&(dof, value)| builder.prescribe(dof, value));
    let part = builder.build()?;
    Ok(analyse(&part, &Options::default())?.reduction_in(Form::Auto)?)
}

/// Slaves of parts that stay factors, ascending: they are unknowns.
pub fn held(reduction: &Reduction) -> Vec<usize> {
    let mut held: Vec<usize> = reduction.factored().iter().flat_map(|block| block.slaves().iter().copied()).collect();
    held.sort_unstable();
    held
}

/// T of the slaves that are eliminated, the masters themselves, and the slaves that are not, which come last.
pub fn triplets(reduction: &Reduction) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
    let slaves = reduction.slaves().iter().enumerate();
    let of_slaves = slaves.flat_map(|(i, &dof)| reduction.t().row(i).map(move |(q, v)| (dof, q, v)));
    let kept = reduction.masters().iter().copied().chain(held(reduction));
    of_slaves.chain(kept.enumerate().map(|(q, dof)| (dof, q, 1.0)))
}
