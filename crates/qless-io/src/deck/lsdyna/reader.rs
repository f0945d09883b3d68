//! Builds the model: first the definitions, then the rigid bodies, then the constraints in the order of the deck.

use std::collections::BTreeSet;
use std::path::PathBuf;

use super::cards::{ReadGroup, body, coupling, prescribed, tie, unread};
use super::model::bodies::DynaDefinitions;
use super::model::mesh::{DynaMesh, has_unknown_option, is_definition, is_part, part_lines};
use super::syntax::card::{DynaCard, DynaCards};
use crate::deck::keyword::draft::KeywordDraft;
use crate::deck::keyword::line::{KeywordFault, KeywordLine, Parameters};
use crate::deck::{DeckError, Dof, Model, Sources};

/// Reads a deck.
///
/// # Errors
/// [`DeckError`].
pub fn read(sources: &mut Sources) -> Result<Model, DeckError> {
    let cards = DynaCards::read(sources)?;
    let mut reader = LsDynaReader::new(sources.paths().to_vec());
    reader.note(&cards)?;
    reader.add_bodies(&cards)?;
    for (file, line, text) in &cards.remarks {
        reader.draft.model.warn(*file, *line, text.as_str());
    }
    for (begin, range) in &cards.cases {
        if let Some(card) = cards.of_cases[range.clone()].iter().find(|card| matters(card)) {
            let text = format!(
                "*{} begins cards of one case, such as *{}, which this reader does not follow: left out",
                begin.keyword, card.keyword
            );
            reader.draft.model.leave_out(begin.file, begin.line, text);
        }
    }
    cards.all.iter().try_for_each(|card| reader.card(card, &cards.parameters))?;
    Ok(reader.finish())
}

/// Reads the nodes, elements and sets of a deck.
///
/// # Errors
/// [`DeckError`].
pub fn mesh(sources: &mut Sources) -> Result<DynaMesh, DeckError> {
    let cards = DynaCards::read(sources)?;
    let mut reader = LsDynaReader::new(sources.paths().to_vec());
    reader.note(&cards)?;
    Ok(reader.all.mesh)
}

struct LsDynaReader {
    draft: KeywordDraft,
    all: DynaDefinitions,
}

/// How a card is read: the number of lines in a group, without its title, and the function that reads the group.
type CardReader = (usize, ReadGroup);

/// Stands in place of a number of lines for cards that are one single group.
const WHOLE: usize = usize::MAX;

/// How a card with this keyword is read; `None` for other keywords. The name comes without `_ID` and `_TITLE`. For the lines of a `*PART`,
/// see [`part_lines`].
fn card_reader(name: &str) -> Option<CardReader> {
    Some(match name {
        "NODE" => (1, prescribed::node),
        "MAT_RIGID" | "MAT_020" => (WHOLE, body::material),
        "CONSTRAINED_NODAL_RIGID_BODY" => (1, body::nodal),
        "CONSTRAINED_NODAL_RIGID_BODY_SPC" => (2, body::nodal_held),
        "CONSTRAINED_NODAL_RIGID_BODY_INERTIA" => (WHOLE, body::nodal),
        "CONSTRAINED_NODAL_RIGID_BODY_SPC_INERTIA" => (WHOLE, body::nodal_held),
        "CONSTRAINED_EXTRA_NODES_NODE" => (1, body::extra::<false>),
        "CONSTRAINED_EXTRA_NODES_SET" => (1, body::extra::<true>),
        "CONSTRAINED_RIGID_BODIES" => (1, body::merged),
        "CONSTRAINED_INTERPOLATION" => (WHOLE, coupling::interpolation),
        "CONSTRAINED_LINEAR_GLOBAL" => (WHOLE, coupling::linear),
        "CONSTRAINED_NODE_SET" => (1, coupling::equal),
        "CONTACT_TIED_NODES_TO_SURFACE" | "CONTACT_TIED_SURFACE_TO_SURFACE" => (WHOLE, tie::tie),
        "BOUNDARY_SPC_NODE" => (1, prescribed::support::<false>),
        "BOUNDARY_SPC_SET" => (1, prescribed::support::<true>),
        "BOUNDARY_SPC_NODE_BIRTH_DEATH" => (2, prescribed::support::<false>),
        "BOUNDARY_SPC_SET_BIRTH_DEATH" => (2, prescribed::support::<true>),
        "BOUNDARY_PRESCRIBED_MOTION_NODE" => (1, prescribed::node_motion::<false>),
        "BOUNDARY_PRESCRIBED_MOTION_SET" => (1, prescribed::node_motion::<true>),
        "BOUNDARY_PRESCRIBED_MOTION_RIGID" => (1, prescribed::body_motion),
        _ => return None,
    })
}

/// Whether a card constrains, or defines what constraints may refer to.
fn matters(card: &DynaCard) -> bool {
    let (name, _) = card.without(["_ID", "_TITLE"]);
    card_reader(name).is_some() || unread::reason(&card.keyword).is_some() || is_definition(card)
}

/// Splits the lines of a card into groups of `count` lines, without the titles. Groups that consist of blank lines are left out.
fn groups<'a>(
    card: &'a DynaCard,
    parameters: &'a Parameters,
    count: usize,
) -> impl Iterator<Item = Vec<KeywordLine<'a>>> {
    let before = usize::from(["_ID", "_TITLE"].iter().any(|title| card.keyword.ends_with(title)));
    let mut lines = card.lines(parameters).peekable();
    let group = move || {
        lines.peek()?;
        let titled: Vec<KeywordLine> = lines.by_ref().take(count.saturating_add(before)).collect();
        Some(titled.into_iter().skip(before).collect::<Vec<_>>())
    };
    std::iter::from_fn(group).filter(|group| group.iter().any(|line| !line.is_blank()))
}

impl LsDynaReader {
    fn new(files: Vec<PathBuf>) -> Self {
        Self { draft: KeywordDraft::new(files), all: DynaDefinitions::default() }
    }

    fn error(&self, card: &DynaCard, fault: KeywordFault) -> DeckError {
        self.draft.error(&format!("*{}", card.keyword), card.file, fault)
    }

    fn note(&mut self, cards: &DynaCards) -> Result<(), DeckError> {
        cards
            .all
            .iter()
            .try_for_each(|card| self.all.mesh.note(card, &cards.parameters).map_err(|fault| self.error(card, fault)))
    }

    /// Adds all rigid bodies before other cards are read, because cards may name a body before its definition.
    fn add_bodies(&mut self, cards: &DynaCards) -> Result<(), DeckError> {
        let path = self.draft.model.files[0].clone();
        let whole = |problem| DeckError { path, line: 0, card: "*PART".into(), field: None, problem };
        self.all.add_parts(&mut self.draft.model).map_err(whole)?;
        for card in cards.all.iter().filter(|card| card.keyword.starts_with("CONSTRAINED_NODAL_RIGID_BODY")) {
            let (name, _) = card.without(["_TITLE"]);
            let (has_inertia, is_held) = (name.contains("_INERTIA"), name.contains("_SPC"));
            for lines in groups(card, &cards.parameters, card_reader(name).map_or(WHOLE, |(count, _)| count)) {
                let inertia = lines.get(1 + usize::from(is_held)).filter(|_| has_inertia);
                let added = body::define(&lines[0], inertia, &mut self.all, &mut self.draft.model);
                added.map_err(|fault| self.error(card, fault))?;
            }
        }
        Ok(())
    }

    fn card(&mut self, card: &DynaCard, parameters: &Parameters) -> Result<(), DeckError> {
        let (name, _) = card.without(["_ID", "_TITLE"]);
        if is_part(name) {
            if has_unknown_option(card) && !name.starts_with("PART_MODES") {
                let text =
                    format!("*{} may define rigid parts in a way that is not understood: left out", card.keyword);
                self.draft.model.leave_out(card.file, card.line, text);
            }
            let parts = part_lines(card, parameters).map_err(|fault| self.error(card, fault))?;
            parts.into_iter().try_for_each(|(line, _)| self.group(card, &[line], body::part).map(|_| ()))?;
        }
        if let Some((count, read)) = card_reader(name) {
            for lines in groups(card, parameters, count) {
                if !self.group(card, &lines, read)? {
                    break;
                }
            }
        } else if let Some(why) = unread::reason(&card.keyword) {
            self.draft.model.leave_out(card.file, card.line, format!("*{} {why}: left out", card.keyword));
        }
        Ok(())
    }

    /// Reads a group of lines. Returns whether more groups of the card may follow.
    fn group(&mut self, card: &DynaCard, lines: &[KeywordLine], read: ReadGroup) -> Result<bool, DeckError> {
        let made = read(lines, &mut self.all);
        self.draft.group(&format!("*{}", card.keyword), card.file, lines, made)
    }

    /// Leaves out translations that are prescribed at a centre of mass if the deck does not give the centre and the body can rotate, and
    /// what is prescribed for a body that is merged into another, unless the other has the same rotation: its values hold for both.
    fn check_centres(&mut self) {
        let given = |dof| self.draft.prescribed.get(&dof).map(|given| (given.value, given.history));
        let turns = |node: &u32| (4..=6).any(|component| !self.draft.is_fixed(Dof { node: *node, component }));
        let free: BTreeSet<u32> = self.all.without_centre().into_iter().filter(turns).collect();
        let is_other = |dof: &Dof| {
            let lead = self.all.merged.get(&dof.node);
            lead.is_some_and(|&node| dof.component <= 3 || given(Dof { node, ..*dof }) != given(*dof))
        };
        let others: BTreeSet<Dof> = self.draft.prescribed.keys().filter(|dof| is_other(dof)).copied().collect();
        let is_uncertain = |dof: &&Dof| dof.component <= 3 && free.contains(&dof.node) && !others.contains(*dof);
        let uncertain = self.draft.prescribed.keys().filter(is_uncertain).copied().collect();
        self.draft.leave_out_values(&others, "holds a body that is merged into another, whose values hold for both");
        self.draft.leave_out_values(
            &uncertain,
            "holds a centre of mass that the deck does not give, of a body that can rotate",
        );
    }

    fn finish(mut self) -> Model {
        self.check_centres();
        self.draft.finish("rigid bodies and interpolations are linearised at the reference configuration")
    }
}
