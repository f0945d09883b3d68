//! Renders a diagnosis as text, JSON, an HTML page, nodes for ParaView, SARIF or JUnit.

mod findings;
mod html;
mod joined;
pub mod json;
mod junit;
mod repairs;
mod sarif;
pub mod text;
mod vtu;

use std::path::Path;
use std::time::Duration;

use qless::{ArgumentError, Form, Reduction, Report};
use qless_io::deck::clean::Plan;

pub use joined::Joined;
pub use repairs::RepairWords;

use crate::args::ReportFormat;
use crate::deck_input::DeckInput;
use crate::diagnose::Diagnosis;
use crate::failure::CliFailure;
use crate::terminal::{self, Progress};
use crate::wording::printable;

/// What the command did after the diagnosis.
pub enum CommandOutcome<'a> {
    /// The command was `check`. Holds the reason if `clean` could not write a deck.
    Checked(Option<&'a str>),
    /// `reduce` or `clean` wrote nothing because of the diagnosis.
    Refused,
    /// `reduce` wrote its files to this folder.
    Written(&'a Path),
    /// `clean` wrote a deck.
    Cleaned {
        /// Path of the cleaned deck.
        output: &'a Path,
        /// Whether a file stood there before.
        is_replaced: bool,
        /// What was changed.
        plan: &'a Plan,
        /// Number of claims that the solver dropped and that now hold.
        restored: usize,
    },
}

/// A reduction, its form, and the time that it took.
#[derive(Clone, Copy)]
pub struct Reduced<'a> {
    pub reduction: &'a Reduction,
    pub form: Form,
    pub time: Duration,
}

impl ReportFormat {
    /// Limit on the terms of all explanations in a report; 0 for text, which computes only the explanations that it shows, and for VTU,
    /// which shows none.
    pub fn terms(self) -> usize {
        if matches!(self, Self::Text | Self::Vtu) { 0 } else { Report::TERMS }
    }

    /// Limit on the terms of the explanations of all load cases together; 0 except for JSON, which alone lists those of every load case.
    pub fn case_terms(self) -> usize {
        if self == Self::Json { Report::TERMS } else { 0 }
    }

    /// Writes a report to standard output.
    pub fn show(self, report: &[u8]) -> Result<(), CliFailure> {
        if self == Self::Text { terminal::show_text(report) } else { terminal::show(report) }
    }

    /// Makes a report safe to show.
    fn printable(self, bytes: Vec<u8>) -> Vec<u8> {
        printable::report(bytes, matches!(self, Self::Json | Self::Html | Self::Sarif))
    }
}

impl Diagnosis<'_> {
    /// Prints the report.
    pub fn print(
        &self,
        reduced: Option<Reduced>,
        outcome: &CommandOutcome,
        progress: Progress,
    ) -> Result<(), CliFailure> {
        progress.stage("explaining");
        let bytes = self.render(reduced, outcome)?;
        drop(progress);
        self.warn();
        let format = self.report_args.format;
        format.show(&Joined::new(format, 1).whole(vec![(&self.args.input, bytes)]))
    }

    /// Writes the warnings of a deck to standard error, if the report does not list them.
    pub fn warn(&self) {
        if self.report_args.format == ReportFormat::Text {
            self.deck.iter().for_each(DeckInput::warn);
        }
    }

    /// The report in the requested format; control characters in names are replaced or escaped.
    pub fn render(&self, reduced: Option<Reduced>, outcome: &CommandOutcome) -> Result<Vec<u8>, CliFailure> {
        Ok(self.report_args.format.printable(self.render_as_named(reduced, outcome)?))
    }

    /// The report with all names as they are in the files.
    fn render_as_named(&self, reduced: Option<Reduced>, outcome: &CommandOutcome) -> Result<Vec<u8>, CliFailure> {
        let misfit =
            |error: &dyn std::fmt::Display| CliFailure::Resource(format!("the report cannot be made: {error}"));
        let report = self.report(reduced, self.report_args.format.terms()).map_err(|error| misfit(&error))?;
        let report = report.with_repairs(&self.analysis).map_err(|error| misfit(&error))?;
        match self.report_args.format {
            ReportFormat::Text => Ok(text::render(self, &report, outcome).into_bytes()),
            ReportFormat::Json => {
                let mut bytes = Vec::new();
                let deck = self.deck.as_ref().map(|deck| deck.report(&self.analysis));
                let file = self.is_one_of_several.then(|| self.args.input.to_string_lossy());
                json::write(&mut bytes, file.as_deref(), &report, deck)
                    .map_err(|error| CliFailure::from_stdout(&error))?;
                Ok(bytes)
            }
            ReportFormat::Sarif => Ok(sarif::run(self, &report).into_bytes()),
            ReportFormat::Junit => Ok(junit::suite(self, &report).into_bytes()),
            ReportFormat::Vtu => vtu::render(self, reduced.map(|reduced| reduced.reduction)),
            ReportFormat::Html => html::render(self, &report, outcome)
                .map(String::into_bytes)
                .map_err(|error| CliFailure::Resource(format!("the page cannot be made: {error}"))),
        }
    }

    fn report(&self, reduced: Option<Reduced>, terms: usize) -> Result<Report, ArgumentError> {
        let mut report = Report::new(&self.analysis, terms);
        if let Some(deck) = &self.deck {
            report = report.with_left_out(deck.left_out());
        }
        if let Some(near) = &self.near_dependence {
            report = report.with_near_dependence(&self.analysis, near, terms)?;
        }
        let (report, time) = match reduced {
            Some(Reduced { reduction, form, time }) => {
                let residual = self.analysis.residual(reduction)?;
                (report.with_reduction(reduction, residual).with_form(form), time)
            }
            None => (report, Duration::ZERO),
        };
        Ok(report.with_timings(self.read, time, self.start.elapsed()))
    }
}
