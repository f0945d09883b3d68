//! Nastran decks, `.bdf`, `.dat`, `.nas`.
//!
//! The reader keeps cards that constrain and skips all others. Rigid elements hold in every load case; `MPC` and `SPC` cards hold in
//! the load cases for which case control selects their set. Equations are homogeneous and use the displacement
//! axes of their grid points, as in Nastran; the first term is the dependent component. The one component of a scalar point is 0.
//!
//! | read | cards |
//! | --- | --- |
//! | points and axes | `GRID` `GRDSET` `SPOINT` `EPOINT` `CORD1R/C/S` `CORD2R/C/S` |
//! | equations | `MPC` `MPCADD` `RBE1` `RBE2` `RBE3` `RBAR` `RBAR1` `RROD` `RJOINT` `RTRPLT` `RTRPLT1` |
//! | equations of OptiStruct | `JOINTG` (`BALL`, `RBEAM`) |
//! | sets that exclude slaves | `ASET` `OMIT` `BSET` `CSET` `QSET` `SUPORT` |
//! | values | `SPC` `SPC1` `SPCADD` `SPCD`, PS of `GRID` |
//! | loads | `LOAD` `FORCE` `MOMENT` `SLOAD` |
//!
//! | folder | holds |
//! | --- | --- |
//! | `syntax` | bytes to cards: numbers, lines, fields, continuations, copies |
//! | `cards` | content of each card of bulk data, and the tables that hold it |
//! | `control` | case control: the sets that hold in each subcase |
//! | `reader` | the sections of a deck in their order |
//! | `model` | points, equations and load cases |
//! | `write` | a deck with changed constraints |
//!
//! Each folder imports only from those above it.
//!
//! Cards that constrain in other ways (such as `RSPLINE`, `CWELD`, superelements) are left out, with a message; the model is then
//! incomplete. Warnings name sets that no subcase selects, and selected sets that do not exist. A continuation line is found by its
//! name anywhere in the deck; OptiStruct and MYSTRAN look only at the next line. Lines that begin with `=` copy the previous card,
//! except for MYSTRAN, which ignores them or stops.
//!
//! ```
//! # let place = tempfile::tempdir()?;
//! let path = place.path().join("lug.bdf");
//! std::fs::write(&path, "CEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nRBE2,7,1,3,2\nENDDATA\n")?;
//! let deck = qless_io::deck::read(&path)?;
//! assert_eq!(deck.model().label(0).as_deref(), Some("line 5 RBE2 7 2:3"));
//! assert_eq!(deck.model().equation(0).expect("one").coefficients, [1.0, -1.0, 1.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod syntax {
    pub mod card;
    pub mod continuations;
    pub mod copies;
    pub mod fields;
    pub mod lines;
    pub mod number;
}

mod cards {
    pub mod assembly;
    pub mod bulk;
    pub mod elements;
    pub mod exclusive;
    pub mod grids;
    pub mod loads;
    pub mod mystran;
    pub mod points;
    pub mod quick;
    pub mod sets;
    pub mod ties;
    pub mod unread;
}

mod control {
    pub mod selected;
    pub mod subcases;
}

mod model;
mod reader;
mod write;

pub(super) use model::positions;
pub(super) use write::write;

use super::{DeckError, Model, Sources};

/// Reads a deck.
pub(super) fn read(sources: &mut Sources) -> Result<Model, DeckError> {
    let content = reader::read(sources)?;
    model::build(content, sources)
}
