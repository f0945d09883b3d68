//! `qless check`: the diagnosis.

use std::process::ExitCode;

use qless_io::write::OneFile;

use crate::args::{CheckArgs, ReportFormat};
use crate::clean;
use crate::diagnose::{Question, diagnose};
use crate::failure::CliFailure;
use crate::report::CommandOutcome;
use crate::terminal::Progress;

/// Prints the report; exit code 0, 1 or 4.
pub fn run(args: &CheckArgs) -> Result<ExitCode, CliFailure> {
    if let Some(file) = &args.output {
        if file.as_os_str() == "-" {
            return Err(CliFailure::Input(
                "-o -: leave it out; the report is then written to standard output".to_owned(),
            ));
        }
        // Before the work begins, refuse an output that cannot be written.
        drop(OneFile::at(file, args.model.inputs())?);
    }
    let progress = Progress::new(args.model.quiet);
    let question =
        Question { options: args.model.options(), preferences: args.model.preferences(), choice: args.choice() };
    let mut diagnosis = diagnose(&args.model, question, &progress)?;
    diagnosis.add_near_dependence();
    // The plan takes time, and only the text report shows it.
    let obstacle = if args.model.format == ReportFormat::Text { clean::obstacle(&diagnosis) } else { None };
    let outcome = CommandOutcome::Checked(obstacle.as_deref());
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
