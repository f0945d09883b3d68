//! `sum_j a_j u_j - d . q = 0`: what follows a reference node, as an equation.

use super::error::CouplingError;
use super::node6::{Component, Node6};
use crate::Store;

/// Below this part of the largest factor of its kind a factor is rounding: a few operations lie behind each.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Adds `sum_j a_j u_j - motion . q = 0`, q the DOFs of the reference; terms that are rounding of the others are left out.
pub fn follow(
    store: &mut Store,
    part: String,
    terms: Vec<(usize, f64)>,
    reference: &Node6,
    mut motion: [f64; 6],
) -> Result<(), CouplingError> {
    motion.as_chunks_mut::<3>().0.iter_mut().for_each(|kind| clean(kind.iter_mut(), 1.0));
    let mut all: Vec<(usize, f64)> = terms.into_iter().filter(|&(_, factor)| factor != 0.0).collect();
    for (component, factor) in Component::ALL.into_iter().zip(motion).filter(|&(_, factor)| factor != 0.0) {
        let dof = reference.dofs[component as usize].ok_or_else(|| missing(&part, component, factor))?;
        all.push((dof, -factor));
    }
    store.equation(part, all, 0.0);
    Ok(())
}

fn missing(part: &str, component: Component, factor: f64) -> CouplingError {
    CouplingError::MissingDof { part: part.to_owned(), component, factor }
}

/// The reference as the mean of others: adds `motion . q - sum_j a_j u_j = 0`.
pub fn lead(
    store: &mut Store,
    part: String,
    terms: impl Iterator<Item = (usize, f64)>,
    reference: &Node6,
    motion: [f64; 6],
) -> Result<(), CouplingError> {
    follow(store, part, terms.map(|(dof, factor)| (dof, -factor)).collect(), reference, motion.map(|x| -x))
}

/// Sets factors of one kind to zero that are `blur` times the rounding of the largest; NaN stays.
pub fn clean<'a>(factors: impl Iterator<Item = &'a mut f64>, blur: f64) {
    let mut factors: Vec<&mut f64> = factors.collect();
    let largest = factors.iter().fold(0.0, |most: f64, factor| most.max(factor.abs()));
    factors.iter_mut().filter(|factor| factor.abs() <= ROUNDING * blur * largest).for_each(|factor| **factor = 0.0);
}

/// Every node is in a finite place and has DOFs of its own, none of which is the reference's.
pub fn check<'a>(reference: &'a Node6, nodes: impl Iterator<Item = &'a Node6>) -> Result<(), CouplingError> {
    for (node, own) in std::iter::once(reference).chain(nodes).enumerate() {
        if own.at.iter().any(|x| !x.is_finite()) {
            return Err(CouplingError::NoPlace { node });
        }
        let shared = if node == 0 { None } else { own.shared_dof(reference) };
        if let Some(dof) = own.repeated_dof().or(shared) {
            return Err(CouplingError::SharedDof { node, dof });
        }
    }
    Ok(())
}
