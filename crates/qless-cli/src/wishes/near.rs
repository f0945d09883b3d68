//! The known name that is nearest to one that is not known.

use strsim::normalized_damerau_levenshtein;

/// Names that are compared at most: the message is not worth more time.
const COMPARED: usize = 200_000;
/// Less alike than this is no help.
const ALIKE: f64 = 0.5;

/// The name most like `word`, in any case.
pub fn nearest(word: &str, known: impl Iterator<Item = String>) -> Option<String> {
    let word = word.to_lowercase();
    let alike = |name: String| (normalized_damerau_levenshtein(&word, &name.to_lowercase()), name);
    let best = known.take(COMPARED).map(alike).max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 >= ALIKE).then_some(best.1)
}
