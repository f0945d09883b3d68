//! All DOFs by one part of a reduction.

use rayon::prelude::*;

use crate::common::pool::WORTH_A_THREAD;
use crate::common::random::{randoms, signed};
use crate::diagnosis::nullspace_probe::RandomKeys;
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, exponent, ldexp};
use crate::reduction::Reduction;

/// All DOFs for one part of the reduction.
pub struct Expanded {
    pub u: Vec<f64>,
    /// The sizes of what makes them, where somebody wants a closer look; until then their own sizes, which are not larger.
    pub sizes: Option<Vec<f64>>,
    /// Whether b belongs to this part.
    pub with_rhs: bool,
}

/// T, G and g, each on its own.
#[derive(Clone, Copy)]
pub enum Part {
    Free,
    Prescribed,
    Constant,
}

/// What a part is expanded from.
#[derive(Clone, Copy)]
pub struct Given<'a> {
    pub part: Part,
    pub local: LocalSystem<'a>,
    pub reduction: &'a Reduction,
    pub scaling: &'a Scaling,
}

impl Expanded {
    /// Random masters, random prescribed values, or neither; masters by `keys`, if there are any.
    pub fn new(given: Given, keys: Option<&RandomKeys>) -> Self {
        let Given { part, local, reduction, .. } = given;
        let (u, factored) = (Self::by_rows(given, keys, |v| v), !reduction.is_explicit());
        let mut expanded = Self { u, sizes: None, with_rhs: matches!(part, Part::Constant) };
        if factored && !expanded.with_rhs {
            let named = &local.numbering.dofs;
            let mut users = vec![0.0; reduction.slaves.len() + reduction.masters.len() + reduction.prescribed.len()];
            named.iter().zip(&expanded.u).for_each(|(&j, &u)| users[j as usize] = u);
            reduction.factored.iter().for_each(|block| block.set_slaves(&mut users));
            expanded.u = named.iter().map(|&j| users[j as usize]).collect();
        }
        expanded
    }

    /// Local DOFs, or the sizes of what makes them, by the rows of T, of G, or of g.
    fn by_rows(given: Given, keys: Option<&RandomKeys>, size: impl Fn(f64) -> f64 + Send + Sync) -> Vec<f64> {
        let Given { part, local, reduction, scaling } = given;
        let (dofs, matrix) = match part {
            Part::Free => (&reduction.masters[..], Some(&reduction.t)),
            Part::Prescribed => (&reduction.prescribed[..], Some(&reduction.g_matrix)),
            Part::Constant => (&[][..], None),
        };
        let x = match (part, keys) {
            (Part::Free, Some(keys)) => by_keys(local, reduction, keys),
            (Part::Prescribed, _) => in_units(local, reduction, scaling),
            _ => randoms(1).take(dofs.len()).collect(),
        };
        let of_slave = |i: usize| match matrix {
            Some(matrix) => {
                let range = matrix.start[i]..matrix.start[i + 1];
                let terms = matrix.col[range.clone()].iter().zip(&matrix.val[range]);
                terms.fold(0.0, |sum, (&j, &v)| sum + size(v * x[j as usize]))
            }
            None => size(reduction.g[i]),
        };
        let slaves = each(reduction.slaves.len(), of_slave);
        let mut users = vec![0.0; reduction.slaves.len() + reduction.masters.len() + reduction.prescribed.len()];
        dofs.iter().zip(&x).for_each(|(&j, &v)| users[j] = v);
        reduction.slaves.iter().zip(slaves).for_each(|(&j, of_slave)| users[j] = of_slave);
        let named = &local.numbering.dofs;
        each(named.len(), |l| users[named[l] as usize])
    }

    /// Takes the sizes of the parts of every DOF.
    pub fn measure(&mut self, given: Given, keys: &RandomKeys) {
        let mut sizes = Self::by_rows(given, Some(keys), f64::abs);
        sizes.iter_mut().zip(&self.u).for_each(|(size, u)| *size = size.max(u.abs()));
        self.sizes = Some(sizes);
    }

    pub fn size(&self, j: usize) -> f64 {
        self.sizes.as_ref().map_or_else(|| self.u[j].abs(), |sizes| sizes[j])
    }
}

/// `0..count` of a function, in their order, by all threads where that is worth it.
pub fn each<T: Send>(count: usize, of: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    if count < WORTH_A_THREAD || rayon::current_num_threads() == 1 {
        (0..count).map(of).collect()
    } else {
        (0..count).into_par_iter().map(of).collect()
    }
}

/// Units are told apart up to this power of two, so that products stay within the range of doubles.
const FAR: i32 = 500;

/// A random number for each master, by its place within its component.
pub fn by_keys(local: LocalSystem, reduction: &Reduction, keys: &RandomKeys) -> Vec<f64> {
    let mut users = vec![1.0; reduction.slaves.len() + reduction.masters.len() + reduction.prescribed.len()];
    let named = local.numbering.dofs.iter().enumerate();
    named.for_each(|(l, &j)| users[j as usize] = signed(1, keys.dof(l)).abs());
    reduction.masters.iter().map(|&j| users[j]).collect()
}

/// A random number for each prescribed DOF, each in its unit: what `2^60` of one brings must not hide what one of another does.
pub fn in_units(local: LocalSystem, reduction: &Reduction, scaling: &Scaling) -> Vec<f64> {
    let mut largest = vec![None; reduction.slaves.len() + reduction.masters.len() + reduction.prescribed.len()];
    for i in 0..local.equations() {
        for (j, v) in local.row(i).filter(|&(j, v)| !local.free()[j] && v != 0.0) {
            let power = &mut largest[local.numbering.dofs[j] as usize];
            *power = (*power).max(Some(exponent(v) + scaling.row[i]));
        }
    }
    let unit = |&j: &usize| -largest[j].unwrap_or(0).clamp(-FAR, FAR);
    reduction.prescribed.iter().map(unit).zip(randoms(1)).map(|(power, x)| ldexp(x, power)).collect()
}
