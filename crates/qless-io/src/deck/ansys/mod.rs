//! ANSYS archives and plain decks, `.cdb`: `CE` equations, `CP` coupled sets, `D` values.
//!
//! Both forms of `CE` define `CONST = sum of C_i U_i`. A later value of `D` replaces an earlier one. Components 1 to 6 are UX, UY,
//! UZ, ROTX, ROTY, ROTZ; 7 is WARP, 8 PRES, 9 VOLT, 10 MAG, 11 TEMP, and so on (`syntax::label`). All of them are along the axes
//! of their node. Fields count from 1 after the name of the command.
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
//! Lines that begin with a number are data of blocks. Only those of `NBLOCK`, `ETBLOCK` and `CMBLOCK` of nodes are read.
//!
//! | folder | holds |
//! | --- | --- |
//! | `syntax` | lines, commands and fields; parameters and expressions; loops and branches |
//! | `model` | nodes, equations by number, load steps |
//! | `commands` | the commands that constrain |
//! | `reader` | reads a text line by line and executes each command |
//! | `build` | the model of a deck |
//! | `joined` | joins the models of a deck that has several |
//! | `write` | a deck with changed equations |

mod syntax {
    pub mod archive;
    pub mod array;
    pub mod command;
    pub mod control;
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
    pub mod written;
}

mod commands {
    pub mod coupled;
    pub mod elements;
    pub mod equations;
    pub mod generated;
    pub mod numbering;
    pub mod prescribed;
    pub mod region;
}

mod build;
mod joined;
mod reader;
mod write;

pub(super) use build::{node_sets, positions, read};
pub(super) use write::write;
