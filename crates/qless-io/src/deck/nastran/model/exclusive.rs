//! Sets that exclude each other: what is dependent (m) or prescribed (s) is in no other, and what is in one of a, o, b, c, q, r in no
//! second one.

use std::collections::BTreeMap;

use super::points::{Points, limited};
use crate::deck::nastran::cards::exclusive::ExclusiveMembers;
use crate::deck::{DeckError, Dof, LoadCase, Model, Origin};

/// A component in a set, and the card that says so.
type SetClaim = (char, Origin);

/// Tells the model what no slave may be, and says which components are in two sets, which it refuses.
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

/// Every component that a card puts into a set.
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

/// Components in such a set that are prescribed in some case, each once.
fn prescribed(claims: &BTreeMap<Dof, SetClaim>, cases: &[LoadCase]) -> Vec<(Dof, Origin, Origin)> {
    let given = cases.iter().flat_map(|case| &case.prescribed);
    let mut found: BTreeMap<Dof, (Origin, Origin)> = BTreeMap::new();
    for given in given.filter(|_| !claims.is_empty()) {
        if let Some(&(_, origin)) = claims.get(&given.dof) {
            found.entry(given.dof).or_insert((origin, given.origin));
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
