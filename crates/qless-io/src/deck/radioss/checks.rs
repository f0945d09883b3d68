//! Looks at all cards together: which of them stop the solver, which become springs, and which need a centre of mass.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use rustc_hash::{FxHashMap, FxHashSet};

use super::model::mesh::{CardPlace, RadiossBody, RadiossMesh};
use crate::deck::Dof;
use crate::deck::keyword::draft::KeywordDraft;
use crate::deck::keyword::group::dofs;
use crate::deck::kinematics::components::Components;

/// Finds main nodes that follow other cards. The starter stops there (`kinchk.F`: messages 806, 807 and 1036).
pub fn order(mesh: &mut RadiossMesh) {
    let mains: FxHashSet<u32> = mesh.bodies.iter().map(|body| body.main).collect();
    let slaves = slaves(&mesh.links);
    let of = |body: &RadiossBody, what: &str| (body.place.clone(), format!("has the main node {}, {what}", body.main));
    let followers = mesh.bodies.iter().filter(|body| slaves.contains(&body.main));
    let mut stops: Vec<(CardPlace, String)> = followers.map(|body| of(body, "a slave of an /RBE2")).collect();
    stops.extend(mesh.links.iter().filter_map(|link| match link.main {
        main if mains.contains(&main) => Some(of(link, "also that of an /RBODY")),
        main if mesh.tied.contains(&main) => Some(of(link, "a slave of an /INTER/TYPE2")),
        _ => None,
    }));
    mesh.stops.extend(stops);
}

fn slaves(bodies: &[RadiossBody]) -> FxHashSet<u32> {
    bodies.iter().flat_map(|body| &body.slaves).copied().collect()
}

/// Warns of weighted means that the solver replaces by springs (`kinchk.F`: messages 3096, 3100, 3104; `hm_read_rbe3.F`: 3115).
pub fn means(mesh: &RadiossMesh, draft: &mut KeywordDraft) {
    let (mains, slaves) = (mesh.bodies.iter().map(|body| body.main).collect::<FxHashSet<u32>>(), slaves(&mesh.links));
    for mean in mesh.means.iter().filter(|mean| !mean.is_strict) {
        let follows = |node: &u32| slaves.contains(node) || mesh.tied.contains(node);
        let why = match mean.reference {
            _ if mean.nodes.iter().any(follows) => "averages slaves of an /RBE2 or /INTER/TYPE2",
            node if mains.contains(&node) => "moves the main node of an /RBODY",
            node if mesh.held_in.contains_key(&node) => "moves a node that a /BCS holds",
            _ => continue,
        };
        let CardPlace { file, line, name, .. } = &mean.place;
        draft.model.warn(*file, *line, format!("{name} {why}, so that Radioss may replace it by springs (Iform)"));
    }
}

/// Leaves out what other cards say about translations of main nodes that the solver moves to a centre of mass, which the deck does not
/// give. It does not matter where the main node is if the body cannot rotate, or if no other card uses its other nodes.
pub fn centres(mesh: &RadiossMesh, draft: &mut KeywordDraft) {
    let moved: Vec<&RadiossBody> = mesh.bodies.iter().filter(|body| body.moves).collect();
    if !moved.is_empty() {
        draft.model.warn(0, 0, "main nodes of rigid bodies count at the positions that the deck gives (ICoG)");
    }
    let nodes = moved.iter().flat_map(|body| body.slaves.iter().chain([&body.main])).copied().collect();
    let users = users(draft, &nodes);
    let is_used = |node: u32, components: RangeInclusive<u8>, own: u32| {
        let others = |(first, is_shared): &SharedDofUse| *is_shared || *first != own;
        components.into_iter().any(|component| users.get(&Dof { node, component }).is_some_and(others))
    };
    let matters = |body: &&RadiossBody| {
        let (main, own) = (body.main, body.place.number);
        let turns = (4..=6).any(|component| !draft.is_fixed(Dof { node: main, component }));
        turns && is_used(main, 1..=3, own) && body.slaves.iter().any(|&node| is_used(node, 1..=6, own))
    };
    let uncertain: Vec<&RadiossBody> = moved.into_iter().filter(matters).collect();
    for CardPlace { file, line, name, .. } in uncertain.iter().map(|body| &body.place) {
        let why = "moves its main node to a centre of mass that the deck does not give, and the position matters";
        draft.model.leave_out(*file, *line, format!("{name} {why}: this is left out"));
    }
    let mains = uncertain.into_iter().map(|body| body.main).collect();
    let translations: BTreeSet<Dof> = dofs(mains, Components::TRANSLATIONS).collect();
    draft.leave_out_values(&translations, "holds a main node that Radioss moves to an unknown centre of mass");
}

/// A card that uses a DOF, and whether another card uses it too.
type SharedDofUse = (u32, bool);

/// Which cards have equations or values with the DOFs of these nodes.
fn users(draft: &KeywordDraft, nodes: &FxHashSet<u32>) -> FxHashMap<Dof, SharedDofUse> {
    let mut users: FxHashMap<Dof, SharedDofUse> = FxHashMap::default();
    let mut note = |dof: Dof, card: u32| {
        if nodes.contains(&dof.node) {
            let (first, is_shared) = users.entry(dof).or_insert((card, false));
            *is_shared |= *first != card;
        }
    };
    for equation in (0..draft.model.equations()).map(|i| draft.model.nth(i)) {
        equation.columns.iter().for_each(|&column| note(draft.model.dofs[column as usize], equation.origin.card));
    }
    draft.prescribed.values().for_each(|given| note(given.dof, given.origin.card));
    users
}
