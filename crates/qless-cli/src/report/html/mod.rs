//! The report as one self-contained HTML page: a template with the report and a picture of the system as JSON.

mod headline;
mod picture;

use qless::Report;
use serde::Serialize;

use super::repairs::RepairWords;
use super::{CommandOutcome, text};
use crate::deck_input::DeckReport;
use crate::diagnose::Diagnosis;
use headline::Headline;
use picture::Picture;

const PAGE: &str = include_str!("page.html");

/// Data of the page.
#[derive(Serialize)]
struct PageData<'a> {
    name: String,
    version: &'static str,
    headline: Headline,
    repairs: Vec<RepairWords>,
    /// Advice, if no repair is known.
    next: Vec<String>,
    /// Certainty, method and time.
    facts: Vec<String>,
    report: &'a Report,
    #[serde(flatten)]
    deck: Option<DeckReport<'a>>,
    picture: Picture,
}

/// Renders the page: the template with its data.
pub fn render(diagnosis: &Diagnosis, report: &Report, outcome: &CommandOutcome) -> Result<String, serde_json::Error> {
    let input = &diagnosis.args.input;
    let repairs = RepairWords::all(report);
    let [facts, next] = text::last_lines(diagnosis, report, outcome);
    let data = PageData {
        name: input.file_name().unwrap_or(input.as_os_str()).to_string_lossy().into_owned(),
        version: env!("CARGO_PKG_VERSION"),
        headline: Headline::new(diagnosis, report),
        next: if repairs.is_empty() { next } else { Vec::new() },
        repairs,
        facts,
        report,
        deck: diagnosis.deck.as_ref().map(|deck| deck.report(&diagnosis.analysis)),
        picture: Picture::new(diagnosis, report),
    };
    Ok(PAGE.replacen("__DATA__", &in_script(&serde_json::to_string(&data)?), 1))
}

/// Escapes JSON for a script element, so that no label ends the script or opens a comment.
fn in_script(json: &str) -> String {
    // In JSON, these characters occur in strings only, where escapes are allowed.
    [('<', "\\u003c"), ('>', "\\u003e"), ('&', "\\u0026"), ('\u{2028}', "\\u2028"), ('\u{2029}', "\\u2029")]
        .into_iter()
        .fold(json.to_owned(), |json, (found, escaped)| json.replace(found, escaped))
}
