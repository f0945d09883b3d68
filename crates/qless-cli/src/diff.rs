//! `qless diff`: compares the solutions of two sets of equations, and lists the equations in which the sets differ.
//!
//! Every equation and prescribed value of one set is evaluated at solutions of the other: at its particular solution and at random ones. An
//! equation that follows from the other set holds at all of them to rounding; any other equation fails at a random one with probability 1.

use std::collections::HashMap;
use std::process::ExitCode;

use qless::common::SplitMix64;
use qless::{ConstraintSystem, Elimination, Form, analyse};
use serde::Serialize;
use serde_json::json;

use crate::args::{AnswerFormat, DiffArgs, ModelArgs, ReportArgs};
use crate::deck_input::LoadCaseChoice;
use crate::diagnose::{Diagnosis, Question, diagnose};
use crate::exit_code;
use crate::failure::CliFailure;
use crate::preferences::PreferenceLists;
use crate::report::json;
use crate::terminal::{self, Progress};
use crate::wording::printable;
use crate::wording::{count, equation, label, number};

/// Random solutions, beside the one whose masters are zero.
const RANDOM: usize = 2;
/// An equation holds if its residual is at most this fraction of its largest term. An equation that follows from the other set leaves
/// rounding errors times the growth of T.
const HOLDS: f64 = 1e-9;
/// Rounding of a solution, relative to its largest entry.
const ROUNDING: f64 = 1e-13;
/// Most equations that are listed for each set.
const SHOWN: usize = 20;

/// Prints the equations of each set that do not follow from the other; exit code 0 if the sets have the same solutions, else 1.
pub fn run(args: &DiffArgs) -> Result<ExitCode, CliFailure> {
    let progress = Progress::new(args.model.quiet);
    let other = ModelArgs { input: args.other.clone(), rhs: None, prescribed: None, ..args.model.clone() };
    let report = ReportArgs::default();
    let question = || Question {
        report: &report,
        options: args.model.options(),
        preferences: PreferenceLists::default(),
        choice: LoadCaseChoice::new(args.case.as_deref(), LoadCaseChoice::Any),
    };
    let first = diagnose(&args.model, question(), &progress)?;
    let second = diagnose(&other, question(), &progress)?;
    progress.stage("comparing");
    let (a, b) = (solvable(&first)?, solvable(&second)?);
    let is_solvable = a.is_some() && b.is_some();
    let set = |of: &Diagnosis, own: &Option<Solutions>, other: &Option<Solutions>| DiffSet {
        file: of.args.input.to_string_lossy().into_owned(),
        conflicting: own.is_none(),
        not_implied: other.as_ref().filter(|_| is_solvable).map_or_else(Vec::new, |other| beyond(of, other)),
    };
    let sets = [set(&first, &a, &b), set(&second, &b, &a)];
    drop(progress);
    let same = is_solvable && sets.iter().all(|set| set.not_implied.is_empty());
    match args.format {
        AnswerFormat::Json => {
            let answer = json!({"schema": "qless.diff/1", "same": same, "sets": sets});
            terminal::show_json(|out| json::lines(out, &answer))?;
        }
        AnswerFormat::Text if same => {
            terminal::write(|out| writeln!(out, "Both sets have the same solutions."))?;
        }
        AnswerFormat::Text => {
            let lines = sets.iter().flat_map(DiffSet::lines).map(|line| line + "\n");
            terminal::write(|out| out.write_all(lines.collect::<String>().as_bytes()))?;
        }
    }
    Ok(if same { ExitCode::SUCCESS } else { ExitCode::from(exit_code::REFUSED) })
}

/// One of the two sets.
#[derive(Serialize)]
struct DiffSet {
    file: String,
    /// Whether its equations conflict; then nothing is compared.
    conflicting: bool,
    /// The equations and prescribed values that do not follow from the other set.
    not_implied: Vec<String>,
}

impl DiffSet {
    /// A heading and the first equations, if there is something to say.
    fn lines(&self) -> Vec<String> {
        let name = printable::line(&self.file);
        if self.conflicting {
            return vec![format!("{name} has conflicting equations: see `qless check`.")];
        }
        if self.not_implied.is_empty() {
            return Vec::new();
        }
        let mut lines =
            vec![format!("{name} asks for {} that the other does not:", count(self.not_implied.len(), "thing"))];
        lines.extend(self.not_implied.iter().take(SHOWN).map(|item| format!("  {item}")));
        let more = self.not_implied.len().saturating_sub(SHOWN);
        lines.extend((more > 0).then(|| format!("  and {more} more (all of them: --format json)")));
        lines
    }
}

/// Sample solutions of one set of equations.
struct Solutions {
    /// By the label of a DOF, or its number if it has none: its place in each sample.
    columns: HashMap<String, usize>,
    samples: Vec<Vec<f64>>,
}

/// Computes sample solutions of a set; `None` if its equations conflict.
fn solvable(diagnosis: &Diagnosis) -> Result<Option<Solutions>, CliFailure> {
    if diagnosis.is_conflicting() {
        return Ok(None);
    }
    let system = &diagnosis.system;
    let failed =
        |error: &dyn std::fmt::Display| CliFailure::Resource(format!("{}: {error}", diagnosis.args.input.display()));
    let analysis = analyse(system, &diagnosis.options).map_err(|error| failed(&error))?;
    let elimination = Elimination::from_analysis(analysis, Form::Auto).map_err(|error| failed(&error))?;
    let mut random = SplitMix64::new(1);
    let mut samples = Vec::new();
    for sample in 0..=RANDOM {
        let mut entry = || if sample == 0 { 0.0 } else { (random.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0 };
        let masters: Vec<f64> = elimination.masters().iter().map(|_| entry()).collect();
        let mut u = vec![0.0; system.dofs()];
        elimination.expand_into(&masters, &mut u).map_err(|error| failed(&error))?;
        samples.push(u);
    }
    let columns = (0..system.dofs()).map(|dof| (system.dof_label(dof).to_lowercase(), dof)).collect();
    Ok(Some(Solutions { columns, samples }))
}

/// Lists the equations and prescribed values of a set that the solutions of the other set do not satisfy.
fn beyond(of: &Diagnosis, solutions: &Solutions) -> Vec<String> {
    let system = &of.system;
    let mut found: Vec<String> = (0..system.equations())
        .filter(|&row| !holds(system, &system.matrix().row(row), system.rhs()[row], solutions))
        .map(|row| equation(system, row))
        .collect();
    for &(dof, value) in system.prescribed() {
        if !holds(system, &std::iter::once((dof, 1.0)), value, solutions) {
            let place = system.prescribed_place(dof).map_or_else(String::new, |place| format!(", {}", label(place)));
            found.push(format!("{} = {}{place}", label(&system.dof_label(dof)), number(value)));
        }
    }
    found
}

/// Whether an equation holds at all samples. A DOF that the other set does not have is free there.
fn holds(
    system: &ConstraintSystem,
    terms: &(impl Iterator<Item = (usize, f64)> + Clone),
    b: f64,
    solutions: &Solutions,
) -> bool {
    solutions.samples.iter().enumerate().all(|(k, u)| {
        let largest = u.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let (mut left, mut size, mut rounding) = (-b, b.abs(), 0.0_f64);
        for (dof, factor) in terms.clone() {
            let place = solutions.columns.get(&system.dof_label(dof).to_lowercase());
            // A different number for each DOF and sample.
            let free = if k == 0 { 0.0 } else { ((dof * 7 + k * 3) as f64).sin() };
            let part = factor * place.map_or(free, |&j| u[j]);
            left += part;
            size = size.max(part.abs());
            rounding = rounding.max(factor.abs() * largest);
        }
        left.abs() <= HOLDS * size + ROUNDING * rounding
    })
}
