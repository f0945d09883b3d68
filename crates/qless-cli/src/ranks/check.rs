//! `qless check` on several ranks: each rank reads a share of the equations, all analyse them, and the first one reports.

use std::num::NonZeroUsize;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use qless::{AnalysisError, Effort, OptionError, Options, Report};
use qless_io::deck::Format;
use qless_io::write::OneFile;
use qless_mpi::{Analysis, CaseError, Error, Ranks, analyse, read_case};

use super::all;
use super::report::Findings;
use crate::args::{CheckArgs, Deny, ReportFormat};
use crate::failure::CliFailure;
use crate::preferences::{ListWord, WordList};
use crate::terminal::Progress;
use crate::wording::printable;
use crate::{exit_code, memory};

/// Runs the command; collective, with the same exit code on all ranks.
pub fn run(ranks: &dyn Ranks, args: &CheckArgs) -> Result<ExitCode, CliFailure> {
    let start = Instant::now();
    let (model, is_first) = (&args.model, ranks.rank() == 0);
    all(ranks, check(args, is_first))?;
    let progress = Progress::new(model.quiet || !is_first);
    // By default one thread for each rank, because each rank usually has a core of its own.
    all(ranks, memory::threads::start(model.threads().or(Some(NonZeroUsize::MIN))).map_err(CliFailure::from_threads))?;
    progress.stage("reading");
    let (rhs, prescribed) = (model.rhs.as_deref(), model.prescribed.as_deref());
    let case = read_case(ranks, &model.input, rhs, prescribed).map_err(of_case)?;
    let read = start.elapsed();
    progress.stage("analysing");
    let mut options = model.options();
    options.preferences.equations = all(ranks, numbers(args.keep.keep.as_ref()))?;
    check_kept(&options, case.rows() as usize, &model.input)?;
    options.memory = minimum(ranks, memory::remaining().map_or(options.memory, |left| left.min(options.memory)));
    let analysis = analyse(ranks, case.share(), &options).map_err(|error| from_analysis(error, &model.input))?;
    all(ranks, check_finite(&analysis, &model.input))?;
    progress.stage("explaining");
    let found = case.gather(ranks, &analysis, Report::TERMS);
    let written = if is_first {
        let findings =
            Findings { case: &case, analysis: &analysis, found: &found, options: &options, ranks: ranks.size() };
        let rendered = findings.render(&args.model.input, args.report.format, (start, read));
        drop(progress);
        rendered.and_then(|bytes| write(args, bytes))
    } else {
        Ok(())
    };
    all(ranks, written)?;
    let counts = analysis.counts();
    // The other findings concern cards and solvers, which a matrix or a case folder does not have.
    let denied = args.report.deny.iter().any(|deny| match deny {
        Deny::Redundant => counts.redundant > 0,
        Deny::Ambiguous => analysis.confidence().ambiguous,
        Deny::Refused | Deny::Dropped | Deny::Lost | Deny::Incomplete => false,
    });
    Ok(ExitCode::from(exit_code::for_diagnosis(counts.conflicting > 0 || denied, false)))
}

/// Refuses options that need one process, and an output that cannot be written.
fn check(args: &CheckArgs, is_first: bool) -> Result<(), CliFailure> {
    let model = &args.model;
    let input = model.input.display();
    if model.effort == Effort::Exact {
        return Err(CliFailure::Input(
            "--effort exact runs in one process only: use another, or leave out mpirun".to_owned(),
        ));
    }
    if !matches!(args.report.format, ReportFormat::Text | ReportFormat::Json) {
        return Err(CliFailure::Input(
            "on several ranks the formats are text and json; for the others run without mpirun".to_owned(),
        ));
    }
    if !args.more.is_empty() {
        return Err(CliFailure::Input("several ranks check one input: start a job for each".to_owned()));
    }
    if model.solver.is_some() || args.case.is_some() {
        return Err(CliFailure::Input(
            "--solver and --case need a deck, which only one process can read: leave out mpirun".to_owned(),
        ));
    }
    if model.input.as_os_str() == "-" || Format::from_path(&model.input).is_some() && !model.input.is_dir() {
        return Err(CliFailure::Input(format!(
            "{input}: several ranks read Matrix Market only: name a .mtx file or a folder with a C.mtx, or leave out mpirun"
        )));
    }
    model
        .options()
        .backend
        .get(usize::MAX)
        .map_err(|error| CliFailure::from_analysis(error.into(), &model.input, None))?;
    if let Some(file) = args.output.as_ref().filter(|_| is_first) {
        // Before the work begins, refuse an output that cannot be written.
        drop(OneFile::at(file, model.inputs())?);
    }
    Ok(())
}

fn write(args: &CheckArgs, bytes: Vec<u8>) -> Result<(), CliFailure> {
    let bytes = printable::report(bytes, matches!(args.report.format, ReportFormat::Json | ReportFormat::Html));
    match &args.output {
        None => args.report.format.show(&bytes),
        Some(file) => Ok(OneFile::at(file, args.model.inputs())?.write(&bytes)?),
    }
}

/// The smallest value of all ranks; collective.
fn minimum(ranks: &dyn Ranks, bytes: usize) -> usize {
    let mut most = [u64::MAX - bytes as u64];
    ranks.max(&mut most);
    (u64::MAX - most[0]) as usize
}

fn of_case(error: CaseError) -> CliFailure {
    match error {
        CaseError::File { message, kind, .. } => CliFailure::from_reading(&message, kind),
        error => CliFailure::Input(error.to_string()),
    }
}

fn from_analysis(error: Error, input: &Path) -> CliFailure {
    match error {
        Error::Option(error) => CliFailure::from_analysis(error.into(), input, None),
        Error::TooLarge { .. } => CliFailure::Resource(format!("{}: {error}", input.display())),
        error => CliFailure::Input(format!("{}: {error}", input.display())),
    }
}

/// Indices of the equations to keep. Names are refused, since no rank knows all labels.
fn numbers(words: Option<&WordList>) -> Result<Vec<usize>, CliFailure> {
    let number = |word: &ListWord| match word {
        ListWord::Numbers(range) => Ok(range.clone()),
        ListWord::Name(name) => {
            Err(CliFailure::Input(format!("--keep: `{name}`: several ranks know rows by their numbers only")))
        }
    };
    let ranges: Vec<_> = words.map_or(&[][..], |words| &words.0).iter().map(number).collect::<Result<_, _>>()?;
    Ok(ranges.into_iter().flatten().collect())
}

/// Refuses indices beyond the last equation.
fn check_kept(options: &Options, count: usize, input: &Path) -> Result<(), CliFailure> {
    match options.preferences.equations.iter().find(|&&row| row >= count) {
        Some(&found) => {
            let error = OptionError::Preference { what: "equation", found, count };
            Err(CliFailure::from_analysis(AnalysisError::Option(error), input, None))
        }
        None => Ok(()),
    }
}

fn check_finite(analysis: &Analysis, input: &Path) -> Result<(), CliFailure> {
    match analysis.generated().iter().find(|(_, value)| !value.is_finite()) {
        Some(&(dof, _)) => Err(CliFailure::from_overflow(input, dof as usize, &format!("DOF {}", dof + 1))),
        None => Ok(()),
    }
}
