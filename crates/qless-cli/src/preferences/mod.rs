//! Lists of equations and DOFs for `--keep`, `--avoid-slaves` and `--prefer-slaves`.
//!
//! | word | equations | DOFs |
//! | --- | --- | --- |
//! | `7`, `10-20` | rows from 1 | columns from 1 |
//! | a label | with this label | with this label |
//! | `line 41`, `part.inc:41` | on this line | of the equations, prescribed values and loads on this line |
//! | `5:3` | that begin with this DOF | component 3 of node 5 |
//! | a node set | that begin with a DOF of its nodes | of its nodes, if they occur in equations |

mod resolve;
mod word;

use qless::{ConstraintSystem, Options, Preferences};
use qless_io::deck::{Deck, LoadCase};

use crate::failure::CliFailure;
use resolve::{NameIndex, Wanted};
#[cfg_attr(not(feature = "mpi"), expect(unused_imports, reason = "ranks take numbers only"))]
pub use word::ListWord;
pub use word::{WordList, words};

/// The lists of the command line, not yet resolved to rows and columns.
#[derive(Clone, Copy, Default)]
pub struct PreferenceLists<'a> {
    pub keep: Option<&'a WordList>,
    pub prefer_slaves: Option<&'a WordList>,
    pub avoid_slaves: Option<&'a WordList>,
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
