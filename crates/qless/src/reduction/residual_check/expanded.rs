//! Expands one term of a reduction (T u_q, G u_p or g) to all DOFs.

use rayon::prelude::*;

use crate::common::pool::WORTH_A_THREAD;
use crate::common::random::{randoms, signed};
use crate::diagnosis::nullspace_probe::RandomKeys;
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, exponent, ldexp};
use crate::reduction::Reduction;

/// The values that one term of the reduction gives all DOFs.
pub struct Expanded {
    pub u: Vec<f64>,
    /// For each DOF the sum of the magnitudes of its terms, if it was computed. The magnitude of the DOF itself is a lower bound.
    pub sizes: Option<Vec<f64>>,
    /// True for g, which satisfies `C u = b`; false for `T u_q` and `G u_p`, which satisfy `C u = 0`.
    pub with_rhs: bool,
}

/// A term of `u_s = T u_q + G u_p + g`: T u_q, G u_p or g.
#[derive(Clone, Copy)]
pub enum ReductionTerm {
    Free,
    Prescribed,
    Constant,
}

/// The data for the expansion of a term.
#[derive(Clone, Copy)]
pub struct ExpansionInput<'a> {
    pub term: ReductionTerm,
    pub local: LocalSystem<'a>,
    pub reduction: &'a Reduction,
    pub scaling: &'a Scaling,
    /// True if masters are random in the units of the scaling, false in those of the user.
    pub is_balanced: bool,
}

impl Expanded {
    /// Expands random masters, random prescribed values, or g. With `keys`, the value of a master depends on its key only.
    pub fn new(input: ExpansionInput, keys: Option<&RandomKeys>) -> Self {
        let ExpansionInput { term, local, reduction, .. } = input;
        let mut expanded = Self {
            u: Self::by_rows(input, keys, |v| v),
            sizes: None,
            with_rhs: matches!(term, ReductionTerm::Constant),
        };
        if !reduction.is_explicit() && !expanded.with_rhs {
            let named = &local.numbering.dofs;
            let mut users = vec![0.0; reduction.dofs()];
            named.iter().zip(&expanded.u).for_each(|(&j, &u)| users[j as usize] = u);
            reduction.factored.iter().for_each(|block| block.set_slaves(&mut users));
            expanded.u = named.iter().map(|&j| users[j as usize]).collect();
        }
        expanded
    }

    /// The values of local DOFs by the explicit rows of T, G or g; with `size` = abs, the sums of the magnitudes of their terms.
    fn by_rows(input: ExpansionInput, keys: Option<&RandomKeys>, size: impl Fn(f64) -> f64 + Send + Sync) -> Vec<f64> {
        let ExpansionInput { term, local, reduction, scaling, is_balanced } = input;
        let (dofs, matrix) = match term {
            ReductionTerm::Free => (&reduction.masters[..], Some(&reduction.t)),
            ReductionTerm::Prescribed => (&reduction.prescribed[..], Some(&reduction.g_matrix)),
            ReductionTerm::Constant => (&[][..], None),
        };
        let mut x = match (term, keys) {
            (ReductionTerm::Free, Some(keys)) => by_keys(local, reduction, keys),
            (ReductionTerm::Prescribed, _) => in_units(local, reduction, scaling),
            _ => randoms(1).take(dofs.len()).collect(),
        };
        if is_balanced && matches!(term, ReductionTerm::Free) {
            let mut units = vec![0; reduction.dofs()];
            local.numbering.dofs.iter().enumerate().for_each(|(l, &j)| units[j as usize] = scaling.col(l));
            x.iter_mut().zip(dofs).for_each(|(x, &j)| *x = ldexp(*x, units[j]));
        }
        let of_slave = |i: usize| match matrix {
            Some(matrix) => {
                let range = matrix.start[i]..matrix.start[i + 1];
                let terms = matrix.col[range.clone()].iter().zip(&matrix.val[range]);
                terms.fold(0.0, |sum, (&j, &v)| sum + size(v * x[j as usize]))
            }
            None => size(reduction.g[i]),
        };
        let slaves = each(reduction.slaves.len(), of_slave);
        let mut users = vec![0.0; reduction.dofs()];
        dofs.iter().zip(&x).for_each(|(&j, &v)| users[j] = v);
        reduction.slaves.iter().zip(slaves).for_each(|(&j, of_slave)| users[j] = of_slave);
        let named = &local.numbering.dofs;
        each(named.len(), |l| users[named[l] as usize])
    }

    /// Computes [`Expanded::sizes`] for the same random masters and prescribed values.
    pub fn measure(&mut self, input: ExpansionInput, keys: &RandomKeys) {
        let mut sizes = Self::by_rows(input, Some(keys), f64::abs);
        sizes.iter_mut().zip(&self.u).for_each(|(size, u)| *size = size.max(u.abs()));
        self.sizes = Some(sizes);
    }

    pub fn size(&self, j: usize) -> f64 {
        self.sizes.as_ref().map_or_else(|| self.u[j].abs(), |sizes| sizes[j])
    }
}

/// The values of a function for `0..count`, in this order; long lists use all threads.
pub fn each<T: Send>(count: usize, value: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    if count < WORTH_A_THREAD || rayon::current_num_threads() == 1 {
        (0..count).map(value).collect()
    } else {
        (0..count).into_par_iter().map(value).collect()
    }
}

/// Bound of the exponent of a unit, so that products stay within the range of doubles.
const FAR: i32 = 500;

/// A random number for each master, determined by its position within its part.
fn by_keys(local: LocalSystem, reduction: &Reduction, keys: &RandomKeys) -> Vec<f64> {
    let mut users = vec![1.0; reduction.dofs()];
    let named = local.numbering.dofs.iter().enumerate();
    named.for_each(|(l, &j)| users[j as usize] = signed(1, keys.dof(l)).abs());
    reduction.masters.iter().map(|&j| users[j]).collect()
}

/// A random number for each prescribed DOF, in the unit of the DOF: otherwise a DOF with large coefficients would hide the others.
fn in_units(local: LocalSystem, reduction: &Reduction, scaling: &Scaling) -> Vec<f64> {
    let mut largest = vec![None; reduction.dofs()];
    for i in 0..local.equations() {
        for (j, v) in local.row(i).filter(|&(j, v)| !local.free()[j] && v != 0.0) {
            let power = &mut largest[local.numbering.dofs[j] as usize];
            *power = (*power).max(Some(exponent(v) + scaling.row[i]));
        }
    }
    let unit = |&j: &usize| -largest[j].unwrap_or(0).clamp(-FAR, FAR);
    reduction.prescribed.iter().map(unit).zip(randoms(1)).map(|(power, x)| ldexp(x, power)).collect()
}
