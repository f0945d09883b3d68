//! The content of bulk data. Collects the cards that matter for constraints, in the order of the deck.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use rustc_hash::FxHashMap;

use super::elements::{jointg, rbar, rbar1, rbe1, rbe2, rbe3, rjoint, rrod, rtrplt, rtrplt1};
use super::exclusive::ExclusiveMembers;
use super::grids::Grids;
use super::loads::{LoadCombinations, LoadedComponents};
use super::points::{
    FrameDefinition, FrameDefinitions, GridCard, GridDefaults, PointSpan, spans, through_grids, through_points,
};
use super::quick::QuickCard;
use super::sets::{PointSupport, SetUnions, read_union, spc, spc1, terms};
use super::ties::Ties;
use super::unread::{CardNotes, UnknownNames, UnreadCard};
use super::{exclusive, loads, mystran, unread};
use crate::deck::kinematics::axes::FrameKind;
use crate::deck::nastran::syntax::card::{BulkCard, CardLocation, CardRefusal};
use crate::deck::nastran::syntax::lines::{DeckLine, FileLine};
use crate::deck::{CardFault, Solver};

const AUTOMPC: &str = "PARAM,AUTOMPC,YES lets Nastran choose dependent components and drop redundant equations: it may not stop where a stop is \
                       predicted";

/// The cards of bulk data that matter for constraints.
#[derive(Debug, Default)]
pub struct BulkData {
    /// Whether the deck is for MYSTRAN, which reads some cards differently.
    pub is_mystran: bool,
    /// Whether `PARAM,AUTOMSET,NO` forbids OptiStruct to choose other dependent components.
    pub keeps_dependent: bool,
    pub grids: Grids,
    pub scalars: Vec<PointSpan>,
    /// The content and the place of the `GRDSET` card, if there is one.
    pub grid_defaults: Option<(GridDefaults, CardLocation)>,
    pub frames: FrameDefinitions,
    /// The place of the card that defines each of the `frames`.
    pub frame_places: BTreeMap<u32, CardLocation>,
    pub ties: Ties,
    /// First lines of cards that must not be removed or replaced: cards with thermal expansion, cards that have copies, and copies.
    pub fixed: BTreeSet<FileLine>,
    /// Continuation lines that other cards separate from their card, by the first line of the card.
    pub apart: BTreeMap<FileLine, Vec<FileLine>>,
    /// The first line of each element's card, by element number.
    elements: FxHashMap<u32, FileLine>,
    /// The components in sets that exclude each other, such as `ASET` and `OMIT`.
    pub exclusive: Vec<ExclusiveMembers>,
    pub supports: Vec<(u32, PointSupport, CardLocation)>,
    /// The `SPCD` cards, each with its load set.
    pub enforced: Vec<(u32, PointSupport, CardLocation)>,
    pub mpc_unions: SetUnions,
    pub spc_unions: SetUnions,
    pub combinations: LoadCombinations,
    pub loads: Vec<LoadedComponents>,
    pub notes: CardNotes,
    /// The unknown card names that occurred.
    pub unknown: UnknownNames,
}

/// Returns the name if cards with it must be read. `name` is in capitals. `None` for cards that are skipped.
pub fn known(name: &[u8]) -> Option<&'static str> {
    const READ: [&str; 31] = [
        "GRID", "GRDSET", "SPOINT", "EPOINT", "CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S", "MPC",
        "MPCADD", "RBE1", "RBE2", "RBE3", "RBAR", "RROD", "SPC", "SPC1", "SPCADD", "SPCD", "LOAD", "FORCE", "MOMENT",
        "SLOAD", "RBAR1", "RJOINT", "RTRPLT", "RTRPLT1", "JOINTG", "PARAM",
    ];
    static KNOWN: LazyLock<FxHashMap<&[u8], &str>> = LazyLock::new(|| {
        READ.into_iter().chain(unread::names()).chain(exclusive::names()).map(|name| (name.as_bytes(), name)).collect()
    });
    KNOWN.get(name).copied()
}

impl BulkData {
    /// Empty bulk data of a deck for this solver.
    pub fn for_solver(solver: Solver) -> Self {
        Self { is_mystran: solver == Solver::Mystran, ..Self::default() }
    }

    /// Stores a card that the fast path has read.
    pub fn quick(&mut self, card: &QuickCard, line: &DeckLine) {
        match card {
            QuickCard::Grid(grid) => self.grids.push(grid, line.file, line.number),
            QuickCard::Mpc(set, first, second) => {
                self.ties.mpc(*set, (line.file, line.number, 1), std::iter::once(*first).chain(*second));
            }
        }
    }

    /// Reads a card and stores its content.
    pub fn card(&mut self, card: &BulkCard) -> Result<(), CardRefusal> {
        if self.is_mystran {
            if mystran::ignores(card.name) {
                let text = format!("MYSTRAN ignores {}: it constrains nothing", card.title());
                self.notes.warn((card.file, card.line), text);
                return Ok(());
            }
            mystran::judge(card, &mut self.notes);
        }
        self.read(card)
    }

    fn read(&mut self, card: &BulkCard) -> Result<(), CardRefusal> {
        match card.name {
            "GRID" => self.grids.push(&GridCard::read(card)?, card.file, card.line),
            "GRDSET" => self.grdset(card)?,
            "SPOINT" | "EPOINT" => self.scalars.extend(spans(card, 0, card.len())?),
            "MPCADD" => read_union(card, &mut self.mpc_unions)?,
            "SPCADD" => read_union(card, &mut self.spc_unions)?,
            "SPC" => self.supports.extend(in_set(card, spc(card)?)?),
            "SPC1" => self.supports.extend(in_set(card, vec![spc1(card, self.is_mystran)?])?),
            "SPCD" => self.enforced.extend(in_set(card, spc(card)?)?),
            "PARAM" => {
                let [name, value] = [0, 1].map(|i| card.field(i).to_ascii_uppercase());
                self.keeps_dependent |= name == b"AUTOMSET" && value.starts_with(b"N");
                if name == b"AUTOMPC" && value.starts_with(b"Y") && !self.is_mystran {
                    self.notes.warn((card.file, card.line), AUTOMPC.into());
                }
            }
            "LOAD" => loads::combination(card, &mut self.combinations)?,
            "FORCE" => self.loads.push(loads::vector(card, 1)?),
            "MOMENT" => self.loads.push(loads::vector(card, 4)?),
            "SLOAD" => self.loads.extend(loads::scalars(card)?),
            "MPC" => {
                // MYSTRAN accepts set 0.
                let set = if self.is_mystran { card.optional_whole(0, SET)?.unwrap_or_default() } else { set(card)? };
                self.ties.mpc(set, (card.file, card.line, card.span()), terms(card)?);
                self.note_apart(card);
            }
            name if name.starts_with("CORD") => self.frame(card)?,
            name => match UnreadCard::find(name) {
                Some(unread) => self.leave_out(card, unread)?,
                None => match exclusive::read(card)? {
                    Some(members) => self.exclusive.extend(members),
                    None => self.element(card)?,
                },
            },
        }
        Ok(())
    }

    /// Notes that a card is not understood. Components of `SUPORT` still count as members of their exclusive set.
    fn leave_out(&mut self, card: &BulkCard, unread: UnreadCard) -> Result<(), CardRefusal> {
        self.exclusive.extend(exclusive::read(card)?.unwrap_or_default());
        if unread.constrains() {
            self.notes.leave_out((card.file, card.line), unread.warning(card));
        } else {
            self.notes.warn((card.file, card.line), unread.warning(card));
        }
        Ok(())
    }

    fn element(&mut self, card: &BulkCard) -> Result<(), CardRefusal> {
        let (element, alpha) = match card.name {
            "RBE1" => rbe1(card)?,
            "RBE2" => rbe2(card, self.is_mystran)?,
            "RBE3" => rbe3(card, self.is_mystran)?,
            "RBAR" => rbar(card)?,
            "RBAR1" => rbar1(card)?,
            "RTRPLT" => rtrplt(card)?,
            "RTRPLT1" => rtrplt1(card)?,
            "RJOINT" => rjoint(card)?,
            "RROD" => rrod(card)?,
            _ => {
                let Some(read) = jointg(card)? else {
                    self.notes.leave_out((card.file, card.line), unread::joint(card));
                    return Ok(());
                };
                read
            }
        };
        let at = (card.file, card.line);
        if alpha != 0.0 {
            let text = format!("{}: its thermal expansion ALPHA is left out", card.title());
            self.notes.warn(at, text);
            self.fixed.insert(at);
        }
        self.number(card)?;
        self.note_apart(card);
        self.ties.element(element, CardLocation::new(card));
        Ok(())
    }

    /// Checks that no other element has the number of this card.
    fn number(&mut self, card: &BulkCard) -> Result<(), CardRefusal> {
        if self.is_mystran && mystran::has_no_number(card) {
            return Ok(());
        }
        let id = card.id(0, "the number of the element")?;
        match self.elements.insert(id, (card.file, card.line)) {
            Some((file, line)) => {
                let other =
                    if file == card.file { format!("line {line}") } else { format!("line {line} of another file") };
                Err(card.at(0, CardFault::ElementTwice { id, other: other.into() }.into()))
            }
            None => Ok(()),
        }
    }

    fn note_apart(&mut self, card: &BulkCard) {
        let apart: Vec<FileLine> = card.apart().collect();
        if !apart.is_empty() {
            self.apart.insert((card.file, card.line), apart);
        }
    }

    fn grdset(&mut self, card: &BulkCard) -> Result<(), CardRefusal> {
        let defaults = GridDefaults::read(card)?;
        if let Some((other, place)) = &self.grid_defaults
            && *other != defaults
        {
            let other = format!("line {}", place.line).into();
            return Err(card.at(0, CardFault::DefinedTwice { what: "GRDSET", id: 1, other }.into()));
        }
        self.grid_defaults = Some((defaults, CardLocation::new(card)));
        Ok(())
    }

    fn frame(&mut self, card: &BulkCard) -> Result<(), CardRefusal> {
        let kind = match card.name.as_bytes().last() {
            Some(b'C') => FrameKind::Cylindrical,
            Some(b'S') => FrameKind::Spherical,
            _ => FrameKind::Rectangular,
        };
        let is_cord1 = card.name.starts_with("CORD1");
        let found = if is_cord1 { through_grids(card, kind)? } else { vec![through_points(card, kind)?] };
        for (id, definition) in found {
            self.define(card, id, definition)?;
        }
        Ok(())
    }

    fn define(&mut self, card: &BulkCard, id: u32, definition: FrameDefinition) -> Result<(), CardRefusal> {
        let place = CardLocation::new(card);
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

const SET: &str = "the number of a set";

fn set(card: &BulkCard) -> Result<u32, CardRefusal> {
    card.id(0, SET)
}

fn in_set(card: &BulkCard, supports: Vec<PointSupport>) -> Result<Vec<(u32, PointSupport, CardLocation)>, CardRefusal> {
    let (set, place) = (set(card)?, CardLocation::new(card));
    Ok(supports.into_iter().map(|support| (set, support, place.clone())).collect())
}
