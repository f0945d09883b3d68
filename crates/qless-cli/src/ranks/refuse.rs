//! A program without MPI under `mpirun`: the same work done many times over, to the same files.

use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;

use super::Job;
use crate::args::Cli;
use crate::failure::Failure;

/// `mpirun` ends all processes when one ends with an error: the first must have spoken by then.
const PATIENCE: Duration = Duration::from_millis(500);

impl Job {
    /// Says why not, once; help and version are said as well.
    pub fn run(self) -> ExitCode {
        let parsed = Cli::try_parse();
        if self.rank > 0 {
            std::thread::sleep(PATIENCE);
            return ExitCode::from(parsed.err().map_or(2, |error| error.exit_code() as u8));
        }
        match parsed {
            Ok(_) => Failure::Input(
                "mpirun has started several processes, and this qless was built without MPI: start one, or build it with \
                 `cargo build --features mpi` (started by a program of such a job it runs with OMPI_COMM_WORLD_SIZE and PMI_SIZE unset)"
                    .to_owned(),
            )
            .tell(),
            Err(error) => {
                // If even that cannot be written there is nobody to tell.
                let _ = error.print();
                ExitCode::from(error.exit_code() as u8)
            }
        }
    }
}
