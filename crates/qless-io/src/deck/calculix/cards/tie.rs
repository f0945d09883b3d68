//! Makes the equations of `*TIE`. Each node s of the slave surface moves with the nearest point xi of the master surface, `u_s = sum
//! N_i(xi) u_i`. N_i are the shape functions of the master's face at xi, and u_i the displacements of its nodes. Abaqus ties rotations in
//! the same way.

use rustc_hash::FxHashSet;

use crate::deck::calculix::cards::unread::claim;
use crate::deck::calculix::cards::{CardEquation, RegisteredCard};
use crate::deck::calculix::model::{DeckDefinitions, DeckSurface};
use crate::deck::calculix::syntax::{KeywordCard, float};
use crate::deck::kinematics::project::{FaceGrid, MasterFace};
use crate::deck::kinematics::vector::{Vector, dot};
use crate::deck::{DeckError, Dof, Model, Problem, Solver};
use crate::fault::quote;

/// Default distance from the master surface within which a node is tied, relative to the typical size of a face.
pub const TOLERANCE: f64 = 0.025;

/// Distance within which a node counts as lying on a face, relative to the typical size of a face. It allows for decks whose coordinates
/// have only six or seven digits.
const ON_FACE: f64 = 1e-6;
/// ccx expands plane elements into solids, and a tie by edge ties the new nodes. ccx can tie only a new node that does not already follow
/// the node of the deck. Only corners of second-order elements have such new nodes.
const EDGES: &str = "only corners of second-order plane elements are tied by edge; name the nodes instead (TYPE=NODE)";
const MOVED: &str = "its slave nodes are moved onto the master: write ADJUST=NO or close the gap";

/// Adds the equations of a `*TIE` card.
pub fn read(
    card: &KeywordCard,
    model: &mut Model,
    definitions: &DeckDefinitions,
    solver: Solver,
) -> Result<(), DeckError> {
    for special in ["MULTISTAGE", "FLUIDPERIODIC", "FLUIDCYCLIC"] {
        if card.parameter(special).is_some() {
            leave_out(card, special, model, definitions);
            return Ok(());
        }
    }
    if card.lines().nth(1).is_some() {
        if solver == Solver::Abaqus {
            leave_out(card, "more than one pair of surfaces", model, definitions);
            return Ok(());
        }
        model.warn(card.file, card.line, "*TIE has more than one line: ccx reads only the first".to_owned());
    }
    if solver == Solver::Ccx && has_shell_faces(card, definitions) {
        leave_out(card, "faces of shells, which ccx expands into solids,", model, definitions);
        return Ok(());
    }
    let place = RegisteredCard::register(card, model, "*TIE");
    let rotates = solver == Solver::Abaqus && card.parameter("NOROTATION").is_none();
    let tied = tied(card, definitions, rotates).map_err(|problem| place.fail(model, problem))?;
    if let Some(first) = tied.apart.first() {
        let text = format!(
            "*TIE leaves {} nodes free that are farther than {} from the master surface, such as {first}",
            tied.apart.len(),
            tied.tolerance
        );
        model.warn(card.file, card.line, text);
    }
    if tied.has_gap && card.word("ADJUST").as_deref() != Some("NO") {
        model.cards.fix_because(place.origin.card, MOVED);
    }
    if card.lines().all(|line| line.file == card.file) {
        model.cards.mark_divisible(place.origin.card);
    }
    let first = model.equations();
    place.push(model, Ok(tied.rows))?;
    let missing = tied.on_edges.iter().filter(|_| solver == Solver::Ccx);
    missing.for_each(|row| model.mark_missing(first + row, EDGES));
    Ok(())
}

struct Tied {
    rows: Vec<CardEquation>,
    apart: Vec<u32>,
    /// Whether a tied node lies off its face.
    has_gap: bool,
    /// Indices in `rows` of the equations that ccx does not make: those of nodes on edges of plane elements.
    on_edges: Vec<usize>,
    tolerance: f64,
}

/// Whether either surface has faces of shells or membranes. ccx expands these into solids and ties the faces of the
/// solids.
fn has_shell_faces(card: &KeywordCard, definitions: &DeckDefinitions) -> bool {
    let is_shell = |side: &String| DeckSurface::find(definitions, card.scope, side).is_ok_and(|side| side.has_shells);
    sides(card).is_ok_and(|sides| sides.iter().any(is_shell))
}

/// Leaves out a tie of an unsupported kind, and claims all DOFs of its nodes.
pub fn leave_out(card: &KeywordCard, kind: &str, model: &mut Model, definitions: &DeckDefinitions) {
    let place = RegisteredCard::register(card, model, "*TIE");
    let text = format!("*TIE with {kind} constrains, but is not understood: left out");
    model.leave_out(card.file, card.line, text);
    let nodes = sides(card).and_then(|sides| nodes(card, definitions, &sides)).unwrap_or_default();
    claim(&place, model, definitions, nodes.into_iter());
}

/// The names of the slave surface and of the master surface.
pub fn sides(card: &KeywordCard) -> Result<[String; 2], Problem> {
    let line = card.lines().next();
    let names: Vec<String> =
        line.into_iter().flat_map(|line| line.fields()).map(|f| String::from_utf8_lossy(f).into_owned()).collect();
    match &names[..] {
        [slave, master, ..] => Ok([slave.clone(), master.clone()]),
        _ => Err(Problem::TooFew { what: "surfaces", promised: 2, found: names.len() }),
    }
}

/// The nodes of both surfaces.
fn nodes(card: &KeywordCard, definitions: &DeckDefinitions, sides: &[String; 2]) -> Result<Vec<u32>, Problem> {
    let mut nodes = Vec::new();
    for side in sides {
        nodes.extend(DeckSurface::find(definitions, card.scope, side)?.all_nodes());
    }
    Ok(nodes)
}

/// The equations of a tie; if `rotates`, rotations are tied, too, where the node and all nodes of its face have them.
fn tied(card: &KeywordCard, definitions: &DeckDefinitions, rotates: bool) -> Result<Tied, Problem> {
    let [slave, master] = &sides(card)?;
    let slaves = DeckSurface::find(definitions, card.scope, slave)?;
    let edges = slaves.faces.iter().filter(|_| slaves.is_line);
    let untied: FxHashSet<u32> =
        edges.flat_map(|edge| if edge.len() == 2 { &edge[..] } else { &edge[2..] }).copied().collect();
    let surface = DeckSurface::find(definitions, card.scope, master)?;
    let faces = MasterFace::all(surface.faces, surface.is_line, |node| definitions.position(node))?;
    if faces.is_empty() {
        let found = quote(master.as_bytes());
        return Err(Problem::Expected { expected: "a master surface of element faces", found });
    }
    let typical = MasterFace::mean_size(&faces);
    let given = card.parameter("POSITIONTOLERANCE").map(|text| float(text.as_bytes())).transpose()?;
    let tolerance = given.unwrap_or(TOLERANCE * typical);
    let grid = FaceGrid::new(&faces, tolerance);
    let mut tied = Tied { rows: Vec::new(), apart: Vec::new(), has_gap: false, on_edges: Vec::new(), tolerance };
    for node in slaves.all_nodes() {
        let position: Vector = definitions.position(node)?;
        match grid.nearest(&faces, position).filter(|near| near.distance <= tolerance) {
            Some(near) if faces[near.face].nodes.contains(&node) => {}
            Some(near) => {
                tied.has_gap |= near.distance > ON_FACE * typical;
                let before = tied.rows.len();
                tied.rows.extend(rows(definitions, node, &faces[near.face].nodes, &near.weights)?);
                let all_rotate = |masters: &[u32]| masters.iter().chain([&node]).all(|&node| definitions.rotates(node));
                if rotates && all_rotate(&faces[near.face].nodes) {
                    tied.rows.extend(rotations(definitions, node, &faces[near.face].nodes, &near.weights)?);
                }
                tied.on_edges.extend((before..tied.rows.len()).filter(|_| untied.contains(&node)));
            }
            None => tied.apart.push(node),
        }
    }
    Ok(tied)
}

/// The equations by which the components of a tied node follow the nodes of its face.
pub fn rows(
    definitions: &DeckDefinitions,
    node: u32,
    masters: &[u32],
    weights: &[f64],
) -> Result<Vec<CardEquation>, Problem> {
    let row = |axis: Vector| {
        let others = masters.iter().zip(weights).filter(|(_, w)| **w != 0.0).map(|(&m, w)| (m, axis.map(|x| -w * x)));
        let gradients: Vec<(u32, Vector)> = std::iter::once((node, axis)).chain(others).collect();
        CardEquation::along(definitions, &gradients, 0.0)
    };
    let components = if definitions.is_flat(node) { 2 } else { 3 };
    definitions.axes(node)?.into_iter().take(components).map(row).collect()
}

/// The equations by which the rotations of a tied node follow those of the nodes of its face, about its own axes.
pub fn rotations(
    definitions: &DeckDefinitions,
    node: u32,
    masters: &[u32],
    weights: &[f64],
) -> Result<Vec<CardEquation>, Problem> {
    let row = |(k, axis): (usize, Vector)| {
        let mut terms = vec![(Dof { node, component: k as u8 + 4 }, 1.0)];
        for (&master, weight) in masters.iter().zip(weights) {
            for (component, own) in (4..).zip(definitions.axes(master)?) {
                let coefficient = -weight * dot(axis, own);
                terms.extend(Some((Dof { node: master, component }, coefficient)).filter(|_| coefficient != 0.0));
            }
        }
        Ok(CardEquation { terms, rhs: 0.0 })
    };
    let axes = definitions.axes(node)?.into_iter().enumerate();
    axes.filter(|(k, _)| definitions.rotates_about(node, *k as u8 + 4)).map(row).collect()
}
