//! The last lines of the text report: output files and advice.

use std::path::Path;

use qless::report::RepairFinding;
use qless::{Effort, Report, Status};
use qless_io::deck::Format;
use qless_io::deck::clean::{Plan, Reason, Removed};
use qless_io::without_gz;

use super::super::CommandOutcome;
use super::super::repairs::others;
use super::summary::of_solver;
use super::{COLUMNS, EquationList};
use crate::deck_input::DeckInput;
use crate::wording::layout::{flow, width};
use crate::wording::printable;
use crate::wording::{change, count};
use crate::wording::{label, number, rough};

/// The files that the command wrote, or advice for the next step.
pub fn lines(list: &EquationList, report: &Report, outcome: &CommandOutcome) -> Vec<String> {
    match outcome {
        CommandOutcome::Written(folder) => written(report, folder),
        CommandOutcome::Cleaned { output, is_replaced, plan, restored } => {
            let changes = (*restored > 0).then(|| changed(list, *restored));
            let doubt = report.confidence.ambiguous.then(|| {
                "The rank is ambiguous, as said above: decide which equations are meant before you use this deck."
                    .to_owned()
            });
            let verb = if *is_replaced { "Replaced" } else { "Wrote" };
            let mut lines = vec![format!("{verb} {}", cleaned(output, plan))];
            lines.extend(changed_cards(list, plan));
            lines.extend(proved(list, plan).filter(|_| doubt.is_none()));
            lines.into_iter().chain(changes).chain(doubt).collect()
        }
        CommandOutcome::Checked(obstacle) => next(list, report, *obstacle),
        CommandOutcome::Refused => {
            std::iter::once("Nothing was written.".to_owned()).chain(next(list, report, None)).collect()
        }
    }
}

/// Lines about a written reduction: its folder, and the quality of T.
fn written(report: &Report, folder: &Path) -> Vec<String> {
    let Some(reduction) = &report.reduction else { return Vec::new() };
    let folder = printable::line(&folder.display().to_string());
    vec![
        format!(
            "Reduced to {} and {}: max |T_ij| {}, relative residual {}.",
            count(reduction.masters, "master"),
            count(reduction.slaves, "slave"),
            number(reduction.growth),
            rough(reduction.residual)
        ),
        match reduction.factored.len() {
            0 => format!("Wrote T, G, g and the lists of DOFs to {folder}."),
            _ => format!("Wrote T, G, g, lists of DOFs and factors to {folder}."),
        },
    ]
}

/// The cleaned deck, and how many equations were removed or rewritten.
fn cleaned(output: &Path, plan: &Plan) -> String {
    let output = printable::line(&output.display().to_string());
    let is_redundant = |removed: &&Removed| matches!(removed.reason, Reason::Redundant(_));
    match (plan.removed.iter().filter(is_redundant).count(), plan.written.len()) {
        (0, 0) => format!("{output}: nothing had to be changed."),
        (removed, 0) => format!("{output}: without {}.", count(removed, "redundant equation")),
        (0, written) => format!("{output}: {} written anew.", count(written, "equation")),
        (removed, written) => {
            format!("{output}: without {}, {written} written anew.", count(removed, "redundant equation"))
        }
    }
}

/// Largest number of lines that name changed cards.
const CARD_LINES: usize = 2;

/// The cards whose equations were removed, each once: `  Changed: line 13 *EQUATION, line 16 *EQUATION`.
fn changed_cards(list: &EquationList, plan: &Plan) -> Vec<String> {
    let Some(model) = list.deck.map(|deck| deck.deck.model()) else { return Vec::new() };
    let mut cards: Vec<String> = Vec::new();
    for equation in plan.removed.iter().filter_map(|removed| model.equation(removed.equation)) {
        let place = model.place(equation.origin);
        if cards.last() != Some(&place) {
            cards.push(place);
        }
    }
    if cards.is_empty() {
        return Vec::new();
    }
    let comma = |k: usize| if k + 1 < cards.len() { "," } else { "" };
    let pieces: Vec<String> =
        cards.iter().enumerate().map(|(k, card)| format!(" {}{}", label(card), comma(k))).collect();
    let tail = format!(" ... ({} in all)", cards.len());
    let flowed = flow("  Removed or changed:", "    ", &pieces, (CARD_LINES, COLUMNS), tail.len());
    let tail = if flowed.used < pieces.len() { tail } else { String::new() };
    flowed.finish(&tail)
}

/// What the proof shows of a deck that was changed.
fn proved(list: &EquationList, plan: &Plan) -> Option<String> {
    let deck = list.deck.filter(|_| !plan.is_empty())?;
    let reasons = if deck.needs_cleaning() {
        format!("; what is said above of {} no longer applies", deck.deck.solver())
    } else {
        String::new()
    };
    Some(format!("  It was read again, and has the same solutions{reasons}."))
}

/// A warning that results change, because claims that the solver dropped now hold.
fn changed(list: &EquationList, restored: usize) -> String {
    let solver = list.deck.map_or_else(String::new, |deck| deck.deck.solver().to_string());
    format!(
        "Results change: {} that {solver} dropped, as said above, now {}.",
        count(restored, "claim"),
        if restored == 1 { "holds" } else { "hold" }
    )
}

/// Largest number of repairs that are shown, and of changes that are shown in each.
const REPAIRS: usize = 3;

/// The repairs of conflicts, or one line of other advice.
fn next(list: &EquationList, report: &Report, obstacle: Option<&str>) -> Vec<String> {
    let known: Vec<&RepairFinding> = report.repairs.iter().filter(|repair| !repair.ways.is_empty()).collect();
    if known.is_empty() {
        return std::iter::once(advice(list, report, obstacle)).chain(then(list, report)).collect();
    }
    let mut lines: Vec<String> = known.iter().take(REPAIRS).flat_map(|repair| repair_lines(repair)).collect();
    if let Some(first) = lines.first_mut() {
        *first = format!("Next: {}", first.trim_start());
    }
    if known.len() > REPAIRS {
        let more = count(known.len() - REPAIRS, "more repair");
        lines.push(format!("  and {more}, of other conflicts (all of them: --format json)"));
    }
    lines.extend(then(list, report));
    lines
}

/// What remains to do when conflicts are cured: no other value changes what the solver does with two claims on one DOF.
fn then(list: &EquationList, report: &Report) -> Option<String> {
    let deck = list.deck.filter(|deck| report.status == Status::Conflicting && deck.needs_cleaning())?;
    let does = of_solver(deck)?.trim_start_matches("But ").trim_end_matches('.').to_owned();
    let how = if matches!(deck.deck.format(), Format::LsDyna | Format::Radioss) {
        "correct what is said above by hand".to_owned()
    } else {
        format!("run `{}`", clean_command(list.input))
    };
    Some(format!("Then {how}: {does} even without conflicts."))
}

/// The most plausible way to cure some conflicts, and how many other ways were verified and not verified.
fn repair_lines(repair: &RepairFinding) -> Vec<String> {
    let way = &repair.ways[0];
    let shown = way.iter().take(REPAIRS).map(|one| change(one, label));
    let mut lines: Vec<String> = shown.map(|change| format!("  {change}")).collect();
    let more = way.len().saturating_sub(REPAIRS);
    let more = if more > 0 { format!(" with {} more (--format json)", count(more, "change")) } else { String::new() };
    let cured = match &repair.conflicts[..] {
        [row] => format!("cures row {row}"),
        [one, other] => format!("cures rows {one} and {other}"),
        rows => format!("cures {} conflicts", rows.len()),
    };
    let unverified = repair.count.saturating_sub(repair.ways.len());
    let others = others(repair.ways.len(), unverified).map(|others| format!("; {others} (--format json)"));
    let others = others.unwrap_or_default();
    if let Some(last) = lines.last_mut() {
        let tail = format!("{more}: {cured}{others}.");
        if width(last) + width(&tail) + 4 <= COLUMNS {
            last.push_str(&tail);
        } else {
            last.push(':');
            lines.push(format!("    {}", tail.trim_start_matches([':', ' '])));
        }
    }
    lines
}

fn advice(list: &EquationList, report: &Report, obstacle: Option<&str>) -> String {
    let input = quoted(list.input);
    let clean = |what: &str| match obstacle {
        None => format!("Next: `{}` writes a deck {what}.", clean_command(list.input)),
        Some(why) => format!("Next: correct the deck by hand, because `qless clean` cannot: {why}"),
    };
    let claims = list.deck.map(DeckInput::claims);
    let is_refused = claims.as_ref().is_some_and(|claims| !claims.refused.is_empty() || !claims.unsound.is_empty());
    let is_lost = claims.as_ref().is_some_and(|claims| !claims.lost.is_empty());
    match report.status {
        Status::Conflicting => {
            "Next: correct each conflicting equation, or one in its combination, or remove it.".to_owned()
        }
        Status::Incomplete => {
            "Next: write what was left out as equations, or ignore it (--allow-incomplete).".to_owned()
        }
        _ if report.input.rows == 0 && list.deck.is_some() => "Next: nothing to mend.".to_owned(),
        _ if report.input.rows == 0 => "Next: check that the equations were exported to this input.".to_owned(),
        _ if report.confidence.ambiguous && report.effort == Effort::Quick => {
            "Next: run again with --effort checked, which checks the rank.".to_owned()
        }
        _ if report.confidence.ambiguous => {
            "Next: decide, as said above, which equations are meant to be independent.".to_owned()
        }
        _ if is_lost && !is_refused => clean("in which the lost ones hold"),
        Status::Redundant if is_refused => clean("that the solver takes, without redundant equations"),
        Status::Redundant if list.deck.is_some() => clean("without redundant equations"),
        Status::Redundant => {
            let them = if report.counts.redundant == 1 { "it" } else { "them" };
            format!("Next: remove {them}, or run `qless reduce {input} -o DIR`, which leaves {them} out.")
        }
        _ if is_refused => clean("that the solver takes"),
        _ if list.idle_loads > 0 => {
            format!("Next: nothing to mend in the constraints, but {} no effect.", loads_have(list.idle_loads))
        }
        _ => format!("Next: nothing to mend. `qless reduce {input} -o DIR` writes the reduced form."),
    }
}

fn loads_have(number: usize) -> String {
    format!("{} {}", count(number, "load"), if number == 1 { "has" } else { "have" })
}

/// `qless clean part.inp -o part-clean.inp`: an output with the ending of the input, which is never packed.
fn clean_command(input: &Path) -> String {
    let plain = without_gz(input).unwrap_or(input);
    let output = plain.file_stem().zip(plain.extension()).map(|(stem, ending)| {
        let name = format!("{}-clean.{}", stem.to_string_lossy(), ending.to_string_lossy());
        quoted(&input.with_file_name(name))
    });
    format!("qless clean {} -o {}", quoted(input), output.as_deref().unwrap_or("DECK"))
}

/// A path, quoted for a shell if necessary.
pub fn quoted(path: &Path) -> String {
    let plain = printable::line(&path.display().to_string());
    let is_safe = |c: char| c.is_ascii_alphanumeric() || "_-./+,=:@%".contains(c);
    if plain.chars().all(is_safe) { plain } else { format!("'{}'", plain.replace('\'', r"'\''")) }
}
