//! The prescribed DOFs and loads of a load case.

use super::points::{PointKind, Points, limited};
use crate::deck::nastran::cards::bulk::BulkData;
use crate::deck::nastran::cards::sets::PointSupport;
use crate::deck::nastran::control::selected::CaseSets;
use crate::deck::nastran::syntax::card::CardPlace;
use crate::deck::{DeckError, Dof, Load, LoadCase, Model, Prescribed, Problem};

/// The load case in which `sets` hold.
pub fn case(
    name: &str,
    sets: &CaseSets,
    sets_of: &[(u32, u32)],
    bulk: &BulkData,
    points: &Points,
    model: &mut Model,
) -> Result<LoadCase, DeckError> {
    let mut given = held(points, model);
    for (_, support, place) in bulk.supports.iter().filter(|(set, ..)| sets.spc.contains(set)) {
        given.extend(prescribed(support, 1.0, place, (points, bulk), model)?);
        limited(given.len()).map_err(|problem| place.error(problem, model))?;
    }
    let (mut prescribed, mut clashes) = sorted_apart(given);
    enforce(enforced(sets, bulk, points, model)?, &mut prescribed, &mut clashes);
    let removed = sets_of.iter().filter(|(_, set)| !sets.mpc.contains(set)).map(|&(equation, _)| equation).collect();
    Ok(LoadCase { name: name.to_owned(), prescribed, clashes, loads: loads(sets, bulk, points, model), removed })
}

/// Components that `GRID` cards hold.
fn held(points: &Points, model: &mut Model) -> Vec<Prescribed> {
    let mut given = Vec::new();
    for (grid, set) in points.held() {
        let origin = points.place(grid).origin(model);
        given.extend(set.iter().map(|component| Prescribed {
            dof: Dof { node: grid.id, component },
            history: 0,
            value: 0.0,
            origin,
        }));
    }
    given
}

fn prescribed(
    support: &PointSupport,
    factor: f64,
    place: &CardPlace,
    (points, bulk): (&Points, &BulkData),
    model: &mut Model,
) -> Result<Vec<Prescribed>, DeckError> {
    let nodes = points.expand(&support.points).map_err(|problem| place.error(problem, model))?;
    points.warn_of_unknown(nodes.iter().copied(), place, model);
    if bulk.is_mystran {
        refuse_unknown(support, place, points, model);
    }
    let mut given = Vec::with_capacity(nodes.len() * support.components.len());
    let (origin, value) = (place.origin(model), factor * support.value);
    for node in nodes {
        if bulk.is_mystran && support.components.is_empty() && points.kind(node) == PointKind::Grid {
            let text = format!("{} gives grid point {node} no component: MYSTRAN holds none", place.name);
            model.warn(place.file, place.line, text);
            continue;
        }
        let dofs = points.dofs(node, support.components).map_err(|fault| place.error(fault.into(), model))?;
        given.extend(dofs.into_iter().map(|dof| Prescribed { dof, value, history: 0, origin }));
    }
    Ok(given)
}

/// MYSTRAN stops at points that are not there, the ends of a range among them.
fn refuse_unknown(support: &PointSupport, place: &CardPlace, points: &Points, model: &mut Model) {
    let mut ends = support.points.iter().flat_map(|span| [span.first, span.last]);
    if let Some(node) = ends.find(|&node| points.kind(node) == PointKind::Unknown) {
        let text = format!("{} holds point {node}, which is not there: MYSTRAN stops", place.name);
        model.refuse(place.file, place.line, text);
    }
}

/// The first value of each DOF, ascending, and the later ones that contradict it.
fn sorted_apart(mut given: Vec<Prescribed>) -> (Vec<Prescribed>, Vec<Prescribed>) {
    given.sort_by_key(|given| given.dof);
    let mut first: Vec<Prescribed> = Vec::with_capacity(given.len());
    let mut clashes = Vec::new();
    for given in given {
        match first.last() {
            Some(before) if before.dof == given.dof => {
                if before.value != given.value {
                    clashes.push(given);
                }
            }
            _ => first.push(given),
        }
    }
    (first, clashes)
}

/// The values of `SPCD` cards in the load sets of the case; those of one DOF in several sets add up.
fn enforced(
    sets: &CaseSets,
    bulk: &BulkData,
    points: &Points,
    model: &mut Model,
) -> Result<Vec<Prescribed>, DeckError> {
    let mut all = Vec::new();
    for (set, support, place) in &bulk.enforced {
        if let Some(&factor) = sets.loads.get(set) {
            all.extend(prescribed(support, factor, place, (points, bulk), model)?);
        }
    }
    all.sort_by_key(|given: &Prescribed| given.dof);
    all.dedup_by(|next, first| {
        let same = next.dof == first.dof;
        first.value += if same { next.value } else { 0.0 };
        same
    });
    if let Some(infinite) = all.iter().find(|given| !given.value.is_finite()) {
        let problem = Problem::Degenerate { what: "the enforced displacement is no 64-bit number".into() };
        return Err(model.error(infinite.origin, None, problem));
    }
    Ok(all)
}

/// Lets enforced values take the place of those that `SPC` gives.
fn enforce(enforced: Vec<Prescribed>, prescribed: &mut Vec<Prescribed>, clashes: &mut Vec<Prescribed>) {
    if enforced.is_empty() {
        return;
    }
    let is_enforced = |given: &Prescribed| enforced.binary_search_by_key(&given.dof, |given| given.dof).is_ok();
    prescribed.retain(|given| !is_enforced(given));
    clashes.retain(|given| !is_enforced(given));
    prescribed.extend(enforced);
    prescribed.sort_by_key(|given| given.dof);
}

fn loads(sets: &CaseSets, bulk: &BulkData, points: &Points, model: &mut Model) -> Vec<Load> {
    let mut loads = Vec::new();
    for loaded in bulk.loads.iter().filter(|loaded| sets.loads.contains_key(&loaded.set)) {
        let origin = loaded.place.origin(model);
        // A load on a point that the deck does not define loads nothing that is constrained.
        let dofs = points.dofs(loaded.node, loaded.components).unwrap_or_default();
        loads.extend(dofs.into_iter().map(|dof| Load { dof, origin }));
    }
    loads
}
