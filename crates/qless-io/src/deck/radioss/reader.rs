//! Builds the model: first the definitions, then the constraints in the order of the deck.

use super::cards::{ReadRadioss, body, coupling, prescribed, tie, unread};
use super::checks;
use super::model::mesh::{CardPlace, RadiossMesh};
use super::syntax::card::{RadiossCard, RadiossCards};
use crate::deck::keyword::draft::KeywordDraft;
use crate::deck::keyword::line::KeywordLine;
use crate::deck::{DeckError, Model, Sources};

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
}

impl RadiossReader {
    fn new(sources: &Sources) -> Self {
        let draft = KeywordDraft::new(sources.paths().to_vec());
        Self { draft, mesh: RadiossMesh::default() }
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
        self.mesh.card = CardPlace { number, file: card.file, line: lines[0].number, name: name.clone() };
        let made = read(&lines[..filled], &mut self.mesh);
        self.draft.group(&name, card.file, &lines[..filled], made)?;
        let is_added = self.draft.model.cards.len() as u32 > number;
        if is_added && matches!(card.keyword.as_str(), "MPC" | "BCS/LAGMUL") {
            self.draft.model.keep_by_multipliers(number);
        }
        Ok(())
    }

    fn finish(mut self) -> Model {
        checks::order(&mut self.mesh);
        for (CardPlace { file, line, name, .. }, why) in std::mem::take(&mut self.mesh.stops) {
            self.draft.model.refuse(file, line, format!("Radioss stops: {name} {why}"));
        }
        checks::means(&self.mesh, &mut self.draft);
        checks::centres(&self.mesh, &mut self.draft);
        self.draft.finish("rigid bodies and weighted means are linearised at the reference configuration")
    }
}
