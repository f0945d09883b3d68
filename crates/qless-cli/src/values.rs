//! Parsers of option values.

use std::num::NonZeroUsize;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// A value with its name on the command line and its line of `--help`.
pub type NamedValue<T> = (&'static str, &'static str, T);

/// Accepts the names of these values only.
pub fn one_of<T: Copy + Send + Sync>(values: &'static [NamedValue<T>]) -> impl TypedValueParser<Value = T> {
    let names = values.iter().map(|(name, help, _)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(names).map(|given| {
        let (.., value) = values.iter().find(|(name, ..)| *name == given).expect("clap accepts these names only");
        *value
    })
}

pub fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "not a number; write it as 0.001 or 1e-3".to_owned())
}

/// A number that is neither NaN nor infinite.
pub fn finite(text: &str) -> Result<f64, String> {
    let number = number(text)?;
    if number.is_finite() { Ok(number) } else { Err("the number must be finite".to_owned()) }
}

pub fn threads(text: &str) -> Result<NonZeroUsize, String> {
    text.parse().map_err(|_| "expected a whole number of at least 1".to_owned())
}
