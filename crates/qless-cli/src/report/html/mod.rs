//! The report as one self-contained HTML page: a template with the report and a picture of the system as JSON.

mod picture;

use qless::Report;
use serde::Serialize;

use crate::deck_input::DeckReport;
use crate::diagnose::Diagnosis;
use crate::report::text;
use picture::Picture;

const PAGE: &str = include_str!("page.html");

/// Data of the page.
#[derive(Serialize)]
struct PageData<'a> {
    name: String,
    verdict: String,
    version: &'static str,
    report: &'a Report,
    exact: Vec<String>,
    #[serde(flatten)]
    deck: Option<DeckReport<'a>>,
    picture: Picture,
}

/// The page.
pub fn render(diagnosis: &Diagnosis, report: &Report) -> Result<String, serde_json::Error> {
    let input = &diagnosis.args.input;
    let data = PageData {
        name: input.file_name().unwrap_or(input.as_os_str()).to_string_lossy().into_owned(),
        verdict: text::verdict(report, diagnosis.deck.as_ref()),
        version: env!("CARGO_PKG_VERSION"),
        report,
        exact: text::exact_rank(diagnosis, report),
        deck: diagnosis.deck.as_ref().map(|deck| deck.report(&diagnosis.analysis)),
        picture: Picture::new(diagnosis),
    };
    Ok(PAGE.replacen("__DATA__", &in_script(&serde_json::to_string(&data)?), 1))
}

/// Escapes JSON for a script element, so that no label ends the script or opens a comment.
fn in_script(json: &str) -> String {
    // In JSON, these characters occur in strings only.
    [('<', "\\u003c"), ('>', "\\u003e"), ('&', "\\u0026"), ('\u{2028}', "\\u2028"), ('\u{2029}', "\\u2029")]
        .into_iter()
        .fold(json.to_owned(), |json, (found, escaped)| json.replace(found, escaped))
}
