//! Builds the model from the content of a deck: first the coordinate systems, then the equations of all `MPC` cards and elements, then the
//! load cases.

mod cases;
mod exclusive;
mod frames;
mod points;
mod stops;
mod warnings;

use std::collections::{BTreeSet, HashMap};

use super::cards::bulk::BulkData;
use super::cards::elements::NastranElement;
use super::cards::points::PointSpan;
use super::cards::sets::MpcTerm;
use super::cards::ties::TieCard;
use super::control::selected::{self, CaseSets};
use super::reader::{NastranContent, read};
use super::syntax::card::CardLocation;
use crate::deck::kinematics::body::{CouplingEquation, Poses};
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::mystran_mean::mystran_mean;
use crate::deck::kinematics::rigid::RigidElement;
use crate::deck::kinematics::vector::minus;
use crate::deck::{CardFault, Deck, DeckError, Dof, Model, Problem, Sources};
use points::{DuplicateGrid, PointKind, Points, limited};
use warnings::brief;

/// The warning about `RIGID = LAGRAN` and `RIGID = STIFF`.
const MULTIPLIERS: &str = "RIGID: Lagrange multipliers or stiffness enforce the rigid elements, so these have no slaves; the dependent \
                           component of an MPC card is a slave";

/// Builds the model of a deck.
pub fn build(mut content: NastranContent, sources: &Sources) -> Result<Model, DeckError> {
    let mut model = Model::new(sources.paths().to_vec());
    model.has_separate_cases = true;
    model.traits.keeps_dependent = content.bulk.keeps_dependent;
    std::mem::take(&mut content.bulk.notes).add_to(&mut model);
    let points = points(&mut content.bulk, &mut model)?;
    let multiplied = content.control.as_ref().and_then(|control| control.multipliers);
    if let Some((file, line)) = multiplied {
        model.warn(file, line, MULTIPLIERS);
    }
    let selections = selected::selections(content.control.as_ref(), &content.bulk, &mut model);
    if content.bulk.is_mystran {
        for choice in content.control.iter().flat_map(|control| &control.zeros) {
            model.refuse(choice.file, choice.line, "MYSTRAN stops at a selection of set 0: remove the line");
        }
    }
    let cases = selected::sets(selections, &content.bulk, &mut model)?;
    let mut building = NastranModel { bulk: &content.bulk, points: &points, model: &mut model };
    let sets_of = building.ties(&cases, multiplied.is_some())?;
    let mut prescribed = 0;
    for (name, sets) in &cases {
        let case = building.case(name, sets, &sets_of)?;
        prescribed += case.prescribed.len();
        limited(prescribed).map_err(|problem| too_many(building.model, problem))?;
        if building.bulk.is_mystran {
            stops::refuse_without_masters(&case, building.model);
        }
        building.model.cases.push(case);
    }
    exclusive::claim(&content.bulk.exclusive, &points, &mut model)?;
    model.warnings = brief(std::mem::take(&mut model.warnings));
    // Load cases that select the same sets repeat what is refused.
    let mut seen = BTreeSet::new();
    model.refusals.retain(|refusal| seen.insert((refusal.file, refusal.line, refusal.text.clone())));
    model.refusals = brief(std::mem::take(&mut model.refusals));
    Ok(model)
}

/// Makes the table of points, with their coordinate systems computed.
pub fn points(bulk: &mut BulkData, model: &mut Model) -> Result<Points, DeckError> {
    let defaults = bulk.grid_defaults.as_ref().map(|(defaults, _)| *defaults).unwrap_or_default();
    let points = Points::new(std::mem::take(&mut bulk.grids), std::mem::take(&mut bulk.scalars), defaults);
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

/// Refuses a second card of a grid point, because MYSTRAN stops there, even if both cards are equal.
fn refuse_repeated(points: &Points, model: &mut Model) {
    for [first, second] in points.repeated() {
        let text =
            format!("{} repeats the card of {}, where MYSTRAN stops: remove it", second.name, first.brief(model));
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

/// The model that is being built, and what it is built from.
struct NastranModel<'a> {
    bulk: &'a BulkData,
    points: &'a Points,
    model: &'a mut Model,
}

impl NastranModel<'_> {
    /// Adds the equations of all elements, and of the `MPC` cards that some load case selects. Returns, for each `MPC` equation, its index and
    /// its set.
    fn ties(&mut self, cases: &[(String, CaseSets)], is_multiplied: bool) -> Result<Vec<(u32, u32)>, DeckError> {
        let selected: BTreeSet<u32> = cases.iter().flat_map(|(_, sets)| sets.mpc.iter().copied()).collect();
        let (mut sets_of, mut row) = (Vec::new(), Vec::new());
        if !selected.is_empty() {
            let (cards, terms) = self.bulk.ties.counts();
            sets_of.reserve_exact(cards);
            self.model.reserve(cards, terms);
        }
        for tie in self.bulk.ties.iter() {
            match tie {
                TieCard::Mpc(card) if selected.contains(&card.set) => {
                    sets_of.push((self.model.equations() as u32, card.set));
                    let place = card.place();
                    self.mpc(self.bulk.ties.terms_of(card), &place, &mut row)?;
                    // The text of a card that is a copy or has copies must stay: equations cannot replace it.
                    if self.bulk.fixed.contains(&(place.file, place.line)) {
                        let card = place.origin(self.model).card;
                        self.model.cards.mark_irreplaceable(card, true);
                    }
                }
                TieCard::Mpc(_) => {}
                TieCard::Element(element, place) => {
                    if let Some(card) = self.add(element, place)?.filter(|_| is_multiplied) {
                        self.model.keep_by_multipliers(card);
                    }
                }
            }
        }
        self.model.shrink();
        Ok(sets_of)
    }

    /// Adds the equations of an element and returns the number of its card. A weighted mean that cannot be solved for its dependent
    /// components is left out.
    fn add(&mut self, element: &NastranElement, place: &CardLocation) -> Result<Option<u32>, DeckError> {
        let equations = match equations(element, self.points) {
            Err(
                problem @ Problem::Card(
                    CardFault::MeanUndetermined { .. } | CardFault::MeanCut { .. } | CardFault::UmSingular,
                ),
            ) => {
                self.leave_out(element, place, &problem);
                return Ok(None);
            }
            equations => equations.map_err(|problem| place.error(problem, self.model))?,
        };
        let origin = place.origin(self.model);
        self.model.cards.mark_irreplaceable(origin.card, self.bulk.fixed.contains(&(place.file, place.line)));
        for equation in equations {
            self.model.push(equation.terms, 0.0, origin);
        }
        Ok(Some(origin.card))
    }

    /// Leaves out a weighted mean that is singular. Its dependent DOFs must still not become slaves, so the model records the claim on them.
    fn leave_out(&mut self, element: &NastranElement, place: &CardLocation, problem: &Problem) {
        let origin = place.origin(self.model);
        self.model.leave_out(place.file, place.line, format!("{} is left out: {problem}", place.name));
        if self.bulk.is_mystran && !matches!(problem, Problem::Card(CardFault::MeanCut { .. })) {
            let text = format!("{}: MYSTRAN stops, because its equations are singular: {problem}", place.name);
            self.model.refuse(place.file, place.line, text);
        }
        let (NastranElement::Mean(mean) | NastranElement::MystranMean(mean)) = element else { return };
        let own = [(mean.reference, mean.components)];
        let dependent = if mean.dependent.is_empty() { &own[..] } else { &mean.dependent };
        let dofs = |&(node, set): &(u32, Components)| set.iter().map(move |component| Dof { node, component });
        let dofs: Vec<Dof> = dependent.iter().flat_map(dofs).collect();
        self.model.claim_left_out(dofs, origin);
    }

    /// Adds the equation of an `MPC` card. `row` is a buffer that all cards share.
    fn mpc(
        &mut self,
        terms: impl Iterator<Item = MpcTerm>,
        place: &CardLocation,
        row: &mut Vec<(Dof, f64)>,
    ) -> Result<(), DeckError> {
        row.clear();
        let mut is_unknown = false;
        for (node, set, value) in terms {
            let kind = self.points.kind(node);
            is_unknown |= kind == PointKind::Unknown;
            let dof = Points::dof(node, kind, set).map_err(|fault| place.error(fault.into(), self.model))?;
            row.push((dof, value));
        }
        if is_unknown {
            self.points.warn_of_unknown(row.iter().map(|(dof, _)| dof.node), place, self.model);
        }
        if self.bulk.is_mystran {
            take_last_of_dependent(row);
        }
        let origin = place.origin(self.model);
        self.model.push(row.iter().copied(), 0.0, origin);
        Ok(())
    }
}

fn equations(element: &NastranElement, points: &Points) -> Result<Vec<CouplingEquation>, Problem> {
    let expand = |spans: &[PointSpan]| points.expand(spans);
    let equations = match element {
        NastranElement::Star(star) => {
            RigidElement::about(star.centre, expand(&star.dependent)?, star.components).equations(points)
        }
        NastranElement::Rigid(element) => element.equations(points),
        NastranElement::Rod(element) => element.equation(points).map(|equation| vec![equation]),
        NastranElement::Mean(element) => element.expand(expand)?.equations(points),
        NastranElement::MystranMean(element) => mystran_mean(&element.expand(expand)?, points),
        NastranElement::Joint(element) => joint(element, points),
    }?;
    let is_finite = equations.iter().flat_map(|equation| &equation.terms).all(|(_, value)| value.is_finite());
    let problem = || Problem::Degenerate { what: "the grid points are too far apart for 64-bit numbers".into() };
    is_finite.then_some(equations).ok_or_else(problem)
}

/// The equations of a joint, whose points must coincide.
fn joint(element: &RigidElement, points: &Points) -> Result<Vec<CouplingEquation>, Problem> {
    for (&(a, _), &(b, _)) in element.independent.iter().zip(&element.dependent) {
        if minus(points.pose(a)?.position, points.pose(b)?.position) != [0.0; 3] {
            return Err(CardFault::JointApart { a, b }.into());
        }
    }
    element.equations(points)
}

/// If a card repeats its dependent DOF, keeps only the last coefficient of this DOF, as MYSTRAN does. Repeated terms of other DOFs stay,
/// because MYSTRAN adds them.
fn take_last_of_dependent(row: &mut Vec<(Dof, f64)>) {
    let Some(&(dependent, _)) = row.first() else { return };
    if let Some(&(_, last)) = row[1..].iter().rfind(|(dof, _)| *dof == dependent) {
        row.retain(|(dof, _)| *dof != dependent);
        row.insert(0, (dependent, last));
    }
}

/// The position of each grid point in the basic system; empty if the deck cannot be read again.
pub fn positions(deck: &Deck) -> HashMap<u32, [f64; 3]> {
    let Ok(mut content) = deck.again(read) else { return HashMap::new() };
    let points = points(&mut content.bulk, &mut Model::new(deck.model.files.clone()));
    points.map(|points| points.positions().collect()).unwrap_or_default()
}
