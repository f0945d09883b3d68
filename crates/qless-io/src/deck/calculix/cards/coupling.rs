//! `*COUPLING` with `*KINEMATIC` or `*DISTRIBUTING`.
//!
//! In Abaqus, the reference of a distributing coupling moves as the weighted mean of the coupled nodes. Its displacement is `u_r = A_r S^-1
//! sum w_k a_k^T u_k` with `S = sum w_k a_k^T a_k`, where u_k, w_k and a_k are the displacement, weight and motion rows of node k, and A_r
//! the motion rows of the reference (see `kinematics::mean`). In ccx, the card only distributes forces: the motion of the reference does
//! not move the surface.

use crate::deck::calculix::cards::rigid::{BodyReference, kinematic, own_rotation};
use crate::deck::calculix::cards::{CardEquation, RegisteredCard, refused};
use crate::deck::calculix::model::{DeckDefinitions, DeckSurface};
use crate::deck::calculix::syntax::{DataLines, KeywordCard, Scope, float, number};
use crate::deck::kinematics::axes::Frame;
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::mean::{MeanElement, WeightedNodes};
use crate::deck::kinematics::vector::{length, minus};
use crate::deck::{DeckError, Model, Problem, Solver};
use crate::fault::quote;

/// A `*COUPLING` card. The card that follows it, `*KINEMATIC` or `*DISTRIBUTING`, decides its type.
#[derive(Clone)]
pub struct CouplingCard {
    scope: Scope,
    reference: String,
    surface: String,
    pub(in crate::deck::calculix) orientation: Option<String>,
    /// Radius of influence: nodes farther from the reference are not coupled.
    radius: Option<String>,
}

impl CouplingCard {
    pub fn from_card(card: &KeywordCard) -> Self {
        let text = |name| card.parameter(name).map(str::to_owned);
        Self {
            scope: card.scope,
            reference: text("REFNODE").unwrap_or_default(),
            surface: text("SURFACE").unwrap_or_default(),
            orientation: text("ORIENTATION"),
            radius: text("INFLUENCERADIUS"),
        }
    }

    /// The reference node. The card gives its number or a set of one node.
    pub fn reference(&self, definitions: &DeckDefinitions) -> Result<u32, Problem> {
        if self.reference.is_empty() {
            return Err(Problem::NoParameter { name: "REF NODE" });
        }
        definitions.one_node(self.scope, self.reference.as_bytes())
    }

    /// Whether the reference is itself a node of the surface.
    fn holds_its_reference(&self, definitions: &DeckDefinitions) -> bool {
        let surface = DeckSurface::find(definitions, self.scope, &self.surface);
        let reference = self.reference(definitions).ok();
        surface.is_ok_and(|surface| reference.is_some_and(|reference| surface.all_nodes().contains(&reference)))
    }

    /// The coupled nodes: those of the surface within the radius of influence, without the reference.
    pub fn nodes(&self, definitions: &DeckDefinitions) -> Result<Vec<u32>, Problem> {
        let reference = self.reference(definitions)?;
        let mut nodes = DeckSurface::find(definitions, self.scope, &self.surface)?.all_nodes();
        nodes.retain(|&node| node != reference);
        let Some(radius) = self.radius.as_ref().filter(|radius| !radius.eq_ignore_ascii_case("WORLD")) else {
            return Ok(nodes);
        };
        let radius = float(radius.as_bytes())?;
        let mut near = Vec::with_capacity(nodes.len());
        for node in nodes {
            if distance(definitions, node, reference)? <= radius {
                near.push(node);
            }
        }
        Ok(near)
    }

    fn kinematic(
        &self,
        card: &KeywordCard,
        definitions: &DeckDefinitions,
        solver: Solver,
    ) -> Result<Vec<CardEquation>, Problem> {
        if couples_nothing(card, solver) {
            return Ok(Vec::new());
        }
        let named = self.orientation.as_deref().map(|name| definitions.orientation(self.scope, name)).transpose()?;
        // Without ORIENTATION, ccx couples along the global axes, even at nodes with local axes.
        let local = named.or((solver == Solver::Ccx).then_some(Frame::BASIC));
        let reference = BodyReference::with_rotations(self.reference(definitions)?);
        let nodes = self.nodes(definitions)?;
        kinematic(definitions, reference, nodes.into_iter(), &components(card, 6)?, local.as_ref())
    }

    fn distributing(&self, card: &KeywordCard, definitions: &DeckDefinitions) -> Result<Vec<CardEquation>, Problem> {
        let reference = self.reference(definitions)?;
        let nodes = self.nodes(definitions)?;
        let mut groups = Vec::new();
        let weights = weights(card, definitions, reference, &nodes)?;
        for (node, weight) in nodes.into_iter().zip(weights).filter(|(_, weight)| *weight > 0.0) {
            groups.push(WeightedNodes { weight, components: translations(), nodes: vec![node] });
        }
        mean(definitions, reference, &components(card, 6)?, groups)
    }
}

/// Whether the card couples nothing: without data, `*KINEMATIC` couples nothing in ccx, but all components in Abaqus.
fn couples_nothing(card: &KeywordCard, solver: Solver) -> bool {
    solver == Solver::Ccx && card.lines().next().is_none()
}

/// Reads `*KINEMATIC` or `*DISTRIBUTING` after `*COUPLING`. Returns false if the card gives no equations.
pub fn read(
    card: &KeywordCard,
    coupling: &CouplingCard,
    model: &mut Model,
    definitions: &DeckDefinitions,
    solver: Solver,
) -> Result<bool, DeckError> {
    let is_kinematic = card.is("*KINEMATIC");
    let place = RegisteredCard::register(card, model, if is_kinematic { "*KINEMATIC" } else { "*DISTRIBUTING" });
    let rows = match (is_kinematic, solver) {
        (true, _) => coupling.kinematic(card, definitions, solver),
        (false, Solver::Ccx) => coupling.reference(definitions).map(|_| Vec::new()),
        (false, _) => coupling.distributing(card, definitions),
    };
    if is_kinematic && solver == Solver::Ccx && !couples_nothing(card, solver) {
        let components = components(card, 6).map_err(|problem| place.fail(model, problem))?;
        let nodes = coupling.nodes(definitions).unwrap_or_default();
        let is_plane = nodes.into_iter().any(|node| definitions.is_flat(node));
        refused::kinematic(card, &components, (is_plane, coupling.holds_its_reference(definitions)), model);
    }
    let before = model.equations();
    if is_kinematic {
        model.traits.has_oriented_couplings |= coupling.orientation.is_some();
        place.push(model, rows)?;
    } else {
        finish(card, &place, model, rows)?;
    }
    let constrains = model.equations() > before;
    if is_kinematic && constrains {
        // The default is never used, because `rows` has already checked that the reference exists.
        let reference = BodyReference::with_rotations(coupling.reference(definitions).unwrap_or_default());
        own_rotation(&place, reference, model, definitions);
        linearised(card, &place, model);
    }
    if is_kinematic && solver == Solver::Ccx && !constrains {
        model.warn(card.file, card.line, "*KINEMATIC without degrees of freedom: ccx couples nothing");
    }
    Ok(constrains)
}

/// Adds the equations `rows` of a coupling. If there are any, marks the card: equations cannot replace it in the deck, because the solver
/// adds rotations to the reference.
pub fn finish(
    card: &KeywordCard,
    place: &RegisteredCard,
    model: &mut Model,
    rows: Result<Vec<CardEquation>, Problem>,
) -> Result<(), DeckError> {
    let before = model.equations();
    place.push(model, rows)?;
    if model.equations() > before {
        place.mark_irreplaceable(model);
        linearised(card, place, model);
    }
    Ok(())
}

fn linearised(card: &KeywordCard, place: &RegisteredCard, model: &mut Model) {
    let name = model.cards.nth(place.origin.card).name;
    model.warn(card.file, card.line, format!("{name} is linearised at the reference configuration"));
}

fn distance(definitions: &DeckDefinitions, a: u32, b: u32) -> Result<f64, Problem> {
    Ok(length(minus(definitions.position(a)?, definitions.position(b)?)))
}

/// The weight of each node. It depends on the distance from the reference, divided by the largest such distance.
fn weights(card: &KeywordCard, of: &DeckDefinitions, reference: u32, nodes: &[u32]) -> Result<Vec<f64>, Problem> {
    const EXPECTED: &str = "UNIFORM, LINEAR, QUADRATIC or CUBIC";
    let method = card.word("WEIGHTINGMETHOD").unwrap_or_else(|| "UNIFORM".into());
    let weight: fn(f64) -> f64 = match method.as_str() {
        "UNIFORM" => |_| 1.0,
        "LINEAR" => |x| 1.0 - x,
        "QUADRATIC" => |x| 1.0 - x * x,
        "CUBIC" => |x| 1.0 - x * x * (3.0 - 2.0 * x),
        _ => return Err(Problem::Expected { expected: EXPECTED, found: quote(method.as_bytes()) }),
    };
    let distances: Vec<f64> = nodes.iter().map(|&node| distance(of, node, reference)).collect::<Result<_, _>>()?;
    let largest = distances.iter().fold(0.0, |largest: f64, x| largest.max(*x));
    let part = |x: f64| if largest > 0.0 { x / largest } else { 0.0 };
    let weights: Vec<f64> = distances.iter().map(|&x| weight(part(x))).collect();
    // If all nodes are at the largest distance, all weights are 0: weigh the nodes equally.
    Ok(if weights.iter().all(|&x| x == 0.0) { vec![1.0; nodes.len()] } else { weights })
}

/// The equations by which the reference moves as the weighted mean of the nodes in `groups`.
pub fn mean(
    definitions: &DeckDefinitions,
    reference: u32,
    components: &[u8],
    groups: Vec<WeightedNodes>,
) -> Result<Vec<CardEquation>, Problem> {
    let digits: Vec<u8> = components.iter().map(|component| b'0' + component).collect();
    let components = Components::parse(&digits).unwrap_or_default();
    let mean = MeanElement { reference, components, groups, dependent: Vec::new() };
    Ok(mean.equations(definitions)?.into_iter().map(|row| CardEquation { terms: row.terms, rhs: 0.0 }).collect())
}

pub fn translations() -> Components {
    Components::parse(b"123").unwrap_or_default()
}

/// Reads components from lines `first, last`. A card without data means all components from 1 to `most`.
fn components(card: &KeywordCard, most: u8) -> Result<Vec<u8>, Problem> {
    let mut components = Vec::new();
    for line in DataLines::new(&card.data) {
        components.extend(range(&mut line.fields(), most)?);
    }
    components.sort_unstable();
    components.dedup();
    Ok(if components.is_empty() { (1..=most).collect() } else { components })
}

/// Reads components from `first, last`. If both are missing, they are all components from 1 to `most`.
pub fn range<'a>(fields: &mut impl Iterator<Item = &'a [u8]>, most: u8) -> Result<Vec<u8>, Problem> {
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
