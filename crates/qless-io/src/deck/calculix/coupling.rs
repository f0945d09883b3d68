//! `*COUPLING` with `*KINEMATIC` or `*DISTRIBUTING`, and the older `*KINEMATIC COUPLING` and `*DISTRIBUTING COUPLING`.
//!
//! A distributing reference moves as the weighted mean of its nodes, `u_r = A_r S^-1 sum w_k a_k^T u_k`.

use super::card::Card;
use super::data::Lines;
use super::definitions::Definitions;
use super::fields::{float, number};
use super::frames::orientation;
use super::geometric::{Place, Row};
use super::mesh::Surface;
use super::rigid::{Reference, kinematic, own_rotation};
use crate::deck::kinematics::axes::BASIC_AXES;
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::mean::{Group, Mean};
use crate::deck::kinematics::vector::{Vector, scaled};
use crate::deck::{DeckError, Model, Problem};
use crate::fault::quote;

/// What a `*COUPLING` card says to the card after it.
#[derive(Clone)]
pub struct Coupling {
    reference: String,
    surface: String,
    orientation: Option<String>,
}

impl Coupling {
    pub fn of(card: &Card) -> Self {
        let text = |name| card.parameter(name).unwrap_or_default().to_owned();
        Self {
            reference: text("REFNODE"),
            surface: text("SURFACE"),
            orientation: card.parameter("ORIENTATION").map(str::to_owned),
        }
    }

    fn reference(&self) -> Result<u32, Problem> {
        if self.reference.is_empty() {
            return Err(Problem::NoParameter { name: "REF NODE" });
        }
        number(self.reference.as_bytes(), "a node")
    }

    /// The nodes of the surface without the reference.
    fn nodes(&self, definitions: &Definitions) -> Result<Vec<u32>, Problem> {
        let reference = self.reference()?;
        let mut nodes = Surface::find(definitions, &self.surface)?.all_nodes();
        nodes.retain(|&node| node != reference);
        Ok(nodes)
    }

    fn kinematic(&self, card: &Card, definitions: &Definitions) -> Result<Vec<Row>, Problem> {
        let local = self.orientation.as_deref().map(|name| orientation(definitions, name)).transpose()?;
        let reference = Reference::turning(self.reference()?);
        let nodes = self.nodes(definitions)?;
        kinematic(definitions, reference, nodes.into_iter(), &components(card, 6)?, local.as_ref())
    }

    fn distributing(&self, card: &Card, definitions: &Definitions) -> Result<Vec<Row>, Problem> {
        let group = Group { weight: 1.0, components: translations(), nodes: self.nodes(definitions)? };
        mean(definitions, self.reference()?, &components(card, 6)?, vec![group])
    }
}

/// `*KINEMATIC` or `*DISTRIBUTING` after `*COUPLING`.
pub fn read(card: &Card, coupling: &Coupling, model: &mut Model, definitions: &Definitions) -> Result<(), DeckError> {
    let is_kinematic = card.is("*KINEMATIC");
    let place = Place::of(card, model, if is_kinematic { "*KINEMATIC" } else { "*DISTRIBUTING" });
    let rows =
        if is_kinematic { coupling.kinematic(card, definitions) } else { coupling.distributing(card, definitions) };
    model.traits.has_turned_couplings |= is_kinematic && coupling.orientation.is_some();
    match coupling.reference() {
        Ok(node) if is_kinematic => {
            place.push(model, rows)?;
            own_rotation(&place, Reference::turning(node), model, definitions);
            linearised(card, &place, model);
            Ok(())
        }
        _ => finish(card, &place, model, rows),
    }
}

/// `*KINEMATIC COUPLING, REF NODE=`: `node or set, first, last` a line.
pub fn kinematic_coupling(card: &Card, model: &mut Model, definitions: &Definitions) -> Result<(), DeckError> {
    let place = Place::of(card, model, "*KINEMATIC COUPLING");
    let rows = || {
        let reference = card.parameter("REFNODE").ok_or(Problem::NoParameter { name: "REF NODE" })?;
        let reference = Reference::turning(number(reference.as_bytes(), "a node")?);
        let mut rows = Vec::new();
        for line in card.lines() {
            let mut fields = line.fields();
            let nodes = definitions.node_or_set(fields.next().unwrap_or_default())?;
            let range = range(&mut fields, 6)?;
            let nodes = nodes.into_iter().filter(|&node| node != reference.node);
            rows.extend(kinematic(definitions, reference, nodes, &range, None)?);
        }
        Ok(rows)
    };
    let rows = rows();
    finish(card, &place, model, rows)
}

/// `*DISTRIBUTING COUPLING, ELSET=`: `node or set, weight` a line; the element set holds the reference, wherever that is. As CalculiX
/// has it: `sum w_k u_k - sum w_k u_r = 0` in each direction, the first node being the slave.
pub fn distributing_coupling(card: &Card, model: &mut Model, definitions: &Definitions) -> Result<(), DeckError> {
    let place = Place::of(card, model, "*DISTRIBUTING COUPLING");
    let rows = || {
        let set = card.parameter("ELSET").ok_or(Problem::NoParameter { name: "ELSET" })?;
        let [reference] = definitions.nodes_of(set)?[..] else {
            let found = quote(set.as_bytes());
            return Err(Problem::Expected { expected: "an element set with one node, the reference", found });
        };
        let mut weights: Vec<(u32, f64)> = Vec::new();
        for line in card.lines() {
            let mut fields = line.fields();
            let nodes = definitions.node_or_set(fields.next().unwrap_or_default())?;
            let weight = fields.next().filter(|field| !field.is_empty()).map_or(Ok(1.0), float)?;
            weights.extend(nodes.into_iter().map(|node| (node, weight)));
        }
        let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
        weights.push((reference, -total));
        let gradients = |axis: Vector| weights.iter().map(|&(node, w)| (node, scaled(axis, w))).collect::<Vec<_>>();
        BASIC_AXES.iter().map(|&axis| Row::along(definitions, &gradients(axis), 0.0)).collect()
    };
    let rows = rows();
    place.push(model, rows)
}

fn finish(card: &Card, place: &Place, model: &mut Model, rows: Result<Vec<Row>, Problem>) -> Result<(), DeckError> {
    place.push(model, rows)?;
    // The rotations of the reference are DOFs that the solver adds.
    place.fix(model);
    linearised(card, place, model);
    Ok(())
}

fn linearised(card: &Card, place: &Place, model: &mut Model) {
    let name = model.cards.nth(place.origin.card).name;
    model.warn(card.file, card.line, format!("{name} is linearised at the reference configuration"));
}

fn mean(definitions: &Definitions, reference: u32, components: &[u8], groups: Vec<Group>) -> Result<Vec<Row>, Problem> {
    let digits: Vec<u8> = components.iter().map(|component| b'0' + component).collect();
    let components = Components::parse(&digits).unwrap_or_default();
    let mean = Mean { reference, components, groups, dependent: Vec::new() };
    Ok(mean.rows(definitions)?.into_iter().map(|row| Row { terms: row.terms, rhs: 0.0 }).collect())
}

fn translations() -> Components {
    Components::parse(b"123").unwrap_or_default()
}

/// `first, last` a line; all up to `most` without data.
fn components(card: &Card, most: u8) -> Result<Vec<u8>, Problem> {
    let mut components = Vec::new();
    for line in Lines::new(&card.data) {
        components.extend(range(&mut line.fields(), most)?);
    }
    components.sort_unstable();
    components.dedup();
    Ok(if components.is_empty() { (1..=most).collect() } else { components })
}

fn range<'a>(fields: &mut impl Iterator<Item = &'a [u8]>, most: u8) -> Result<Vec<u8>, Problem> {
    const EXPECTED: &str = "a degree of freedom from 1 to 6";
    let mut next = || {
        let field = fields.next().filter(|field| !field.is_empty());
        let value = field.map(|field| number(field, EXPECTED)).transpose()?;
        match value.map(u8::try_from) {
            None => Ok(None),
            Some(Ok(value)) if (1..=most).contains(&value) => Ok(Some(value)),
            Some(_) => Err(Problem::Expected { expected: EXPECTED, found: quote(field.unwrap_or_default()) }),
        }
    };
    let Some(first) = next()? else { return Ok((1..=most).collect()) };
    let last = next()?.unwrap_or(first);
    Ok((first..=last.max(first)).collect())
}
