//! The report as one page that needs nothing else: the template with the report and a picture of the system as JSON in it.

mod picture;

use qless::Report;
use serde::Serialize;

use crate::deck_input::DeckReport;
use crate::diagnose::Diagnosis;
use crate::text;
use picture::Picture;

const PAGE: &str = include_str!("page.html");

/// What the page shows.
#[derive(Serialize)]
struct Data<'a> {
    name: String,
    verdict: String,
    version: &'static str,
    report: &'a Report,
    exact: Vec<String>,
    deck: Option<DeckReport>,
    picture: Picture,
}

/// The page.
pub fn render(diagnosis: &Diagnosis, report: &Report) -> Result<String, serde_json::Error> {
    let input = &diagnosis.args.input;
    let data = Data {
        name: input.file_name().unwrap_or(input.as_os_str()).to_string_lossy().into_owned(),
        verdict: text::verdict(report),
        version: env!("CARGO_PKG_VERSION"),
        report,
        exact: text::exact(diagnosis, report),
        deck: diagnosis.deck.as_ref().map(|deck| deck.report(&diagnosis.analysis)),
        picture: Picture::of(diagnosis),
    };
    // A label must not end the script that holds it.
    let json = serde_json::to_string(&data)?.replace("</", "<\\/").replace("<!--", "<\\!--");
    Ok(PAGE.replacen("__DATA__", &json, 1))
}
