//! Reads files, and detects from their content whether they hold a matrix, relations or a deck.

use std::path::{Path, PathBuf};

use qless::ConstraintSystem;

use crate::case::CaseFiles;
use crate::deck::{self, Deck, Format, Solver, format_of};
use crate::error::read_file;
use crate::matrix_market::header;
use crate::{ReadError, bytes, relations};

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileContent {
    /// A matrix, in Matrix Market format.
    Matrix,
    /// Relations between named DOFs.
    Relations,
    /// A finite-element deck.
    Deck(Format),
}

/// A file that was read but not yet parsed.
///
/// ```
/// use qless_io::{FileContent, Opened};
/// use qless_io::deck::Format;
/// # let place = tempfile::tempdir()?;
/// // The content decides, not the ending.
/// let path = place.path().join("links.inp");
/// std::fs::write(&path, "GRID,1,,0.,0.,0.\nGRID,2,,0.,0.,0.\nMPC,1,1,1,1.,2,1,-1.\n")?;
/// let opened = Opened::read(&path, None)?;
/// assert_eq!(opened.content(), FileContent::Deck(Format::Nastran));
/// assert_eq!(opened.into_deck(None)?.format(), Format::Nastran);
///
/// std::fs::write(&path, "<html>")?;
/// let error = Opened::read(&path, None).unwrap_err().to_string();
/// assert!(error.contains("cannot tell what this is: it starts as an HTML page; decks of CalculiX"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Opened {
    path: PathBuf,
    text: Vec<u8>,
    content: FileContent,
}

impl Opened {
    /// Reads a file (or standard input, for the path `-`), unpacked and decoded if needed. The first cards of a deck decide its format. If
    /// they do not, the format is that of the requested solver, or else that of the file's ending.
    ///
    /// # Errors
    /// [`ReadError::Io`], or [`ReadError::Unknown`] if no reader recognises the content.
    pub fn read(path: &Path, solver: Option<Solver>) -> Result<Self, ReadError> {
        let text = read_file(path)?;
        let ending = bytes::without_gz(path).unwrap_or(path).extension();
        let expected = solver.map(Solver::format).or_else(|| Format::from_path(path));
        let content = match format_of(&text, expected) {
            _ if header::is_present(&text) => FileContent::Matrix,
            _ if relations::is_relations(path, &text) => FileContent::Relations,
            Ok(format) => FileContent::Deck(format),
            // No reader recognises the text, but its path ends like that of a matrix. The reader of matrices then gives the best error.
            Err(_) if ending.is_some_and(|ending| ending.eq_ignore_ascii_case("mtx")) => FileContent::Matrix,
            Err(seen) => return Err(ReadError::Unknown { path: path.to_path_buf(), seen }),
        };
        Ok(Self { path: path.to_path_buf(), text, content })
    }

    /// What the file holds.
    pub fn content(&self) -> FileContent {
        self.content
    }

    /// Parses a deck for a solver; without one, for the default solver of the deck's format.
    ///
    /// # Errors
    /// [`ReadError`] if the file is no deck, if the solver does not read its format, or if the deck has an error.
    pub fn into_deck(self, solver: Option<Solver>) -> Result<Deck, ReadError> {
        let Self { path, text, content } = self;
        let FileContent::Deck(format) = content else {
            return Err(ReadError::OtherContent {
                path,
                problem: "it is a matrix or a list of relations; name a deck",
            });
        };
        let asked = solver;
        let solver = solver.unwrap_or(format.into());
        if solver.format() != format {
            return Err(ReadError::Solver { path, solver, format });
        }
        let mut deck = deck::parse(solver, &path, text, &mut |file: &Path| bytes::read(file))?;
        asked.into_iter().for_each(|asked| deck.warn_of_other_solver(asked));
        Ok(deck)
    }

    /// Parses a matrix or relations. A matrix takes its right-hand side and prescribed DOFs from other files, as [`read_case`] does;
    /// relations contain their own.
    ///
    /// # Errors
    /// [`ReadError`] if the file is a deck, if a file is malformed, or if `rhs` or `prescribed` is given for relations.
    pub fn into_case(self, rhs: Option<&Path>, prescribed: Option<&Path>) -> Result<ConstraintSystem, ReadError> {
        let Self { path, text, content } = self;
        match content {
            FileContent::Matrix => CaseFiles::lone(&path).with(rhs, prescribed).read_from(text),
            FileContent::Relations if rhs.is_some() || prescribed.is_some() => Err(ReadError::OtherContent {
                path,
                problem: "relations have their own values; leave out --rhs and --prescribed",
            }),
            FileContent::Relations => relations::parse(&path, &text),
            FileContent::Deck(_) => Err(ReadError::OtherContent { path, problem: "it is a deck; name a matrix" }),
        }
    }
}

/// Reads a case: a Matrix Market file, a file of [`relations`], or a folder with `C.mtx` and optional files. The path `-` is standard
/// input. Text may be packed by gzip, or be UTF-16 with a byte order mark.
///
/// `rhs` and `prescribed` name additional files for a `.mtx` file. For a folder, they replace the folder's own files. Without a right-hand
/// side, b is zero. An empty label becomes `row 5` or `DOF 5`.
///
/// # Errors
/// [`ReadError`] if the path is not a case, or if one of its files is malformed.
///
/// ```
/// use qless_io::read_case;
/// # let place = tempfile::tempdir()?;
/// let matrix = place.path().join("C.mtx");
/// std::fs::write(&matrix, "%%MatrixMarket matrix coordinate real general\n1 2 2\n1 1 1\n1 2 -1\n")?;
/// let rhs = place.path().join("gap.txt");
/// std::fs::write(&rhs, "0.25\n")?;
/// let system = read_case(&matrix, Some(&rhs), None)?;
/// assert_eq!((system.equations(), system.dofs(), system.rhs()), (1, 2, &[0.25][..]));
///
/// let folder = read_case(place.path(), None, None)?;
/// assert_eq!(folder.rhs(), [0.0]);
///
/// std::fs::write(&rhs, "inf\n")?;
/// let error = read_case(&matrix, Some(&rhs), None).unwrap_err().to_string();
/// assert!(error.contains("gap.txt:1: the right-hand side of row 1 is `inf`: every number must be finite"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_case(path: &Path, rhs: Option<&Path>, prescribed: Option<&Path>) -> Result<ConstraintSystem, ReadError> {
    if !path.is_dir() {
        return Opened::read(path, None)?.into_case(rhs, prescribed);
    }
    let files = CaseFiles::in_folder(path)?.with(rhs, prescribed);
    let matrix = read_file(&files.matrix)?;
    files.read_from(matrix)
}

/// Reads a deck and the files that it includes, for the default solver of its format.
///
/// # Errors
/// As [`read_deck_for`].
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("tie.inp");
/// std::fs::write(&path, "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*EQUATION\n2\n1,1,1.,2,1,-1.\n")?;
/// let deck = qless_io::deck::read(&path)?;
/// assert_eq!(deck.model().label(0).as_deref(), Some("line 5 *EQUATION 1:1"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_deck(path: &Path) -> Result<Deck, ReadError> {
    read_deck_for(path, None)
}

/// Reads a deck and the files that it includes, for a solver; without one, for the default solver of the deck's format.
///
/// # Errors
/// [`ReadError`] if a file cannot be read or is no deck, or if the solver does not read its format. An error in the deck is a
/// [`DeckError`](crate::deck::DeckError) with file, line, card and field.
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
pub fn read_deck_for(path: &Path, solver: Option<Solver>) -> Result<Deck, ReadError> {
    Opened::read(path, solver)?.into_deck(solver)
}
