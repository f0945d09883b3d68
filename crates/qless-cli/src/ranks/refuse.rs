//! Refuses to run under `mpirun` if the program was built without MPI: all processes would write the same files.

use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;

use super::Job;
use crate::args::Cli;
use crate::exit_code;
use crate::failure::CliFailure;

/// `mpirun` ends all processes when one ends with an error, so the others wait until the first has written its message.
const PATIENCE: Duration = Duration::from_millis(500);

impl Job {
    /// The first process writes the reason; `--help` and `--version` work as usual.
    pub fn run(self) -> ExitCode {
        let parsed = Cli::try_parse();
        if self.rank > 0 {
            std::thread::sleep(PATIENCE);
            return ExitCode::from(parsed.err().map_or(exit_code::INPUT, |error| error.exit_code() as u8));
        }
        match parsed {
            Ok(_) => CliFailure::Input(
                "mpirun has started several processes, and this qless was built without MPI: start only one, or build with \
                 `cargo build --features mpi` (if a program of an MPI job starts it, unset OMPI_COMM_WORLD_SIZE and PMI_SIZE)"
                    .to_owned(),
            )
            .tell(),
            Err(error) => {
                // A write error could not be reported anywhere.
                let _ = error.print();
                ExitCode::from(error.exit_code() as u8)
            }
        }
    }
}
