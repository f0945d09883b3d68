//! `qless check`: the diagnosis.

use std::process::ExitCode;

use qless_io::write::OneFile;

use crate::args::{CheckArgs, Format};
use crate::clean;
use crate::diagnose::{Question, diagnose};
use crate::failure::CliFailure;
use crate::report::Outcome;
use crate::terminal::Progress;

/// Prints the report; exit code 0, 1 or 4.
pub fn run(args: &CheckArgs) -> Result<ExitCode, CliFailure> {
    if args.exact && args.model.format == Format::Vtu {
        return Err(CliFailure::Input(
            "--exact goes with --format text, json or html; a vtu file shows no rank".to_owned(),
        ));
    }
    if let Some(file) = &args.output {
        if file.as_os_str() == "-" {
            return Err(CliFailure::Input("-o -: leave it out, and the report goes to standard output".to_owned()));
        }
        // Refuse an output that cannot be written before the work begins.
        drop(OneFile::at(file, args.model.inputs())?);
    }
    let progress = Progress::new(args.model.quiet);
    let question =
        Question { options: args.model.options(), preferences: args.model.preferences(), choice: args.choice() };
    let mut diagnosis = diagnose(&args.model, question, &progress)?;
    diagnosis.take_meaning();
    if args.exact {
        progress.stage("exact arithmetic");
        diagnosis.take_exact_rank()?;
    }
    // Only the text report gives this advice, so only it pays for the plan.
    let obstacle = if args.model.format == Format::Text { clean::obstacle(&diagnosis) } else { None };
    let outcome = Outcome::Checked(obstacle.as_deref());
    match &args.output {
        None => diagnosis.print(None, &outcome, progress)?,
        Some(file) => {
            progress.stage("writing");
            let bytes = diagnosis.render(None, &outcome)?;
            OneFile::at(file, diagnosis.inputs())?.write(&bytes)?;
        }
    }
    Ok(diagnosis.code())
}
