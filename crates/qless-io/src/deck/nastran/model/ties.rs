//! What ties components together, in the order of the deck: millions of `MPC` in little room, other elements between them.

use crate::deck::CardName;
use crate::deck::chunks::Chunks;
use crate::deck::kinematics::rigid::Rigid;
use crate::deck::kinematics::rod::Rod;
use crate::deck::nastran::cards::elements::{Averaged, Star};
use crate::deck::nastran::cards::mpc::Term;
use crate::deck::nastran::syntax::place::Place;

/// A card that ties components.
#[derive(Clone, Copy, Debug)]
pub enum Tie<'a> {
    Mpc(&'a Mpc),
    Element(&'a Element, &'a Place),
}

/// An `MPC` card.
#[derive(Clone, Copy, Debug)]
pub struct Mpc {
    pub set: u32,
    pub file: u32,
    pub line: u32,
    lines: u32,
    /// Where its terms begin and end.
    start: u32,
    end: u32,
}

/// A rigid or interpolating element.
#[derive(Clone, Debug)]
pub enum Element {
    Star(Star),
    Rigid(Rigid),
    Rod(Rod),
    Mean(Averaged),
    /// A mean over the motions of the reference's own components alone.
    PartialMean(Averaged),
    /// Points at one place.
    Joint(Rigid),
}

impl Mpc {
    pub fn place(&self) -> Place {
        Place { name: CardName::numbered("MPC", self.set), file: self.file, line: self.line, lines: self.lines }
    }
}

/// All of them.
#[derive(Debug, Default)]
pub struct Ties {
    mpcs: Chunks<Mpc>,
    terms: Chunks<Term>,
    /// Elements with the number of `MPC` cards before them.
    elements: Vec<(usize, Element, Place)>,
}

impl Ties {
    /// Adds an `MPC` card at a file, a line, and so many lines.
    pub fn mpc(&mut self, set: u32, (file, line, lines): (u32, u32, u32), terms: impl IntoIterator<Item = Term>) {
        let start = self.terms.len() as u32;
        terms.into_iter().for_each(|term| self.terms.push(term));
        self.mpcs.push(Mpc { set, file, line, lines, start, end: self.terms.len() as u32 });
    }

    pub fn element(&mut self, element: Element, place: Place) {
        self.elements.push((self.mpcs.len(), element, place));
    }

    /// `MPC` cards.
    pub fn mpcs(&self) -> impl Iterator<Item = &Mpc> {
        self.mpcs.iter()
    }

    /// The terms of an `MPC` card.
    pub fn terms_of(&self, card: &Mpc) -> impl Iterator<Item = Term> {
        (card.start..card.end).map(|k| self.terms[k as usize])
    }

    /// Number of `MPC` cards and of their terms.
    pub fn counts(&self) -> (usize, usize) {
        (self.mpcs.len(), self.terms.len())
    }

    /// All in order.
    pub fn iter(&self) -> impl Iterator<Item = Tie<'_>> {
        let (mut mpcs, mut count, mut element) = (self.mpcs.iter(), 0, 0);
        std::iter::from_fn(move || match self.elements.get(element) {
            Some((before, tie, place)) if *before == count => {
                element += 1;
                Some(Tie::Element(tie, place))
            }
            _ => {
                count += 1;
                mpcs.next().map(Tie::Mpc)
            }
        })
    }
}
