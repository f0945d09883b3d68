//! Checks sets that exclude each other: a component in set a, o, b, c, q or r is in no other of these sets, and is neither dependent (set
//! m) nor prescribed (set s).

use std::collections::BTreeMap;

use super::points::{Points, limited};
use crate::deck::nastran::cards::exclusive::ExclusiveMembers;
use crate::deck::{DeckError, Dof, LoadCase, Model, Origin};

/// The letter of a set, and the card that puts a component into it.
type SetClaim = (char, Origin);

/// Tells the model which components must not be slaves. Refuses components that are in two exclusive sets, or in one and prescribed.
pub fn claim(members: &[ExclusiveMembers], points: &Points, model: &mut Model) -> Result<(), DeckError> {
    let mut claims: BTreeMap<Dof, SetClaim> = BTreeMap::new();
    for (dof, claim) in all(members, points, model)? {
        match claims.get(&dof) {
            Some(&first) if first.0 != claim.0 => refuse(dof, first.1, claim.1, model),
            Some(_) => {}
            None => drop(claims.insert(dof, claim)),
        }
    }
    for (dof, first, by) in prescribed(&claims, &model.cases) {
        refuse(dof, first, by, model);
    }
    model.claim(claims.into_iter().map(|(dof, (_, origin))| (dof, origin)).collect());
    Ok(())
}

/// Lists each component that a card puts into an exclusive set, with its claim.
fn all(members: &[ExclusiveMembers], points: &Points, model: &mut Model) -> Result<Vec<(Dof, SetClaim)>, DeckError> {
    let mut found = Vec::new();
    for ExclusiveMembers { letter, points: lists, components, place } in members {
        let nodes = points.expand(lists).map_err(|problem| place.error(problem, model))?;
        limited(found.len() + nodes.len()).map_err(|problem| place.error(problem, model))?;
        let origin = place.origin(model);
        for node in nodes {
            let dofs = points.dofs(node, *components).map_err(|fault| place.error(fault.into(), model))?;
            found.extend(dofs.into_iter().map(|dof| (dof, (*letter, origin))));
        }
    }
    Ok(found)
}

/// The components of exclusive sets that some load case prescribes, each once. Each comes with the card that puts it into the set, and with
/// the card of the value.
fn prescribed(claims: &BTreeMap<Dof, SetClaim>, cases: &[LoadCase]) -> Vec<(Dof, Origin, Origin)> {
    let all = cases.iter().flat_map(|case| &case.prescribed);
    let mut found: BTreeMap<Dof, (Origin, Origin)> = BTreeMap::new();
    for prescribed in all.filter(|_| !claims.is_empty()) {
        if let Some(&(_, origin)) = claims.get(&prescribed.dof) {
            found.entry(prescribed.dof).or_insert((origin, prescribed.origin));
        }
    }
    found.into_iter().map(|(dof, (first, by))| (dof, first, by)).collect()
}

fn refuse(dof: Dof, first: Origin, second: Origin, model: &mut Model) {
    let text = format!(
        "{dof} is in the sets of {} and of {}, which exclude each other",
        model.place(first),
        model.place(second)
    );
    model.refuse(model.cards.nth(second.card).file, second.line, text);
}
