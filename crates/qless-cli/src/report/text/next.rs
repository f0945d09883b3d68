//! The last lines of the text report: output files and advice.

use std::path::Path;

use qless::{Report, Status};

use super::super::CommandOutcome;
use super::EquationList;
use crate::deck_input::DeckInput;
use crate::wording::count;
use crate::wording::layout::{shorten, width};
use crate::wording::printable;
use crate::wording::{number, rough};

/// One or two lines.
pub fn lines(list: &EquationList, report: &Report, outcome: &CommandOutcome) -> Vec<String> {
    match outcome {
        CommandOutcome::Written(folder) => written(report, folder),
        CommandOutcome::Cleaned { output, removed, written, restored } => {
            let changes = (*restored > 0).then(|| changed(list, *restored));
            std::iter::once(cleaned(output, *removed, *written)).chain(changes).collect()
        }
        CommandOutcome::Checked(obstacle) => vec![advice(list, report, *obstacle)],
        CommandOutcome::Refused => vec!["Nothing was written.".to_owned(), advice(list, report, None)],
    }
}

/// The folder of the files, and the quality of T.
fn written(report: &Report, folder: &Path) -> Vec<String> {
    let Some(reduction) = &report.reduction else { return Vec::new() };
    let folder = shorten(&printable::line(&folder.display().to_string()), 60);
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
fn cleaned(output: &Path, removed: usize, written: usize) -> String {
    let output = shorten(&printable::line(&output.display().to_string()), 60);
    match (removed, written) {
        (0, 0) => format!("Wrote {output}: nothing had to be changed."),
        (_, 0) => format!("Wrote {output}: without {}.", count(removed, "redundant equation")),
        _ => format!("Wrote {output}: without {}, {written} written anew.", count(removed, "redundant equation")),
    }
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

fn advice(list: &EquationList, report: &Report, obstacle: Option<&str>) -> String {
    let input = quoted(list.input);
    let clean = |what: &str| match obstacle {
        None => format!("Next: `qless clean {input} -o DECK` writes a deck {what}."),
        Some(why) => format!("Next: correct the deck by hand, because `qless clean` cannot: {}", shorten(why, 150)),
    };
    let claims = list.deck.map(DeckInput::claims);
    let is_refused = claims.as_ref().is_some_and(|claims| !claims.refused.is_empty() || !claims.unsound.is_empty());
    let is_dropped = claims.as_ref().is_some_and(|claims| !claims.ignored.is_empty());
    match report.status {
        Status::Conflicting => {
            "Next: correct each conflicting equation, or one in its combination, or remove it.".to_owned()
        }
        Status::Incomplete => {
            "Next: write what was left out as equations, or ignore it (--allow-incomplete).".to_owned()
        }
        _ if report.input.rows == 0 && list.deck.is_some() => "Next: nothing to mend.".to_owned(),
        _ if report.input.rows == 0 => "Next: check that the equations were exported to this input.".to_owned(),
        _ if report.confidence.ambiguous => {
            "Next: decide, as said above, which equations are meant to be independent.".to_owned()
        }
        _ if is_dropped && !is_refused => {
            "Next: decide which of the claims are meant: what is dropped has no effect on the result.".to_owned()
        }
        Status::Redundant if list.deck.is_some() => clean("without redundant equations"),
        Status::Redundant => {
            let them = if report.counts.redundant == 1 { "it" } else { "them" };
            format!("Next: remove {them}, or run `qless reduce {input} -o DIR`, which leaves {them} out.")
        }
        _ if is_refused => clean("that the solver takes"),
        _ => format!("Next: nothing to mend. `qless reduce {input} -o DIR` writes the reduced form."),
    }
}

/// The input in the syntax of a shell, or `INPUT` if it is too long or needs quotes.
fn quoted(path: &Path) -> String {
    let plain = path.display().to_string();
    let is_safe = plain.chars().all(|c| c.is_ascii_alphanumeric() || "_-./+,=:@%".contains(c));
    if is_safe && width(&plain) <= 28 { plain } else { "INPUT".to_owned() }
}
