//! Finite-element decks: reads their constraints as equations `C u = b`, and writes decks with an independent set of
//! equations.
//!
//! | module, lowest layer first | content |
//! | --- | --- |
//! | `format`, `error`, `limits` | formats and solvers; errors in decks; limits on time and memory |
//! | `expression` | values of expressions of parameters |
//! | `source`, `detect` | a deck and its included files; detection of the format |
//! | `cards`, `model` | constraints of a deck of any format |
//! | `kinematics` | equations of rigid bodies and weighted means |
//! | `faults`, `solver` | faults of equations; the reactions of solvers |
//! | `plan` | changes that make the equations independent |
//! | `calculix`, `nastran`, `ansys` | readers and writers of `.inp`; `.bdf`, `.dat`, `.nas`, `.fem`; `.cdb` |
//! | `keyword` | what the following two share |
//! | `lsdyna`, `radioss` | readers of `.k`, `.key`, `.dyn`; `.rad` |
//! | [`clean`] | writes a cleaned deck, and proves that it constrains the same |
//!
//! The first cards of a deck decide its format. If they do not decide, the requested solver does, or else the ending of the file name. Text
//! may be packed by gzip, or be UTF-16 with a byte order mark. Lines may end in LF, CRLF or CR. The path `-` is standard input.
//!
//! A reader turns a deck and its included files into a [`Model`], which knows the card and the line of every equation.
//! [`Model::system`] gives `C u = b` for a load case. [`clean`] plans the changes after which a solver accepts the
//! deck.

mod ansys;
mod calculix;
mod card_fault;
mod cards;
pub mod clean;
mod detect;
mod error;
mod expression;
mod faults;
mod format;
mod keyword;
mod kinematics;
mod limits;
mod lsdyna;
mod model;
mod nastran;
mod paged_list;
mod plan;
mod radioss;
mod solver;
mod source;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

pub use card_fault::CardFault;
pub use cards::{Card, CardName, Cards};
pub use detect::UnrecognizedText;
pub(crate) use detect::format_of;
pub use error::{DeckError, Problem};
pub use format::{Format, Solver, UnknownSolver};
pub use model::{DeckEquation, Dof, Load, LoadCase, Model, Origin, Prescribed, Warning};
pub use solver::Outcome;
pub use source::Open;
use source::SolverReason;
pub(crate) use source::Sources;

pub use crate::opened::{read_deck as read, read_deck_for as read_for};

/// A deck: its constraints, and the text of its files.
#[derive(Debug)]
pub struct Deck {
    solver: Solver,
    model: Model,
    texts: Vec<Arc<Vec<u8>>>,
    other_solver: Option<SolverReason>,
}

impl Deck {
    /// Warns if another solver than `asked` reads the deck.
    pub(crate) fn warn_of_other_solver(&mut self, asked: Solver) {
        if let Some((file, line, why)) = self.other_solver.take() {
            let text = format!("{why}: the deck is read as one of {}, although {asked} is asked for", self.solver);
            self.model.warn(file, line, text);
        }
    }

    /// The format of the deck.
    pub fn format(&self) -> Format {
        self.solver.format()
    }

    /// The solver for which the deck was read.
    pub fn solver(&self) -> Solver {
        self.solver
    }

    /// The constraints of the deck.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The bytes of each file in [`Model::files`].
    pub fn texts(&self) -> &[Arc<Vec<u8>>] {
        &self.texts
    }

    /// The position of each node, by its number, in the model's axes. Nodes that commands generate are left out, and so are ANSYS nodes in
    /// coordinate systems that the reader does not follow.
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
            Format::LsDyna => lsdyna::positions(self),
            Format::Radioss => radioss::positions(self),
        }
    }

    /// The nodes of the set with this name, in capitals or not: `*NSET` in CalculiX and Abaqus, components in ANSYS, the number of
    /// `*SET_NODE` in LS-DYNA, the number of `/GRNOD` in Radioss. Nastran decks have no named sets.
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
            Format::LsDyna => lsdyna::node_set(self, name),
            Format::Radioss => radioss::node_set(self, name),
            Format::Nastran => None,
        }
    }

    /// Names of all node sets.
    pub fn node_set_names(&self) -> Vec<String> {
        match self.format() {
            Format::Calculix => calculix::node_set_names(self),
            Format::Ansys => ansys::node_sets(self).into_keys().collect(),
            Format::LsDyna => lsdyna::node_set_names(self),
            Format::Radioss => radioss::node_set_names(self),
            Format::Nastran => Vec::new(),
        }
    }

    /// Reads the deck again from its text in memory.
    fn again<T>(&self, read: impl FnOnce(&mut Sources) -> T) -> T {
        let mut none = |_: &Path| Err(std::io::ErrorKind::NotFound.into());
        read(&mut Sources::again(self.solver, &self.model.files, &self.texts, &mut none))
    }
}

/// Parses a deck for a solver, or, if a format is given, for the default solver of the format. `open` reads included files.
///
/// # Errors
/// [`DeckError`].
pub fn parse(solver: impl Into<Solver>, path: &Path, bytes: Vec<u8>, open: Open) -> Result<Deck, DeckError> {
    let solver = solver.into();
    let mut sources = Sources::new(solver, path, bytes, open);
    let model = read_model(&mut sources, &[])?;
    let other_solver = sources.other_solver();
    Ok(Deck { solver: sources.solver(), model, other_solver, texts: sources.into_texts() })
}

/// Reads the model of a deck. A model of an ANSYS deck also has the DOFs `others`, even if no equation names them.
fn read_model(sources: &mut Sources, others: &[Dof]) -> Result<Model, DeckError> {
    match sources.solver().format() {
        Format::Calculix => calculix::read(sources),
        Format::Ansys => ansys::read(sources, others),
        Format::Nastran => nastran::read(sources),
        Format::LsDyna => lsdyna::read(sources),
        Format::Radioss => radioss::read(sources),
    }
}
