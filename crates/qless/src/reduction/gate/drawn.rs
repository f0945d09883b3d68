//! Random numbers that depend on the component alone.

use super::Reduction;
use crate::common::random::{randoms, signed};
use crate::diagnosis::samples::Keys;
use crate::input::numbering::Local;
use crate::input::scale::{Scaling, exponent, ldexp};

/// Units are told apart up to this power of two, so that products stay within the range of doubles.
const FAR: i32 = 500;

/// A random number for each master, by its place within its component.
pub fn by_keys(local: Local, reduction: &Reduction, keys: &Keys) -> Vec<f64> {
    let mut users = vec![1.0; reduction.slaves.len() + reduction.masters.len() + reduction.prescribed.len()];
    let named = local.numbering.dofs.iter().enumerate();
    named.for_each(|(l, &j)| users[j as usize] = signed(1, keys.dof(l)).abs());
    reduction.masters.iter().map(|&j| users[j]).collect()
}

/// A random number for each prescribed DOF, each in its unit: what `2^60` of one brings must not hide what one of another does.
pub fn in_units(local: Local, reduction: &Reduction, scaling: &Scaling) -> Vec<f64> {
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
