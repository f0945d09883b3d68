//! Lines about the whole model: verdict, input, presolve, backend, time, factored blocks, and unmet preferences.

use qless::report::FactoredSizes;
use qless::{Form, Report};

use crate::deck_input::DeckInput;
use crate::wording::count;

/// The verdict: the number of constraints left out, `3 of 16 equations are redundant; 1 conflicts; the rest (12) are independent.`, and
/// what the solver does with the deck.
pub fn verdict(report: &Report, deck: Option<&DeckInput>) -> String {
    let solver = deck.and_then(of_solver).map_or_else(String::new, |text| format!(" {text}"));
    verdict_on_equations(report, deck.is_some()) + &solver
}

/// What the solver does with the deck: `But ccx refuses the deck.`, `But ccx loses 12 claims.`
pub fn of_solver(deck: &DeckInput) -> Option<String> {
    let (solver, claims) = (deck.deck.solver(), deck.claims());
    match (claims.refused.len(), deck.lost(), claims.unsound.len()) {
        (0, 0, 0) => None,
        (0, 0, _) => Some(format!("But results of {solver} are unreliable.")),
        (0, lost, _) => Some(format!("But {solver} loses {}.", count(lost, "claim"))),
        _ => Some(format!("But {solver} refuses the deck.")),
    }
}

/// The verdict on the equations, after the number of constraints left out.
pub fn verdict_on_equations(report: &Report, is_deck: bool) -> String {
    let left_out = report.incomplete.len();
    if left_out == 0 {
        return of_equations(report, is_deck);
    }
    let constraints = if left_out == 1 { "constraint card was" } else { "constraint cards were" };
    let rest = if report.input.rows == 0 { "No equation was read.".to_owned() } else { of_equations(report, is_deck) };
    format!("INCOMPLETE: {left_out} {constraints} left out. {rest}")
}

fn of_equations(report: &Report, is_deck: bool) -> String {
    let (m, counts) = (report.input.rows, report.counts);
    match (m, m - counts.independent) {
        (0, _) if is_deck => return "The deck has no equations between DOFs, so there is nothing to find.".to_owned(),
        (0, _) => return "There are no equations, so there is nothing to find.".to_owned(),
        (1, 0) => return format!("The only equation is independent{}.", doubt(report)),
        (_, 0) => return format!("All {m} equations are independent{}.", doubt(report)),
        _ => {}
    }
    let of = format!(" of {}", count(m, "equation"));
    let redundant = some(counts.redundant, &of, "is redundant", "are redundant");
    let of = if counts.redundant == 0 { of.as_str() } else { "" };
    let conflicting = some(counts.conflicting, of, "conflicts", "conflict");
    let rest = match counts.independent {
        0 => Some("none is independent".to_owned()),
        1 => Some("the other one is independent".to_owned()),
        n => Some(format!("the rest ({n}) are independent")),
    };
    let parts: Vec<String> = [redundant, conflicting, rest].into_iter().flatten().collect();
    format!("{}{}.", parts.join("; "), doubt(report))
}

fn doubt(report: &Report) -> &'static str {
    if report.confidence.ambiguous { " (ambiguous, see below)" } else { "" }
}

fn some(n: usize, of: &str, one: &str, many: &str) -> Option<String> {
    let verb = if n == 1 { one } else { many };
    (n > 0).then(|| format!("{n}{of} {verb}"))
}

/// The line about the input: `Input: 16 equations with 32 coefficients on 28 DOFs, 2 prescribed.`, or `Input: no equations.`
pub fn input(report: &Report) -> String {
    let input = report.input;
    if input.rows == 0 {
        return "Input: no equations.".to_owned();
    }
    let prescribed = match input.prescribed {
        0 => "none prescribed".to_owned(),
        n => format!("{n} prescribed"),
    };
    let (rows, coefficients) = (count(input.rows, "equation"), count(input.nnz, "coefficient"));
    format!("Input: {rows} with {coefficients} on {}, {prescribed}.", count(input.dofs, "DOF"))
}

/// The line about the effort: `Effort checked: by estimates; a doubtful rank is called ambiguous.`
pub fn effort(report: &Report) -> String {
    format!("Effort {}: {}.", report.effort.name(), report.promise)
}

/// The line about the proof; for exact arithmetic, about the chance of error.
pub fn proof(report: &Report) -> Option<String> {
    let proof = report.proof.as_ref()?;
    Some(match &report.exact_rank {
        Some(exact) if exact.error_chance == 0.0 => "Certificates prove the exact rank: no chance of error.".to_owned(),
        Some(exact) => {
            format!("Two primes drawn at random miss the exact rank with a chance of {:.0e}.", exact.error_chance)
        }
        None => format!(
            "Proved: {} triangular, {} more independent; {} dependent exactly, {} to rounding.",
            proof.triangular,
            proof.bounded + proof.modular,
            proof.exact,
            proof.enclosed
        ),
    })
}

/// The line about presolve: `Presolve settled 12 of 16 equations; faer factored 4, in 1 block.`
pub fn presolve(report: &Report) -> String {
    let (rows, name) = (report.input.rows, report.backend.name);
    let Some(presolve) = report.presolve else { return of_ranks(report) };
    let blocks = match presolve.blocks {
        1 => "1 block".to_owned(),
        n => format!("{n} blocks of at most {}", presolve.largest_block),
    };
    match presolve.core_rows {
        0 => format!("Presolve settled all equations; nothing was left for {name} to factor."),
        core if core == rows => format!("{name} factored all equations, in {blocks}."),
        core => {
            format!("Presolve settled {} of {rows} equations; {name} factored {core}, in {blocks}.", rows - core)
        }
    }
}

/// The line of `presolve` for an analysis across ranks, which does not count the equations that presolve settles.
fn of_ranks(report: &Report) -> String {
    let ranks = count(report.ranks.unwrap_or(1), "rank");
    format!("Analysed by {ranks}, each with presolve and {}.", report.backend.name)
}

/// The line about the backend, if its version has details: `Backend: SuiteSparseQR 2.1.0, SuiteSparse 5.12.0, task tree on oneTBB 2021.8.`
pub fn backend(report: &Report) -> Option<String> {
    let has_core = report.presolve.is_some_and(|presolve| presolve.core_rows > 0);
    let says_more = has_core && report.backend.version.contains(',');
    says_more.then(|| format!("Backend: {}.", report.backend.version))
}

/// The line about time: `Time: 0.53 s (reading 0.21, analysis 0.30).`
pub fn time(report: &Report) -> String {
    let ms = report.timings_ms;
    let of_stages = ms.presolve + ms.factor + ms.classify;
    let analysis = if report.ranks.is_some() { ms.total - ms.read } else { of_stages };
    let reduction =
        report.reduction.as_ref().map_or_else(String::new, |_| format!(", reduction {:.2}", ms.reduce / 1e3));
    let (total, read, analysis) = (ms.total / 1e3, ms.read / 1e3, analysis / 1e3);
    let threads = count(report.backend.threads, "thread");
    let who = report.ranks.map_or_else(|| threads.clone(), |ranks| format!("{} of {threads}", count(ranks, "rank")));
    format!("Time: {total:.2} s (reading {read:.2}, analysis {analysis:.2}{reduction}) on {who}.")
}

/// Largest number of blocks shown; `--format json` has all of them.
const BLOCKS_SHOWN: usize = 2;

/// At most three lines about blocks in factor form; none if T is explicit.
pub fn factored_blocks(report: &Report) -> Vec<String> {
    let Some(reduction) = &report.reduction else { return Vec::new() };
    match (&reduction.factored[..], reduction.form) {
        (_, Form::Explicit) => Vec::new(),
        ([], Form::Auto) => vec!["No block stayed factored: T is small enough as numbers.".to_owned()],
        ([], Form::Factored) => vec!["No block stayed factored: none needs elimination, or none allows it.".to_owned()],
        (all, _) => largest(all),
    }
}

/// The number of factored blocks, and the largest of them.
fn largest(all: &[FactoredSizes]) -> Vec<String> {
    let total = |of: fn(&FactoredSizes) -> usize| all.iter().map(of).sum::<usize>();
    let mut numbered: Vec<(usize, &FactoredSizes)> = (1..).zip(all).collect();
    numbered.sort_by_key(|(_, block)| std::cmp::Reverse(block.predicted));
    let (blocks, nnz, predicted) = (all.len(), total(|block| block.nnz), total(|block| block.predicted));
    let which = if blocks > BLOCKS_SHOWN { "; the largest:" } else { ":" };
    let mut lines =
        vec![format!("Factored: {blocks} blocks, {nnz} numbers where T would have about {predicted}{which}")];
    lines.extend(numbered.iter().take(BLOCKS_SHOWN).map(|(k, block)| format!("  {}", block_line(*k, block))));
    lines
}

/// The line about a factored block: `block 1: 4980 equations, 4980 slaves, 812 masters, 71234 numbers; T about 3141592`.
fn block_line(number: usize, block: &FactoredSizes) -> String {
    let sizes =
        [(block.equations, "equation"), (block.slaves, "slave"), (block.masters, "master"), (block.nnz, "number")];
    format!("block {number}: {}; T about {}", sizes.map(|(n, what)| count(n, what)).join(", "), block.predicted)
}

/// A line for each kind of preference that is not met completely.
pub fn unmet_preferences(report: &Report) -> Vec<String> {
    let unmet = &report.unmet_preferences;
    let kinds = [
        (
            &unmet.equations,
            "equation",
            "to keep is dependent on others to keep",
            "to keep are dependent on others to keep",
        ),
        (
            &unmet.masters,
            "column",
            "is a slave anyway: no choice avoids that",
            "are slaves anyway: no choice avoids that",
        ),
        (
            &unmet.slaves,
            "column",
            "is no slave: prescribed, in no equation, or with more growth only",
            "are no slaves: prescribed, in no equation, or with more growth only",
        ),
    ];
    let lines = kinds.iter().filter(|(numbers, ..)| !numbers.is_empty());
    lines
        .map(|(numbers, what, one, many)| unmet_line(numbers, what, if numbers.len() == 1 { one } else { many }))
        .collect()
}

fn unmet_line(numbers: &[usize], what: &str, rest: &str) -> String {
    const SHOWN: usize = 5;
    let first: Vec<_> = numbers.iter().take(SHOWN).map(usize::to_string).collect();
    let more = numbers.len().saturating_sub(SHOWN);
    let and = if more > 0 { format!(" and {more} more") } else { String::new() };
    let plural = if numbers.len() == 1 { "" } else { "s" };
    format!("Not met: {what}{plural} {}{and} {rest}.", first.join(", "))
}
