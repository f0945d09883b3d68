//! `qless explain`: why an equation is redundant or conflicting, why a DOF is fixed or a slave, and what would free it.

use std::process::ExitCode;

use qless::explanation::{Explanation, Freed, Member, Number};
use qless::{Analysis, ConstraintSystem, Elimination, Form, Kind};

use crate::args::ExplainArgs;
use crate::diagnose::{Diagnosis, Question, diagnose};
use crate::failure::CliFailure;
use crate::preferences::Place;
use crate::report::text::member_name;
use crate::terminal::{self, Progress};
use crate::wording::{self, count, label, number};

/// Most members or terms in a list; `--format json` of `check` has all.
const SHOWN: usize = 200;

/// Prints an explanation for each equation and DOF that is named; exit code 0.
pub fn run(args: &ExplainArgs) -> Result<ExitCode, CliFailure> {
    let progress = Progress::new(args.model.quiet);
    let question =
        Question { options: args.model.options(), preferences: args.model.preferences(), choice: args.choice() };
    let diagnosis = diagnose(&args.model, question, &progress)?;
    let deck = diagnosis.deck.as_ref().map(|input| (&input.deck, &input.deck.model().cases()[input.case]));
    let places = crate::preferences::find(&args.what, &diagnosis.system, deck)?;
    progress.stage("explaining");
    let teller = Teller { system: &diagnosis.system, analysis: &diagnosis.analysis };
    let mut lines = Vec::new();
    for (k, &place) in places.iter().take(SHOWN).enumerate() {
        if k > 0 {
            lines.push(String::new());
        }
        lines.extend(match place {
            Place::Equation(row) => teller.equation(row)?,
            Place::Dof(dof) => teller.dof(&diagnosis, dof)?,
        });
    }
    if places.len() > SHOWN {
        lines.push(format!("and {} more: name one of them", places.len() - SHOWN));
    }
    drop(progress);
    let text: String = lines.into_iter().map(|line| line + "\n").collect();
    terminal::write(|out| out.write_all(text.as_bytes()))?;
    Ok(ExitCode::SUCCESS)
}

/// Explains equations and DOFs of one analysis.
struct Teller<'a> {
    system: &'a ConstraintSystem,
    analysis: &'a Analysis,
}

impl Teller<'_> {
    fn equation(&self, row: usize) -> Result<Vec<String>, CliFailure> {
        let name = wording::equation(self.system, row);
        let explanation = self.analysis.explain(row).map_err(|error| CliFailure::Input(error.to_string()))?;
        let Some(explanation) = explanation else {
            return Ok(vec![format!("{name} is independent: the other kept equations do not give it.")]);
        };
        let (verdict, kind) = match self.analysis.kinds()[row] {
            Kind::Conflicting => {
                ("conflicts: these give its left side, but another right-hand side.", Kind::Conflicting)
            }
            kind => ("is redundant: these already say the same.", kind),
        };
        let mut lines = vec![format!("{name} {verdict}")];
        lines.extend(self.members(&explanation));
        if kind == Kind::Conflicting {
            lines.push(format!("  {}", explanation.arithmetic(self.system, row)));
        }
        let frees = self.frees(Freed::Equation(row))?;
        lines.push(match frees.as_slice() {
            [] => {
                "No single equation or prescribed value makes it independent if left out: others imply each.".to_owned()
            }
            _ => format!("It is independent without any one of: {}.", self.list(&frees)),
        });
        Ok(lines)
    }

    fn dof(&self, diagnosis: &Diagnosis, dof: usize) -> Result<Vec<String>, CliFailure> {
        let name = label(&self.system.dof_label(dof));
        if let Some(value) = self.system.prescribed_value(dof) {
            let place =
                self.system.prescribed_place(dof).map_or_else(String::new, |place| format!(", {}", label(place)));
            return Ok(vec![format!("{name} is prescribed: {}{place}.", number(value))]);
        }
        let failed =
            |error: &dyn std::fmt::Display| CliFailure::Resource(format!("{name} cannot be explained: {error}"));
        if let Some(explanation) = self.analysis.explain_fixed(dof).map_err(|error| failed(&error))? {
            let value = number(explanation.right_hand_side);
            let mut lines = vec![format!("{name} is fixed to {value}: these leave it no other value.")];
            lines.extend(self.members(&explanation));
            let frees = self.frees(Freed::Dof(dof))?;
            lines.push(match frees.as_slice() {
                [] => "No single equation or prescribed value frees it if left out: others imply each.".to_owned(),
                _ => format!("It is free without any one of: {}.", self.list(&frees)),
            });
            return Ok(lines);
        }
        if !(0..self.system.equations()).any(|row| self.system.matrix().row(row).any(|(j, _)| j == dof)) {
            return Ok(vec![format!("{name} is in no equation.")]);
        }
        if diagnosis.is_conflicting() {
            return Ok(vec![format!("{name} is free. The equations conflict, so that none is chosen as a slave.")]);
        }
        let analysis = qless::analyse(self.system, &diagnosis.options).map_err(|error| failed(&error))?;
        let elimination = Elimination::from_analysis(analysis, Form::Explicit).map_err(|error| failed(&error))?;
        let Some((terms, constant)) = elimination.row(dof).filter(|_| elimination.is_slave(dof)) else {
            return Ok(vec![format!("{name} is a master: free, and no equation is needed to compute it.")]);
        };
        let mut lines = vec![format!("{name} is a slave: {name} = {}.", self.sum(&terms, constant))];
        let relation: Vec<(usize, f64)> =
            std::iter::once((dof, 1.0)).chain(terms.iter().map(|&(j, factor)| (j, -factor))).collect();
        if let Some(explanation) = self.analysis.explain_sum(&relation).map_err(|error| failed(&error))? {
            lines.push("These give that relation:".to_owned());
            lines.extend(self.members(&explanation));
        }
        lines.push(format!("Another DOF becomes the slave with `qless reduce --avoid-slaves {}`.", dof + 1));
        Ok(lines)
    }

    /// ` 2 * 7:1 - 1 * 8:1 + 0.5`.
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

    /// One line for each member.
    fn members(&self, explanation: &Explanation) -> Vec<String> {
        let members = &explanation.members;
        let line = |&member: &Member| {
            let factor = member.coefficient();
            let sign = if factor < 0.0 { "-" } else { "+" };
            format!("  {sign} {} * {}", number(factor.abs()), member_name(self.system, member))
        };
        let mut lines: Vec<String> = members.iter().take(SHOWN).map(line).collect();
        if members.len() > SHOWN {
            lines.push(format!("  and {} more (all of them: qless check --format json)", members.len() - SHOWN));
        }
        lines
    }

    fn frees(&self, freed: Freed) -> Result<Vec<Number>, CliFailure> {
        let failed = |error| CliFailure::Resource(format!("what would free it cannot be computed: {error}"));
        self.analysis.what_frees(freed).map_err(failed)
    }

    fn list(&self, numbers: &[Number]) -> String {
        /// Most names in one sentence.
        const NAMES: usize = 12;
        let name = |number: &Number| match *number {
            Number::RightHandSide(row) => wording::equation(self.system, row),
            Number::Prescribed(dof) => format!("the value of {}", label(&self.system.dof_label(dof))),
            _ => String::new(),
        };
        let names: Vec<String> = numbers.iter().take(NAMES).map(name).collect();
        let more = numbers.len().saturating_sub(NAMES);
        let tail = if more > 0 { format!(" and {}", count(more, "other")) } else { String::new() };
        format!("{}{tail}", names.join(", "))
    }
}
