//! Makes the equations of `*PRE-TENSION SECTION` in ccx: two sides move apart along a normal n, by component 1 of the reference node r.
//!
//! ```text
//! u_k' - u_k = n u_r1            for each node k of a surface
//! n . (u_2 - u_1) = -u_r1        for a beam from node 1 to node 2
//! ```
//!
//! The elements of the surface leave its nodes: instead of k they get a new node k' at the same place. The card gives n. If it does not, n
//! is the mean of the outward normals of the faces, or the direction of the beam. ccx removes the beam.

use crate::deck::calculix::cards::free_slave::SlaveRule;
use crate::deck::calculix::cards::{CardEquation, RegisteredCard, mean_rotation};
use crate::deck::calculix::model::{DeckDefinitions, DeckSurface};
use crate::deck::calculix::syntax::{KeywordCard, float, number};
use crate::deck::kinematics::axes::BASIC_AXES;
use crate::deck::kinematics::project::MasterFace;
use crate::deck::kinematics::vector::{Vector, cross, minus, plus, scaled, unit};
use crate::deck::{DeckError, Dof, Model, Problem};
use crate::fault::quote;

/// Name of these cards in the model.
const NAME: &str = "*PRE-TENSION SECTION";
const CUT: &str = "it cuts the mesh, which equations cannot do";
/// Cards that name the nodes of their equations. Others take the nodes of faces or elements, and so may get nodes that a cut has made.
const BY_NODE: [&str; 4] = ["*EQUATION", "*MPC", mean_rotation::NAME, "*DISTRIBUTING COUPLING"];
/// ccx 2.20 takes a direction as the slave's only if the normal is at least this large in it.
const SMALLEST: f64 = 1e-10;

/// The nodes that a card doubles, ascending.
pub struct CutNodes {
    card: u32,
    nodes: Vec<u32>,
}

/// Adds the equations of a card. Returns the nodes that it doubles, or how ccx chooses the slave of the only equation.
pub fn read(
    card: &KeywordCard,
    is_late: bool,
    model: &mut Model,
    definitions: &DeckDefinitions,
) -> Result<(CutNodes, Option<SlaveRule>), DeckError> {
    let place = RegisteredCard::register(card, model, NAME);
    model.cards.fix_because(place.origin.card, CUT);
    if is_late {
        let text = "ccx stops: *PRE-TENSION SECTION follows the start of a step; write it before";
        model.refuse(card.file, card.line, text);
    }
    warn_of_sets(card, model);
    let section = PreTension { card, definitions };
    let made = if card.parameter("ELEMENT").is_some() { section.beam() } else { section.surface() };
    let made = made.map_err(|problem| place.fail(model, problem))?;
    for (own, other) in &made.doubled {
        model.name_node(*other, format!("{} across line {}", model.node_name(*own), card.line));
    }
    let nodes = made.doubled.iter().map(|(own, _)| *own).collect();
    place.push(model, Ok(made.rows))?;
    Ok((CutNodes { card: place.origin.card, nodes }, made.rule))
}

fn warn_of_sets(card: &KeywordCard, model: &mut Model) {
    for (parameter, what) in [("NODE", "a node"), ("ELEMENT", "an element")] {
        if let Some(set) = card.parameter(parameter).filter(|text| number(text.as_bytes(), what).is_err()) {
            let text = format!("{NAME}: ccx 2.20 refuses the set {set} as {what}; give the number");
            model.warn(card.file, card.line, text);
        }
    }
}

/// Leaves out sections whose nodes also occur in equations of faces or elements: these may have to name new nodes instead.
pub fn leave_out_shared(model: &mut Model, sections: &[CutNodes]) {
    for CutNodes { card, nodes } in sections {
        let is_cut = |&j: &u32| nodes.binary_search(&model.dofs[j as usize].node).is_ok();
        let follows_mesh = |i: &usize| {
            let (own, equation) = (model.nth(*i).origin.card, model.nth(*i));
            let name = model.cards.nth(own).name;
            own != *card && !BY_NODE.iter().any(|by_node| name == *by_node) && equation.columns.iter().any(is_cut)
        };
        let found = (0..model.equations()).filter(|_| !nodes.is_empty()).find(follows_mesh);
        let Some(other) = found.map(|i| model.place(model.nth(i).origin)) else { continue };
        let own = model.cards.nth(*card);
        let text = format!("{NAME} doubles nodes that {other} takes from faces or elements: left out");
        model.leave_out(own.file, own.line, text);
    }
}

/// The equations of a card, each node of a cut with its new one, and how ccx chooses the slave.
struct MadeSection {
    rows: Vec<CardEquation>,
    doubled: Vec<(u32, u32)>,
    rule: Option<SlaveRule>,
}

struct PreTension<'a> {
    card: &'a KeywordCard,
    definitions: &'a DeckDefinitions,
}

impl PreTension<'_> {
    fn reference(&self) -> Result<u32, Problem> {
        let node = self.card.parameter("NODE").ok_or(Problem::NoParameter { name: "NODE" })?;
        self.definitions.one_node(self.card.scope, node.as_bytes())
    }

    /// The normal that the card gives; `None` if it gives none.
    fn given_normal(&self) -> Result<Option<Vector>, Problem> {
        let Some(line) = self.card.lines().next() else { return Ok(None) };
        let mut normal = [0.0; 3];
        for (x, field) in normal.iter_mut().zip(line.fields()).filter(|(_, field)| !field.is_empty()) {
            *x = float(field)?;
        }
        unit_or(normal, "the normal is zero").map(Some)
    }

    fn surface(&self) -> Result<MadeSection, Problem> {
        let (of, name) = (self.definitions, self.card.parameter("SURFACE"));
        let name = name.ok_or(Problem::NoParameter { name: "SURFACE" })?;
        let surface = DeckSurface::find(of, self.card.scope, name)?;
        if surface.faces.is_empty() {
            let expected = "a surface of element faces";
            return Err(Problem::Expected { expected, found: quote(name.as_bytes()) });
        }
        let components = self.components(&surface)?;
        let normal = self.given_normal()?.map_or_else(|| self.mean_normal(&surface), Ok)?;
        if components == 2 && normal[2] != 0.0 {
            return Err(Problem::NotFollowed { what: "a normal in the plane of the elements".into() });
        }
        let (nodes, reference) = (surface.all_nodes(), self.reference()?);
        let places = nodes.iter().map(|&node| of.position(node)).collect::<Result<Vec<_>, _>>()?;
        let doubled: Vec<(u32, u32)> = nodes.into_iter().zip(of.make_nodes(&places)?).collect();
        let mut rows = Vec::with_capacity(components * doubled.len());
        for (&(own, other), k) in doubled.iter().flat_map(|pair| (0..components).map(move |k| (pair, k))) {
            let axis = BASIC_AXES[k];
            let apart = (reference, scaled(BASIC_AXES[0], -normal[k]));
            rows.push(CardEquation::along(of, &[(other, axis), (own, scaled(axis, -1.0)), apart], 0.0)?);
        }
        Ok(MadeSection { rows, doubled, rule: None })
    }

    /// How many components of the nodes the section ties: two for plane elements, three for solids and for edges of shells.
    fn components(&self, surface: &DeckSurface) -> Result<usize, Problem> {
        let elements = self.definitions.elements()?;
        let shapes = || surface.elements.iter().map(|&element| elements.shape(element));
        if shapes().all(|shape| shape.is_plane()) {
            return Ok(2);
        }
        let are_shells = surface.is_line && shapes().all(|shape| shape.is_shell() && shape.rotates);
        if !are_shells && shapes().any(|shape| shape.is_expanded()) {
            return Err(Problem::NotFollowed { what: "faces of solids, or edges of plane elements or shells".into() });
        }
        Ok(3)
    }

    fn mean_normal(&self, surface: &DeckSurface) -> Result<Vector, Problem> {
        let elements = self.definitions.elements()?;
        let is_tetrahedron = |&element: &u32| !surface.is_line && matches!(elements.shape(element).nodes, Some(4 | 10));
        if surface.elements.iter().any(is_tetrahedron) {
            // ccx 2.20 computes wrong normals of tetrahedra, which depend on memory that it has not set.
            return Err(Problem::NotFollowed { what: "a given normal at faces of tetrahedra".into() });
        }
        let mut sum = [0.0; 3];
        for (face, &element) in surface.faces.iter().zip(&surface.elements) {
            let outward = self.outward(face, element, surface.is_line)?;
            sum = plus(sum, unit_or(outward, "a face has no normal")?);
        }
        unit_or(sum, "the faces have no mean normal")
    }

    /// A vector along the outward normal of a face at its centre. The corners of a face go round the inward normal. At an edge of a plane
    /// element or of a shell, the normal is perpendicular to the edge and to the normal of the element.
    fn outward(&self, face: &[u32], element: u32, is_line: bool) -> Result<Vector, Problem> {
        let position = |node| self.definitions.position(node);
        if !is_line {
            return Ok(scaled(MasterFace::new(face.to_vec(), false, position)?.normal(), -1.0));
        }
        let nodes = self.definitions.elements()?.nodes(element);
        let first = nodes.iter().position(|node| *node == face[0]).unwrap_or_default();
        let normal = MasterFace::new(nodes.to_vec(), false, position)?.normal_at_edge(first);
        Ok(cross(minus(position(face[1])?, position(face[0])?), normal))
    }

    fn beam(&self) -> Result<MadeSection, Problem> {
        let [from, to] = self.beam_nodes()?;
        let along = minus(self.definitions.position(to)?, self.definitions.position(from)?);
        let normal = self.given_normal()?.map_or_else(|| unit_or(along, "the beam has no length"), Ok)?;
        let gradients = [(to, normal), (from, scaled(normal, -1.0)), (self.reference()?, BASIC_AXES[0])];
        let row = CardEquation::along(self.definitions, &gradients, 0.0)?;
        Ok(MadeSection { rows: vec![row], doubled: Vec::new(), rule: Some(slave_rule(from, to, normal)) })
    }

    fn beam_nodes(&self) -> Result<[u32; 2], Problem> {
        let (elements, field) = (self.definitions.elements()?, self.card.parameter("ELEMENT").unwrap_or_default());
        if let [element] = self.definitions.element_or_set(self.card.scope, field.as_bytes())?[..] {
            let shape = elements.shape(element);
            let is_beam = shape.rotates && !shape.is_flat && !shape.is_shell();
            if let (true, &[from, to]) = (is_beam, elements.nodes(element)) {
                return Ok([from, to]);
            }
        }
        Err(Problem::Expected { expected: "one beam of type B31", found: quote(field.as_bytes()) })
    }
}

/// ccx takes the directions from the largest to the smallest component of the normal, and of each first the second node of the beam. Of
/// equal components, those are first that the sorting of ccx leaves there: it begins with the smaller one of the first and the last.
fn slave_rule(from: u32, to: u32, normal: Vector) -> SlaveRule {
    let size = |k: &usize| normal[*k].abs();
    let mut directions = if size(&2) > size(&0) { [2, 1, 0] } else { [0, 1, 2] };
    directions.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let usable = directions.into_iter().filter(|k| size(k) >= SMALLEST);
    SlaveRule::First(usable.flat_map(|k| [to, from].map(|node| Dof { node, component: k as u8 + 1 })).collect())
}

fn unit_or(a: Vector, what: &str) -> Result<Vector, Problem> {
    unit(a).ok_or_else(|| Problem::Degenerate { what: what.into() })
}
