//! The errors of an analysis across ranks: all ranks return the same error.

mod option_names;
mod words;

use qless::OptionError;

use crate::ranks::{Message, Ranks};
use crate::share::ShareError;
pub use option_names::OptionName;
pub(crate) use option_names::agree_on_options;
pub(crate) use words::{text, text_of};

/// Why the ranks could not analyse their equations.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting is out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Two ranks have different options.
    #[error("rank {rank} has another {setting} in its options than rank 0; pass the same options on all ranks")]
    Options {
        /// The first rank that differs from rank 0.
        rank: usize,
        /// The first setting in which this rank differs from rank 0.
        setting: OptionName,
    },
    /// The share of a rank is not valid.
    #[error(transparent)]
    Share(#[from] ShareError),
    /// A component is too large for the memory that one rank may use.
    #[error(
        "a connected component has {equations} equations with {terms} terms; a rank needs about {bytes} bytes for it, and the limit is \
         {limit} (Options::memory): allow more, or analyse it on a larger machine"
    )]
    TooLarge {
        /// Number of equations of the component.
        equations: u64,
        /// Number of terms of these equations.
        terms: u64,
        /// Number of bytes that the analysis of the component needs.
        bytes: u64,
        /// Number of bytes that a rank may use.
        limit: u64,
    },
    /// The serial analysis of the equations assigned to a rank failed.
    #[error("rank {rank}: {message}")]
    Failed {
        /// The rank on which the analysis failed.
        rank: usize,
        /// The text of the error.
        message: String,
    },
    /// Equations contradict one another, so that no u satisfies all of them.
    #[error("{count} equations contradict others, among them equation {first}; correct them")]
    Conflicting {
        /// The number of conflicting equations.
        count: u64,
        /// The smallest number of a conflicting equation.
        first: u64,
    },
}

impl Error {
    /// Wraps an error of the caller on this rank, so that [`agree`] can send it to all ranks.
    pub fn of(ranks: &dyn Ranks, error: &dyn std::fmt::Display) -> Self {
        Failure::of(error).on(ranks.rank())
    }
}

/// An error on one rank that the other ranks have not received yet.
#[derive(Debug)]
pub(crate) struct Failure(String);

impl Failure {
    pub fn of(error: &dyn std::fmt::Display) -> Self {
        Self(error.to_string())
    }

    pub fn on(self, rank: usize) -> Error {
        Error::Failed { rank, message: self.0 }
    }
}

/// An error that can be sent to other ranks.
pub trait ErrorWords: Sized {
    /// Encodes the error as 64-bit words, at least one.
    fn to_words(&self) -> Vec<u64>;

    /// Decodes the words of an error that a rank has sent.
    fn from_words(words: &[u64]) -> Self;
}

/// An error of the calling program, as a code and a message.
///
/// ```
/// use qless_mpi::{CodedError, agree, on_threads};
/// let errors = on_threads(3, |ranks| {
///     let own = if ranks.rank() == 1 { Err(CodedError { code: 2, text: "no such file".into() }) } else { Ok(()) };
///     agree(ranks, own).map_err(|error| (error.code, error.text))
/// });
/// assert_eq!(errors, vec![Err((2, "no such file".to_owned())); 3]);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CodedError {
    /// The code, which the calling program chooses.
    pub code: u64,
    /// The message.
    pub text: String,
}

impl ErrorWords for CodedError {
    fn to_words(&self) -> Vec<u64> {
        [vec![self.code], text(&self.text)].concat()
    }

    fn from_words(words: &[u64]) -> Self {
        Self { code: words[0], text: text_of(&words[1..]) }
    }
}

/// The result of this rank if no rank has an error, else the error of the first rank with one. Collective.
///
/// Without this call, the other ranks wait for ever for a rank that returns with an error.
///
/// ```
/// use qless_mpi::{Error, agree, on_threads};
/// let errors = on_threads(3, |ranks| {
///     let own = if ranks.rank() == 1 { Err(Error::of(ranks, &"no mesh file")) } else { Ok(()) };
///     agree(ranks, own).map_err(|error| error.to_string())
/// });
/// assert_eq!(errors, vec![Err("rank 1: no mesh file".to_owned()); 3]);
/// ```
///
/// # Errors
/// The error of the first rank that has one, on all ranks.
pub fn agree<T, E: ErrorWords>(ranks: &dyn Ranks, own: Result<T, E>) -> Result<T, E> {
    let size = ranks.size() as u64;
    let mut first = [if own.is_err() { size - ranks.rank() as u64 } else { 0 }];
    ranks.max(&mut first);
    if first[0] == 0 {
        return own;
    }
    let first = (size - first[0]) as usize;
    let own_error = own.err().filter(|_| ranks.rank() == first);
    let messages = own_error.map_or_else(Vec::new, |error| {
        let words = error.to_words();
        (0..ranks.size()).map(|rank| Message { rank, words: words.clone() }).collect()
    });
    let received = ranks.exchange(messages);
    Err(E::from_words(&received.first().expect("the first rank with an error sends it to all").words))
}
