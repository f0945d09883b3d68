//! `--case`: the load cases to analyse.

use qless_io::deck::{LoadCase, Model};

/// Largest number of load cases that a message names.
const NAMED: usize = 20;

/// The load cases to analyse.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LoadCaseChoice {
    /// All load cases.
    All,
    /// Any single load case; an error if load cases constrain differently.
    Any,
    /// The load case with this name or number.
    Named(String),
}

/// `--case` does not determine a load case.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChoiceError {
    #[error("its {count} load cases constrain differently: name one with --case ({list})")]
    Differ { count: usize, list: String },
    #[error("--case {name}: there is no such load case; there are {list}")]
    Unknown { name: String, list: String },
    #[error("--case {name}: several load cases match ({list}); give the whole name of one")]
    Several { name: String, list: String },
}

impl LoadCaseChoice {
    /// The load cases that the option `--case` names with `text`. Without the option, and for `all`, these are `default`.
    pub fn new(text: Option<&str>, default: Self) -> Self {
        match text {
            None => default,
            Some(text) if text.trim().eq_ignore_ascii_case("all") => default,
            Some(text) => Self::Named(text.trim().to_owned()),
        }
    }

    /// Indices of the load cases in the model.
    pub fn select(&self, model: &Model) -> Result<Vec<usize>, ChoiceError> {
        let cases = model.cases();
        match self {
            Self::All => Ok((0..cases.len()).collect()),
            Self::Any if cases.iter().all(|case| case.constrains_as(&cases[0])) => Ok(vec![0]),
            Self::Any => Err(ChoiceError::Differ { count: cases.len(), list: names(cases.iter()) }),
            Self::Named(name) => find(cases, name).map(|index| vec![index]),
        }
    }
}

/// The first names of load cases, and the number of the others.
fn names<'a>(cases: impl ExactSizeIterator<Item = &'a LoadCase>) -> String {
    let more = cases.len().saturating_sub(NAMED);
    let list = cases.take(NAMED).map(|case| case.name.as_str()).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{list} and {more} more") } else { list }
}

/// Finds a load case by its whole name, or else by the number at the end of its name.
fn find(cases: &[LoadCase], name: &str) -> Result<usize, ChoiceError> {
    let whole = |case: &LoadCase| case.name.eq_ignore_ascii_case(name);
    let number = |case: &LoadCase| case.name.rsplit(' ').next() == Some(name);
    for matches in [&whole as &dyn Fn(&LoadCase) -> bool, &number] {
        let found: Vec<usize> = (0..cases.len()).filter(|&k| matches(&cases[k])).collect();
        match found[..] {
            [] => {}
            [one] => return Ok(one),
            _ => {
                let list = names(found.iter().map(|&k| &cases[k]));
                return Err(ChoiceError::Several { name: name.to_owned(), list });
            }
        }
    }
    Err(ChoiceError::Unknown { name: name.to_owned(), list: names(cases.iter()) })
}
