//! Errors as 64-bit words, to be sent to all ranks.

use qless::OptionError;

use super::{Error, ErrorWords, OptionName};
use crate::share::{ShareError, SharePlace};

/// Encodes a text as words: its length in bytes, then its bytes, eight in each word.
pub(crate) fn text(message: &str) -> Vec<u64> {
    let bytes = message.as_bytes().chunks(8).map(|chunk| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    });
    std::iter::once(message.len() as u64).chain(bytes).collect()
}

pub(crate) fn text_of(words: &[u64]) -> String {
    let mut bytes: Vec<u8> = words[1..].iter().flat_map(|word| word.to_le_bytes()).collect();
    bytes.truncate(words[0] as usize);
    String::from_utf8_lossy(&bytes).into_owned()
}

fn place(what: SharePlace) -> [u64; 3] {
    match what {
        SharePlace::Coefficient { equation, dof } => [0, equation, dof],
        SharePlace::RightHandSide { equation } => [1, equation, 0],
        SharePlace::Prescribed { dof } => [2, 0, dof],
        SharePlace::Needed { dof } => [3, 0, dof],
    }
}

fn place_of(words: &[u64]) -> SharePlace {
    let (equation, dof) = (words[1], words[2]);
    match words[0] {
        0 => SharePlace::Coefficient { equation, dof },
        1 => SharePlace::RightHandSide { equation },
        2 => SharePlace::Prescribed { dof },
        _ => SharePlace::Needed { dof },
    }
}

impl ErrorWords for Error {
    fn to_words(&self) -> Vec<u64> {
        let with_place =
            |code, rank: usize, what, last| [vec![code, rank as u64], place(what).to_vec(), vec![last]].concat();
        match self {
            Self::Failed { rank, message } => [vec![0, *rank as u64], text(message)].concat(),
            Self::TooLarge { equations, terms, bytes, limit } => vec![1, *equations, *terms, *bytes, *limit],
            Self::Conflicting { count, first } => vec![2, *count, *first],
            Self::Share(ShareError::NotFinite { rank, what, value }) => with_place(3, *rank, *what, value.to_bits()),
            Self::Share(ShareError::DofOutOfRange { rank, what, dofs }) => with_place(4, *rank, *what, *dofs),
            Self::Share(ShareError::Ranges { rank, start, expected }) => vec![5, *rank as u64, *start, *expected],
            Self::Share(ShareError::PrescribedTwice { dof, first, second }) => {
                vec![6, *dof, first.to_bits(), second.to_bits()]
            }
            Self::Share(ShareError::NumberTwice { rank, number }) => vec![7, *rank as u64, *number],
            Self::Share(ShareError::NumberTooLarge { rank, number }) => vec![8, *rank as u64, *number],
            Self::Option(OptionError::Tolerance(value)) => vec![9, value.to_bits()],
            Self::Option(OptionError::Growth(value)) => vec![10, value.to_bits()],
            Self::Option(OptionError::Contradiction(dof)) => vec![11, *dof as u64],
            Self::Options { rank, setting } => vec![12, *rank as u64, *setting as u64],
            Self::Option(other) => [vec![0, 0], text(&other.to_string())].concat(),
        }
    }

    fn from_words(words: &[u64]) -> Self {
        let (rank, real) = (words[1] as usize, |k: usize| f64::from_bits(words[k]));
        match words[0] {
            1 => Self::TooLarge { equations: words[1], terms: words[2], bytes: words[3], limit: words[4] },
            2 => Self::Conflicting { count: words[1], first: words[2] },
            3 => ShareError::NotFinite { rank, what: place_of(&words[2..]), value: real(5) }.into(),
            4 => ShareError::DofOutOfRange { rank, what: place_of(&words[2..]), dofs: words[5] }.into(),
            5 => ShareError::Ranges { rank, start: words[2], expected: words[3] }.into(),
            6 => ShareError::PrescribedTwice { dof: words[1], first: real(2), second: real(3) }.into(),
            7 => ShareError::NumberTwice { rank, number: words[2] }.into(),
            8 => ShareError::NumberTooLarge { rank, number: words[2] }.into(),
            9 => OptionError::Tolerance(real(1)).into(),
            10 => OptionError::Growth(real(1)).into(),
            11 => OptionError::Contradiction(rank).into(),
            12 => Self::Options { rank, setting: OptionName::ALL[words[2] as usize] },
            _ => Self::Failed { rank, message: text_of(&words[2..]) },
        }
    }
}
