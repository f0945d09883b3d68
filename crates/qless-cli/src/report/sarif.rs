//! SARIF 2.1.0, which code hosts and editors show beside the lines of a deck: one run for each input.

use std::path::{Path, PathBuf};

use qless::Report;
use serde_json::{Value, json};

use super::findings::{Finding, Rule, findings};
use crate::diagnose::Diagnosis;
use crate::failure::CliFailure;

/// The document around runs, which a comma separates.
pub const FRAME: [&str; 3] = [
    "{\"version\": \"2.1.0\", \"$schema\": \"https://json.schemastore.org/sarif-2.1.0.json\", \"runs\": [\n",
    ",\n",
    "]}\n",
];

/// The run of a diagnosis.
pub fn run(diagnosis: &Diagnosis, report: &Report) -> String {
    let files: Vec<&Path> = match &diagnosis.deck {
        Some(deck) => deck.deck.model().files().iter().map(PathBuf::as_path).collect(),
        None => vec![&diagnosis.args.input],
    };
    let results = findings(diagnosis, report).into_iter().map(|finding| result(diagnosis, &files, &finding));
    let results: Vec<Value> = results.collect();
    json!({"tool": tool(), "invocations": [{"executionSuccessful": true}], "results": results}).to_string()
}

/// The run of an input that could not be analysed.
pub fn failed(input: &Path, failure: &CliFailure) -> String {
    let location = json!({"physicalLocation": {"artifactLocation": {"uri": uri(input)}}});
    let message = json!({"text": failure.message()});
    let notification = json!({"level": "error", "message": message, "locations": [location]});
    let invocation = json!({"executionSuccessful": false, "toolExecutionNotifications": [notification]});
    json!({"tool": tool(), "invocations": [invocation], "results": []}).to_string()
}

fn tool() -> Value {
    let rule = |rule: Rule| {
        let (id, text) = rule.words();
        json!({"id": id, "shortDescription": {"text": text}})
    };
    let rules: Vec<Value> = Rule::ALL.into_iter().map(rule).collect();
    json!({"driver": {"name": "qless", "version": env!("CARGO_PKG_VERSION"), "rules": rules}})
}

fn result(diagnosis: &Diagnosis, files: &[&Path], finding: &Finding) -> Value {
    let level = match finding.rule {
        rule if rule.is_failure(diagnosis) => "error",
        Rule::Redundant => "note",
        _ => "warning",
    };
    let related: Vec<Value> = finding.because.iter().map(|label| location(files, label)).collect();
    let mut result = json!({
        "ruleId": finding.rule.words().0, "level": level, "message": {"text": finding.message},
        "locations": [location(files, &finding.label)]});
    if !related.is_empty() {
        result["relatedLocations"] = Value::Array(related);
    }
    result
}

/// The file, the line if the label has one, and the label as the name of the place.
fn location(files: &[&Path], label: &str) -> Value {
    let (file, line) = place(files, label);
    let mut physical = json!({"artifactLocation": {"uri": uri(file)}});
    if let Some(line) = line {
        physical["region"] = json!({"startLine": line});
    }
    let mut location = json!({"physicalLocation": physical});
    if !label.is_empty() {
        location["logicalLocations"] = json!([{"name": label}]);
    }
    location
}

/// The file and line that a label names: `part.inc:41`, or else `line 41` of the main file.
fn place<'a>(files: &[&'a Path], label: &str) -> (&'a Path, Option<usize>) {
    let number = |text: &str| {
        let digits = text.bytes().take_while(u8::is_ascii_digit).count();
        text[..digits].parse::<usize>().ok().filter(|&line| line > 0)
    };
    let named = files.iter().find_map(|&file| {
        let name = format!("{}:", file.file_name()?.to_string_lossy());
        let line = number(&label[label.find(&name)? + name.len()..])?;
        Some((file, Some(line)))
    });
    let main = || (files[0], label.find("line ").and_then(|at| number(&label[at + "line ".len()..])));
    named.unwrap_or_else(main)
}

/// A relative or absolute reference; what a URI reserves is written in hexadecimal.
fn uri(path: &Path) -> String {
    let written = |&byte: &u8| match byte {
        b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'/' | b'-' | b'.' | b'_' | b'~' => char::from(byte).to_string(),
        _ => format!("%{byte:02X}"),
    };
    path.to_string_lossy().as_bytes().iter().map(written).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read_from_labels() {
        let files = [Path::new("models/plate.inp"), Path::new("models/part.inc")];
        let cases = [
            ("line 41 *TIE 3:1", (files[0], Some(41))),
            ("part.inc:7 *EQUATION 2:3", (files[1], Some(7))),
            ("1:3 is the slave of line 9 *EQUATION and prescribed in line 12 *BOUNDARY", (files[0], Some(9))),
            ("tie 7", (files[0], None)),
            ("line zero", (files[0], None)),
        ];
        cases.into_iter().for_each(|(label, expected)| assert_eq!(place(&files, label), expected, "{label}"));
        assert_eq!(uri(Path::new("a b/ä%.inp")), "a%20b/%C3%A4%25.inp");
    }
}
