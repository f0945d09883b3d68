//! The report on a diagnosis: as text, JSON, a page for browsers, or nodes for ParaView.

mod html;
pub mod json;
pub mod text;
mod vtu;

use std::path::Path;
use std::time::Duration;

use qless::{ArgumentError, Form, Reduction, Report};

use crate::args::Format;
use crate::deck_input::DeckInput;
use crate::diagnose::Diagnosis;
use crate::failure::CliFailure;
use crate::terminal::{self, Progress};

/// The action of the command after the diagnosis.
pub enum Outcome<'a> {
    /// None: it was `check`. Holds the reason if `clean` could not write a deck.
    Checked(Option<&'a str>),
    /// `reduce` wrote nothing because of what was found.
    Refused,
    /// `reduce` wrote its files to this folder.
    Written(&'a Path),
    /// `clean` wrote a deck.
    Cleaned {
        /// The deck.
        output: &'a Path,
        /// Equations taken out because they are redundant.
        removed: usize,
        /// Equations that took the place of others.
        written: usize,
        /// Claims that the solver dropped and that now hold.
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

impl Diagnosis<'_> {
    /// Prints the report.
    pub fn print(&self, reduced: Option<Reduced>, outcome: &Outcome, progress: Progress) -> Result<(), CliFailure> {
        progress.stage("explaining");
        let bytes = self.render(reduced, outcome)?;
        drop(progress);
        if self.args.format == Format::Text {
            self.deck.iter().for_each(DeckInput::warn);
        }
        terminal::write(|out| out.write_all(&bytes))
    }

    /// The report in the form that was asked for.
    pub fn render(&self, reduced: Option<Reduced>, outcome: &Outcome) -> Result<Vec<u8>, CliFailure> {
        let terms = if self.args.format == Format::Text { 0 } else { Report::TERMS };
        let misfit = |error| CliFailure::Resource(format!("the report cannot be made: {error}"));
        let report = self.report(reduced, terms).map_err(misfit)?;
        match self.args.format {
            Format::Text => Ok(text::render(self, &report, outcome).into_bytes()),
            Format::Json => {
                let mut bytes = Vec::new();
                let deck = self.deck.as_ref().map(|deck| deck.report(&self.analysis));
                json::write(&mut bytes, &report, deck).map_err(|error| CliFailure::of_stdout(&error))?;
                Ok(bytes)
            }
            Format::Vtu => vtu::render(self, reduced.map(|reduced| reduced.reduction)),
            Format::Html => html::render(self, &report)
                .map(String::into_bytes)
                .map_err(|error| CliFailure::Resource(format!("the page cannot be made: {error}"))),
        }
    }

    fn report(&self, reduced: Option<Reduced>, terms: usize) -> Result<Report, ArgumentError> {
        let mut report = Report::new(&self.analysis, terms);
        if let Some(deck) = &self.deck {
            report = report.with_left_out(deck.left_out());
        }
        if let Some(exact) = &self.exact {
            report = report.with_exact(&self.analysis, exact)?;
        }
        if let Some(meant) = &self.meant {
            report = report.with_near_dependence(&self.analysis, meant, terms)?;
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
