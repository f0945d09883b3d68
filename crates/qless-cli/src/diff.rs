//! `qless diff`: compares the solutions of two sets of equations, and lists the equations in which the sets differ.
//!
//! The equations of both sets are analysed together, with prescribed values as equations and the equations of one set preferred. An equation
//! of the other set follows from them if it is redundant then; it tells the sets apart if it is independent or conflicts.

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::process::ExitCode;

use qless::{Kind, SystemBuilder, analyse};

use crate::args::{DiffArgs, ModelArgs};
use crate::deck_input::LoadCaseChoice;
use crate::diagnose::{Diagnosis, Question, diagnose};
use crate::exit_code;
use crate::failure::CliFailure;
use crate::preferences::PreferenceLists;
use crate::terminal::{self, Progress};
use crate::wording::printable;
use crate::wording::{count, equation, label, number};

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
    let conflicting: Vec<String> = [&first, &second]
        .into_iter()
        .filter(|diagnosis| diagnosis.is_conflicting())
        .map(|diagnosis| format!("{} has conflicting equations: see `qless check`.", name(&diagnosis.args.input)))
        .collect();
    let lines = if conflicting.is_empty() {
        let [a, b] = [&first, &second].map(Relations::new);
        [a.beyond(&b, &first)?, b.beyond(&a, &second)?].concat()
    } else {
        conflicting
    };
    drop(progress);
    let same = lines.is_empty();
    let text = if same { "Both sets have the same solutions.\n".to_owned() } else { lines.join("\n") + "\n" };
    terminal::write(|out| out.write_all(text.as_bytes()))?;
    Ok(if same { ExitCode::SUCCESS } else { ExitCode::from(exit_code::REFUSED) })
}

/// Terms on DOFs, each by its label in small letters, and the right-hand side.
type Relation = (Vec<(String, f64)>, f64);

/// The equations and prescribed values of a set, each with its name.
struct Relations {
    relations: Vec<Relation>,
    names: Vec<String>,
}

impl Relations {
    fn new(diagnosis: &Diagnosis) -> Self {
        let system = &diagnosis.system;
        let labels: Vec<String> = (0..system.dofs()).map(|dof| system.dof_label(dof)).collect();
        let mut all = Self { relations: Vec::new(), names: Vec::new() };
        for row in 0..system.equations() {
            let terms = system.matrix().row(row).map(|(dof, factor)| (labels[dof].to_lowercase(), factor)).collect();
            all.relations.push((terms, system.rhs()[row]));
            all.names.push(equation(system, row));
        }
        for &(dof, value) in system.prescribed() {
            all.prescribe(&labels[dof], value, system.prescribed_place(dof));
        }
        // The system does not have the values of a deck on DOFs that occur in no equation.
        if let Some(input) = &diagnosis.deck {
            let (model, known) = (input.deck.model(), labels.iter().collect::<HashSet<_>>());
            for given in &model.cases()[input.case].prescribed {
                let dof = model.dof_name(given.dof);
                if !known.contains(&dof) {
                    all.prescribe(&dof, given.value, Some(&model.place(given.origin)));
                }
            }
        }
        all
    }

    fn prescribe(&mut self, dof: &str, value: f64, place: Option<&str>) {
        let place = place.map_or_else(String::new, |place| format!(", {}", label(place)));
        self.relations.push((vec![(dof.to_lowercase(), 1.0)], value));
        self.names.push(format!("{} = {}{place}", label(dof), number(value)));
    }

    /// Lists the relations that do not follow from `other`, below a heading. `of` is the diagnosis of this set.
    fn beyond<'a>(&'a self, other: &'a Self, of: &Diagnosis) -> Result<Vec<String>, CliFailure> {
        let mut numbers: HashMap<&'a str, usize> = HashMap::new();
        let mut equations = Vec::new();
        for (terms, b) in other.relations.iter().chain(&self.relations) {
            let number = |(dof, factor): &'a (String, f64)| {
                let next = numbers.len();
                (*numbers.entry(dof).or_insert(next), *factor)
            };
            equations.push((terms.iter().map(number).collect::<Vec<_>>(), *b));
        }
        let count_of_other = other.relations.len();
        let mut builder = SystemBuilder::new(numbers.len().max(1));
        equations.into_iter().for_each(|(terms, b)| _ = builder.equation(terms, b));
        let mut options = of.options.clone();
        options.preferences.equations = (0..count_of_other).collect();
        let failed =
            |error: &dyn std::fmt::Display| CliFailure::Resource(format!("{}: {error}", of.args.input.display()));
        let system = builder.build().map_err(|error| failed(&error))?;
        let analysis = analyse(&system, &options).map_err(|error| failed(&error))?;
        let own = analysis.kinds()[count_of_other..].iter().zip(&self.names);
        let found: Vec<&String> = own.filter(|(kind, _)| **kind != Kind::Redundant).map(|(_, name)| name).collect();
        if found.is_empty() {
            return Ok(Vec::new());
        }
        let relations = count(found.len(), "relation");
        let mut lines = vec![format!("{} has {relations} that the other does not imply:", name(&of.args.input))];
        lines.extend(found.iter().take(SHOWN).map(|item| format!("  {item}")));
        if found.len() > SHOWN {
            lines.push(format!("  and {} more", found.len() - SHOWN));
        }
        Ok(lines)
    }
}

fn name(path: &Path) -> String {
    printable::line(&path.display().to_string())
}
