//! Runs under `mpirun`: the ranks check one model together, and the first one reports.

#[cfg(feature = "mpi")]
mod check;
#[cfg(feature = "mpi")]
mod job;
#[cfg(not(feature = "mpi"))]
mod refuse;
#[cfg(feature = "mpi")]
mod report;

#[cfg(feature = "mpi")]
use qless_mpi::{Ranks, Said, agree};

#[cfg(feature = "mpi")]
use crate::{exit_code, failure::CliFailure};

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
}

/// The result of this rank, or the failure of the first rank that failed; collective.
#[cfg(feature = "mpi")]
fn all<T>(ranks: &dyn Ranks, own: Result<T, CliFailure>) -> Result<T, CliFailure> {
    let message = own.map_err(|failure| match failure {
        CliFailure::Input(text) => Said { code: exit_code::INPUT.into(), text },
        CliFailure::Resource(text) => Said { code: exit_code::RESOURCE.into(), text },
    });
    agree(ranks, message).map_err(|message| match message.code {
        code if code == u64::from(exit_code::INPUT) => CliFailure::Input(message.text),
        _ => CliFailure::Resource(message.text),
    })
}
