//! Refuses to run under `mpirun` without MPI: every process would do the same work and write the same files.

use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;

use super::Job;
use crate::args::Cli;
use crate::failure::CliFailure;

/// `mpirun` ends all processes when one ends with an error: the other processes wait until the first has written its message.
const PATIENCE: Duration = Duration::from_millis(500);

impl Job {
    /// Writes the reason once; help and version work as usual.
    pub fn run(self) -> ExitCode {
        let parsed = Cli::try_parse();
        if self.rank > 0 {
            std::thread::sleep(PATIENCE);
            return ExitCode::from(parsed.err().map_or(2, |error| error.exit_code() as u8));
        }
        match parsed {
            Ok(_) => CliFailure::Input(
                "mpirun has started several processes, and this qless was built without MPI: start one, or build it with \
                 `cargo build --features mpi` (started by a program of such a job it runs with OMPI_COMM_WORLD_SIZE and PMI_SIZE unset)"
                    .to_owned(),
            )
            .tell(),
            Err(error) => {
                // An error of standard error cannot be reported anywhere.
                let _ = error.print();
                ExitCode::from(error.exit_code() as u8)
            }
        }
    }
}
