//! Checks that all ranks have the same options.

use std::fmt::{self, Debug};
use std::hash::{DefaultHasher, Hasher};

use qless::{Noise, Options};

use super::Error;
use crate::ranks::Ranks;

/// A setting of [`Options`] that decides the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OptionName {
    /// [`Options::backend`].
    Backend,
    /// [`Options::tolerance`].
    Tolerance,
    /// [`Options::noise`].
    Noise,
    /// [`Options::presolve`].
    Presolve,
    /// [`Options::effort`].
    Effort,
    /// [`Options::growth`].
    Growth,
    /// [`Options::preferences`].
    Preferences,
}

impl OptionName {
    pub(super) const ALL: [Self; 7] =
        [Self::Backend, Self::Tolerance, Self::Noise, Self::Presolve, Self::Effort, Self::Growth, Self::Preferences];
}

impl fmt::Display for OptionName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Backend => "backend",
            Self::Tolerance => "tolerance",
            Self::Noise => "noise",
            Self::Presolve => "presolve",
            Self::Effort => "effort",
            Self::Growth => "growth",
            Self::Preferences => "preferences",
        })
    }
}

/// Compares the options of all ranks. Collective; all ranks return the same.
///
/// `memory` is not compared: it does not affect results, and differs between machines. The floors of [`Noise::Floors`] are not compared
/// either.
pub(crate) fn agree_on_options(ranks: &dyn Ranks, options: &Options) -> Result<(), Error> {
    let all = ranks.gather(&words(options));
    let each: Vec<&[u64]> = all.chunks(OptionName::ALL.len()).collect();
    let differs = |&rank: &usize| each[rank] != each[0];
    let Some(rank) = (1..each.len()).find(differs) else { return Ok(()) };
    let setting = (0..OptionName::ALL.len()).find(|&k| each[rank][k] != each[0][k]).unwrap_or_default();
    Err(Error::Options { rank, setting: OptionName::ALL[setting] })
}

/// A hash of each setting, in the order of [`OptionName::ALL`].
fn words(options: &Options) -> [u64; OptionName::ALL.len()] {
    let noise = match &options.noise {
        Noise::Floors { .. } => word(&"floors"),
        noise => word(noise),
    };
    [
        word(&options.backend),
        word(&options.tolerance),
        noise,
        word(&options.presolve),
        word(&options.effort),
        word(&options.growth),
        word(&options.preferences),
    ]
}

/// Hash of the debug text of a setting, which shows all digits of a number. The hash is the same in every process.
fn word(setting: &dyn Debug) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(format!("{setting:?}").as_bytes());
    hasher.finish()
}
