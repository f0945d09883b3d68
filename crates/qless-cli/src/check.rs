//! `qless check`: the diagnosis.

use std::process::ExitCode;

use qless_io::write::write_bytes;

use crate::args::CheckArgs;
use crate::diagnose::diagnose;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::text::Outcome;

/// Prints the report; exit code 0 or 1.
pub fn run(args: &CheckArgs) -> Result<ExitCode, Failure> {
    let progress = Progress::new(args.model.quiet);
    let diagnosis = diagnose(&args.model, args.model.options(), &progress)?;
    match &args.output {
        None => diagnosis.print(None, &Outcome::Checked, progress)?,
        Some(file) => {
            progress.stage("writing");
            write_bytes(file, &diagnosis.render(None, &Outcome::Checked)?)?;
        }
    }
    Ok(ExitCode::from(u8::from(diagnosis.is_refused())))
}
