//! `qless check`: the diagnosis of one input, or of several.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use qless_io::case_files;
use qless_io::write::{Inputs, OneFile};

use crate::args::{CheckArgs, ModelArgs, ReportFormat};
use crate::deck_input::DeckInput;
use crate::diagnose::{Question, diagnose};
use crate::failure::{CliFailure, say};
use crate::report::{CommandOutcome, Joined};
use crate::terminal::Progress;
use crate::{clean, exit_code};

/// Prints the report and returns the worst exit code of the inputs. An input that fails ends the run only if the report has no place for
/// failures.
pub fn run(args: &CheckArgs) -> Result<ExitCode, CliFailure> {
    check_options(args)?;
    let joined = Joined::new(args.report.format, args.more.len() + 1);
    let (mut pieces, mut codes, mut summary) = (Vec::new(), Vec::new(), Vec::new());
    for input in args.inputs() {
        let model = ModelArgs { input: input.clone(), ..args.model.clone() };
        let (piece, code, findings) = match report(args, &model) {
            Ok(done) => done,
            Err(failure) if joined.shows_failures() => {
                say(format_args!("error: {}", failure.message()));
                (joined.failed(input, &failure), failure.code(), vec!["not checked".to_owned()])
            }
            Err(failure) => return Err(failure),
        };
        pieces.push((input, piece));
        codes.push(code);
        summary.push((input.as_path(), findings));
    }
    let text = joined.whole(pieces);
    match &args.output {
        None => args.report.format.show(&text)?,
        Some(file) => OneFile::at(file, args.files())?.write(&text)?,
    }
    if args.is_several() {
        say(format_args!("{}", Joined::summary(&summary)));
    }
    Ok(ExitCode::from(exit_code::worst(codes)))
}

/// Before the work begins, refuses options that do not fit the number of inputs, and an output that cannot be written.
fn check_options(args: &CheckArgs) -> Result<(), CliFailure> {
    let refused = |why: &str| Err(CliFailure::Input(why.to_owned()));
    if let Some(file) = &args.output {
        if file.as_os_str() == "-" {
            return refused("-o -: leave it out; the report is then written to standard output");
        }
        drop(OneFile::at(file, args.files())?);
    }
    let ModelArgs { rhs, prescribed, .. } = &args.model;
    if args.is_several() && (rhs.is_some() || prescribed.is_some()) {
        return refused("--rhs and --prescribed belong to one input: check the others in runs of their own");
    }
    if args.is_several() && matches!(args.report.format, ReportFormat::Html | ReportFormat::Vtu) {
        return refused("a page or a file of nodes shows one input: check the others in runs of their own");
    }
    if args.inputs().filter(|input| input.as_os_str() == "-").count() > 1 {
        return refused("standard input can be read once only");
    }
    Ok(())
}

/// The report of one input, its exit code, and its findings in words.
fn report(args: &CheckArgs, model: &ModelArgs) -> Result<(Vec<u8>, u8, Vec<String>), CliFailure> {
    let progress = Progress::new(model.quiet);
    let question = Question {
        report: &args.report,
        options: model.options(),
        preferences: args.keep.preferences(),
        choice: args.choice(),
    };
    let mut diagnosis = diagnose(model, question, &progress)?;
    diagnosis.is_one_of_several = args.is_several();
    diagnosis.add_near_dependence();
    if let Some(file) = &args.output {
        // The file must not replace a file that the deck includes. That it replaces no input file was checked before.
        drop(OneFile::at(file, diagnosis.inputs())?);
    }
    // A plan for `clean` takes time to make, so it is made only for reports that say whether one exists: text always, HTML if the deck
    // needs cleaning.
    let is_planned = match args.report.format {
        ReportFormat::Text => true,
        ReportFormat::Html => diagnosis.deck.as_ref().is_some_and(DeckInput::needs_cleaning),
        _ => false,
    };
    let obstacle = if is_planned { clean::obstacle(&diagnosis) } else { None };
    let outcome = CommandOutcome::Checked(obstacle.as_deref());
    progress.stage("explaining");
    let bytes = diagnosis.render(None, &outcome)?;
    drop(progress);
    diagnosis.warn();
    Ok((bytes, diagnosis.code(), diagnosis.findings()))
}

impl CheckArgs {
    fn inputs(&self) -> impl Iterator<Item = &PathBuf> {
        std::iter::once(&self.model.input).chain(&self.more)
    }

    fn is_several(&self) -> bool {
        !self.more.is_empty()
    }

    /// All files that are named as inputs.
    fn files(&self) -> Inputs {
        let ModelArgs { rhs, prescribed, .. } = &self.model;
        let of = |input: &PathBuf| case_files(input, rhs.as_deref(), prescribed.as_deref());
        Inputs::new(self.inputs().flat_map(of).collect::<Vec<PathBuf>>().iter().map(Path::new))
    }
}
