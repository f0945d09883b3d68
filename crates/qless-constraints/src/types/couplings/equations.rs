//! Checks the nodes of a coupling, and adds its equations `sum_j a_j u_j - motion . q = 0`, where q are the six components of the
//! reference's motion, and `motion` their coefficients.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::error::CouplingError;
use super::node6::{Component, Node6};
use crate::EquationSink;
use crate::scalar::clean;
use crate::scalar::vector::{Vector, dot};

/// Adds `sum_j a_j u_j - motion . q = 0` with the terms `a_j u_j`; q are the six components of the reference's motion, and `motion` their
/// coefficients. Coefficients that are only rounding are left out.
pub fn follow(
    sink: &mut EquationSink,
    part: String,
    terms: Vec<(usize, f64)>,
    reference: &Node6,
    motion: [f64; 6],
) -> Result<(), CouplingError> {
    let mut all: Vec<(usize, f64)> = terms.into_iter().filter(|&(_, factor)| factor != 0.0).collect();
    for (component, factor) in in_axes(reference, motion) {
        let own = reference.coupled(component).ok_or_else(|| missing(&part, component, factor))?;
        all.extend(own.terms.iter().map(|&(dof, a)| (dof, -factor * a)));
    }
    sink.equation(part, all, 0.0);
    Ok(())
}

/// Expresses `motion . q` in the components of the reference, which may be along local axes; returns each component with its factor. A
/// factor is left out if it is only rounding, compared with the other factors of translations, or of rotations.
fn in_axes(reference: &Node6, motion: [f64; 6]) -> impl Iterator<Item = (Component, f64)> {
    let factor = |component: Component| {
        let kind =
            if component.is_rotation() { [motion[3], motion[4], motion[5]] } else { [motion[0], motion[1], motion[2]] };
        if reference.local.is_none() { kind[component as usize % 3] } else { dot(kind, reference.axis(component)) }
    };
    let mut factors = Component::ALL.map(factor);
    factors.as_chunks_mut::<3>().0.iter_mut().for_each(|kind| clean(kind.iter_mut(), 1.0));
    Component::ALL.into_iter().zip(factors).filter(|&(_, factor)| factor != 0.0)
}

fn missing(part: &str, component: Component, factor: f64) -> CouplingError {
    CouplingError::MissingDof { part: part.to_owned(), component, factor }
}

/// Adds `motion . q - sum_j a_j u_j = 0`: the reference, with the components q, follows a mean of other DOFs.
pub fn lead(
    sink: &mut EquationSink,
    part: String,
    terms: impl Iterator<Item = (usize, f64)>,
    reference: &Node6,
    motion: [f64; 6],
) -> Result<(), CouplingError> {
    follow(sink, part, terms.map(|(dof, factor)| (dof, -factor)).collect(), reference, motion.map(|x| -x))
}

/// Checks that every node has finite coordinates, coupled components, and DOFs that no other node has.
///
/// Repeated nodes are allowed in a mean, where they add weight.
pub fn check<'a>(
    reference: &'a Node6,
    nodes: impl Iterator<Item = &'a Node6>,
    again: RepeatedNodes,
) -> Result<(), CouplingError> {
    let mut owners = DofOwners::default();
    for (node, own) in std::iter::once(reference).chain(nodes).enumerate() {
        if own.at.iter().any(|x| !x.is_finite()) {
            return Err(CouplingError::NoPlace { node });
        }
        if !Component::ALL.into_iter().any(|component| own.has(component)) {
            return Err(CouplingError::NoComponents { node });
        }
        if let Some(component) = own.without_dofs() {
            return Err(CouplingError::LocalAxis { node, component });
        }
        let again = again == RepeatedNodes::Allowed && node > 0;
        owners.claim(node, own, again).map_err(|dof| CouplingError::SharedDof { node, dof })?;
    }
    Ok(())
}

/// Whether a node may be listed more than once.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum RepeatedNodes {
    Refused,
    Allowed,
}

/// What a DOF stands for: position of its node in the list, component, and coordinates of the node.
type DofMeaning = (usize, usize, Vector<f64>);

/// The meaning of each DOF seen so far.
#[derive(Default)]
pub struct DofOwners {
    meanings: HashMap<usize, DofMeaning>,
}

impl DofOwners {
    /// Registers the DOFs of a node. The error is a DOF that already has another meaning: the coupling would silently
    /// equate two displacements.
    ///
    /// The same component at the same coordinates is the same node; with `again` it is accepted.
    pub fn claim(&mut self, number: usize, node: &Node6, again: bool) -> Result<(), usize> {
        for (k, dof) in node.dofs.into_iter().enumerate().filter_map(|(k, dof)| Some((k, dof?))) {
            match self.meanings.entry(dof) {
                Entry::Vacant(free) => {
                    free.insert((number, k, node.at));
                }
                Entry::Occupied(taken) => {
                    let (first, component, at) = *taken.get();
                    let same = first != 0 && first != number && (component, at) == (k, node.at);
                    if !(again && same) {
                        return Err(dof);
                    }
                }
            }
        }
        Ok(())
    }
}
