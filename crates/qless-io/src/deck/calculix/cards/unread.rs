//! Cards that constrain but are not read, and the DOFs that they may claim.

use crate::deck::calculix::cards::RegisteredCard;
use crate::deck::calculix::model::{AxesKind, DeckDefinitions, DeckSurface, axes};
use crate::deck::calculix::syntax::KeywordCard;
use crate::deck::{Dof, Model, Origin, Problem};

/// Keywords of cards that constrain but are not read: without blanks, and in their usual spelling.
const UNREAD: [(&str, &str); 9] = [
    ("*PRE-TENSIONSECTION", "*PRE-TENSION SECTION"),
    ("*EMBEDDEDELEMENT", "*EMBEDDED ELEMENT"),
    ("*SHELLTOSOLIDCOUPLING", "*SHELL TO SOLID COUPLING"),
    ("*CONNECTORSECTION", "*CONNECTOR SECTION"),
    ("*NETWORKMPC", "*NETWORK MPC"),
    ("*MPCUSER", "*MPC USER"),
    ("*RELEASE", "*RELEASE"),
    ("*FASTENER", "*FASTENER"),
    ("*CONTACTPAIR", "*CONTACT PAIR, TIED"),
];

/// Keywords of cards that constrain. They are long, so another keyword that differs in one letter is probably a misspelling.
const READ: [&str; 7] =
    ["*BOUNDARY", "*EQUATION", "*COUPLING", "*KINEMATIC", "*DISTRIBUTING", "*RIGIDBODY", "*KINEMATICCOUPLING"];

/// Valid keywords that differ from one of [`READ`] by one additional letter: they are no misspellings.
const OTHER: [&str; 2] = ["*BOUNDARYF", "*EQUATIONF"];

/// Leaves out a card whose keyword differs by one letter from one that constrains. CalculiX ignores such a card with a warning.
fn misspelt(card: &KeywordCard, model: &mut Model) {
    let keyword = String::from_utf8_lossy(&card.keyword);
    let is_meant = |known: &&&str| strsim::osa_distance(known, &keyword) == 1;
    let meant = READ.iter().find(is_meant).filter(|_| !OTHER.contains(&&*keyword));
    if let Some(meant) = meant {
        model.leave_out(
            card.file,
            card.line,
            format!("{keyword} is no keyword; if {meant} is meant, it constrains: left out"),
        );
    }
}

/// Warns of a card in [`UNREAD`], which constrains, and claims the DOFs of its nodes. Also warns of a misspelt keyword. Does nothing for
/// any other card.
pub fn read(card: &KeywordCard, model: &mut Model, definitions: &DeckDefinitions) {
    let has_axes = [("*TRANSFORM", "TYPE"), ("*ORIENTATION", "SYSTEM")];
    let named = has_axes.iter().find(|(keyword, _)| card.is(keyword) && !definitions.is_abaqus);
    if named.is_some_and(|(_, kind)| matches!(axes(card, kind).kind, AxesKind::ZRectangular | AxesKind::Other)) {
        let text = "ccx knows rectangular and cylindrical axes only: it takes these as rectangular";
        model.warn(card.file, card.line, text);
    }
    let Some((keyword, name)) = UNREAD.iter().find(|(keyword, _)| card.is(keyword)) else {
        return misspelt(card, model);
    };
    if *keyword == "*CONTACTPAIR" && card.parameter("TIED").is_none() {
        return;
    }
    let place = RegisteredCard::register(card, model, name);
    model.leave_out(card.file, card.line, format!("{name} constrains, but is not understood: left out"));
    // If the card names something that is not defined, it claims no DOFs.
    let nodes = nodes(card, definitions).unwrap_or_default();
    claim(&place, model, definitions, nodes.into_iter());
}

/// Claims the DOFs of the nodes that a card names which is left out, as far as they are known. `coupled` are the nodes of a `*COUPLING`.
pub fn claim_named(card: &KeywordCard, coupled: Vec<u32>, model: &mut Model, definitions: &DeckDefinitions) {
    let scope = card.scope;
    let mut nodes = if card.is("*KINEMATIC") || card.is("*DISTRIBUTING") { coupled } else { Vec::new() };
    for set in ["NSET", "TIENSET", "PINNSET", "REFNODE"].iter().filter_map(|name| card.parameter(name)) {
        nodes.extend(definitions.node_or_set(scope, set.as_bytes()).unwrap_or_default());
    }
    nodes.extend(self::nodes(card, definitions).unwrap_or_default());
    nodes.extend(card.parameter("ELSET").and_then(|set| definitions.nodes_of(scope, set).ok()).unwrap_or_default());
    for field in card.lines().flat_map(|line| line.fields()) {
        if card.is("*MPC") {
            nodes.extend(definitions.node_or_set(scope, field).unwrap_or_default());
        } else if card.is("*TIE") {
            let surface = DeckSurface::find(definitions, scope, &String::from_utf8_lossy(field));
            nodes.extend(surface.map(|surface| surface.all_nodes()).unwrap_or_default());
        }
    }
    // The card was added to the model before it failed.
    let Some(last) = (model.cards.len() as u32).checked_sub(1) else { return };
    let place = RegisteredCard { origin: Origin { card: last, line: card.line, lines: 1 } };
    claim(&place, model, definitions, nodes.into_iter());
}

/// Nodes whose DOFs a card may claim.
fn nodes(card: &KeywordCard, definitions: &DeckDefinitions) -> Result<Vec<u32>, Problem> {
    let fields = || card.lines().flat_map(|line| line.fields()).filter(|field| !field.is_empty());
    let surface = |name: &str| DeckSurface::find(definitions, card.scope, name).map(|surface| surface.all_nodes());
    let elements = |field: &[u8]| -> Result<Vec<u32>, Problem> {
        let mut nodes = Vec::new();
        for element in definitions.element_or_set(card.scope, field)? {
            nodes.extend_from_slice(definitions.elements()?.nodes(element));
        }
        Ok(nodes)
    };
    let mut nodes = Vec::new();
    if card.is("*PRE-TENSIONSECTION") {
        if let Some(name) = card.parameter("SURFACE") {
            nodes.extend(surface(name)?);
        }
        if let Some(name) = card.parameter("ELEMENT") {
            nodes.extend(elements(name.as_bytes())?);
        }
    } else if card.is("*EMBEDDEDELEMENT") {
        for field in fields() {
            nodes.extend(elements(field)?);
        }
    } else if card.is("*CONTACTPAIR") || card.is("*SHELLTOSOLIDCOUPLING") {
        for field in fields() {
            nodes.extend(surface(&String::from_utf8_lossy(field))?);
        }
    }
    Ok(nodes)
}

/// Records that a card may constrain all DOFs of these nodes.
pub fn claim(
    place: &RegisteredCard,
    model: &mut Model,
    definitions: &DeckDefinitions,
    nodes: impl Iterator<Item = u32>,
) {
    let all_dofs = |node: u32| {
        let last = if definitions.rotates(node) { 6 } else { 3 };
        (1..=last).map(move |component| Dof { node, component })
    };
    let dofs: Vec<Dof> = nodes.flat_map(all_dofs).collect();
    model.claim_left_out(dofs, place.origin);
}
