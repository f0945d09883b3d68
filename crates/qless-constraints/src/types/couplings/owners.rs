//! One DOF, one meaning: which component of which node each DOF of a coupling is.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::node6::Node6;
use crate::scalar::vector::Vector;

/// Whether a node may be named more than once.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Again {
    Refused,
    Allowed,
}

/// What a DOF stands for: the number of its node in the list, its component, and the place.
type Meaning = (usize, usize, Vector<f64>);

/// The DOFs met so far.
#[derive(Default)]
pub struct Owners {
    meanings: HashMap<usize, Meaning>,
}

impl Owners {
    /// Takes the DOFs of a node, or names one that is taken: one DOF for two displacements would make them equal in silence.
    ///
    /// The same component in the same place is the same node, which may be named `again`.
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
