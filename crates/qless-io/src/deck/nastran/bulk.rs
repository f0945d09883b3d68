//! Bulk data: the cards that say what is constrained, in their order. All others are passed over.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use super::axes::Kind;
use super::card::{Card, Refused};
use super::elements::{Star, rbar, rbe1, rbe2, rbe3, rrod};
use super::frames::{Definition, Definitions};
use super::grid::{Grid, Usual};
use super::loads::{self, Combinations, Loaded};
use super::mean::Mean;
use super::mpc::{Term, terms};
use super::place::Place;
use super::rigid::Rigid;
use super::rod::Rod;
use super::sets::{self, Unions};
use super::spans::{Span, spans};
use super::supports::{Support, spc, spc1};
use super::unread::Unread;
use super::{coordinates, fault::CardFault};

/// What ties components together; small, because there can be millions of `MPC`.
#[derive(Clone, Debug)]
pub(super) enum Tie {
    Mpc { set: u32, terms: Box<[Term]> },
    Star(Box<Star>),
    Rigid(Box<Rigid>),
    Rod(Rod),
    Mean(Box<Mean>),
}

/// What the bulk data of a deck constrains.
#[derive(Debug, Default)]
pub(super) struct Bulk {
    pub grids: Vec<Grid>,
    pub scalars: Vec<Span>,
    pub usual: Option<(Usual, Place)>,
    pub frames: Definitions,
    /// The cards of `frames`.
    pub frame_places: BTreeMap<u32, Place>,
    pub ties: Vec<(Tie, Place)>,
    /// Lines of cards with thermal expansion, which equations cannot stand in for; by file and line.
    pub expanding: BTreeSet<(u32, u32)>,
    pub supports: Vec<(u32, Support, Place)>,
    /// `SPCD`.
    pub enforced: Vec<(u32, Support, Place)>,
    pub mpc_unions: Unions,
    pub spc_unions: Unions,
    pub combinations: Combinations,
    pub loads: Vec<Loaded>,
    /// File, line and text of warnings.
    pub warnings: Vec<(u32, u32, String)>,
}

/// Whether a card of this name, in capitals, has to be read.
pub(super) fn is_read(name: &[u8]) -> bool {
    const READ: [&[u8]; 22] = [
        b"GRID", b"GRDSET", b"SPOINT", b"EPOINT", b"CORD1R", b"CORD1C", b"CORD1S", b"CORD2R", b"CORD2C", b"CORD2S",
        b"MPC", b"MPCADD", b"RBE1", b"RBE2", b"RBE3", b"RBAR", b"RROD", b"SPC", b"SPC1", b"SPCADD", b"SPCD", b"LOAD",
    ];
    const LOADS: [&[u8]; 3] = [b"FORCE", b"MOMENT", b"SLOAD"];
    READ.contains(&name) || LOADS.contains(&name) || Unread::of(name).is_some()
}

impl Bulk {
    /// Takes a card.
    pub fn card(&mut self, card: &Card) -> Result<(), Refused> {
        match card.name.as_slice() {
            b"GRID" => self.grids.push(Grid::read(card)?),
            b"GRDSET" => self.grdset(card)?,
            b"SPOINT" | b"EPOINT" => self.scalars.extend(spans(card, 0, card.len())?),
            b"MPCADD" => sets::read(card, &mut self.mpc_unions)?,
            b"SPCADD" => sets::read(card, &mut self.spc_unions)?,
            b"SPC" => self.supports.extend(in_set(card, spc(card)?)?),
            b"SPC1" => self.supports.extend(in_set(card, vec![spc1(card)?])?),
            b"SPCD" => self.enforced.extend(in_set(card, spc(card)?)?),
            b"LOAD" => loads::combination(card, &mut self.combinations)?,
            b"FORCE" => self.loads.push(loads::vector(card, 1)?),
            b"MOMENT" => self.loads.push(loads::vector(card, 4)?),
            b"SLOAD" => self.loads.extend(loads::scalars(card)?),
            name if name.starts_with(b"CORD") => self.frame(card)?,
            name => match Unread::of(name) {
                Some(unread) => self.warnings.push((card.file, card.line, unread.warning(card))),
                None => self.tie(card)?,
            },
        }
        Ok(())
    }

    fn tie(&mut self, card: &Card) -> Result<(), Refused> {
        let (tie, alpha) = match card.name.as_slice() {
            b"MPC" => (Tie::Mpc { set: set(card)?, terms: terms(card)?.into() }, 0.0),
            b"RBE1" => rbe1(card).map(|read| (Tie::Rigid(Box::new(read.element)), read.alpha))?,
            b"RBE2" => rbe2(card).map(|read| (Tie::Star(Box::new(read.element)), read.alpha))?,
            b"RBE3" => rbe3(card).map(|read| (Tie::Mean(Box::new(read.element)), read.alpha))?,
            b"RBAR" => rbar(card).map(|read| (Tie::Rigid(Box::new(read.element)), read.alpha))?,
            _ => rrod(card).map(|read| (Tie::Rod(read.element), read.alpha))?,
        };
        if alpha != 0.0 {
            let text = format!("{}: its thermal expansion ALPHA is left out", card.title());
            self.warnings.push((card.file, card.line, text));
            self.expanding.insert((card.file, card.line));
        }
        let mut place = Place::of(card);
        // Cards of one set have one name.
        if let Some((_, last)) = self.ties.last().filter(|(_, last)| last.name == place.name) {
            place.name = Rc::clone(&last.name);
        }
        self.ties.push((tie, place));
        Ok(())
    }

    fn grdset(&mut self, card: &Card) -> Result<(), Refused> {
        let usual = Usual::read(card)?;
        if let Some((other, place)) = &self.usual
            && *other != usual
        {
            let other = format!("line {}", place.line).into();
            return Err(card.at(0, CardFault::DefinedTwice { what: "GRDSET", id: 1, other }.into()));
        }
        self.usual = Some((usual, Place::of(card)));
        Ok(())
    }

    fn frame(&mut self, card: &Card) -> Result<(), Refused> {
        let kind = match card.name.last() {
            Some(b'C') => Kind::Cylindrical,
            Some(b'S') => Kind::Spherical,
            _ => Kind::Rectangular,
        };
        let through_grids = card.name.get(4) == Some(&b'1');
        let found = if through_grids {
            coordinates::through_grids(card, kind)?
        } else {
            vec![coordinates::through_points(card, kind)?]
        };
        for (id, definition) in found {
            self.define(card, id, definition)?;
        }
        Ok(())
    }

    fn define(&mut self, card: &Card, id: u32, definition: Definition) -> Result<(), Refused> {
        let place = Place::of(card);
        if let (Some(known), Some(other)) = (self.frames.get(&id), self.frame_places.get(&id))
            && *known != definition
        {
            let other = format!("line {}", other.line).into();
            return Err(card.at(0, CardFault::DefinedTwice { what: "coordinate system", id, other }.into()));
        }
        self.frames.insert(id, definition);
        self.frame_places.entry(id).or_insert(place);
        Ok(())
    }
}

fn set(card: &Card) -> Result<u32, Refused> {
    card.id(0, "the number of a set")
}

fn in_set(card: &Card, supports: Vec<Support>) -> Result<Vec<(u32, Support, Place)>, Refused> {
    let (set, place) = (set(card)?, Place::of(card));
    Ok(supports.into_iter().map(|support| (set, support, place.clone())).collect())
}
