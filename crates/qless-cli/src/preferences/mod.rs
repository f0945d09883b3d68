//! Lists of equations and DOFs for `--keep`, `--avoid-slaves` and `--prefer-slaves`.
//!
//! | word | equations | DOFs |
//! | --- | --- | --- |
//! | `7`, `10-20` | rows from 1 | columns from 1 |
//! | a label | with this label | with this label |
//! | `line 41`, `part.inc:41` | on this line | of the equations, prescribed values and loads on this line |
//! | `5:3`, `5:UZ` | that begin with this DOF | component 3 of node 5 |
//! | `RBE2 13`, `*TIE` | of the cards with this name | of these equations |
//! | a node set | that begin with a DOF of its nodes | of its nodes, if they occur in equations |

mod resolve;
mod word;

use qless::{ConstraintSystem, Options, Preferences};
use qless_io::deck::{Deck, LoadCase};

use crate::failure::CliFailure;
use resolve::{NameIndex, Wanted, WordError};
pub use word::ListWord;
pub use word::{WordList, words};

/// The lists of the command line, not yet resolved to rows and columns.
#[derive(Clone, Copy, Default)]
pub struct PreferenceLists<'a> {
    pub keep: Option<&'a WordList>,
    pub prefer_slaves: Option<&'a WordList>,
    pub avoid_slaves: Option<&'a WordList>,
}

/// An equation or a DOF, 0-based.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Place {
    Equation(usize),
    Dof(usize),
}

/// What a text such as `row 17`, `column 3`, `5:3`, `line 41` or a label names: equations, or else DOFs.
pub fn find(text: &str, system: &ConstraintSystem, deck: Option<(&Deck, &LoadCase)>) -> Result<Vec<Place>, CliFailure> {
    let numbered = |word: &str, count: usize| {
        let start = text.get(..word.len()).filter(|start| start.eq_ignore_ascii_case(word))?;
        // The report names equations `row 14 "tie B/C, y"`.
        let number = text[start.len()..].split('"').next().unwrap_or_default();
        let number: usize = number.trim().parse().ok()?;
        Some(if (1..=count).contains(&number) {
            Ok(number - 1)
        } else {
            Err(CliFailure::Input(format!("{text}: there are {count}, from 1 to {count}")))
        })
    };
    if let Some(row) = numbered("row ", system.equations()) {
        return Ok(vec![Place::Equation(row?)]);
    }
    for word in ["column ", "DOF "] {
        if let Some(dof) = numbered(word, system.dofs()) {
            return Ok(vec![Place::Dof(dof?)]);
        }
    }
    if text.trim().parse::<usize>().is_ok() {
        let node = if deck.is_some() { format!(", `{text}:1` for the first DOF of a node") } else { String::new() };
        return Err(CliFailure::Input(format!(
            "{text}: say `row {text}` for an equation, `column {text}` for a DOF{node}"
        )));
    }
    let names = NameIndex::new(system, deck);
    let words = WordList(vec![ListWord::Name(text.trim().to_owned())]);
    // `5:3` means a DOF. `line 41` means the equations on this line; if there are none, the prescribed values and loads on it.
    let is_dof = text.split_once(':').is_some_and(|(node, _)| node.trim().parse::<u32>().is_ok());
    let equations = if is_dof { Ok(Vec::new()) } else { names.all("WHAT", &words, Wanted::Equations) };
    if let Some(rows) = equations.as_ref().ok().filter(|rows| !rows.is_empty()) {
        return Ok(rows.iter().copied().map(Place::Equation).collect());
    }
    match (equations, names.all("WHAT", &words, Wanted::Dofs)) {
        (_, Ok(mut dofs)) if !dofs.is_empty() => {
            dofs.sort_unstable();
            dofs.dedup();
            Ok(dofs.into_iter().map(Place::Dof).collect())
        }
        (Err(error @ WordError::Unknown { .. }), _) | (_, Err(error @ WordError::Line { .. })) => {
            Err(CliFailure::Input(error.to_string()))
        }
        _ if is_dof && resolve::dof(text).is_none() => {
            Err(CliFailure::Input(format!("{text}: write the component as a number, or as UX to UZ and ROTX to ROTZ")))
        }
        _ if is_dof => Err(CliFailure::Input(format!("{text}: no equation has this DOF"))),
        _ => Err(CliFailure::Input(format!("{text}: no equation of this load case belongs to it"))),
    }
}

impl PreferenceLists<'_> {
    /// Whether nothing is preferred.
    pub fn is_empty(&self) -> bool {
        self.keep.is_none() && self.prefer_slaves.is_none() && self.avoid_slaves.is_none()
    }

    /// The options with the lists resolved in this system, which may belong to a load case of a deck.
    pub fn resolve(
        &self,
        options: &Options,
        system: &ConstraintSystem,
        deck: Option<(&Deck, &LoadCase)>,
    ) -> Result<Options, CliFailure> {
        if self.is_empty() {
            return Ok(options.clone());
        }
        let names = NameIndex::new(system, deck);
        let list = |option, words: Option<&WordList>, wanted| match words {
            None => Ok(Vec::new()),
            Some(words) => names.all(option, words, wanted).map_err(|error| CliFailure::Input(error.to_string())),
        };
        let preferences = Preferences {
            equations: list("--keep", self.keep, Wanted::Equations)?,
            slaves: list("--prefer-slaves", self.prefer_slaves, Wanted::Dofs)?,
            masters: list("--avoid-slaves", self.avoid_slaves, Wanted::Dofs)?,
        };
        Ok(Options { preferences, ..options.clone() })
    }
}
