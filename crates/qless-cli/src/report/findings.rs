//! The findings of a diagnosis as a flat list, each with a rule and a place: the content of SARIF and JUnit.

use qless::report::{DependentEquation, Term};
use qless::{Kind, Report};

use super::repairs::RepairWords;
use crate::args::Deny;
use crate::deck_input::DeckInput;
use crate::diagnose::Diagnosis;

/// The kinds of findings, in the order in which SARIF and JUnit list them.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    Conflicting,
    Refused,
    Unsound,
    Lost,
    Dropped,
    Redundant,
    Ambiguous,
    Incomplete,
}

impl Rule {
    pub const ALL: [Self; 8] = [
        Self::Conflicting,
        Self::Refused,
        Self::Unsound,
        Self::Lost,
        Self::Dropped,
        Self::Redundant,
        Self::Ambiguous,
        Self::Incomplete,
    ];

    /// The identifier of the rule, and its meaning.
    pub fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Conflicting => ("conflicting", "Equations have no solution"),
            Self::Refused => ("refused", "The solver stops at two claims on one DOF"),
            Self::Unsound => ("unsound", "The solver may continue, but its results are unreliable"),
            Self::Lost => ("lost", "The solver drops a claim that does not follow from the rest"),
            Self::Dropped => ("dropped", "The solver drops a claim, which follows from what it keeps"),
            Self::Redundant => ("redundant", "An equation is a combination of others, which already say the same"),
            Self::Ambiguous => ("ambiguous", "The rank or the verdict may be wrong"),
            Self::Incomplete => ("incomplete", "A constraint of the deck was left out"),
        }
    }

    /// Whether a finding of this rule ends the program with another exit code than 0.
    pub fn is_failure(self, diagnosis: &Diagnosis) -> bool {
        let denied = |what| diagnosis.report_args.deny.contains(&what);
        match self {
            Self::Conflicting => true,
            Self::Unsound => false,
            Self::Refused => denied(Deny::Refused),
            Self::Lost => denied(Deny::Dropped) || denied(Deny::Lost),
            Self::Dropped => denied(Deny::Dropped),
            Self::Redundant => denied(Deny::Redundant),
            Self::Ambiguous => denied(Deny::Ambiguous),
            Self::Incomplete => denied(Deny::Incomplete) || !diagnosis.report_args.allow_incomplete,
        }
    }
}

/// One finding.
pub struct Finding {
    pub rule: Rule,
    pub message: String,
    /// Place of the finding, as in a label: `line 41 *TIE 3:1`.
    pub label: String,
    /// The equations and prescribed values that explain the finding.
    pub because: Vec<String>,
}

/// Largest number of members of an explanation that a message names.
const NAMED: usize = 5;

/// All findings of a diagnosis, in the order of [`Rule::ALL`].
pub fn findings(diagnosis: &Diagnosis, report: &Report) -> Vec<Finding> {
    let repairs = RepairWords::all(report);
    let cure =
        |row: usize| repairs.iter().find(|repair| repair.rows.binary_search(&row).is_ok()).map(RepairWords::short);
    let mut all: Vec<Finding> = report.dependent.iter().map(|equation| of_equation(equation, &cure)).collect();
    let plain = |rule, text: String| Finding { rule, label: text.clone(), message: text, because: Vec::new() };
    let claims = diagnosis.deck.as_ref().map(DeckInput::claims).unwrap_or_default();
    all.extend(claims.refused.iter().map(|words| plain(Rule::Refused, words.clone())));
    all.extend(claims.unsound.iter().map(|words| plain(Rule::Unsound, words.clone())));
    all.extend(claims.lost.iter().map(|claim| plain(Rule::Lost, claim.words())));
    all.extend(claims.implied.iter().map(|claim| plain(Rule::Dropped, claim.words())));
    if report.confidence.ambiguous || diagnosis.deck.as_ref().is_some_and(DeckInput::is_ambiguous) {
        let text = format!("rank {} is ambiguous: the report of `qless check` says why", report.rank);
        all.push(Finding { label: String::new(), ..plain(Rule::Ambiguous, text) });
    }
    all.extend(report.incomplete.iter().map(|words| plain(Rule::Incomplete, words.clone())));
    all.sort_by_key(|finding| Rule::ALL.iter().position(|rule| *rule == finding.rule));
    all
}

/// The finding about a dependent equation. `cure` names the repair of a conflicting row.
fn of_equation(equation: &DependentEquation, cure: &dyn Fn(usize) -> Option<String>) -> Finding {
    let name = |term: &Term| match term {
        Term::Prescribed { label, value, place, .. } => {
            format!("[{label} = {value}{}]", place.as_ref().map_or_else(String::new, |place| format!(", {place}")))
        }
        Term::Equation { label, .. } => label.clone(),
        _ => String::new(),
    };
    let because: Vec<String> = equation.certificate.because.iter().map(name).collect();
    let first = because.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", ");
    let named = if because.len() > NAMED { format!("{first} and {} more", because.len() - NAMED) } else { first };
    let label = equation.label.clone();
    let (rule, message) = match (equation.kind, &equation.arithmetic) {
        (Kind::Conflicting, sum) => {
            let sum = sum.as_ref().map_or_else(String::new, |sum| format!(": {sum}"));
            let cure = cure(equation.row).map_or_else(String::new, |cure| format!("; {cure}"));
            (Rule::Conflicting, format!("{label} contradicts {named}{sum}{cure}"))
        }
        _ if named.is_empty() => (Rule::Redundant, format!("{label} has no free DOF, and holds")),
        _ => (Rule::Redundant, format!("{label} follows from {named}")),
    };
    Finding { rule, message, label, because }
}
