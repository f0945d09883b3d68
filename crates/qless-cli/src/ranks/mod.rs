//! Runs under `mpirun`: the ranks check one model together, and the first of them reports.

#[cfg(feature = "mpi")]
mod check;
#[cfg(feature = "mpi")]
mod job;
#[cfg(not(feature = "mpi"))]
mod refuse;
#[cfg(feature = "mpi")]
mod report;

#[cfg(feature = "mpi")]
use qless_mpi::{CodedError, Ranks, agree};

#[cfg(feature = "mpi")]
use crate::{exit_code, failure::CliFailure};

/// Several processes that `mpirun` has started.
#[derive(Clone, Copy)]
pub struct Job {
    /// The number of this process.
    rank: usize,
}

impl Job {
    /// Reads the environment variables that OpenMPI and MPICH set; none if there is only one process.
    pub fn of_environment() -> Option<Self> {
        let number = |name: &str| std::env::var(name).ok()?.parse::<usize>().ok();
        let told = [("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"), ("PMI_SIZE", "PMI_RANK")];
        let (size, rank) = told.iter().find_map(|(size, rank)| Some((number(size)?, number(rank)?)))?;
        (size > 1).then_some(Self { rank })
    }
}

/// The result of this rank, or the failure of the first rank that has one; collective.
#[cfg(feature = "mpi")]
fn all<T>(ranks: &dyn Ranks, own: Result<T, CliFailure>) -> Result<T, CliFailure> {
    let said = own.map_err(|failure| match failure {
        CliFailure::Input(text) => CodedError { code: exit_code::INPUT.into(), text },
        CliFailure::Resource(text) => CodedError { code: exit_code::RESOURCE.into(), text },
    });
    agree(ranks, said).map_err(|said| match said.code {
        code if code == u64::from(exit_code::INPUT) => CliFailure::Input(said.text),
        _ => CliFailure::Resource(said.text),
    })
}
