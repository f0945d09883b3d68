//! Builds the model: first the definitions, then the constraints in the order of the deck.

use std::collections::BTreeSet;

use rustc_hash::{FxHashMap, FxHashSet};

use super::cards::{ReadRadioss, body, coupling, prescribed, tie, unread};
use super::model::mesh::{RadiossBody, RadiossMesh};
use super::syntax::card::{RadiossCard, RadiossCards};
use crate::deck::keyword::draft::KeywordDraft;
use crate::deck::keyword::line::KeywordLine;
use crate::deck::{DeckError, Dof, Model, Sources};

/// Reads a deck.
///
/// # Errors
/// [`DeckError`].
pub fn read(sources: &mut Sources) -> Result<Model, DeckError> {
    let cards = RadiossCards::read(sources)?;
    let mut reader = RadiossReader::new(sources);
    reader.note(&cards)?;
    for card in &cards.submodels {
        let text = format!("{} has numbers with offsets, which this reader does not follow: left out", card.name());
        reader.draft.model.leave_out(card.file, card.line, text);
    }
    cards.all.iter().try_for_each(|card| reader.card(card, &cards))?;
    Ok(reader.finish())
}

/// Reads the nodes, elements and groups of a deck.
///
/// # Errors
/// [`DeckError`].
pub fn mesh(sources: &mut Sources) -> Result<RadiossMesh, DeckError> {
    let cards = RadiossCards::read(sources)?;
    let mut reader = RadiossReader::new(sources);
    reader.note(&cards)?;
    Ok(reader.mesh)
}

/// How a card with this keyword is read; `None` for other keywords.
fn card_reader(keyword: &str) -> Option<ReadRadioss> {
    Some(match keyword {
        "RBODY" => body::rigid,
        "RBE2" => body::rbe2,
        "RBE3" => coupling::mean,
        "MPC" => coupling::linear,
        "INTER/TYPE2" => tie::tie,
        "BCS" | "BCS/LAGMUL" => prescribed::group,
        "NBCS" => prescribed::nodes,
        "IMPDISP" => prescribed::displacement,
        "IMPVEL" => prescribed::velocity,
        "IMPACC" => prescribed::acceleration,
        _ => return None,
    })
}

struct RadiossReader {
    draft: KeywordDraft,
    mesh: RadiossMesh,
    /// For each body of the mesh, the number of its card.
    of_bodies: Vec<u32>,
    /// For each `/RBE2` of the mesh, the file and the name of its card.
    of_rbe2: Vec<(u32, String)>,
}

impl RadiossReader {
    fn new(sources: &Sources) -> Self {
        let draft = KeywordDraft::new(sources.paths().to_vec());
        Self { draft, mesh: RadiossMesh::default(), of_bodies: Vec::new(), of_rbe2: Vec::new() }
    }

    fn note(&mut self, cards: &RadiossCards) -> Result<(), DeckError> {
        self.mesh.unread = cards.submodels.first().map(RadiossCard::name);
        cards.all.iter().try_for_each(|card| {
            let noted = self.mesh.note(card, &cards.parameters);
            noted.map_err(|fault| self.draft.error(&card.name(), card.file, fault))
        })
    }

    fn card(&mut self, card: &RadiossCard, cards: &RadiossCards) -> Result<(), DeckError> {
        let why = match card_reader(&card.keyword) {
            Some(read) if !card.is_continued => return self.constraint(card, cards, read),
            Some(_) => Some("goes on in another file"),
            None => unread::reason(&card.keyword),
        };
        if let Some(why) = why {
            self.draft.model.leave_out(card.file, card.line, format!("{} {why}: left out", card.name()));
        }
        Ok(())
    }

    /// Adds what a card means. Blank lines before the last one that is not blank stand for zeros.
    fn constraint(&mut self, card: &RadiossCard, cards: &RadiossCards, read: ReadRadioss) -> Result<(), DeckError> {
        let lines: Vec<KeywordLine> = card.lines(&cards.parameters).skip(1).collect();
        let filled = lines.iter().rposition(|line| !line.is_blank()).map_or(0, |last| last + 1);
        if filled == 0 {
            return Ok(());
        }
        let (name, number) = (card.name(), self.draft.model.cards.len() as u32);
        let made = read(&lines[..filled], &mut self.mesh);
        self.draft.group(&name, card.file, &lines[..filled], made)?;
        for (line, why) in std::mem::take(&mut self.mesh.stops) {
            self.draft.model.refuse(card.file, line, format!("Radioss stops: {name} {why}"));
        }
        self.of_bodies.resize(self.mesh.bodies.len(), number);
        self.of_rbe2.resize(self.mesh.rbe2_mains.len(), (card.file, name));
        let is_added = self.draft.model.cards.len() as u32 > number;
        if is_added && matches!(card.keyword.as_str(), "MPC" | "BCS/LAGMUL") {
            self.draft.model.keep_by_multipliers(number);
        }
        Ok(())
    }

    /// Refuses main nodes that follow other cards, as the starter does (`kinchk.F`: messages 806, 807 and 1036).
    fn check_order(&mut self) {
        let mains: FxHashSet<u32> = self.mesh.bodies.iter().map(|body| body.main).collect();
        let slaves = &self.mesh.rbe2_slaves;
        for (body, number) in
            self.mesh.bodies.iter().zip(&self.of_bodies).filter(|(body, _)| slaves.contains(&body.main))
        {
            let card = self.draft.model.cards.nth(*number);
            let text = format!("Radioss stops: the main node {} of {} is a slave of an /RBE2", body.main, card.name);
            self.draft.model.refuse(card.file, card.line, text);
        }
        for (&(main, line), (file, name)) in self.mesh.rbe2_mains.iter().zip(&self.of_rbe2) {
            let what = match () {
                () if mains.contains(&main) => "the main node of an /RBODY",
                () if self.mesh.tied.contains(&main) => "a slave of an /INTER/TYPE2",
                () => continue,
            };
            let text = format!("Radioss stops: the main node {main} of {name} is {what}");
            self.draft.model.refuse(*file, line, text);
        }
    }

    /// The cards that have equations or values with a DOF of these nodes.
    fn users(&self, nodes: &FxHashSet<u32>) -> FxHashMap<Dof, FxHashSet<u32>> {
        let mut users: FxHashMap<Dof, FxHashSet<u32>> = FxHashMap::default();
        let model = &self.draft.model;
        for equation in (0..model.equations()).map(|i| model.nth(i)) {
            let dofs = equation.columns.iter().map(|&column| model.dofs[column as usize]);
            for dof in dofs.filter(|dof| nodes.contains(&dof.node)) {
                users.entry(dof).or_default().insert(equation.origin.card);
            }
        }
        for given in self.draft.prescribed.values().filter(|given| nodes.contains(&given.dof.node)) {
            users.entry(given.dof).or_default().insert(given.origin.card);
        }
        users
    }

    /// Leaves out what other cards say about translations of main nodes that the solver moves to a centre of mass, which the deck does not
    /// give. It does not matter where the main node is if the body cannot rotate, or if no other card uses its other nodes.
    fn check_centres(&mut self) {
        let moved: Vec<(&RadiossBody, u32)> =
            self.mesh.bodies.iter().zip(self.of_bodies.iter().copied()).filter(|(body, _)| body.moves).collect();
        let nodes = moved.iter().flat_map(|(body, _)| body.slaves.iter().chain([&body.main])).copied().collect();
        let users = self.users(&nodes);
        let is_used = |node: u32, components: std::ops::RangeInclusive<u8>, own: u32| {
            let others =
                |component| users.get(&Dof { node, component }).is_some_and(|all| all.iter().any(|card| *card != own));
            components.into_iter().any(others)
        };
        let (mut uncertain, mut said) = (BTreeSet::new(), Vec::new());
        for (body, own) in moved {
            let turns = (4..=6).any(|component| !self.draft.is_fixed(Dof { node: body.main, component }));
            if turns && is_used(body.main, 1..=3, own) && body.slaves.iter().any(|&node| is_used(node, 1..=6, own)) {
                uncertain.extend((1..=3).map(|component| Dof { node: body.main, component }));
                said.push(own);
            }
        }
        let why = "moves its main node to a centre of mass that the deck does not give, and the position matters";
        for own in said {
            let card = self.draft.model.cards.nth(own);
            self.draft.model.leave_out(card.file, card.line, format!("{} {why}: this is left out", card.name));
        }
        self.draft.leave_out_values(&uncertain, "holds a main node that Radioss moves to an unknown centre of mass");
    }

    fn finish(mut self) -> Model {
        self.check_order();
        self.check_centres();
        if self.mesh.bodies.iter().any(|body| body.moves) {
            let text = "main nodes of rigid bodies count at the positions that the deck gives (ICoG)";
            self.draft.model.warn(0, 0, text);
        }
        self.draft.finish("rigid bodies and weighted means are linearised at the reference configuration")
    }
}
