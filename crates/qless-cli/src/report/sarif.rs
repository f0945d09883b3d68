//! SARIF 2.1.0, which code hosts and editors show beside the lines of a deck: one run for each input.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use qless::Report;
use serde_json::{Value, json};

use super::findings::{Finding, Rule, findings};
use crate::diagnose::Diagnosis;
use crate::failure::CliFailure;

/// The text before the first run, between two runs, and after the last run.
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
    let because = finding.because.iter().map(|label| location(place(files, label), label));
    // A claim names two cards: the first is its place.
    let own = places(files, &finding.label);
    let others = own.iter().skip(1).filter(|&place| *place != own[0]).map(|&place| location(place, ""));
    let related: Vec<Value> = others.chain(because).collect();
    let mut result = json!({
        "ruleId": finding.rule.words().0, "level": level, "message": {"text": finding.message},
        "locations": [location(place(files, &finding.label), &finding.label)]});
    if !related.is_empty() {
        result["relatedLocations"] = Value::Array(related);
    }
    result
}

/// A location in SARIF: a file, a line if it is known, and the label as the name of the place.
fn location((file, line): (&Path, usize), label: &str) -> Value {
    let mut physical = json!({"artifactLocation": {"uri": uri(file)}});
    if line > 0 {
        physical["region"] = json!({"startLine": line});
    }
    let mut location = json!({"physicalLocation": physical});
    if !label.is_empty() {
        location["logicalLocations"] = json!([{"name": label}]);
    }
    location
}

/// The first place that a label names, or else the main file with line 0.
fn place<'a>(files: &[&'a Path], label: &str) -> (&'a Path, usize) {
    places(files, label).first().copied().unwrap_or((files[0], 0))
}

/// The files and lines that a text names, in its order: `part.inc:41`, and `line 41` of the main file.
fn places<'a>(files: &[&'a Path], text: &str) -> Vec<(&'a Path, usize)> {
    let named = files.iter().filter_map(|&file| Some((file, format!("{}:", file.file_name()?.to_string_lossy()))));
    let mut found = BTreeMap::new();
    for (file, name) in named.chain([(files[0], "line ".to_owned())]) {
        for (at, _) in text.match_indices(&name) {
            let number = &text[at + name.len()..];
            let digits = number.bytes().take_while(u8::is_ascii_digit).count();
            let starts =
                text[..at].chars().next_back().is_none_or(|before| before.is_whitespace() || "/\\".contains(before));
            if let Some(line) = number[..digits].parse().ok().filter(|&line| starts && line > 0) {
                found.entry(at).or_insert((file, line));
            }
        }
    }
    found.into_values().collect()
}

/// A path as a relative or absolute URI; bytes that a URI reserves are written in hexadecimal.
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
            ("line 41 *TIE 3:1", vec![(files[0], 41)]),
            ("part.inc:7 *EQUATION 2:3", vec![(files[1], 7)]),
            (
                "1:3 is the slave of line 9 *EQUATION, and prescribed in part.inc:12 *BOUNDARY",
                vec![(files[0], 9), (files[1], 12)],
            ),
            ("models/plate.inp:14: *MPC is not known", vec![(files[0], 14)]),
            ("[4:1 = 0.5, line 17 *BOUNDARY]", vec![(files[0], 17)]),
            ("tie 7 of beamline 4", vec![]),
            ("line zero, counterpart.inc:3", vec![]),
        ];
        cases.into_iter().for_each(|(label, expected)| assert_eq!(places(&files, label), expected, "{label}"));
        assert_eq!(place(&files, "tie 7"), (files[0], 0));
        assert_eq!(uri(Path::new("a b/ä%.inp")), "a%20b/%C3%A4%25.inp");
    }
}
