//! Turns the content of a deck into a model: coordinate systems, then the equations of all `MPC` cards and elements, then load cases.

mod cases;
mod exclusive;
mod frames;
mod points;
mod warnings;

use std::collections::{BTreeSet, HashMap};

use super::cards::bulk::BulkData;
use super::cards::elements::{NastranElement, star};
use super::cards::sets::MpcTerm;
use super::cards::ties::TieCard;
use super::control::selected;
use super::control::selected::CaseSets;
use super::control::subcases::CaseControl;
use super::reader::{NastranContent, read};
use super::syntax::card::CardPlace;
use crate::deck::kinematics::mean::partial_rows;
use crate::deck::kinematics::rigid::Rigid;
use crate::deck::kinematics::row::{Poses, Row};
use crate::deck::kinematics::vector::minus;
use crate::deck::{CardFault, Deck, DeckError, Dof, Model, Problem, Sources};
use points::{DuplicateGrid, PointKind, Points, limited};
use warnings::brief;

/// What `RIGID` can change.
const MULTIPLIERS: &str = "RIGID: rigid elements are kept by Lagrange multipliers or stiffness, so that no component of theirs is a slave; \
                           that of an MPC card is";

/// The model of a deck.
pub fn build(mut content: NastranContent, sources: &Sources) -> Result<Model, DeckError> {
    let mut model = Model::new(sources.paths().to_vec());
    model.has_separate_cases = true;
    std::mem::take(&mut content.bulk.notes).tell(&mut model);
    let points = points(&mut content.bulk, &mut model)?;
    let multiplied = content.control.as_ref().and_then(CaseControl::multipliers);
    if let Some((file, line)) = multiplied {
        model.warn(file, line, MULTIPLIERS);
    }
    let selections = selected::selections(content.control.as_ref(), &content.bulk, &mut model);
    if content.bulk.is_mystran {
        refuse_zeros(&content, &mut model);
    }
    let cases = selected::sets(selections, &content.bulk, &mut model)?;
    let sets_of = ties(&content.bulk, &points, &cases, multiplied.is_some(), &mut model)?;
    let mut prescribed = 0;
    for (name, sets) in &cases {
        let case = cases::case(name, sets, &sets_of, &content.bulk, &points, &mut model)?;
        prescribed += case.prescribed.len();
        limited(prescribed).map_err(|problem| too_many(&model, problem))?;
        model.cases.push(case);
    }
    exclusive::claim(&content.bulk.exclusive, &points, &mut model)?;
    model.warnings = brief(std::mem::take(&mut model.warnings));
    model.refusals = brief(std::mem::take(&mut model.refusals));
    Ok(model)
}

/// The points with their coordinate systems.
pub fn points(bulk: &mut BulkData, model: &mut Model) -> Result<Points, DeckError> {
    let usual = bulk.usual.as_ref().map(|(usual, _)| *usual).unwrap_or_default();
    let points = Points::new(std::mem::take(&mut bulk.grids), std::mem::take(&mut bulk.scalars), usual);
    let mut points = points.map_err(|twice| defined_twice(&twice, model))?;
    if bulk.is_mystran {
        refuse_repeated(&points, model);
    }
    points.resolve(&bulk.frames).map_err(|(frame, problem)| match bulk.frame_places.get(&frame) {
        Some(place) => place.error(problem, model),
        None => DeckError { path: model.files[0].clone(), line: 0, card: "CORD".into(), field: None, problem },
    })?;
    Ok(points)
}

/// MYSTRAN takes no selection of set 0.
fn refuse_zeros(content: &NastranContent, model: &mut Model) {
    for choice in content.control.iter().flat_map(|control| &control.zeros) {
        model.refuse(choice.file, choice.line, "MYSTRAN stops at a selection of set 0: remove the line");
    }
}

/// MYSTRAN takes no second card of a grid point, even if it says the same.
fn refuse_repeated(points: &Points, model: &mut Model) {
    for [first, second] in points.repeated() {
        let text = format!("{} is that of {} already, where MYSTRAN stops: remove it", second.name, first.brief(model));
        model.refuse(second.file, second.line, text);
    }
}

fn defined_twice(twice: &DuplicateGrid, model: &mut Model) -> DeckError {
    let (id, [first, second]) = &**twice;
    let problem = CardFault::DefinedTwice { what: "grid point", id: *id, other: first.brief(model).into() };
    second.error(problem.into(), model)
}

fn too_many(model: &Model, problem: Problem) -> DeckError {
    DeckError { path: model.files[0].clone(), line: 0, card: "all subcases".into(), field: None, problem }
}

/// Adds the equations of all ties that some case selects.
fn ties(
    bulk: &BulkData,
    points: &Points,
    cases: &[(String, CaseSets)],
    is_multiplied: bool,
    model: &mut Model,
) -> Result<Vec<(u32, u32)>, DeckError> {
    let selected: BTreeSet<u32> = cases.iter().flat_map(|(_, sets)| sets.mpc.iter().copied()).collect();
    let (mut sets_of, mut row) = (Vec::new(), Vec::new());
    if !selected.is_empty() {
        let (cards, terms) = bulk.ties.counts();
        sets_of.reserve_exact(cards);
        model.reserve(cards, terms);
    }
    for tie in bulk.ties.iter() {
        match tie {
            TieCard::Mpc(card) if selected.contains(&card.set) => {
                sets_of.push((model.equations() as u32, card.set));
                let place = card.place();
                mpc(bulk.ties.terms_of(card), &place, (points, bulk), &mut row, model)?;
                fix_copied(&place, bulk, model);
            }
            TieCard::Mpc(_) => {}
            TieCard::Element(element, place) => {
                let card = add(element, place, bulk, points, model)?;
                if is_multiplied {
                    model.keep_by_multipliers(card);
                }
            }
        }
    }
    model.shrink();
    Ok(sets_of)
}

/// An `MPC` card that others copy, or that is a copy, stays as it is.
fn fix_copied(place: &CardPlace, bulk: &BulkData, model: &mut Model) {
    if bulk.fixed.contains(&(place.file, place.line)) {
        let card = place.origin(model).card;
        model.cards.fix(card, true);
    }
}

/// Adds the equations of an element and returns the number of its card.
fn add(
    element: &NastranElement,
    place: &CardPlace,
    bulk: &BulkData,
    points: &Points,
    model: &mut Model,
) -> Result<u32, DeckError> {
    let rows = rows(element, points).and_then(finite).map_err(|problem| place.error(problem, model))?;
    let origin = place.origin(model);
    model.cards.fix(origin.card, bulk.fixed.contains(&(place.file, place.line)));
    for row in rows {
        model.push(row.terms, 0.0, origin);
    }
    Ok(origin.card)
}

fn rows(element: &NastranElement, points: &Points) -> Result<Vec<Row>, Problem> {
    match element {
        NastranElement::Star(element) => star(element, points.expand(&element.dependent)?)?.rows(points),
        NastranElement::Rigid(element) => element.rows(points),
        NastranElement::Rod(element) => element.rows(points),
        NastranElement::Mean(element) => element.mean(|spans| points.expand(spans))?.rows(points),
        NastranElement::PartialMean(element) => partial_rows(&element.mean(|spans| points.expand(spans))?, points),
        NastranElement::Joint(element) => joint(element, points),
    }
}

/// The rows of a joint, whose points are at one place.
fn joint(element: &Rigid, points: &Points) -> Result<Vec<Row>, Problem> {
    let ends = element.independent.iter().zip(&element.dependent);
    for (&(a, _), &(b, _)) in ends {
        if minus(points.pose(a)?.position, points.pose(b)?.position) != [0.0; 3] {
            return Err(CardFault::JointApart { a, b }.into());
        }
    }
    element.rows(points)
}

/// Refuses coordinates so far apart that an equation cannot be written.
fn finite(rows: Vec<Row>) -> Result<Vec<Row>, Problem> {
    let whole = rows.iter().flat_map(|row| &row.terms).all(|(_, value)| value.is_finite());
    let problem = || Problem::Degenerate { what: "the grid points are too far apart for 64-bit numbers".into() };
    if whole { Ok(rows) } else { Err(problem()) }
}

/// Adds the equation of an `MPC` card, by way of `row`, which is filled anew.
fn mpc(
    terms: impl Iterator<Item = MpcTerm>,
    place: &CardPlace,
    (points, bulk): (&Points, &BulkData),
    row: &mut Vec<(Dof, f64)>,
    model: &mut Model,
) -> Result<(), DeckError> {
    row.clear();
    let mut is_unknown = false;
    for (node, set, value) in terms {
        let kind = points.kind(node);
        is_unknown |= kind == PointKind::Unknown;
        let dof = Points::dof(node, kind, set).map_err(|fault| place.error(fault.into(), model))?;
        row.push((dof, value));
    }
    if is_unknown {
        points.warn_of_unknown(row.iter().map(|(dof, _)| dof.node), place, model);
    }
    if bulk.is_mystran {
        take_last_of_dependent(row);
    }
    let origin = place.origin(model);
    model.push(row.iter().copied(), 0.0, origin);
    Ok(())
}

/// Where a card names its dependent DOF again, MYSTRAN takes the last coefficient of it; those of other DOFs add up.
fn take_last_of_dependent(row: &mut Vec<(Dof, f64)>) {
    let Some(&(dependent, _)) = row.first() else { return };
    if let Some(&(_, last)) = row[1..].iter().rfind(|(dof, _)| *dof == dependent) {
        row.retain(|(dof, _)| *dof != dependent);
        row.insert(0, (dependent, last));
    }
}

/// Positions in the basic system; none where the deck cannot be read once more.
pub fn positions(deck: &Deck) -> HashMap<u32, [f64; 3]> {
    let Ok(mut content) = deck.again(read) else { return HashMap::new() };
    let points = points(&mut content.bulk, &mut Model::new(deck.model.files.clone()));
    points.map(|points| points.positions().collect()).unwrap_or_default()
}
