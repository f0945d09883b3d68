//! Runs under `mpirun`: the ranks check one model together, and the first one reports.

#[cfg(feature = "mpi")]
mod check;
#[cfg(feature = "mpi")]
mod job;
#[cfg(feature = "mpi")]
mod report;

use std::process::ExitCode;

use clap::Parser;
#[cfg(feature = "mpi")]
use qless_mpi::{CodedError, Ranks, agree};

use crate::args::Cli;
#[cfg(feature = "mpi")]
use crate::exit_code;
use crate::failure::{CliFailure, say_usage};

/// One of several processes started by `mpirun`.
#[derive(Clone, Copy)]
pub struct Job {
    /// Number of this process.
    rank: usize,
}

impl Job {
    /// Reads the environment variables of OpenMPI and MPICH; `None` if there is only one process.
    pub fn from_environment() -> Option<Self> {
        let number = |name: &str| std::env::var(name).ok()?.parse::<usize>().ok();
        let variables = [("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"), ("PMI_SIZE", "PMI_RANK")];
        let (size, rank) = variables.iter().find_map(|(size, rank)| Some((number(size)?, number(rank)?)))?;
        (size > 1).then_some(Self { rank })
    }

    /// Parses the command line. Only the first process prints errors, help and version.
    fn parse(self) -> Result<Cli, ExitCode> {
        Cli::try_parse().map_err(|error| {
            if self.rank == 0 {
                say_usage(&error);
            }
            ExitCode::from(error.exit_code() as u8)
        })
    }

    /// Returns the exit code of a failure; only the first process prints it.
    fn fail(self, failure: &CliFailure) -> ExitCode {
        if self.rank == 0 { failure.tell() } else { ExitCode::from(failure.code()) }
    }

    /// Fails: without MPI, all processes would write the same files.
    #[cfg(not(feature = "mpi"))]
    pub fn run(self) -> ExitCode {
        if self.rank > 0 {
            // `mpirun` ends all processes when one ends with an error: wait until the first has written its message.
            std::thread::sleep(std::time::Duration::from_millis(500));
        }
        match self.parse() {
            Err(code) => code,
            Ok(_) => self.fail(&CliFailure::Input(
                "mpirun has started several processes, and this qless was built without MPI: start only one, or build with \
                 `cargo build --features mpi` (if a program of an MPI job starts it, unset OMPI_COMM_WORLD_SIZE and PMI_SIZE)"
                    .to_owned(),
            )),
        }
    }
}

/// The result of this rank, or the failure of the first rank that failed; collective.
#[cfg(feature = "mpi")]
fn all<T>(ranks: &dyn Ranks, own: Result<T, CliFailure>) -> Result<T, CliFailure> {
    let message = own.map_err(|failure| match failure {
        CliFailure::Input(text) => CodedError { code: exit_code::INPUT.into(), text },
        CliFailure::Resource(text) => CodedError { code: exit_code::RESOURCE.into(), text },
    });
    agree(ranks, message).map_err(|message| match message.code {
        code if code == u64::from(exit_code::INPUT) => CliFailure::Input(message.text),
        _ => CliFailure::Resource(message.text),
    })
}
