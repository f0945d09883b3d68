//! `--case`: which load cases are looked at.

use std::fmt;

use qless_io::deck::{LoadCase, Model};

/// Load cases named in a message at most.
const NAMED: usize = 20;

/// The load cases that the user chooses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LoadCaseChoice {
    /// Each load case.
    All,
    /// One, which the user has to name where load cases differ.
    Any,
    /// The one of this name or number.
    Named(String),
}

/// A load case that cannot be told.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChoiceError {
    #[error("its {} load cases constrain differently: name one with --case ({list})", list.0.len())]
    Differ { list: LoadCaseNames },
    #[error("--case {name}: there is no such load case; there are {list}")]
    Unknown { name: String, list: LoadCaseNames },
    #[error("--case {name}: that is several load cases ({list}); give the whole name of one")]
    Several { name: String, list: LoadCaseNames },
}

/// Names of load cases.
#[derive(Debug, PartialEq, Eq)]
pub struct LoadCaseNames(Vec<String>);

impl fmt::Display for LoadCaseNames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0[..self.0.len().min(NAMED)].join(", "))?;
        if self.0.len() > NAMED { write!(f, " and {} more", self.0.len() - NAMED) } else { Ok(()) }
    }
}

impl LoadCaseChoice {
    /// The choice of `--case`, or `standard` without that option.
    pub fn new(text: Option<&str>, standard: Self) -> Self {
        match text {
            None => standard,
            Some(text) if text.trim().eq_ignore_ascii_case("all") => {
                if standard == Self::Any {
                    Self::Any
                } else {
                    Self::All
                }
            }
            Some(text) => Self::Named(text.trim().to_owned()),
        }
    }

    /// The load cases, by their number in the model from 0.
    pub fn of(&self, model: &Model) -> Result<Vec<usize>, ChoiceError> {
        let cases = model.cases();
        match self {
            Self::All => Ok((0..cases.len()).collect()),
            Self::Any if cases.iter().all(|case| case.constrains_as(&cases[0])) => Ok(vec![0]),
            Self::Any => Err(ChoiceError::Differ { list: names(cases.iter()) }),
            Self::Named(name) => named(cases, name).map(|number| vec![number]),
        }
    }
}

fn names<'a>(cases: impl Iterator<Item = &'a LoadCase>) -> LoadCaseNames {
    LoadCaseNames(cases.map(|case| case.name.clone()).collect())
}

/// By its whole name, or else by the number that its name ends in.
fn named(cases: &[LoadCase], name: &str) -> Result<usize, ChoiceError> {
    let whole = |case: &LoadCase| case.name.eq_ignore_ascii_case(name);
    let number = |case: &LoadCase| case.name.rsplit(' ').next() == Some(name);
    for is_meant in [&whole as &dyn Fn(&LoadCase) -> bool, &number] {
        let meant: Vec<usize> = (0..cases.len()).filter(|&k| is_meant(&cases[k])).collect();
        match meant[..] {
            [] => {}
            [one] => return Ok(one),
            _ => {
                let list = names(meant.iter().map(|&k| &cases[k]));
                return Err(ChoiceError::Several { name: name.to_owned(), list });
            }
        }
    }
    Err(ChoiceError::Unknown { name: name.to_owned(), list: names(cases.iter()) })
}
