//! Decks, Matrix Market files and case folders.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use qless::ConstraintSystem;
use qless_io::deck::{Deck, LoadCase, Solver, Warning};
use qless_io::{FileContent, Opened, ReadError, read_case};

use crate::errors::plain;
use crate::interrupt::run;
use crate::system::PySystem;

/// A system that was read, warnings, and constraints that were left out.
type Content = (ConstraintSystem, Vec<String>, Vec<String>);

/// What is wrong with a file.
enum Fault {
    Read(ReadError),
    Other(String),
}

impl From<ReadError> for Fault {
    fn from(error: ReadError) -> Self {
        Self::Read(error)
    }
}

/// Reads a file or folder. A deck is read for a solver and a load case. Without `solver`, the solver is recognised from the file. Without
/// `case`, the first load case is read; it is an error unless all load cases have the same constraints.
#[pyfunction]
#[pyo3(signature = (path, solver=None, case=None))]
pub fn read(
    py: Python<'_>,
    path: PathBuf,
    solver: Option<String>,
    case: Option<String>,
) -> PyResult<(PySystem, Vec<String>, Vec<String>)> {
    let failed = |fault| match fault {
        Fault::Read(error) => plain("ReadError", &error),
        Fault::Other(message) => plain("ReadError", &message),
    };
    // The size is unknown before the file is read, so assume a long call.
    let content = run(py, usize::MAX, move || content(&path, solver.as_deref(), case.as_deref()))?;
    let (system, warnings, left_out) = content.map_err(failed)?;
    Ok((PySystem(system), warnings, left_out))
}

fn content(path: &Path, solver: Option<&str>, case: Option<&str>) -> Result<Content, Fault> {
    let other = |message: String| Fault::Other(format!("{}: {message}", path.display()));
    let solver = solver.map(|name| name.parse::<Solver>().map_err(|error| other(error.to_string()))).transpose()?;
    if path.is_dir() {
        return Ok((read_case(path, None, None)?, Vec::new(), Vec::new()));
    }
    let opened = Opened::read(path, solver)?;
    if matches!(opened.content(), FileContent::Matrix | FileContent::Relations) {
        return Ok((opened.into_case(None, None)?, Vec::new(), Vec::new()));
    }
    let deck = opened.into_deck(solver)?;
    let case = load_case(deck.model().cases(), case).map_err(other)?;
    let system = deck.model().system(case).map_err(|error| other(error.to_string()))?;
    let (left_out, warnings): (Vec<_>, Vec<_>) = deck.model().warnings().iter().partition(|warning| warning.leaves_out);
    let place = |warnings: Vec<&Warning>| warnings.into_iter().map(|one| said(&deck, one)).collect::<Vec<_>>();
    let mut warnings = place(warnings);
    if deck.model().histories_of(case).len() > 1 {
        warnings
            .push("prescribed values have several time histories; only their values at the end were read".to_owned());
    }
    Ok((system, warnings, place(left_out)))
}

fn said(deck: &Deck, warning: &Warning) -> String {
    format!("{}: {}", deck.model().place_of(warning), warning.text)
}

/// The load case with this name. Without a name, the first load case; it is an error unless all load cases have the same constraints.
fn load_case<'a>(cases: &'a [LoadCase], name: Option<&str>) -> Result<&'a LoadCase, String> {
    let names = || cases.iter().map(|case| case.name.as_str()).collect::<Vec<_>>().join(", ");
    let first = cases.first().ok_or("the deck has no load case")?;
    match name {
        None if cases.iter().all(|case| case.constrains_as(first)) => Ok(first),
        None => Err(format!("its load cases constrain differently; name one with `case`: {}", names())),
        Some(name) => {
            let found = cases.iter().find(|case| case.name.eq_ignore_ascii_case(name));
            found.ok_or_else(|| format!("there is no load case `{name}`; there are {}", names()))
        }
    }
}
