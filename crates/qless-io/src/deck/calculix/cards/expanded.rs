//! Constraints at nodes of beams, trusses, shells, membranes and plane elements, which ccx expands into solids.
//!
//! The node of the deck stays, and the mean of the new nodes follows it. So equations and values of its translations hold as the deck gives
//! them. ccx replaces other constraints, mostly by equations between new nodes, which may contradict each other. This reader reports the
//! replaced constraints as left out, so the model is incomplete:
//!
//! | constraint | ccx 2.20 |
//! | --- | --- |
//! | a rotation | replaces it by mean rotations or by a rigid body, or ignores it, or stops |
//! | `*MPC` | stops, or uses the nodes of the deck |
//! | component 3 at a plane element | is zero, whatever the equation says |
//! | `*TIE` with faces of shells | ties the new nodes: see `tie` |

use std::collections::{BTreeMap, BTreeSet};

use crate::deck::calculix::cards::mean_rotation;
use crate::deck::calculix::model::DeckDefinitions;
use crate::deck::calculix::model::elements::ElementShape;
use crate::deck::{Dof, Model, Origin};

const ROTATION: &str = "with equations of their own for rotations";
const MPC: &str = "with rules of its own for *MPC";
const THIRD: &str = "of which component 3 stays zero";

/// For each kind of constraint that ccx changes: where it was found first, the DOF found there, and all DOFs found.
type Found = BTreeMap<&'static str, (Origin, Dof, BTreeSet<Dof>)>;

/// Reports the constraints that ccx changes when it expands elements into solids. They count as left out; each kind gives one warning.
pub fn leave_out(model: &mut Model, definitions: &DeckDefinitions) {
    if !definitions.blocks.iter().any(|block| ElementShape::from_type(&block.kind).is_expanded()) {
        return;
    }
    let mut found = Found::new();
    let mut note = |why, dof, origin| {
        found.entry(why).or_insert_with(|| (origin, dof, BTreeSet::new())).2.insert(dof);
    };
    for given in model.cases.iter().flat_map(|case| &case.prescribed) {
        if is_rotation(given.dof, definitions) {
            note(ROTATION, given.dof, given.origin);
        }
    }
    for equation in (0..model.equations()).map(|i| model.nth(i)) {
        for dof in equation.columns.iter().map(|&j| model.dofs[j as usize]) {
            why(dof, model, equation.origin.card, definitions)
                .into_iter()
                .for_each(|why| note(why, dof, equation.origin));
        }
    }
    for (why, (origin, dof, all)) in found {
        let card = model.cards.nth(origin.card);
        let (more, name) = (all.len() - 1, model.dof_name(dof));
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let text = format!("{} at {name}{more}: ccx expands the elements there into solids {why}: left out", card.name);
        model.leave_out(card.file, origin.line, text);
    }
}

fn is_rotation(dof: Dof, definitions: &DeckDefinitions) -> bool {
    (4..=6).contains(&dof.component) && !definitions.expanded_at(dof.node).is_empty()
}

/// Why ccx may change an equation of `card` because of the term on `dof`; `None` if it does not.
fn why(dof: Dof, model: &Model, card: u32, definitions: &DeckDefinitions) -> Option<&'static str> {
    let name = model.cards.nth(card).name;
    if is_rotation(dof, definitions) {
        Some(ROTATION)
    } else if !definitions.expanded_at(dof.node).is_empty() && (name == "*MPC" || name == mean_rotation::NAME) {
        Some(MPC)
    } else if dof.component == 3 && definitions.is_flat(dof.node) && name == "*EQUATION" {
        Some(THIRD)
    } else {
        None
    }
}
