//! The files of a deck: the main file and the files that it includes.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{DeckError, Problem, Solver};
use crate::bytes::is_too_much;
use crate::deck::limits::{INCLUDE_DEPTH, INCLUDES};

/// A function that returns the bytes of a file.
pub type Open<'a> = &'a mut dyn FnMut(&Path) -> io::Result<Vec<u8>>;

/// Why another solver than the given one reads the deck: file, line and a clause.
pub type SolverReason = (u32, u32, String);

/// The files that were read so far. A file is given by its number, from 0.
pub struct Sources<'a> {
    solver: Solver,
    paths: Vec<PathBuf>,
    texts: Vec<Arc<Vec<u8>>>,
    open: Open<'a>,
    includes: usize,
    other_solver: Option<SolverReason>,
}

impl<'a> Sources<'a> {
    /// The sources of a deck of which only the main file is read.
    pub fn new(solver: Solver, path: &Path, bytes: Vec<u8>, open: Open<'a>) -> Self {
        Self {
            solver,
            paths: vec![path.to_path_buf()],
            texts: vec![Arc::new(bytes)],
            open,
            includes: 0,
            other_solver: None,
        }
    }

    /// The sources of a deck whose files were all read before.
    pub(super) fn again(solver: Solver, paths: &[PathBuf], texts: &[Arc<Vec<u8>>], open: Open<'a>) -> Self {
        Self { solver, paths: paths.to_vec(), texts: texts.to_vec(), open, includes: 0, other_solver: None }
    }

    /// The solver for which the deck is read.
    pub fn solver(&self) -> Solver {
        self.solver
    }

    /// Changes the solver. A reader calls this if the text shows that only the new solver can read the deck.
    pub fn set_solver(&mut self, solver: Solver, reason: Option<SolverReason>) {
        if self.solver != solver {
            self.other_solver = reason;
        }
        self.solver = solver;
    }

    /// The reason with which a reader has changed the solver.
    pub fn other_solver(&mut self) -> Option<SolverReason> {
        self.other_solver.take()
    }

    /// The path of a file.
    pub fn path(&self, file: usize) -> &Path {
        &self.paths[file]
    }

    /// The bytes of a file, which are shared and not copied.
    pub fn text(&self, file: usize) -> Arc<Vec<u8>> {
        Arc::clone(&self.texts[file])
    }

    /// The paths of all files, the main file first.
    pub fn paths(&self) -> &[PathBuf] {
        &self.paths
    }

    /// Returns the number of an included file, which is read only the first time. The include stands in file `from` at `line`; `depth` is
    /// its nesting. A relative name is looked up beside the main file, then beside the including file.
    ///
    /// # Errors
    /// [`DeckError`] if the file cannot be read, or if there are too many includes.
    pub fn include(&mut self, name: &str, from: usize, line: usize, depth: usize) -> Result<usize, DeckError> {
        let fail =
            |problem| DeckError { path: self.paths[from].clone(), line, card: "include".into(), field: None, problem };
        if depth >= INCLUDE_DEPTH {
            let advice = "break the circle of includes";
            return Err(fail(Problem::Limit { what: "the depth of includes", limit: INCLUDE_DEPTH, advice }));
        }
        if self.includes >= INCLUDES {
            let advice = "join some of the files";
            return Err(fail(Problem::Limit { what: "the number of includes", limit: INCLUDES, advice }));
        }
        self.includes += 1;
        let beside = |file: usize| self.paths[file].parent().unwrap_or(Path::new("")).join(name);
        let candidates = [beside(0), beside(from)];
        let mut failed = None;
        for path in candidates {
            if let Some(file) = self.paths.iter().position(|known| *known == path) {
                return Ok(file);
            }
            match (self.open)(&path) {
                Ok(bytes) => {
                    self.paths.push(path);
                    self.texts.push(Arc::new(bytes));
                    return Ok(self.paths.len() - 1);
                }
                Err(error) if is_too_much(&error) => {
                    let reason = format!("{name} is not read to its end: {error}");
                    return Err(fail(Problem::IncludeTooLarge { reason }));
                }
                Err(error) => failed = failed.or(Some(error)),
            }
        }
        let reason = failed.map(|error| error.to_string()).unwrap_or_default();
        Err(fail(Problem::Include { file: name.to_owned(), reason }))
    }

    /// The bytes of all files.
    pub fn into_texts(self) -> Vec<Arc<Vec<u8>>> {
        self.texts
    }
}
