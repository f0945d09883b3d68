//! ANSYS archives and plain decks, `.cdb`: `CE` equations, `CP` coupled sets, `D` values.
//!
//! `CONST = sum of C_i U_i` in either spelling of `CE`. Values that `D` gives later replace earlier ones. Components 1 to 6 are UX,
//! UY, UZ, ROTX, ROTY, ROTZ; 7 WARP, 8 PRES, 9 VOLT, 10 MAG, 11 TEMP, and so on (`label`). All of them are along the axes of
//! their node. Fields are counted from 1 after the name of the command.
//!
//! ```
//! # let place = tempfile::tempdir()?;
//! let path = place.path().join("lug.cdb");
//! std::fs::write(&path, "CE,4,0.5,1,UX,1,2,UX,-1 ! a gap\nD,2,UX\n")?;
//! let deck = qless_io::deck::read(&path)?;
//! assert_eq!(deck.model().label(0).as_deref(), Some("line 1 CE 4 1:1"));
//! assert_eq!((deck.model().equation(0).expect("one").rhs, deck.model().cases()[0].prescribed[0].value), (0.5, 0.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Lines that begin with a number are data of blocks; only those of `NBLOCK` and of `CMBLOCK` of nodes are read.
//!
//! | folder | holds |
//! | --- | --- |
//! | `syntax` | lines as commands and fields, parameters and what is computed of them |
//! | `commands` | what each command that constrains does |
//! | `model` | what the commands have made: nodes, equations by number, load steps |
//! | `write` | the deck with other equations |
//!
//! `reader` goes through the text and hands each command to the one who reads it.

mod syntax {
    pub mod archive;
    pub mod command;
    pub mod control;
    pub mod expression;
    pub mod field;
    pub mod format;
    pub mod known;
    pub mod label;
    pub mod parameters;
}

mod model {
    pub mod events;
    pub mod nodes;
    pub mod numbered;
    pub mod positions;
    pub mod selection;
    pub mod terms;
}

mod commands {
    pub mod coupled;
    pub mod elements;
    pub mod equations;
    pub mod numbering;
    pub mod prescribed;
    pub mod region;
}

mod build;
mod reader;
mod write;

pub(super) use build::{node_sets, positions, read};
pub(super) use write::write;
