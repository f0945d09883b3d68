//! Finite-element decks: their constraints as equations `C u = b`, and decks written back with an independent set.
//!
//! | format | module | usual endings |
//! | --- | --- | --- |
//! | CalculiX, Abaqus | `calculix` | `.inp` |
//! | Nastran | `nastran` | `.bdf`, `.dat`, `.nas`, `.fem` |
//! | ANSYS | `ansys` | `.cdb` |
//!
//! The first cards of a deck decide which it is; where they leave that open, the solver asked for, or else the ending, does. Text
//! may be packed by gzip or be UTF-16 with a byte order mark, and its lines may end in LF, CRLF or CR; `-` is standard input.
//!
//! A reader turns the bytes of a deck and of the files that it includes into a [`Model`], which knows the card and the line of
//! every equation; [`Model::system`] gives `C u = b` for a load case. [`clean`] decides what must
//! change so that a solver takes it.

mod ansys;
mod calculix;
mod cards;
mod chunks;
pub mod clean;
mod detect;
mod error;
mod format;
mod kinematics;
mod model;
mod nastran;
mod solver;
mod source;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

pub use cards::{Card, CardName, Cards};
pub use detect::UnrecognizedText;
pub(crate) use detect::format_of;
pub use error::{DeckError, Problem};
pub use format::{Format, Solver, UnknownSolver};
pub use model::{DeckEquation, Dof, Load, LoadCase, Model, Origin, Prescribed, Warning};
pub use nastran::CardFault;
pub use solver::Outcome;
pub use source::Open;
pub(crate) use source::Sources;

pub use crate::opened::{read_deck as read, read_deck_for as read_for};

/// A deck: its constraints, and the text that they were read from.
#[derive(Debug)]
pub struct Deck {
    solver: Solver,
    model: Model,
    texts: Vec<Arc<Vec<u8>>>,
}

impl Deck {
    /// Its language.
    pub fn format(&self) -> Format {
        self.solver.format()
    }

    /// The solver that it was read for.
    pub fn solver(&self) -> Solver {
        self.solver
    }

    /// Its constraints.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The bytes of [`Model::files`].
    pub fn texts(&self) -> &[Arc<Vec<u8>>] {
        &self.texts
    }

    /// Where nodes are in the model's axes, by number. Nodes that commands generate, or give along other axes in a way that is not
    /// followed (ANSYS), are left out.
    ///
    /// ```
    /// # let place = tempfile::tempdir()?;
    /// let path = place.path().join("node.inp");
    /// std::fs::write(&path, "*NODE\n7,1.,2.,3.\n")?;
    /// assert_eq!(qless_io::deck::read(&path)?.positions()[&7], [1.0, 2.0, 3.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn positions(&self) -> HashMap<u32, [f64; 3]> {
        match self.format() {
            Format::Calculix => calculix::positions(self),
            Format::Nastran => nastran::positions(self),
            Format::Ansys => ansys::positions(self),
        }
    }

    /// The nodes of a set by its name in any case: `*NSET` of CalculiX and Abaqus, components of ANSYS. Nastran's decks name no sets.
    ///
    /// ```
    /// # let place = tempfile::tempdir()?;
    /// let path = place.path().join("set.inp");
    /// std::fs::write(&path, "*NODE\n7,1.,2.,3.\n*NSET,NSET=Top\n7\n")?;
    /// let deck = qless_io::deck::read(&path)?;
    /// assert_eq!((deck.node_set("top"), deck.node_set_names()), (Some(vec![7]), vec!["TOP".to_owned()]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn node_set(&self, name: &str) -> Option<Vec<u32>> {
        match self.format() {
            Format::Calculix => calculix::node_set(self, name),
            Format::Ansys => ansys::node_sets(self).remove(&name.to_ascii_uppercase()),
            Format::Nastran => None,
        }
    }

    /// The names of all node sets.
    pub fn node_set_names(&self) -> Vec<String> {
        match self.format() {
            Format::Calculix => calculix::node_set_names(self),
            Format::Ansys => ansys::node_sets(self).into_keys().collect(),
            Format::Nastran => Vec::new(),
        }
    }

    /// Goes through the deck's text once more.
    fn again<T>(&self, read: impl FnOnce(&mut Sources) -> T) -> T {
        let mut none = |_: &Path| Err(std::io::ErrorKind::NotFound.into());
        read(&mut Sources::again(self.solver, &self.model.files, &self.texts, &mut none))
    }
}

/// Reads a deck from its bytes as this solver does, or as that of a format; `open` gives those of the files that it includes.
///
/// # Errors
/// [`DeckError`].
pub fn parse(solver: impl Into<Solver>, path: &Path, bytes: Vec<u8>, open: Open) -> Result<Deck, DeckError> {
    let solver = solver.into();
    let mut sources = Sources::new(solver, path, bytes, open);
    let model = match solver.format() {
        Format::Calculix => calculix::read(&mut sources)?,
        Format::Ansys => ansys::read(&mut sources)?,
        Format::Nastran => nastran::read(&mut sources)?,
    };
    Ok(Deck { solver: sources.solver(), model, texts: sources.into_texts() })
}
