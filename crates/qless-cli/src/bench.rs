//! `qless bench`: runs the measurements of the crate qless-bench with standard output and the progress display.

use std::process::ExitCode;

use qless_bench::{BenchArgs, BenchError};

use crate::failure::CliFailure;
use crate::terminal::{self, Progress};

/// Runs the measurements, prints their results and writes the output files.
pub fn run(args: &BenchArgs) -> Result<ExitCode, CliFailure> {
    let mut progress = None;
    let stage = move |name| progress.get_or_insert_with(|| Progress::new(args.quiet)).stage(name);
    qless_bench::run(args, stage, |text| terminal::stream(|out| text(out)))?;
    Ok(ExitCode::SUCCESS)
}

impl From<BenchError> for CliFailure {
    fn from(error: BenchError) -> Self {
        match error {
            BenchError::Input(message) => Self::Input(message),
            BenchError::Resource(message) => Self::Resource(message),
            BenchError::Write(error) => error.into(),
        }
    }
}
