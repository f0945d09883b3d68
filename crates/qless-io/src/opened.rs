//! A file whose content says what it is: a matrix, or a deck of one of the formats.

use std::path::{Path, PathBuf};

use qless::ConstraintSystem;

use crate::case::CaseFiles;
use crate::deck::{self, Deck, Format, Solver, format_of};
use crate::matrix_market::header;
use crate::{ReadError, bytes};

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// A matrix, in Matrix Market format.
    Matrix,
    /// A finite-element deck.
    Deck(Format),
}

/// A file that was read, but not yet parsed.
///
/// ```
/// use qless_io::{Content, Opened};
/// use qless_io::deck::Format;
/// # let place = tempfile::tempdir()?;
/// // The ending says something else.
/// let path = place.path().join("links.inp");
/// std::fs::write(&path, "GRID,1,,0.,0.,0.\nGRID,2,,0.,0.,0.\nMPC,1,1,1,1.,2,1,-1.\n")?;
/// let opened = Opened::read(&path, None)?;
/// assert_eq!(opened.content(), Content::Deck(Format::Nastran));
/// assert_eq!(opened.into_deck(None)?.format(), Format::Nastran);
///
/// std::fs::write(&path, "<html>")?;
/// let error = Opened::read(&path, None).unwrap_err().to_string();
/// assert!(error.contains("cannot tell what this is: it starts as a page of the web; decks of CalculiX"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Opened {
    path: PathBuf,
    text: Vec<u8>,
    content: Content,
}

impl Opened {
    /// Reads a file, or standard input for a path of `-`, unpacked and decoded where needed. A solver that is asked for decides
    /// where the first cards do not, and without one the ending.
    ///
    /// # Errors
    /// [`ReadError::Io`], or [`ReadError::Unknown`] where no reader knows the content.
    pub fn read(path: &Path, solver: Option<Solver>) -> Result<Self, ReadError> {
        let text = bytes::read(path).map_err(ReadError::io(path))?;
        let expected = solver.map(Solver::format).or_else(|| Format::of(path));
        let content = match format_of(&text, expected) {
            _ if header::is_present(&text) => Content::Matrix,
            Ok(format) => Content::Deck(format),
            // What is wrong with it, the reader of matrices says best.
            Err(_) if is_matrix(path) => Content::Matrix,
            Err(seen) => return Err(ReadError::Unknown { path: path.to_path_buf(), seen }),
        };
        Ok(Self { path: path.to_path_buf(), text, content })
    }

    /// What it holds.
    pub fn content(&self) -> Content {
        self.content
    }

    /// Parses a deck, as this solver reads it, or that of its format.
    ///
    /// # Errors
    /// [`ReadError`]: a matrix, a solver that does not read the deck's format, or a fault in the deck.
    pub fn into_deck(self, solver: Option<Solver>) -> Result<Deck, ReadError> {
        let Self { path, text, content } = self;
        let Content::Deck(format) = content else {
            return Err(ReadError::OtherContent { path, problem: "it is a matrix; name a deck" });
        };
        let solver = solver.unwrap_or(format.into());
        if solver.format() != format {
            return Err(ReadError::Solver { path, solver, format });
        }
        Ok(deck::parse(solver, &path, text, &mut |file: &Path| bytes::read(file))?)
    }

    /// Parses a matrix, with a right-hand side and prescribed DOFs from other files, as [`read_case`](crate::read_case) does.
    ///
    /// # Errors
    /// [`ReadError`]: a deck, or a malformed file.
    pub fn into_case(self, rhs: Option<&Path>, prescribed: Option<&Path>) -> Result<ConstraintSystem, ReadError> {
        let Self { path, text, content } = self;
        match content {
            Content::Matrix => CaseFiles::lone(&path).with(rhs, prescribed).read_from(text),
            Content::Deck(_) => Err(ReadError::OtherContent { path, problem: "it is a deck; name a matrix" }),
        }
    }
}

/// Whether the ending is that of a matrix.
fn is_matrix(path: &Path) -> bool {
    let ends = |path: &Path, ending: &str| path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending));
    ends(path, "mtx") || ends(path, "gz") && path.file_stem().is_some_and(|stem| ends(Path::new(stem), "mtx"))
}
