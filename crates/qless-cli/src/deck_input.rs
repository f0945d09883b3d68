//! A deck as input: its load cases, its warnings, and what its solver refuses though the equations are independent.

use qless::{Analysis, ConstraintSystem, Kind};
use qless_io::deck::clean::faults_in;
use qless_io::deck::{Deck, Dof, Load};
use serde::Serialize;

use crate::diagnose::Diagnosis;
use crate::failure::{Failure, say};

/// Warnings and findings shown at most; JSON has all of them.
const SHOWN: usize = 5;
const LINES: usize = 3;

/// A deck, and the load case that the report is about.
pub struct DeckInput {
    pub deck: Deck,
    /// The load case with the worst diagnosis, the first of them.
    pub case: usize,
    /// The other load cases that have another diagnosis: name and what they are.
    others: Vec<String>,
}

/// What JSON says of a deck beyond the report.
#[derive(Serialize)]
pub struct DeckReport {
    load_case: String,
    other_load_cases: Vec<String>,
    solver_refuses: Vec<String>,
    loads_without_effect: Vec<String>,
    warnings: Vec<String>,
}

type Run<'a> = &'a dyn Fn(&ConstraintSystem) -> Result<Analysis, Failure>;

impl DeckInput {
    /// Analyses every load case and keeps the worst.
    pub fn analyse(deck: Deck, run: Run) -> Result<(ConstraintSystem, Analysis, Option<Self>), Failure> {
        let path = deck.model().files()[0].display().to_string();
        let mut worst: Option<(usize, ConstraintSystem, Analysis)> = None;
        let mut found = Vec::new();
        for (k, case) in deck.model().cases().iter().enumerate() {
            if k > 0 && case.constrains_as(&deck.model().cases()[k - 1]) {
                continue;
            }
            let system = deck.model().system(case).map_err(|error| Failure::Input(format!("{path}: {error}")))?;
            let analysis = run(&system)?;
            found.push((k, summary(&case.name, &analysis)));
            if worst.as_ref().is_none_or(|(_, _, before)| badness(&analysis) > badness(before)) {
                worst = Some((k, system, analysis));
            }
        }
        let Some((case, system, analysis)) = worst else {
            return Err(Failure::Input(format!("{path}: the deck has no load case")));
        };
        let others = found.into_iter().filter(|(k, _)| *k != case).map(|(_, summary)| summary).collect();
        Ok((system, analysis, Some(Self { deck, case, others })))
    }

    /// What the solver would refuse or swallow, besides dependent equations.
    fn findings(&self) -> Vec<String> {
        let model = self.deck.model();
        let found = faults_in(model, &model.cases()[self.case]);
        found.iter().map(|fault| fault.describe(model)).collect()
    }

    /// Whether the solver refuses the deck although its equations are consistent.
    pub fn is_refused_by_solver(&self) -> bool {
        !self.findings().is_empty()
    }

    /// Lines of the report for people.
    pub fn lines(&self, diagnosis: &Diagnosis) -> Vec<String> {
        let mut lines = Vec::new();
        if self.deck.model().cases().len() > 1 {
            lines.push(format!(
                "Load case: {} of {}.",
                self.deck.model().cases()[self.case].name,
                self.deck.model().cases().len()
            ));
            lines.extend(self.others.iter().take(LINES).map(|other| format!("  Otherwise {other}.")));
        }
        lines.extend(section("The solver refuses, as they stand:", &self.findings()));
        lines.extend(section(
            "Loads without effect, on DOFs that the equations fix:",
            &self.swallowed(&diagnosis.analysis),
        ));
        lines
    }

    /// Loads on DOFs that the equations fix.
    fn swallowed(&self, analysis: &Analysis) -> Vec<String> {
        let model = self.deck.model();
        let is_fixed = |dof: Dof| {
            let column = model.column(dof).map(|j| j as usize);
            column.is_some_and(|j| analysis.generated().binary_search_by_key(&j, |fixed| fixed.0).is_ok())
        };
        let name = |load: &Load| format!("{} in {}", load.dof, model.place(load.origin));
        model.cases()[self.case].loads.iter().filter(|load| is_fixed(load.dof)).map(name).collect()
    }

    /// Says on standard error what was not understood.
    pub fn warn(&self) {
        let warnings = self.warnings();
        warnings.iter().take(SHOWN).for_each(|warning| say(format_args!("warning: {warning}")));
        if warnings.len() > SHOWN {
            say(format_args!("warning: and {} more (all of them: --format json)", warnings.len() - SHOWN));
        }
    }

    fn warnings(&self) -> Vec<String> {
        let model = self.deck.model();
        let place = |file: u32, line: u32| match line {
            0 => model.files()[file as usize].display().to_string(),
            _ => format!("{}:{line}", model.files()[file as usize].display()),
        };
        model.warnings().iter().map(|w| format!("{}: {}", place(w.file, w.line), w.text)).collect()
    }

    /// For JSON.
    pub fn report(&self, analysis: &Analysis) -> DeckReport {
        DeckReport {
            load_case: self.deck.model().cases()[self.case].name.clone(),
            other_load_cases: self.others.clone(),
            solver_refuses: self.findings(),
            loads_without_effect: self.swallowed(analysis),
            warnings: self.warnings(),
        }
    }
}

fn section(heading: &str, findings: &[String]) -> Vec<String> {
    if findings.is_empty() {
        return Vec::new();
    }
    let mut lines = vec![heading.to_owned()];
    lines.extend(findings.iter().take(LINES).map(|finding| format!("  {finding}")));
    if findings.len() > LINES {
        lines.push(format!("  and {} more (all of them: --format json)", findings.len() - LINES));
    }
    lines
}

/// Conflicts weigh more than redundancies.
fn badness(analysis: &Analysis) -> (usize, usize) {
    let of = |kind| analysis.dependent().iter().filter(|dependent| dependent.kind == kind).count();
    (of(Kind::Conflicting), of(Kind::Redundant))
}

fn summary(name: &str, analysis: &Analysis) -> String {
    let (conflicting, redundant) = badness(analysis);
    format!("{name}: {} independent, {redundant} redundant, {conflicting} conflicting", analysis.rank())
}
