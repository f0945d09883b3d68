//! `qless diff`: compares the solutions of two sets of equations, and lists the equations in which the sets differ.
//!
//! The equations of both sets are analysed together, with prescribed values as equations, and with a preference to keep the equations of
//! one set. An equation of the other set follows from that set if it is redundant then. It tells the sets apart if it is independent or
//! conflicts.

use std::collections::{HashMap, HashSet};
use std::process::ExitCode;

use qless::{Kind, SystemBuilder, analyse};
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

/// Largest number of equations that are listed for each set.
const SHOWN: usize = 20;
/// What the text says if the comparison is in doubt.
const IN_DOUBT: &str =
    "AMBIGUOUS: the sets may differ by rounding only, or agree only to rounding; `qless check` of each set says more.";

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
    let is_solvable = !first.is_conflicting() && !second.is_conflicting();
    // Solvers do not tell capitals from small letters in the names of decks. If a set has labels that differ in nothing else, it does.
    let folds = ![&first, &second].iter().any(|of| tells_case(of));
    let [a, b] = [&first, &second].map(|of| Relations::new(of, folds));
    let set = |of: &Diagnosis, own: &Relations, other: &Relations| -> Result<DiffSet, CliFailure> {
        let (not_implied, is_in_doubt) = if is_solvable { own.beyond(other, of)? } else { Default::default() };
        let file = of.args.input.to_string_lossy().into_owned();
        Ok(DiffSet { file, conflicting: of.is_conflicting(), not_implied, ambiguous: is_in_doubt })
    };
    let sets = [set(&first, &a, &b)?, set(&second, &b, &a)?];
    drop(progress);
    let same = is_solvable && sets.iter().all(|set| set.not_implied.is_empty());
    match args.format {
        AnswerFormat::Json => {
            let ambiguous = sets.iter().any(|set| set.ambiguous);
            let answer = json!({"schema": "qless.diff/1", "same": same, "ambiguous": ambiguous, "sets": sets});
            terminal::show_json(|out| json::lines(out, &answer))?;
        }
        AnswerFormat::Text => {
            let same = same.then(|| "Both sets have the same solutions.".to_owned());
            let doubt = sets.iter().any(|set| set.ambiguous).then(|| IN_DOUBT.to_owned());
            let lines =
                same.into_iter().chain(sets.iter().flat_map(DiffSet::lines)).chain(doubt).map(|line| line + "\n");
            terminal::write(|out| out.write_all(lines.collect::<String>().as_bytes()))?;
        }
    }
    Ok(if same { ExitCode::SUCCESS } else { ExitCode::from(exit_code::REFUSED) })
}

/// One of the two sets that are compared.
#[derive(Serialize)]
struct DiffSet {
    file: String,
    /// Whether the equations of this set conflict; then nothing is compared.
    conflicting: bool,
    /// The equations and prescribed values that do not follow from the other set.
    not_implied: Vec<String>,
    /// Whether `not_implied` is in doubt: another reading of rounding gives another list.
    #[serde(skip)]
    ambiguous: bool,
}

impl DiffSet {
    /// Lines about the set: that its equations conflict; or a heading and the first equations that the other set does not imply. If the
    /// other set implies all of them, there are no lines.
    fn lines(&self) -> Vec<String> {
        let name = printable::line(&self.file);
        if self.conflicting {
            return vec![format!("{name} has conflicting equations: see `qless check`.")];
        }
        if self.not_implied.is_empty() {
            return Vec::new();
        }
        let relations = count(self.not_implied.len(), "relation");
        let mut lines = vec![format!("{name} adds {relations} to the other:")];
        lines.extend(self.not_implied.iter().take(SHOWN).map(|item| format!("  {item}")));
        let more = self.not_implied.len().saturating_sub(SHOWN);
        lines.extend((more > 0).then(|| format!("  and {more} more (all of them: --format json)")));
        lines
    }
}

/// Terms on DOFs, each by its label, and the right-hand side.
type LabelledRelation = (Vec<(String, f64)>, f64);

/// The equations and prescribed values of a set, each with its name.
struct Relations {
    relations: Vec<LabelledRelation>,
    names: Vec<String>,
}

/// Whether labels of DOFs differ only in capitals and small letters.
fn tells_case(diagnosis: &Diagnosis) -> bool {
    let labels = || (0..diagnosis.system.dofs()).map(|dof| diagnosis.system.dof_label(dof));
    let folded: HashSet<String> = labels().map(|label| label.to_lowercase()).collect();
    folded.len() < labels().collect::<HashSet<_>>().len()
}

impl Relations {
    /// If `folds`, labels are written in small letters.
    fn new(diagnosis: &Diagnosis, folds: bool) -> Self {
        let system = &diagnosis.system;
        let labels: Vec<String> = (0..system.dofs()).map(|dof| system.dof_label(dof)).collect();
        let key = |label: &str| if folds { label.to_lowercase() } else { label.to_owned() };
        let mut all = Self { relations: Vec::new(), names: Vec::new() };
        for row in 0..system.equations() {
            let terms = system.matrix().row(row).map(|(dof, factor)| (key(&labels[dof]), factor)).collect();
            all.relations.push((terms, system.rhs()[row]));
            all.names.push(equation(system, row));
        }
        for &(dof, value) in system.prescribed() {
            all.prescribe(key(&labels[dof]), &labels[dof], value, system.prescribed_place(dof));
        }
        // The system omits prescribed values on DOFs that occur in no equation. They are taken from the deck.
        if let Some(input) = &diagnosis.deck {
            let (model, known) = (input.deck.model(), labels.iter().collect::<HashSet<_>>());
            for given in &model.cases()[input.case].prescribed {
                let dof = model.dof_name(given.dof);
                if !known.contains(&dof) {
                    all.prescribe(key(&dof), &dof, given.value, Some(&model.place(given.origin)));
                }
            }
        }
        all
    }

    fn prescribe(&mut self, key: String, dof: &str, value: f64, place: Option<&str>) {
        let place = place.map_or_else(String::new, |place| format!(", {}", label(place)));
        self.relations.push((vec![(key, 1.0)], value));
        self.names.push(format!("{} = {}{place}", label(dof), number(value)));
    }

    /// The names of the relations that do not follow from `other`, and whether this is in doubt. `of` is the diagnosis of this set.
    fn beyond<'a>(&'a self, other: &'a Self, of: &Diagnosis) -> Result<(Vec<String>, bool), CliFailure> {
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
        let beyond = own.filter(|(kind, _)| **kind != Kind::Redundant).map(|(_, name)| name.clone()).collect();
        Ok((beyond, analysis.confidence().ambiguous))
    }
}
