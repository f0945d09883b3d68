//! Joins the reports of several inputs to one document.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::{junit, sarif};
use crate::args::ReportFormat;
use crate::failure::CliFailure;
use crate::wording::{count, printable};

/// The document of one format for a number of inputs.
pub struct Joined {
    format: ReportFormat,
    is_several: bool,
}

impl Joined {
    pub fn new(format: ReportFormat, inputs: usize) -> Self {
        Self { format, is_several: inputs > 1 }
    }

    /// Whether the document has a place for inputs that could not be analysed.
    pub fn shows_failures(&self) -> bool {
        self.is_several || matches!(self.format, ReportFormat::Sarif | ReportFormat::Junit)
    }

    /// The report of an input that could not be analysed.
    pub fn failed(&self, input: &Path, failure: &CliFailure) -> Vec<u8> {
        let text = match self.format {
            ReportFormat::Sarif => sarif::failed(input, failure),
            ReportFormat::Junit => junit::failed(input, failure),
            ReportFormat::Json => {
                json!({"file": input.to_string_lossy(), "error": failure.message(), "code": failure.code()}).to_string()
            }
            _ => format!("Not checked: {}\n", failure.message()),
        };
        self.format.printable(text.into_bytes())
    }

    /// The document; `pieces` are the reports, each with its input.
    pub fn whole(&self, pieces: Vec<(&PathBuf, Vec<u8>)>) -> Vec<u8> {
        let [before, between, after] = match self.format {
            ReportFormat::Sarif => sarif::FRAME,
            ReportFormat::Junit => junit::FRAME,
            ReportFormat::Json if self.is_several => ["[\n", ",\n", "]\n"],
            _ => ["", "\n", ""],
        };
        let mut document = before.as_bytes().to_vec();
        for (k, (input, piece)) in pieces.into_iter().enumerate() {
            document.extend_from_slice(if k > 0 { between.as_bytes() } else { b"" });
            if self.is_several && self.format == ReportFormat::Text {
                document.extend_from_slice(format!("== {}\n", printable::line(&input.to_string_lossy())).as_bytes());
            }
            document.extend_from_slice(&piece);
        }
        document.extend_from_slice(after.as_bytes());
        document
    }

    /// A summary of several inputs: `3 inputs: nothing to mend in 1`, and a line for each other input,
    /// `  a.inp: 2 redundant equations, 5 refused claims`.
    pub fn summary(inputs: &[(&Path, Vec<String>)]) -> String {
        let (good, others): (Vec<_>, Vec<_>) = inputs.iter().partition(|(_, findings)| findings.is_empty());
        let line = |(input, findings): &(&Path, Vec<String>)| {
            format!("\n  {}: {}", printable::line(&input.to_string_lossy()), findings.join(", "))
        };
        let lines: String = others.into_iter().map(line).collect();
        format!("{}: nothing to mend in {}{lines}", count(inputs.len(), "input"), good.len())
    }
}
