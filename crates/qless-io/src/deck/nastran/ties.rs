//! What ties components together, in the order of the deck: millions of `MPC` in little room, other elements between them.

use super::elements::Star;
use super::mean::Mean;
use super::mpc::Term;
use super::place::Place;
use super::rigid::Rigid;
use super::rod::Rod;
use crate::deck::CardName;

/// A card that ties components.
#[derive(Clone, Copy, Debug)]
pub(super) enum Tie<'a> {
    Mpc(&'a Mpc, &'a [Term]),
    Element(&'a Element, &'a Place),
}

/// An `MPC` card.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mpc {
    pub set: u32,
    pub file: u32,
    pub line: u32,
    lines: u32,
    /// Where its terms end.
    end: u32,
}

/// A rigid or interpolating element.
#[derive(Clone, Debug)]
pub(super) enum Element {
    Star(Star),
    Rigid(Rigid),
    Rod(Rod),
    Mean(Mean),
}

impl Mpc {
    pub fn place(&self) -> Place {
        Place { name: CardName::numbered("MPC", self.set), file: self.file, line: self.line, lines: self.lines }
    }
}

/// All of them.
#[derive(Debug, Default)]
pub(super) struct Ties {
    mpcs: Vec<Mpc>,
    terms: Vec<Term>,
    /// Elements with the number of `MPC` cards before them.
    elements: Vec<(usize, Element, Place)>,
}

impl Ties {
    /// Adds an `MPC` card at a file, a line, and so many lines.
    pub fn mpc(&mut self, set: u32, (file, line, lines): (u32, u32, u32), terms: impl IntoIterator<Item = Term>) {
        self.terms.extend(terms);
        self.mpcs.push(Mpc { set, file, line, lines, end: self.terms.len() as u32 });
    }

    pub fn element(&mut self, element: Element, place: Place) {
        self.elements.push((self.mpcs.len(), element, place));
    }

    /// `MPC` cards.
    pub fn mpcs(&self) -> &[Mpc] {
        &self.mpcs
    }

    /// Number of terms of `MPC` cards.
    pub fn terms(&self) -> usize {
        self.terms.len()
    }

    /// All in order.
    pub fn iter(&self) -> impl Iterator<Item = Tie<'_>> {
        let (mut mpc, mut element) = (0, 0);
        std::iter::from_fn(move || match self.elements.get(element) {
            Some((before, tie, place)) if *before == mpc => {
                element += 1;
                Some(Tie::Element(tie, place))
            }
            _ => {
                let card = self.mpcs.get(mpc)?;
                let start = mpc.checked_sub(1).map_or(0, |before| self.mpcs[before].end);
                mpc += 1;
                Some(Tie::Mpc(card, &self.terms[start as usize..card.end as usize]))
            }
        })
    }
}
