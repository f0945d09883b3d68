//! From cards to a model: coordinate systems, then the equations of every tie, then the load cases.

use std::collections::BTreeSet;

use super::bulk::{Bulk, Tie};
use super::cases;
use super::content::Content;
use super::elements::star;
use super::fault::CardFault;
use super::grid::Grid;
use super::mpc::Term;
use super::place::Place;
use super::points::{Point, Points, limited};
use super::row::Row;
use super::selected::{self, Sets};
use super::warnings::brief;
use crate::deck::{DeckError, Dof, Model, Origin, Problem, Sources};

/// The model of a deck.
pub(super) fn model(mut content: Content, sources: &Sources) -> Result<Model, DeckError> {
    let mut model = Model::new(sources.paths().to_vec());
    for (file, line, text) in std::mem::take(&mut content.bulk.warnings) {
        model.warn(file, line, text);
    }
    let points = points(&mut content.bulk, &mut model)?;
    let selections = selected::selections(&content, &mut model);
    let cases = selected::sets(selections, &content.bulk, &mut model)?;
    let sets_of = ties(&content.bulk, &points, &cases, &mut model)?;
    let mut prescribed = 0;
    for (name, sets) in &cases {
        let case = cases::case(name, sets, &sets_of, &content.bulk, &points, &mut model)?;
        prescribed += case.prescribed.len();
        limited(prescribed).map_err(|problem| too_many(&model, problem))?;
        model.cases.push(case);
    }
    model.warnings = brief(std::mem::take(&mut model.warnings));
    Ok(model)
}

fn points(bulk: &mut Bulk, model: &mut Model) -> Result<Points, DeckError> {
    let usual = bulk.usual.as_ref().map(|(usual, _)| *usual).unwrap_or_default();
    let points = Points::new(std::mem::take(&mut bulk.grids), std::mem::take(&mut bulk.scalars), usual);
    let mut points = points.map_err(|pair| defined_twice(&pair, model))?;
    points.resolve(&bulk.frames).map_err(|(frame, problem)| match bulk.frame_places.get(&frame) {
        Some(place) => fail(place, problem, model),
        None => DeckError { path: model.files[0].clone(), line: 0, card: "CORD".into(), field: None, problem },
    })?;
    Ok(points)
}

fn defined_twice(pair: &[Grid; 2], model: &mut Model) -> DeckError {
    let place =
        |grid: &Grid| Place { name: format!("GRID {}", grid.id).into(), file: grid.file, line: grid.line, lines: 1 };
    let other = place(&pair[0]).brief(model).into();
    let problem = CardFault::DefinedTwice { what: "grid point", id: pair[0].id, other };
    fail(&place(&pair[1]), problem.into(), model)
}

/// An error of a card.
pub(super) fn fail(place: &Place, problem: Problem, model: &mut Model) -> DeckError {
    let origin = place.origin(model);
    model.error(origin, None, problem)
}

fn too_many(model: &Model, problem: Problem) -> DeckError {
    DeckError { path: model.files[0].clone(), line: 0, card: "all subcases".into(), field: None, problem }
}

/// Equations of `MPC` cards with their set.
pub(super) type SetsOf = Vec<(u32, u32)>;

/// Adds the equations of all ties that some case selects.
fn ties(bulk: &Bulk, points: &Points, cases: &[(String, Sets)], model: &mut Model) -> Result<SetsOf, DeckError> {
    let selected: BTreeSet<u32> = cases.iter().flat_map(|(_, sets)| sets.mpc.iter().copied()).collect();
    let mut sets_of = SetsOf::new();
    for (tie, place) in &bulk.ties {
        if let Tie::Mpc { set, terms } = tie {
            if selected.contains(set) {
                sets_of.push((model.equations() as u32, *set));
                mpc(terms, place, points, model)?;
            }
            continue;
        }
        let rows = rows(tie, points).and_then(finite).map_err(|problem| fail(place, problem, model))?;
        let origin = place.origin(model);
        model.cards[origin.card as usize].is_fixed = bulk.expanding.contains(&(place.file, place.line));
        for row in rows {
            model.push(row.terms, 0.0, origin);
        }
    }
    Ok(sets_of)
}

fn rows(tie: &Tie, points: &Points) -> Result<Vec<Row>, Problem> {
    match tie {
        Tie::Star(element) => star(element, points.expand(&element.dependent)?)?.rows(points),
        Tie::Rigid(element) => element.rows(points),
        Tie::Rod(element) => element.rows(points),
        Tie::Mean(element) => element.rows(points),
        Tie::Mpc { .. } => Ok(Vec::new()),
    }
}

/// Refuses coordinates so far apart that an equation cannot be written.
fn finite(rows: Vec<Row>) -> Result<Vec<Row>, Problem> {
    let whole = rows.iter().flat_map(|row| &row.terms).all(|(_, value)| value.is_finite());
    let problem = || Problem::Degenerate { what: "the grid points are too far apart for 64-bit numbers".into() };
    if whole { Ok(rows) } else { Err(problem()) }
}

fn mpc(terms: &[Term], place: &Place, points: &Points, model: &mut Model) -> Result<(), DeckError> {
    let dof = |&(node, set, value): &Term| points.dofs(node, set).map(|dofs| (dofs[0], value));
    let terms: Result<Vec<(Dof, f64)>, CardFault> = terms.iter().map(dof).collect();
    let terms = terms.map_err(|fault| fail(place, fault.into(), model))?;
    warn_of_unknown(terms.iter().map(|(dof, _)| dof.node), place, points, model);
    let origin: Origin = place.origin(model);
    model.push(terms, 0.0, origin);
    Ok(())
}

/// Says which points of a card the deck does not define; scalar points may be those of elements.
pub(super) fn warn_of_unknown(nodes: impl Iterator<Item = u32>, place: &Place, points: &Points, model: &mut Model) {
    let unknown: BTreeSet<u32> = nodes.filter(|&node| points.kind(node) == Point::Unknown).collect();
    if let Some(first) = unknown.first() {
        let more = if unknown.len() > 1 { format!(" and {} more", unknown.len() - 1) } else { String::new() };
        let text = format!("{}: no GRID or SPOINT defines point {first}{more}; taken as it stands", place.name);
        model.warn(place.file, place.line, text);
    }
}
