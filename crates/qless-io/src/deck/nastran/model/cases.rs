//! Builds the prescribed DOFs and the loads of a load case.

use super::points::{PointKind, Points, limited};
use crate::deck::nastran::cards::bulk::BulkData;
use crate::deck::nastran::cards::sets::PointSupport;
use crate::deck::nastran::control::selected::CaseSets;
use crate::deck::nastran::syntax::card::CardLocation;
use crate::deck::{DeckError, Dof, Load, LoadCase, Model, Prescribed, Problem};

/// The load case in which these `sets` hold.
pub fn case(
    name: &str,
    sets: &CaseSets,
    sets_of: &[(u32, u32)],
    bulk: &BulkData,
    points: &Points,
    model: &mut Model,
) -> Result<LoadCase, DeckError> {
    let mut all = prescribed_by_grids(points, model);
    for (_, support, place) in bulk.supports.iter().filter(|(set, ..)| sets.spc.contains(set)) {
        all.extend(prescribed(support, 1.0, place, (points, bulk), model)?);
        limited(all.len()).map_err(|problem| place.error(problem, model))?;
    }
    let (mut prescribed, mut clashes) = split_clashes(all);
    enforce(enforced(sets, bulk, points, model)?, &mut prescribed, &mut clashes);
    let removed = sets_of.iter().filter(|(_, set)| !sets.mpc.contains(set)).map(|&(equation, _)| equation).collect();
    Ok(LoadCase { name: name.to_owned(), prescribed, clashes, loads: loads(sets, bulk, points, model), removed })
}

/// The components that `GRID` cards prescribe, with the value zero.
fn prescribed_by_grids(points: &Points, model: &mut Model) -> Vec<Prescribed> {
    let mut all = Vec::new();
    for (grid, set) in points.prescribed() {
        let origin = points.place(grid).origin(model);
        let dofs = set.iter().map(|component| Dof { node: grid.id, component });
        all.extend(dofs.map(|dof| Prescribed { dof, history: 0, value: 0.0, origin }));
    }
    all
}

/// The values that a card prescribes, multiplied by a factor.
fn prescribed(
    support: &PointSupport,
    factor: f64,
    place: &CardLocation,
    (points, bulk): (&Points, &BulkData),
    model: &mut Model,
) -> Result<Vec<Prescribed>, DeckError> {
    let nodes = points.expand(&support.points).map_err(|problem| place.error(problem, model))?;
    points.warn_of_unknown(nodes.iter().copied(), place, model);
    if bulk.is_mystran {
        refuse_unknown(support, place, points, model);
    }
    let mut all = Vec::with_capacity(nodes.len() * support.components.len());
    let (origin, value) = (place.origin(model), factor * support.value);
    for node in nodes {
        if bulk.is_mystran && support.components.is_empty() && points.kind(node) == PointKind::Grid {
            let text = format!("{} names no component of grid point {node}: MYSTRAN prescribes none", place.name);
            model.warn(place.file, place.line, text);
            continue;
        }
        let dofs = points.dofs(node, support.components).map_err(|fault| place.error(fault.into(), model))?;
        all.extend(dofs.into_iter().map(|dof| Prescribed { dof, value, history: 0, origin }));
    }
    Ok(all)
}

/// Refuses a card that prescribes undefined points, because MYSTRAN stops there. If the card names a range, both of its ends must be
/// defined.
fn refuse_unknown(support: &PointSupport, place: &CardLocation, points: &Points, model: &mut Model) {
    let mut ends = support.points.iter().flat_map(|span| [span.first, span.last]);
    if let Some(node) = ends.find(|&node| points.kind(node) == PointKind::Unknown) {
        let text = format!("{} prescribes point {node}, which is not defined: MYSTRAN stops", place.name);
        model.refuse(place.file, place.line, text);
    }
}

/// Splits values into the first value of each DOF, ascending by DOF, and the later values that contradict it.
fn split_clashes(mut all: Vec<Prescribed>) -> (Vec<Prescribed>, Vec<Prescribed>) {
    all.sort_by_key(|prescribed| prescribed.dof);
    let mut first: Vec<Prescribed> = Vec::with_capacity(all.len());
    let mut clashes = Vec::new();
    for next in all {
        match first.last() {
            Some(before) if before.dof == next.dof => {
                if before.value != next.value {
                    clashes.push(next);
                }
            }
            _ => first.push(next),
        }
    }
    (first, clashes)
}

/// The values of the `SPCD` cards in the load sets of the case. Several values of one DOF are added.
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
    all.sort_by_key(|enforced: &Prescribed| enforced.dof);
    all.dedup_by(|next, first| {
        let same = next.dof == first.dof;
        first.value += if same { next.value } else { 0.0 };
        same
    });
    if let Some(infinite) = all.iter().find(|enforced| !enforced.value.is_finite()) {
        let problem = Problem::Degenerate { what: "the enforced displacement is too large for a 64-bit number".into() };
        return Err(model.error(infinite.origin, None, problem));
    }
    Ok(all)
}

/// Replaces the values that `SPC` prescribes by enforced values of the same DOFs.
fn enforce(enforced: Vec<Prescribed>, prescribed: &mut Vec<Prescribed>, clashes: &mut Vec<Prescribed>) {
    if enforced.is_empty() {
        return;
    }
    let is_enforced = |p: &Prescribed| enforced.binary_search_by_key(&p.dof, |enforced| enforced.dof).is_ok();
    prescribed.retain(|p| !is_enforced(p));
    clashes.retain(|p| !is_enforced(p));
    prescribed.extend(enforced);
    prescribed.sort_by_key(|p| p.dof);
}

fn loads(sets: &CaseSets, bulk: &BulkData, points: &Points, model: &mut Model) -> Vec<Load> {
    let mut loads = Vec::new();
    for loaded in bulk.loads.iter().filter(|loaded| sets.loads.contains_key(&loaded.set)) {
        let origin = loaded.place.origin(model);
        // A load on an undefined point does not matter: it acts on no constrained DOF.
        let dofs = points.dofs(loaded.node, loaded.components).unwrap_or_default();
        loads.extend(dofs.into_iter().map(|dof| Load { dof, origin }));
    }
    loads
}
