//! The local DOFs of a rank, and T, G and g on them.

use std::collections::BTreeMap;

use qless::{Csr, Elimination, Reduction};

use crate::analysis::Analysis;
use crate::error::Failure;
use crate::ranks::{Message, Outbox, Ranks, real, records};
use crate::share::Share;
use crate::solve::PRESCRIBED_BIT;

/// The local DOFs: those that a rank owns or needs, and those in their rows of T and G; ascending.
pub(super) struct LocalDofs {
    pub dofs: Vec<u64>,
    /// Values of the prescribed DOFs in `dofs`.
    values: BTreeMap<u64, f64>,
}

impl LocalDofs {
    /// Collects the local DOFs, and their prescribed values from the owners. Collective.
    pub fn new(ranks: &dyn Ranks, share: &Share, analysis: &Analysis) -> Self {
        let own = analysis.layout.owned(ranks.rank());
        let mut others = analysis.ghosts();
        others.extend(share.needed.iter().filter(|dof| !own.contains(dof)));
        others.sort_unstable();
        others.dedup();
        let mut values = prescribed_values(ranks, analysis, &others);
        values.extend(analysis.prescribed());
        let below = others.partition_point(|&dof| dof < own.start);
        let mut dofs = others;
        dofs.splice(below..below, own);
        Self { dofs, values }
    }

    /// The elimination on the local DOFs. A local DOF is numbered by its index in the ascending list `dofs`.
    pub fn elimination(&self, analysis: &Analysis) -> Result<Elimination, Failure> {
        let [mut slaves, mut masters, mut prescribed] = [Vec::new(), Vec::new(), Vec::new()];
        // Each DOF is a slave, a master or prescribed; find its index in the list of that kind.
        let mut place = Vec::with_capacity(self.dofs.len());
        for (j, &dof) in self.dofs.iter().enumerate() {
            let list = if self.values.contains_key(&dof) {
                &mut prescribed
            } else if analysis.reduction_row(dof).is_some() {
                &mut slaves
            } else {
                &mut masters
            };
            place.push(list.len());
            list.push(j);
        }
        let place_of = |dof: u64| self.dofs.binary_search(&(dof & !PRESCRIBED_BIT)).map_or(0, |j| place[j]);
        let (mut t, mut g_matrix, mut g) = (Csr::empty(masters.len()), Csr::empty(prescribed.len()), Vec::new());
        for &j in &slaves {
            let Some(row) = analysis.reduction_row(self.dofs[j]) else { continue };
            let terms = |bit: u64| {
                let terms = row.dofs.iter().zip(row.values).filter(move |(dof, _)| **dof & PRESCRIBED_BIT == bit);
                terms.map(|(&dof, &value)| (place_of(dof), value))
            };
            t.push_row(terms(0)).map_err(|error| Failure::of(&error))?;
            g_matrix.push_row(terms(PRESCRIBED_BIT)).map_err(|error| Failure::of(&error))?;
            g.push(row.constant);
        }
        let values: Vec<f64> = prescribed.iter().map(|&j| self.values[&self.dofs[j]]).collect();
        let reduction = Reduction::from_parts([slaves, masters, prescribed], t, g_matrix, g);
        let reduction = reduction.map_err(|error| Failure::of(&error))?;
        Elimination::from_reduction(reduction, &values).map_err(|error| Failure::of(&error))
    }
}

/// Asks the owners of `dofs` for prescribed values; returns the prescribed DOFs with their values. Collective.
fn prescribed_values(ranks: &dyn Ranks, analysis: &Analysis, dofs: &[u64]) -> BTreeMap<u64, f64> {
    let mut post = Outbox::default();
    dofs.iter().for_each(|&dof| post.to(analysis.layout.owner(dof)).push(dof));
    let values = &analysis.directory.prescribed;
    let answer = |message: Message| {
        let known = message.words.iter().filter_map(|dof| Some([*dof, values.get(dof)?.to_bits()]));
        Message { rank: message.rank, words: known.flatten().collect() }
    };
    let answers = post.send(ranks).into_iter().map(answer).filter(|message| !message.words.is_empty()).collect();
    records(ranks.exchange(answers)).map(|(_, [dof, bits])| (dof, real(bits))).collect()
}
