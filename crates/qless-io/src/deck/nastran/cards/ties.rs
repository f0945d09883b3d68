//! A compact table of the `MPC` cards and rigid elements of a deck, in its order.

use super::elements::NastranElement;
use super::sets::MpcTerm;
use crate::deck::CardName;
use crate::deck::nastran::syntax::card::CardLocation;
use crate::deck::paged_list::PagedList;

/// A card that couples components: an `MPC` card or a rigid element.
#[derive(Clone, Copy, Debug)]
pub enum TieCard<'a> {
    Mpc(&'a MpcCard),
    Element(&'a NastranElement, &'a CardLocation),
}

/// An `MPC` card.
#[derive(Clone, Copy, Debug)]
pub struct MpcCard {
    pub set: u32,
    pub file: u32,
    pub line: u32,
    lines: u32,
    /// The range of the card's terms in `Ties::terms`.
    start: u32,
    end: u32,
}

impl MpcCard {
    pub fn place(&self) -> CardLocation {
        CardLocation { name: CardName::numbered("MPC", self.set), file: self.file, line: self.line, lines: self.lines }
    }
}

/// All `MPC` cards and rigid elements of a deck.
#[derive(Debug, Default)]
pub struct Ties {
    mpcs: PagedList<MpcCard>,
    terms: PagedList<MpcTerm>,
    /// The elements, each with the number of `MPC` cards that precede it in the deck.
    elements: Vec<(usize, NastranElement, CardLocation)>,
}

impl Ties {
    /// Adds an `MPC` card. Its place is the file, the first line, and the number of lines.
    pub fn mpc(&mut self, set: u32, (file, line, lines): (u32, u32, u32), terms: impl IntoIterator<Item = MpcTerm>) {
        let start = self.terms.len() as u32;
        terms.into_iter().for_each(|term| self.terms.push(term));
        self.mpcs.push(MpcCard { set, file, line, lines, start, end: self.terms.len() as u32 });
    }

    pub fn element(&mut self, element: NastranElement, place: CardLocation) {
        self.elements.push((self.mpcs.len(), element, place));
    }

    pub fn mpcs(&self) -> impl Iterator<Item = &MpcCard> {
        self.mpcs.iter()
    }

    /// The terms of an `MPC` card.
    pub fn terms_of(&self, card: &MpcCard) -> impl Iterator<Item = MpcTerm> {
        (card.start..card.end).map(|k| self.terms[k as usize])
    }

    /// The number of `MPC` cards, and the number of all their terms.
    pub fn counts(&self) -> (usize, usize) {
        (self.mpcs.len(), self.terms.len())
    }

    /// All `MPC` cards and elements, in the order of the deck.
    pub fn iter(&self) -> impl Iterator<Item = TieCard<'_>> {
        let (mut mpcs, mut count, mut element) = (self.mpcs.iter(), 0, 0);
        std::iter::from_fn(move || match self.elements.get(element) {
            Some((before, tie, place)) if *before == count => {
                element += 1;
                Some(TieCard::Element(tie, place))
            }
            _ => {
                count += 1;
                mpcs.next().map(TieCard::Mpc)
            }
        })
    }
}
