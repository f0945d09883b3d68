//! Reads `*MPC`, which gives a type and nodes. Its equations are linearised at the reference configuration.
//!
//! | type | equation |
//! | --- | --- |
//! | `PLANE a b c k...` | `det[x_k - x_a, x_b - x_a, x_c - x_a] = 0` for each k |
//! | `STRAIGHT a b k...` | `(x_k - x_a) x (x_b - x_a) = 0` for each k |
//! | `BEAM a b` | a rigid beam, with the rotations of a if it has them; in CalculiX a constant distance unless both nodes have rotations |
//! | `LINK a b` | `abs(x_a - x_b)` constant |
//! | `PIN a b` | `u_a = u_b`, in global directions |
//! | `TIE a b` | `u_a = u_b`, also for rotations if both nodes have them |
//! | `MEANROT k k k... p` | component 1 of p is the mean rotation of nodes k about the axis along p's coordinates (CalculiX) |
//! | `DIST a a a b b b c` | `abs(x_a - x_b)` does not exceed the first coordinate of c (CalculiX) |
//!
//! x_k is the position of node k, and u_k its displacement. In the types with two nodes, a may be a node set. Each of its nodes is then
//! coupled to b, or to its partner in a set b of the same size (Abaqus).

use crate::deck::calculix::cards::mean_rotation;
use crate::deck::calculix::cards::rigid::{BodyReference, kinematic};
use crate::deck::calculix::cards::unread::claim;
use crate::deck::calculix::cards::{CardEquation, RegisteredCard, refused, tie};
use crate::deck::calculix::model::{DeckDefinitions, folded};
use crate::deck::calculix::syntax::KeywordCard;
use crate::deck::kinematics::vector::{Vector, cross, dot, length, minus, plus, scaled};
use crate::deck::{DeckError, Dof, Model, Problem, Solver};
use crate::fault::quote;

const MEAN_ROTATION: &str = "MEANROT";

/// The first type on a card. ccx reads no other type.
fn first_type(card: &KeywordCard) -> String {
    card.lines().next().and_then(|line| line.fields().next().map(folded)).unwrap_or_default()
}

/// Whether the card makes all steps nonlinear in ccx.
pub fn is_nonlinear(card: &KeywordCard) -> bool {
    card.is("*MPC") && matches!(first_type(card).as_str(), "PLANE" | "STRAIGHT" | "BEAM")
}

/// Adds the equations of an `*MPC` card. Returns the indices and the nodes of those that are mean rotations.
pub fn read(
    card: &KeywordCard,
    model: &mut Model,
    definitions: &DeckDefinitions,
    solver: Solver,
) -> Result<Vec<(usize, Vec<u32>)>, DeckError> {
    let name = if first_type(card) == MEAN_ROTATION { mean_rotation::NAME } else { "*MPC" };
    let place = RegisteredCard::register(card, model, name);
    let lists = lists(card, definitions).map_err(|problem| place.fail(model, problem))?;
    let mut rotations = Vec::new();
    for (kind, fields) in lists {
        let nodes = fields.concat();
        if solver == Solver::Ccx {
            refused::mpc(card, &kind, fields.iter().any(|nodes| nodes.len() != 1), model);
        }
        let rows = match kind.as_str() {
            "PLANE" => plane(definitions, &nodes),
            "STRAIGHT" => straight(definitions, &nodes),
            "BEAM" => of_pairs(&fields, |a, b| beam(definitions, a, b, solver)),
            "LINK" => of_pairs(&fields, |a, b| Ok(vec![distance(definitions, a, b)?])),
            "PIN" => of_pairs(&fields, |a, b| tie::rows(definitions, a, &[b], &[1.0])),
            "TIE" => of_pairs(&fields, |a, b| {
                let mut rows = tie::rows(definitions, a, &[b], &[1.0])?;
                if definitions.rotates(a) && definitions.rotates(b) {
                    rows.extend(tie::rotations(definitions, a, &[b], &[1.0])?);
                }
                Ok(rows)
            }),
            MEAN_ROTATION => mean_rotation::equation(definitions, &nodes).map(|row| vec![row]),
            "DIST" => bound(definitions, &nodes).map(|row| row.into_iter().collect()),
            _ => {
                let text =
                    format!("*MPC of type {kind} constrains {} nodes, but is not understood: left out", nodes.len());
                model.leave_out(card.file, card.line, text);
                claim(&place, model, definitions, nodes.iter().copied());
                continue;
            }
        };
        let before = model.equations();
        if let Err(problem @ Problem::NotFollowed { .. }) = rows {
            let text = format!("*MPC of type {kind} constrains {} nodes, but {problem}: left out", nodes.len());
            model.leave_out(card.file, card.line, text);
            claim(&place, model, definitions, nodes.iter().copied());
            continue;
        }
        place.push(model, rows)?;
        if kind == MEAN_ROTATION {
            rotations.push((before, mean_rotation::nodes(&nodes).map_err(|problem| place.fail(model, problem))?.0));
        }
        if model.equations() == before && kind == "DIST" {
            let text = "*MPC DIST is inactive while the nodes are closer than its bound: no equation";
            model.warn(card.file, card.line, text);
        } else if !matches!(kind.as_str(), "PIN" | "TIE") {
            // The solver treats these types as nonlinear, so linear equations cannot replace the card.
            place.mark_irreplaceable(model);
            model.warn(card.file, card.line, format!("*MPC {kind} is linearised at the reference configuration"));
        }
    }
    Ok(rotations)
}

/// A type of `*MPC`, and the nodes in each of the fields after it.
type TypedFields = (String, Vec<Vec<u32>>);

/// Reads the types, each with its nodes. A line that begins with a number continues the list of the line before it.
fn lists(card: &KeywordCard, definitions: &DeckDefinitions) -> Result<Vec<TypedFields>, Problem> {
    let mut lists: Vec<TypedFields> = Vec::new();
    for line in card.lines() {
        let mut fields = line.fields().peekable();
        let starts = fields.peek().is_some_and(|field| !field.first().is_some_and(u8::is_ascii_digit));
        if starts || lists.is_empty() {
            lists.push((folded(fields.next().unwrap_or_default()), Vec::new()));
        }
        for field in fields.filter(|field| !field.is_empty() && *field != b"0") {
            let nodes = definitions.node_or_set(card.scope, field)?;
            if let Some((_, list)) = lists.last_mut() {
                list.push(nodes);
            }
        }
    }
    Ok(lists)
}

/// Calls `equations` for each pair of nodes in the fields, and returns all equations.
fn of_pairs(
    fields: &[Vec<u32>],
    equations: impl Fn(u32, u32) -> Result<Vec<CardEquation>, Problem>,
) -> Result<Vec<CardEquation>, Problem> {
    let rows = pairs(fields)?.into_iter().map(|(a, b)| equations(a, b)).collect::<Result<Vec<_>, _>>()?;
    Ok(rows.into_iter().flatten().collect())
}

/// Pairs the nodes of two fields. If there are only two nodes in all, they are the only pair. Otherwise each node of the first field is
/// paired with the only node of the second field, or with the node in the same place there.
fn pairs(fields: &[Vec<u32>]) -> Result<Vec<(u32, u32)>, Problem> {
    match (fields, &fields.concat()[..]) {
        (_, &[a, b]) => Ok(vec![(a, b)]),
        ([first, second], _) if second.len() == 1 => Ok(first.iter().map(|&a| (a, second[0])).collect()),
        ([first, second], _) if first.len() == second.len() => {
            Ok(first.iter().copied().zip(second.iter().copied()).collect())
        }
        (_, nodes) => {
            let expected = "two nodes, a node set and a node, or two sets of one size";
            Err(Problem::Expected { expected, found: quote(format!("{} nodes", nodes.len()).as_bytes()) })
        }
    }
}

fn positions<const N: usize>(definitions: &DeckDefinitions, nodes: &[u32]) -> Result<[Vector; N], Problem> {
    let mut positions = [[0.0; 3]; N];
    if nodes.len() < N {
        return Err(Problem::TooFew { what: "nodes", promised: N, found: nodes.len() });
    }
    for (position, node) in positions.iter_mut().zip(nodes) {
        *position = definitions.position(*node)?;
    }
    Ok(positions)
}

fn plane(definitions: &DeckDefinitions, nodes: &[u32]) -> Result<Vec<CardEquation>, Problem> {
    let [a, b, c] = positions(definitions, nodes)?;
    let (to_b, to_c) = (minus(b, a), minus(c, a));
    let normal = cross(to_b, to_c);
    if length(normal) <= 1e-9 * length(to_b) * length(to_c) {
        return Err(Problem::Degenerate { what: "the three nodes of a plane lie on a line".into() });
    }
    let row = |&node: &u32| {
        let to_k = minus(definitions.position(node)?, a);
        let (by_b, by_c) = (cross(to_c, to_k), cross(to_k, to_b));
        let by_a = scaled(plus(plus(normal, by_b), by_c), -1.0);
        let gradients = [(node, normal), (nodes[0], by_a), (nodes[1], by_b), (nodes[2], by_c)];
        let off = dot(to_k, normal);
        let is_off = off.abs() > 1e-6 * length(normal) * length(to_k);
        CardEquation::along(definitions, &gradients, if is_off { -off } else { 0.0 })
    };
    nodes[3..].iter().filter(|node| !nodes[..3].contains(node)).map(row).collect()
}

fn straight(definitions: &DeckDefinitions, nodes: &[u32]) -> Result<Vec<CardEquation>, Problem> {
    let [a, b] = positions(definitions, nodes)?;
    let along = minus(b, a);
    let largest = (0..3).rev().max_by(|&i, &j| along[i].abs().total_cmp(&along[j].abs())).unwrap_or(0);
    if length(along) == 0.0 {
        return Err(Problem::Degenerate { what: "the two nodes of a line coincide".into() });
    }
    let mut rows = Vec::new();
    for &node in nodes[2..].iter().filter(|node| !nodes[..2].contains(node)) {
        let to_k = minus(definitions.position(node)?, a);
        // Two equations suffice, because they imply the third: the one of the component in which the line is longest.
        for i in (0..3).filter(|&i| i != largest) {
            let axis: Vector = std::array::from_fn(|k| f64::from(u8::from(k == i)));
            let (by_k, by_b) = (cross(along, axis), cross(axis, to_k));
            let by_a = scaled(plus(by_k, by_b), -1.0);
            let off = dot(cross(to_k, along), axis);
            let is_off = off.abs() > 1e-6 * length(along) * length(to_k);
            let gradients = [(node, by_k), (nodes[0], by_a), (nodes[1], by_b)];
            let row = CardEquation::along(definitions, &gradients, if is_off { -off } else { 0.0 })?;
            // The two equations get distinct slaves: the two components in which the line is shorter. Without this, they might have the
            // same slave if all components of the line are equal in size.
            rows.push(row.led_by(Dof { node, component: (3 - i - largest) as u8 + 1 }));
        }
    }
    Ok(rows)
}

fn beam(definitions: &DeckDefinitions, a: u32, b: u32, solver: Solver) -> Result<Vec<CardEquation>, Problem> {
    let rotates = definitions.rotates(a);
    if solver != Solver::Abaqus && !(rotates && definitions.rotates(b)) {
        return Ok(vec![distance(definitions, a, b)?]);
    }
    let components = definitions.components(a, rotates);
    kinematic(definitions, BodyReference::with_rotations(b), std::iter::once(a), &components, None)
}

fn distance(definitions: &DeckDefinitions, a: u32, b: u32) -> Result<CardEquation, Problem> {
    let along = minus(definitions.position(a)?, definitions.position(b)?);
    if length(along) == 0.0 {
        return Err(Problem::Degenerate { what: format!("nodes {a} and {b} coincide") });
    }
    CardEquation::along(definitions, &[(a, along), (b, scaled(along, -1.0))], 0.0)
}

/// The equation of `DIST`, an upper bound on a distance; `None` while the distance is smaller. Component 1 of the last node, which the deck
/// has to prescribe, is the squared distance minus the squared bound.
fn bound(definitions: &DeckDefinitions, nodes: &[u32]) -> Result<Option<CardEquation>, Problem> {
    let [a, _, _, b, _, _, c] = *nodes else {
        let found = nodes.len();
        return Err(if found < 7 {
            Problem::TooFew { what: "nodes", promised: 7, found }
        } else {
            Problem::Expected { expected: "seven nodes", found: quote(found.to_string().as_bytes()) }
        });
    };
    let along = minus(definitions.position(a)?, definitions.position(b)?);
    let most = definitions.position(c)?[0];
    if dot(along, along) < most * most {
        return Ok(None);
    }
    let along = scaled(along, 2.0);
    let rhs = most * most - dot(along, along) / 4.0;
    let excess = (Dof { node: c, component: 1 }, -1.0);
    CardEquation::along_with(definitions, &[(a, along), (b, scaled(along, -1.0))], &[excess], rhs).map(Some)
}
