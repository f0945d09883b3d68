//! What is said where several parts are refused: the gravest, of all parts that it is true of.

use super::super::EnforceError::{self, PenaltyTooSmall, Unsupported};

/// One refusal of two, the first where both are of different kinds and equally grave.
pub fn both(first: EnforceError, second: EnforceError) -> EnforceError {
    match (first, second) {
        (Unsupported(a), Unsupported(b)) => Unsupported(a.and(&b)),
        (PenaltyTooSmall { factor, accuracy, cost, smallest }, second @ PenaltyTooSmall { .. }) => {
            let PenaltyTooSmall { factor: f, cost: c, smallest: s, .. } = second else { return second };
            // One factor for all of them.
            let smallest = smallest.zip(s).map(|(a, b)| a.max(b));
            PenaltyTooSmall { factor: factor.max(f), accuracy, cost: cost.max(c), smallest }
        }
        // What no factor changes comes first.
        (PenaltyTooSmall { .. }, other) | (_, other @ Unsupported(_)) => other,
        (first, _) => first,
    }
}
