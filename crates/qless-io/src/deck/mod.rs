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
mod card_fault;
mod cards;
mod chunks;
pub mod clean;
mod columns;
mod detect;
mod error;
mod kinematics;
mod model;
mod name;
mod nastran;
mod node_names;
mod solver;
mod source;
mod system;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

pub use card_fault::CardFault;
pub use cards::{Card, Cards};
pub use detect::Seen;
pub(crate) use detect::format_of;
pub use error::{DeckError, Problem};
pub use model::{Dof, Equation, Load, LoadCase, Model, Origin, Prescribed, Warning};
pub use name::CardName;
pub use solver::{Outcome, Solver, UnknownSolver};
pub use source::Open;
pub(crate) use source::Sources;

use crate::{Opened, ReadError};

/// The language of a deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// CalculiX and Abaqus, `.inp`.
    Calculix,
    /// ANSYS archives, `.cdb`.
    Ansys,
    /// Nastran, `.bdf`, `.dat`, `.nas`.
    Nastran,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Calculix, Self::Ansys, Self::Nastran];

    /// The format that a path's ending stands for, before `.gz` if it ends in that.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "inp" => Some(Self::Calculix),
            "cdb" => Some(Self::Ansys),
            "bdf" | "dat" | "nas" | "fem" => Some(Self::Nastran),
            "gz" => Self::of(Path::new(path.file_stem()?)),
            _ => None,
        }
    }
}

impl std::fmt::Display for Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Calculix => "CalculiX or Abaqus",
            Self::Ansys => "ANSYS",
            Self::Nastran => "Nastran",
        })
    }
}

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

/// Reads a deck and the files that it includes, as the solver of its format does.
///
/// # Errors
/// As [`read_for`].
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("tie.inp");
/// std::fs::write(&path, "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*EQUATION\n2\n1,1,1.,2,1,-1.\n")?;
/// let deck = qless_io::deck::read(&path)?;
/// assert_eq!(deck.model().label(0).as_deref(), Some("line 5 *EQUATION 1:1"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(path: &Path) -> Result<Deck, ReadError> {
    read_for(path, None)
}

/// Reads a deck and the files that it includes, as this solver does; that of its format where none is given.
///
/// # Errors
/// [`ReadError`]: a file that cannot be read, content that is no deck's, a solver that does not read it, or a [`DeckError`] with file,
/// line, card and field.
///
/// ```
/// use qless_io::deck::{Solver, read_for};
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("tie.inp");
/// std::fs::write(&path, "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*EQUATION\n2\n1,1,1.,2,1,-1.\n")?;
/// assert_eq!(read_for(&path, Some(Solver::Abaqus))?.solver(), Solver::Abaqus);
/// let error = read_for(&path, Some(Solver::Nastran)).unwrap_err().to_string();
/// assert!(error.ends_with("nastran does not read it: it is a deck of CalculiX or Abaqus; leave --solver out, or name ccx or abaqus"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_for(path: &Path, solver: Option<Solver>) -> Result<Deck, ReadError> {
    Opened::read(path, solver)?.into_deck(solver)
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
