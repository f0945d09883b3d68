//! Which parts of the equations stay factors, and what they would cost as numbers.

use qless::report::FactoredSizes;
use qless::{Form, Report};

use super::name::count;

/// Parts shown where there are more than one; `--format json` has all of them.
const SHOWN: usize = 2;

/// Nothing if T was asked for as numbers; else at most three lines.
pub fn lines(report: &Report) -> Vec<String> {
    let Some(reduction) = &report.reduction else { return Vec::new() };
    match (&reduction.factored[..], reduction.form) {
        (_, Form::Explicit) => Vec::new(),
        ([], Form::Auto) => vec!["No block stayed factored: T is small enough as numbers.".to_owned()],
        ([], Form::Factored) => vec!["No block stayed factored: none needs elimination, or none allows it.".to_owned()],
        (all, _) => largest(all),
    }
}

/// How many there are, and those that would cost most.
fn largest(all: &[FactoredSizes]) -> Vec<String> {
    let total = |of: fn(&FactoredSizes) -> usize| all.iter().map(of).sum::<usize>();
    let mut numbered: Vec<(usize, &FactoredSizes)> = (1..).zip(all).collect();
    numbered.sort_by_key(|(_, block)| std::cmp::Reverse(block.predicted));
    let (blocks, nnz, predicted) = (all.len(), total(|block| block.nnz), total(|block| block.predicted));
    let which = if blocks > SHOWN { "; the largest:" } else { ":" };
    let mut lines =
        vec![format!("Factored: {blocks} blocks, {nnz} numbers where T would have about {predicted}{which}")];
    lines.extend(numbered.iter().take(SHOWN).map(|(k, block)| format!("  {}", line(*k, block))));
    lines
}

/// `block 1: 4980 equations, 4980 slaves, 812 masters, 71234 numbers; T about 3141592`.
fn line(number: usize, block: &FactoredSizes) -> String {
    let sizes =
        [(block.equations, "equation"), (block.slaves, "slave"), (block.masters, "master"), (block.nnz, "number")];
    format!("block {number}: {}; T about {}", sizes.map(|(n, what)| count(n, what)).join(", "), block.predicted)
}
