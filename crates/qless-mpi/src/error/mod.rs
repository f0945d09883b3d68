//! Why ranks have no analysis: all return the same error.

mod words;

use qless::OptionError;

use crate::ranks::{Message, Ranks};
use crate::share::ShareError;
pub(crate) use words::{text, text_of};

/// Why the ranks could not analyse their equations.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// What a rank gave is not valid.
    #[error(transparent)]
    Share(#[from] ShareError),
    /// A component that no rank can take.
    #[error(
        "{equations} equations with {terms} terms are connected with one another, for which a rank needs about {bytes} bytes where \
         {limit} are allowed (Options::memory); allow more, or analyse them on a larger machine"
    )]
    TooLarge {
        /// Equations of the component.
        equations: u64,
        /// Their terms.
        terms: u64,
        /// Bytes that they take.
        bytes: u64,
        /// Bytes that may be taken.
        limit: u64,
    },
    /// What the serial analysis says of the equations that a rank was dealt.
    #[error("rank {rank}: {message}")]
    Failed {
        /// The rank.
        rank: usize,
        /// The error's text.
        message: String,
    },
    /// Equations that contradict others: there is no u to expand to.
    #[error("{count} equations contradict others, among them equation {first}; correct them")]
    Conflicting {
        /// How many.
        count: u64,
        /// The one with the smallest number.
        first: u64,
    },
}

impl Error {
    /// An error of what a code does by itself on this rank, for [`agree`].
    pub fn of(ranks: &dyn Ranks, error: &dyn std::fmt::Display) -> Self {
        Failure::of(error).on(ranks.rank())
    }
}

/// What went wrong on one rank, until all know.
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

/// An error that ranks tell one another.
pub trait Spoken: Sized {
    /// It in words; at least one.
    fn to_words(&self) -> Vec<u64>;

    /// What a rank has said.
    fn from_words(words: &[u64]) -> Self;
}

/// A message and a number that goes with it: errors of a program, which has its own.
///
/// ```
/// use qless_mpi::{Said, agree, together};
/// let found = together(3, |ranks| {
///     let own = if ranks.rank() == 1 { Err(Said { code: 2, text: "no such file".into() }) } else { Ok(()) };
///     agree(ranks, own).map_err(|said| (said.code, said.text))
/// });
/// assert!(found.iter().all(|found| *found == Err((2, "no such file".to_owned()))));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Said {
    /// The number.
    pub code: u64,
    /// The message.
    pub text: String,
}

impl Spoken for Said {
    fn to_words(&self) -> Vec<u64> {
        [vec![self.code], text(&self.text)].concat()
    }

    fn from_words(words: &[u64]) -> Self {
        Self { code: words[0], text: text_of(&words[1..]) }
    }
}

/// The result of this rank if no rank has an error, or the error of the first rank that has one: a rank that returns while others wait
/// for it leaves them waiting for ever. Collective.
///
/// ```
/// use qless_mpi::{Error, agree, together};
/// let said = together(3, |ranks| {
///     let own = if ranks.rank() == 1 { Err(Error::of(ranks, &"no mesh file")) } else { Ok(()) };
///     agree(ranks, own).map_err(|error| error.to_string())
/// });
/// assert_eq!(said, vec![Err("rank 1: no mesh file".to_owned()); 3]);
/// ```
///
/// # Errors
/// That of the first rank with one, on all ranks.
pub fn agree<T, E: Spoken>(ranks: &dyn Ranks, own: Result<T, E>) -> Result<T, E> {
    let size = ranks.size() as u64;
    let mut first = [if own.is_err() { size - ranks.rank() as u64 } else { 0 }];
    ranks.max(&mut first);
    if first[0] == 0 {
        return own;
    }
    let first = (size - first[0]) as usize;
    let speaks = if ranks.rank() == first { own.as_ref().err() } else { None };
    let messages = speaks.map_or_else(Vec::new, |error| {
        let words = error.to_words();
        (0..ranks.size()).map(|rank| Message { rank, words: words.clone() }).collect()
    });
    let came = ranks.exchange(messages);
    Err(E::from_words(&came.first().expect("the first rank with an error tells all").words))
}
