//! `qless explain`: why an equation is redundant or conflicting, why a DOF is fixed or a slave, and what would free it.

use std::process::ExitCode;

use qless::explanation::{Explanation, Freed, Member, Number};
use qless::report::{Certificate, RepairFinding, Term};
use qless::{Analysis, ConstraintSystem, Elimination, Form, Kind, Report};
use serde::Serialize;

use crate::args::{AnswerFormat, ExplainArgs, ReportArgs};
use crate::deck_input::Reaction;
use crate::diagnose::{Diagnosis, Question, diagnose};
use crate::failure::CliFailure;
use crate::preferences::Place;
use crate::report::text::{member_name, remainder};
use crate::report::{RepairWords, json};
use crate::terminal::{self, Progress};
use crate::wording::{self, count, label, number, printable};

/// Largest number of answers, and of members or terms in a list of the text.
const SHOWN: usize = 200;

/// Prints an explanation for each equation and DOF that is named; exit code 0.
pub fn run(args: &ExplainArgs) -> Result<ExitCode, CliFailure> {
    let progress = Progress::new(args.model.quiet);
    let report = &ReportArgs::default();
    let (options, preferences) = (args.model.options(), args.keep.preferences());
    let question = Question { report, options, preferences, choice: args.choice() };
    let diagnosis = diagnose(&args.model, question, &progress)?;
    let deck = diagnosis.deck.as_ref().map(|input| (&input.deck, &input.deck.model().cases()[input.case]));
    let places = crate::preferences::find(&args.what, &diagnosis.system, deck)?;
    progress.stage("explaining");
    let teller = Teller::new(&diagnosis, &places)?;
    let list = places.iter().take(SHOWN).map(|&place| teller.answer(place)).collect::<Result<_, _>>()?;
    drop(progress);
    let answers = Answers { schema: "qless.explain/1", more: places.len().saturating_sub(SHOWN), list };
    match args.format {
        AnswerFormat::Text => terminal::write(|out| out.write_all(answers.text().as_bytes()))?,
        AnswerFormat::Json => terminal::show_json(|out| json::lines(out, &answers))?,
    }
    Ok(ExitCode::SUCCESS)
}

#[derive(Serialize)]
struct Answers {
    schema: &'static str,
    #[serde(rename = "answers")]
    list: Vec<Answer>,
    /// Number of equations or DOFs without an answer, because too many are named.
    more: usize,
}

/// The answer about one equation or DOF.
#[derive(Default, Serialize)]
struct Answer {
    /// The row of an equation, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    row: Option<usize>,
    /// The column of a DOF, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    dof: Option<usize>,
    label: String,
    verdict: &'static str,
    /// The members of the explanation.
    because: Vec<Term>,
    /// [`Explanation::error`].
    because_error: f64,
    /// False if it may be possible to leave out a member; absent otherwise.
    #[serde(skip_serializing_if = "Option::is_none")]
    because_irreducible: Option<bool>,
    /// Equations and prescribed values, each of which would free the equation or DOF if it alone were left out.
    freed_by: Vec<String>,
    /// The repairs that cure the conflict.
    repairs: Vec<RepairFinding>,
    /// The solver's reactions to faults of the equation or DOF, in words.
    solver: Vec<String>,
    /// The whole answer in words, line by line.
    text: Vec<String>,
}

impl Answers {
    fn text(&self) -> String {
        let answers: Vec<String> = self.list.iter().map(|answer| answer.text.join("\n") + "\n").collect();
        let more = match self.more {
            0 => String::new(),
            more => format!("and {more} more: name one of them\n"),
        };
        answers.join("\n") + &more
    }
}

impl Answer {
    fn new(verdict: &'static str, first_line: String) -> Self {
        Self { verdict, text: vec![first_line], ..Self::default() }
    }
}

/// Explains equations and DOFs of one analysis.
struct Teller<'a> {
    diagnosis: &'a Diagnosis<'a>,
    system: &'a ConstraintSystem,
    analysis: &'a Analysis,
    repairs: Vec<RepairFinding>,
    reactions: Vec<Reaction>,
}

impl<'a> Teller<'a> {
    fn new(diagnosis: &'a Diagnosis, places: &[Place]) -> Result<Self, CliFailure> {
        let (system, analysis) = (&diagnosis.system, &diagnosis.analysis);
        let conflicts =
            |place: &Place| matches!(place, Place::Equation(row) if analysis.kinds()[*row] == Kind::Conflicting);
        let failed = |error| CliFailure::Resource(format!("repairs cannot be computed: {error}"));
        let repairs = if places.iter().any(conflicts) {
            Report::new(analysis, 0).with_repairs(analysis).map_err(failed)?.repairs
        } else {
            Vec::new()
        };
        let reactions = diagnosis.deck.as_ref().map(|deck| deck.reactions(&diagnosis.options)).unwrap_or_default();
        Ok(Self { diagnosis, system, analysis, repairs, reactions })
    }

    fn answer(&self, place: Place) -> Result<Answer, CliFailure> {
        let answer = match place {
            Place::Equation(row) => {
                Answer { row: Some(row + 1), label: self.system.equation_label(row), ..self.equation(row)? }
            }
            Place::Dof(dof) => Answer { dof: Some(dof + 1), label: self.system.dof_label(dof), ..self.dof(dof)? },
        };
        let concerns = |reaction: &&Reaction| match place {
            Place::Equation(row) => reaction.rows.contains(&row),
            Place::Dof(dof) => reaction.dofs.contains(&dof),
        };
        let solver: Vec<String> =
            self.reactions.iter().filter(concerns).map(|reaction| printable::line(&reaction.words)).collect();
        let mut text = answer.text;
        text.extend(solver.iter().map(|words| format!("{words}.")));
        Ok(Answer { solver, text, ..answer })
    }

    fn equation(&self, row: usize) -> Result<Answer, CliFailure> {
        let name = wording::equation(self.system, row);
        let explanation = self.analysis.explain(row).map_err(|error| CliFailure::Input(error.to_string()))?;
        let Some(explanation) = explanation else {
            let line = format!("{name} is independent: the other kept equations do not give it.");
            return Ok(Answer::new("independent", line));
        };
        let is_conflict = self.analysis.kinds()[row] == Kind::Conflicting;
        let mut answer = if is_conflict {
            let line = format!("{name} conflicts: these give its left side, but another right-hand side.");
            Answer::new("conflicting", line)
        } else {
            Answer::new("redundant", format!("{name} is redundant: these already say the same."))
        };
        self.add_members(&mut answer, &explanation);
        if is_conflict {
            answer.text.push(format!("  {}", explanation.arithmetic(self.system, row)));
            self.add_repairs(&mut answer, row + 1);
        }
        answer.freed_by = self.freed_by(Freed::Equation(row))?;
        match &answer.freed_by[..] {
            [] if is_conflict => {}
            [] => answer.text.push(
                "Leaving out a single equation or prescribed value does not make it independent: others imply each."
                    .to_owned(),
            ),
            names => answer.text.push(format!("Leaving out any one of these makes it independent: {}.", list(names))),
        }
        Ok(answer)
    }

    /// Adds the repairs that cure the conflicting equation `row`, from 1.
    fn add_repairs(&self, answer: &mut Answer, row: usize) {
        answer.repairs = self.repairs.iter().filter(|repair| repair.conflicts.contains(&row)).cloned().collect();
        for words in answer.repairs.iter().filter_map(RepairWords::new) {
            answer.text.push(words.heading(row));
            answer.text.extend(words.ways.iter().map(|way| format!("  {way}")));
            answer.text.extend((words.more > 0).then(|| format!("  and {} more, not verified", words.more)));
        }
    }

    fn dof(&self, dof: usize) -> Result<Answer, CliFailure> {
        let name = label(&self.system.dof_label(dof));
        if let Some(value) = self.system.prescribed_value(dof) {
            let place =
                self.system.prescribed_place(dof).map_or_else(String::new, |place| format!(", {}", label(place)));
            return Ok(Answer::new("prescribed", format!("{name} is prescribed: {}{place}.", number(value))));
        }
        let explanation = self.analysis.explain_fixed(dof).map_err(|error| unexplained(&name, &error))?;
        if let Some(explanation) = explanation {
            let value = number(explanation.right_hand_side);
            let mut answer =
                Answer::new("fixed", format!("{name} is fixed to {value}: these leave it no other value."));
            self.add_members(&mut answer, &explanation);
            answer.freed_by = self.freed_by(Freed::Dof(dof))?;
            answer.text.push(match &answer.freed_by[..] {
                [] => {
                    "Leaving out a single equation or prescribed value does not free it: others imply each.".to_owned()
                }
                names => format!("Leaving out any one of these frees it: {}.", list(names)),
            });
            return Ok(answer);
        }
        if !(0..self.system.equations()).any(|row| self.system.matrix().row(row).any(|(j, _)| j == dof)) {
            return Ok(Answer::new("unused", format!("{name} is in no equation.")));
        }
        if self.diagnosis.is_conflicting() {
            let line = format!("{name} is free. The equations conflict, so that none is chosen as a slave.");
            return Ok(Answer::new("free", line));
        }
        self.slave_or_master(dof, &name)
    }

    fn slave_or_master(&self, dof: usize, name: &str) -> Result<Answer, CliFailure> {
        let failed = |error: &dyn std::fmt::Display| unexplained(name, error);
        let analysis = qless::analyse(self.system, &self.diagnosis.options).map_err(|error| failed(&error))?;
        let elimination = Elimination::from_analysis(analysis, Form::Explicit).map_err(|error| failed(&error))?;
        let Some((terms, constant)) = elimination.row(dof).filter(|_| elimination.is_slave(dof)) else {
            let line =
                format!("{name} is a master of the reduced form: free, and no equation is needed to compute it.");
            return Ok(Answer::new("master", line));
        };
        let sum = self.sum(&terms, constant);
        let mut answer = Answer::new("slave", format!("{name} is a slave of the reduced form: {name} = {sum}."));
        let relation: Vec<(usize, f64)> =
            std::iter::once((dof, 1.0)).chain(terms.iter().map(|&(j, factor)| (j, -factor))).collect();
        if let Some(explanation) = self.analysis.explain_sum(&relation).map_err(|error| failed(&error))? {
            answer.text.push("These give that relation:".to_owned());
            self.add_members(&mut answer, &explanation);
        }
        answer.text.push(format!("Another DOF becomes the slave with `qless reduce --avoid-slaves {}`.", dof + 1));
        Ok(answer)
    }

    /// A sum of terms and a constant in words: `2 * 7:1 - 8:1 + 0.5`.
    fn sum(&self, terms: &[(usize, f64)], constant: f64) -> String {
        let mut text = String::new();
        let mut add = |factor: f64, name: Option<String>| {
            let sign = match (text.is_empty(), factor < 0.0) {
                (true, false) => "",
                (true, true) => "-",
                (false, true) => " - ",
                (false, false) => " + ",
            };
            let size = number(factor.abs());
            let what = match name {
                Some(name) if size == "1" => name,
                Some(name) => format!("{size} * {name}"),
                None => size,
            };
            text.extend([sign, &what]);
        };
        for &(j, factor) in terms.iter().take(SHOWN) {
            add(factor, Some(label(&self.system.dof_label(j))));
        }
        if constant != 0.0 || terms.is_empty() {
            add(constant, None);
        }
        if terms.len() > SHOWN { format!("{text} + {} more", terms.len() - SHOWN) } else { text }
    }

    /// Adds the members of an explanation, one line for each.
    fn add_members(&self, answer: &mut Answer, explanation: &Explanation) {
        let members = &explanation.members;
        let line = |&member: &Member| {
            let factor = member.coefficient();
            let sign = if factor < 0.0 { "-" } else { "+" };
            format!("  {sign} {} * {}", number(factor.abs()), member_name(self.system, member))
        };
        answer.because = Certificate::of_members(self.system, members).because;
        answer.because_error = explanation.error;
        answer.because_irreducible = (!explanation.is_irreducible).then_some(false);
        answer.text.extend(members.iter().take(SHOWN).map(line));
        if members.len() > SHOWN {
            answer.text.push(format!("  and {} more (all of them: --format json)", members.len() - SHOWN));
        }
        let left = remainder(explanation.error, self.diagnosis.options.tolerance);
        answer.text.extend(left.map(|line| format!("  {line}")));
    }

    fn freed_by(&self, freed: Freed) -> Result<Vec<String>, CliFailure> {
        let failed = |error| CliFailure::Resource(format!("what would free it cannot be computed: {error}"));
        let name = |number: &Number| match *number {
            Number::RightHandSide(row) => wording::equation(self.system, row),
            Number::Prescribed(dof) => format!("the value of {}", label(&self.system.dof_label(dof))),
            _ => String::new(),
        };
        Ok(self.analysis.what_frees(freed).map_err(failed)?.iter().map(name).collect())
    }
}

fn unexplained(name: &str, error: &dyn std::fmt::Display) -> CliFailure {
    CliFailure::Resource(format!("{name} cannot be explained: {error}"))
}

fn list(names: &[String]) -> String {
    /// Largest number of names in one sentence.
    const NAMES: usize = 12;
    let more = names.len().saturating_sub(NAMES);
    let tail = if more > 0 { format!(" and {}", count(more, "other")) } else { String::new() };
    format!("{}{tail}", names[..names.len() - more].join(", "))
}
