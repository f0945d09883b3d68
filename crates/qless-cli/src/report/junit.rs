//! JUnit XML, which build servers show as tests: a suite for each input, a test for each rule.

use std::fmt::Write;
use std::path::Path;

use qless::Report;

use super::findings::{Finding, Rule, findings};
use crate::diagnose::Diagnosis;
use crate::failure::CliFailure;

/// The text before the first suite, between two suites, and after the last suite.
pub const FRAME: [&str; 3] =
    ["<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"qless\">\n", "", "</testsuites>\n"];

/// The suite of a diagnosis. Findings that do not change the exit code are output of a test that passes.
pub fn suite(diagnosis: &Diagnosis, report: &Report) -> String {
    let found = findings(diagnosis, report);
    let of_rule = |rule: Rule| found.iter().filter(move |finding| finding.rule == rule);
    let fails = |rule: Rule| of_rule(rule).next().is_some() && rule.is_failure(diagnosis);
    let failures = Rule::ALL.into_iter().filter(|&rule| fails(rule)).count();
    let name = attribute(&diagnosis.args.input.to_string_lossy());
    let mut text =
        format!("<testsuite name={name} tests=\"{}\" failures=\"{failures}\" errors=\"0\">\n", Rule::ALL.len());
    for rule in Rule::ALL {
        let (id, meaning) = rule.words();
        let lines: Vec<&str> = of_rule(rule).map(|finding: &Finding| finding.message.as_str()).collect();
        let _ = write!(text, "<testcase classname={name} name=\"{id}\">");
        if fails(rule) {
            let message = attribute(&format!("{meaning}: {} found", lines.len()));
            let _ = write!(text, "<failure message={message}>{}</failure>", escaped(&lines.join("\n")));
        } else if !lines.is_empty() {
            let _ = write!(text, "<system-out>{}</system-out>", escaped(&lines.join("\n")));
        }
        text.push_str("</testcase>\n");
    }
    text.push_str("</testsuite>\n");
    text
}

/// The suite of an input that could not be analysed.
pub fn failed(input: &Path, failure: &CliFailure) -> String {
    let name = attribute(&input.to_string_lossy());
    let message = attribute(failure.message());
    format!(
        "<testsuite name={name} tests=\"1\" failures=\"0\" errors=\"1\">\n<testcase classname={name} name=\"analysis\">\
         <error message={message}></error></testcase>\n</testsuite>\n"
    )
}

fn attribute(text: &str) -> String {
    format!("\"{}\"", escaped(text).replace('\n', "&#10;"))
}

/// Escapes text for XML, which permits no control characters other than tabs and line ends.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' => out.push(c),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}
