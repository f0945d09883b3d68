//! Shortens lists of warnings: sorts them by line, removes repetitions, and limits the number of each kind.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::deck::Warning;

/// Largest number of warnings of one kind that are shown.
const OF_A_KIND: usize = 100;

/// Returns the warnings in the order of file and line, each once. If there are more of one kind than the limit, a warning at the end of the
/// list says how many are omitted.
pub fn brief(mut warnings: Vec<Warning>) -> Vec<Warning> {
    warnings.sort_by_key(|warning| (warning.file, warning.line));
    let mut seen = FxHashSet::default();
    warnings.retain(|warning| seen.insert((warning.file, warning.line, warning.text.clone())));
    let mut counts: FxHashMap<String, usize> = FxHashMap::default();
    let mut kept: Vec<Warning> = Vec::new();
    let mut beyond: Vec<(String, Warning)> = Vec::new();
    for warning in warnings {
        let kind = kind(&warning.text);
        let count = counts.entry(kind.clone()).or_insert(0);
        *count += 1;
        match *count {
            0..=OF_A_KIND => kept.push(warning),
            // The warning that says how many are omitted has the line of the first omitted one.
            n if n == OF_A_KIND + 1 => beyond.push((kind, warning)),
            _ => {}
        }
    }
    kept.extend(beyond.into_iter().map(|(kind, first)| {
        let text = format!(
            "{} of {} such warnings are omitted; the first of these is: {}",
            counts[&kind] - OF_A_KIND,
            counts[&kind],
            first.text
        );
        Warning { text, ..first }
    }));
    kept
}

/// The kind of a warning: its text without words that contain digits.
fn kind(text: &str) -> String {
    let words = text.split_whitespace().filter(|word| !word.bytes().any(|byte| byte.is_ascii_digit()));
    words.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_are_sorted_unique_and_counted() {
        let warning = |line: u32| Warning { file: 0, line, text: format!("CFAST {line} joins"), leaves_out: false };
        let found = brief((1..=300).rev().chain([7, 7]).map(warning).collect());
        assert_eq!(found.len(), OF_A_KIND + 1);
        assert_eq!((found[0].line, found[99].line, found[100].line), (1, 100, 101));
        assert_eq!(found[100].text, "200 of 300 such warnings are omitted; the first of these is: CFAST 101 joins");
    }
}
