//! `qless diff`: compares the solutions of two sets of equations, and lists the equations in which the sets differ.
//!
//! Every equation and prescribed value of one set is evaluated at solutions of the other: at its particular solution and at random ones. An
//! equation that follows from the other set holds at all of them to rounding; any other equation fails at a random one with probability 1.

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::process::ExitCode;

use qless::common::SplitMix64;
use qless::{Elimination, Form, analyse};

use crate::args::{DiffArgs, ModelArgs};
use crate::deck_input::LoadCaseChoice;
use crate::diagnose::{Diagnosis, Question, diagnose};
use crate::exit_code;
use crate::failure::CliFailure;
use crate::preferences::PreferenceLists;
use crate::terminal::{self, Progress};
use crate::wording::printable;
use crate::wording::{count, equation, label, number};

/// Number of random solutions, in addition to the one whose masters are zero.
const RANDOM: usize = 2;
/// An equation holds if its residual is at most this fraction of its largest term. The residual of an equation that follows from the other
/// set is rounding error times the growth of T.
const HOLDS: f64 = 1e-9;
/// Rounding of a solution, relative to its largest entry.
const ROUNDING: f64 = 1e-13;
/// Most equations that are listed for each set.
const SHOWN: usize = 20;

/// Prints the equations of each set that do not follow from the other; exit code 0 if the sets have the same solutions, else 1.
pub fn run(args: &DiffArgs) -> Result<ExitCode, CliFailure> {
    let progress = Progress::new(args.model.quiet);
    let other = ModelArgs { input: args.other.clone(), rhs: None, prescribed: None, ..args.model.clone() };
    let question = || Question {
        options: args.model.options(),
        preferences: PreferenceLists::default(),
        choice: LoadCaseChoice::new(args.case.as_deref(), LoadCaseChoice::Any),
    };
    let first = diagnose(&args.model, question(), &progress)?;
    let second = diagnose(&other, question(), &progress)?;
    progress.stage("comparing");
    let lines = match (solvable(&first)?, solvable(&second)?) {
        (Some(a), Some(b)) => {
            let mut lines = beyond(&first, &b);
            lines.extend(beyond(&second, &a));
            lines
        }
        (a, b) => [(a.is_none(), &first), (b.is_none(), &second)]
            .into_iter()
            .filter(|(conflicts, _)| *conflicts)
            .map(|(_, diagnosis)| {
                format!("{} has conflicting equations: see `qless check`.", name(&diagnosis.args.input))
            })
            .collect(),
    };
    drop(progress);
    let same = lines.is_empty();
    let text = if same { "Both sets have the same solutions.\n".to_owned() } else { lines.join("\n") + "\n" };
    terminal::write(|out| out.write_all(text.as_bytes()))?;
    Ok(if same { ExitCode::SUCCESS } else { ExitCode::from(exit_code::REFUSED) })
}

/// Sample solutions of one set of equations.
struct Solutions {
    /// Index of a DOF in each sample, by the label of the DOF, or by its number without a label.
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
    let alone = alone(diagnosis);
    samples.iter_mut().for_each(|u| u.extend(alone.iter().map(|given| given.value)));
    let labels = (0..system.dofs()).map(|dof| system.dof_label(dof)).chain(alone.into_iter().map(|given| given.label));
    let columns = labels.map(|label| label.to_lowercase()).zip(0..).collect();
    Ok(Some(Solutions { columns, samples }))
}

/// A prescribed value, with its place in the input if that is known.
struct Given {
    label: String,
    value: f64,
    place: Option<String>,
}

/// The prescribed values of a deck's load case on DOFs that occur in no equation: the system does not have them.
fn alone(diagnosis: &Diagnosis) -> Vec<Given> {
    let Some(input) = &diagnosis.deck else { return Vec::new() };
    let model = input.deck.model();
    let known: HashSet<String> = (0..diagnosis.system.dofs()).map(|dof| diagnosis.system.dof_label(dof)).collect();
    let given = model.cases()[input.case].prescribed.iter().map(|given| Given {
        label: model.dof_name(given.dof),
        value: given.value,
        place: Some(model.place(given.origin)),
    });
    given.filter(|given| !known.contains(&given.label)).collect()
}

/// Lists the equations and prescribed values of a set that the solutions of the other set do not satisfy, below a heading.
fn beyond(of: &Diagnosis, solutions: &Solutions) -> Vec<String> {
    let system = &of.system;
    let label_of = |dof: usize| system.dof_label(dof);
    let mut found: Vec<String> = (0..system.equations())
        .filter(|&row| {
            let terms = system.matrix().row(row).map(|(dof, factor)| (label_of(dof), factor));
            !solutions.satisfy(&terms.collect::<Vec<_>>(), system.rhs()[row])
        })
        .map(|row| equation(system, row))
        .collect();
    let given = system.prescribed().iter().map(|&(dof, value)| {
        let place = system.prescribed_place(dof).map(str::to_owned);
        Given { label: label_of(dof), value, place }
    });
    for Given { label: dof, value, place } in given.chain(alone(of)) {
        let terms = [(dof, 1.0)];
        if !solutions.satisfy(&terms, value) {
            let place = place.map_or_else(String::new, |place| format!(", {}", label(&place)));
            found.push(format!("{} = {}{place}", label(&terms[0].0), number(value)));
        }
    }
    if found.is_empty() {
        return Vec::new();
    }
    let relations = count(found.len(), "relation");
    let mut lines = vec![format!("{} has {relations} that the other does not imply:", name(&of.args.input))];
    let more = found.len().saturating_sub(SHOWN);
    lines.extend(found.into_iter().take(SHOWN).map(|item| format!("  {item}")));
    if more > 0 {
        lines.push(format!("  and {more} more"));
    }
    lines
}

impl Solutions {
    /// Whether an equation holds at all samples. DOFs have labels; one that these solutions do not have is free.
    fn satisfy(&self, terms: &[(String, f64)], b: f64) -> bool {
        let places: Vec<Option<usize>> =
            terms.iter().map(|(label, _)| self.columns.get(&label.to_lowercase()).copied()).collect();
        self.samples.iter().enumerate().all(|(k, u)| {
            let largest = u.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let (mut left, mut size, mut rounding) = (-b, b.abs(), 0.0_f64);
            for (at, (place, (_, factor))) in places.iter().zip(terms).enumerate() {
                // A different number for each DOF and sample.
                let free = if k == 0 { 0.0 } else { ((at * 7 + k * 3) as f64).sin() };
                let part = factor * place.map_or(free, |j| u[j]);
                left += part;
                size = size.max(part.abs());
                rounding = rounding.max(factor.abs() * largest);
            }
            left.abs() <= HOLDS * size + ROUNDING * rounding
        })
    }
}

fn name(path: &Path) -> String {
    printable::line(&path.display().to_string())
}
