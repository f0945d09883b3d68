//! Joins cards with continuation lines that are not next to them.
//!
//! A card that ends with the mark `+A` continues in the line that begins with `+A`, wherever that line is in the deck. If a line has no
//! mark and the next line begins with a name, the next line continues it. There is one exception: the mark of another line gives this name.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::card::{BulkCard, CardRefusal, NamedRefusal};
use super::fields::{mark, name_in, split};
use super::lines::FileLine;
use crate::deck::{CardFault, Solver};

/// Cards that wait for their continuation lines, and continuation lines that wait for their card. Both are in the order of the deck.
#[derive(Debug, Default)]
pub struct Continuations {
    claims: Vec<ContinuationClaim>,
    pieces: Vec<LoosePiece>,
    /// The names that occur in the marks of cards and of pieces (continuation lines whose card is not known yet).
    named: BTreeSet<Vec<u8>>,
}

/// A card that claims the continuation line with a given name.
#[derive(Debug)]
struct ContinuationClaim {
    card: Option<BulkCard>,
    name: Vec<u8>,
    /// For a card without a mark: the index of the piece that directly follows it. The piece belongs to this card unless another card names
    /// it.
    next: Option<usize>,
}

/// A piece: consecutive continuation lines whose card is not known yet.
#[derive(Debug)]
struct LoosePiece {
    name: Vec<u8>,
    /// The name of the line that continues the piece, from the mark of its last line.
    mark: Vec<u8>,
    lines: Vec<(FileLine, Vec<u8>)>,
    /// Whether these lines may belong to the skipped card that precedes them.
    may_be_unread: bool,
    /// Whether these lines directly follow another piece that ends without a mark.
    follows: bool,
    is_taken: bool,
}

/// The kind of the line that precedes a continuation line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineBefore {
    Nothing,
    /// A line of the card that is being read.
    Read,
    /// A line of a card that is skipped.
    Unread,
    /// A line of the last piece: continuation lines whose card is not known yet.
    Piece,
}

impl Continuations {
    /// Adds a card that continues on a line with this name. `card` is `None` for a card that is skipped.
    pub fn claim(&mut self, name: Vec<u8>, card: Option<BulkCard>) {
        self.claims.push(ContinuationClaim { card, name, next: None });
    }

    /// Adds a card that has no mark, but is followed by a continuation line with a name.
    pub fn claim_next(&mut self, card: BulkCard) {
        self.claims.push(ContinuationClaim { card: Some(card), name: Vec::new(), next: Some(self.pieces.len()) });
    }

    /// Starts a new piece of continuation lines, whose card is not known yet. Its first line does not continue the line before it.
    pub fn start(&mut self, name: Vec<u8>, line: &[u8], at: FileLine, may_be_unread: bool) {
        let lines = vec![(at, line.to_vec())];
        let mark = name_in(mark(line));
        self.pieces.push(LoosePiece { name, mark, lines, may_be_unread, follows: false, is_taken: false });
    }

    /// Starts a new piece of continuation lines that directly follows the last piece.
    pub fn start_next(&mut self, name: Vec<u8>, line: &[u8], at: FileLine) {
        let last = self.pieces.last();
        let (may_be_unread, follows) =
            last.map_or((false, false), |piece| (piece.may_be_unread, piece.mark.is_empty()));
        self.start(name, line, at, may_be_unread && follows);
        self.pieces.last_mut().into_iter().for_each(|piece| piece.follows = follows);
    }

    /// Whether a line with this name continues the last piece of continuation lines.
    pub fn goes_on(&self, name: &[u8]) -> bool {
        self.pieces.last().is_some_and(|piece| name.is_empty() || piece.mark == name)
    }

    /// Appends a line to the last piece of continuation lines.
    pub fn extend(&mut self, line: &[u8], at: FileLine) {
        if let Some(piece) = self.pieces.last_mut() {
            piece.mark = name_in(mark(line));
            piece.lines.push((at, line.to_vec()));
        }
    }

    /// The waiting cards, each with all of its lines, in the order of the deck.
    ///
    /// # Errors
    /// If a card lacks its continuation line, or a continuation line lacks its card. MYSTRAN looks for a continuation on the next line
    /// only: it accepts a card whose continuation is missing. A continuation line elsewhere, which MYSTRAN silently drops, is an error
    /// here.
    pub fn finish(mut self, solver: Solver) -> Result<Vec<BulkCard>, NamedRefusal> {
        let mut by_name: BTreeMap<Vec<u8>, VecDeque<usize>> = BTreeMap::new();
        for (i, piece) in self.pieces.iter().enumerate() {
            by_name.entry(piece.name.clone()).or_default().push_back(i);
        }
        let marks = self.pieces.iter().map(|piece| &piece.mark);
        self.named = self.claims.iter().map(|claim| &claim.name).chain(marks).cloned().collect();
        let mut cards = Vec::with_capacity(self.claims.len());
        // Cards whose marks give names come first: a piece belongs to the card before it only if no mark gives the name of the piece.
        let claims = std::mem::take(&mut self.claims);
        for claim in claims.iter().filter(|claim| claim.next.is_none()) {
            cards.extend(self.complete(claim, &mut by_name, solver)?);
        }
        for claim in claims.iter().filter(|claim| claim.next.is_some()) {
            cards.extend(self.complete(claim, &mut by_name, solver)?);
        }
        if let Some(orphan) = self.pieces.iter().find(|piece| !piece.is_taken && !piece.may_be_unread) {
            let fault = CardFault::Orphan { found: String::from_utf8_lossy(&orphan.name).into() };
            let refused = CardRefusal::of_line(orphan.lines[0].0, fault);
            return Err(NamedRefusal { card: "continuation".into(), refused });
        }
        cards.sort_by_key(|card| (card.file, card.line));
        Ok(cards)
    }

    /// Completes the card of a claim, and marks the lines that it takes.
    fn complete(
        &mut self,
        claim: &ContinuationClaim,
        by_name: &mut BTreeMap<Vec<u8>, VecDeque<usize>>,
        solver: Solver,
    ) -> Result<Option<BulkCard>, NamedRefusal> {
        let (mut card, mut name) = (claim.card.clone(), claim.name.clone());
        if let Some(next) = claim.next.filter(|&next| !self.pieces[next].is_taken) {
            name = self.take(next, card.as_mut(), false)?;
        }
        while !name.is_empty() {
            let free = by_name.get_mut(&name).and_then(|pieces| {
                std::iter::from_fn(|| pieces.pop_front()).find(|&piece| !self.pieces[piece].is_taken)
            });
            match (free, card.as_mut()) {
                (Some(piece), Some(card)) if solver == Solver::Mystran => {
                    let at = self.pieces[piece].lines[0].0;
                    return Err(CardRefusal::of_line(at, CardFault::ContinuationDropped).in_card(card));
                }
                (None, Some(_)) if solver == Solver::Mystran => break,
                (Some(piece), card) => name = self.take(piece, card, true)?,
                (None, None) => break,
                (None, Some(card)) => {
                    let expected = String::from_utf8_lossy(&name).into();
                    let fault = CardFault::NoContinuation { expected };
                    return Err(CardRefusal::of_line(card.last(), fault).in_card(card));
                }
            }
        }
        Ok(card)
    }

    /// Appends a piece of continuation lines, and the pieces that follow it, to a card. If the card is skipped, only marks them as taken.
    /// Returns the name of the line that continues the card.
    fn take(
        &mut self,
        mut at: usize,
        mut card: Option<&mut BulkCard>,
        is_apart: bool,
    ) -> Result<Vec<u8>, NamedRefusal> {
        loop {
            let piece = &mut self.pieces[at];
            piece.is_taken = true;
            if let Some(card) = card.as_deref_mut() {
                for (at, line) in &piece.lines {
                    card.extend(line, *at, is_apart).map_err(|refused| refused.in_card(card))?;
                }
            }
            at += 1;
            let next = self.pieces.get(at).filter(|next| next.follows && !next.is_taken);
            if next.is_none_or(|next| self.named.contains(&next.name)) {
                return Ok(self.pieces[at - 1].mark.clone());
            }
        }
    }
}

/// The name at the start of a continuation line, in capitals. It is empty if the line begins with blanks or a bare `+` or `*`.
pub fn name_of(line: &[u8]) -> Vec<u8> {
    split(line).map(|fields| fields.name.to_ascii_uppercase()).unwrap_or_default()
}

/// Whether all cards with this name fit on one line in small field. A text in their last field is then a remark, not a continuation mark.
pub fn is_always_one_line(name: &str) -> bool {
    matches!(name, "GRID" | "GRDSET" | "SPC" | "SPCD" | "FORCE" | "MOMENT" | "SLOAD") || name.starts_with("CORD1")
}
