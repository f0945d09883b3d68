//! Runs under `mpirun`: the ranks check one model together, and the first of them speaks.

#[cfg(feature = "mpi")]
mod check;
#[cfg(feature = "mpi")]
mod job;
#[cfg(not(feature = "mpi"))]
mod refuse;
#[cfg(feature = "mpi")]
mod report;

/// Several processes that `mpirun` has started.
#[derive(Clone, Copy)]
pub struct Job {
    /// The number of this process.
    rank: usize,
}

impl Job {
    /// What OpenMPI, MPICH and their like tell the processes that they start; none for one process.
    pub fn of_environment() -> Option<Self> {
        let number = |name: &str| std::env::var(name).ok()?.parse::<usize>().ok();
        let told = [("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"), ("PMI_SIZE", "PMI_RANK")];
        let (size, rank) = told.iter().find_map(|(size, rank)| Some((number(size)?, number(rank)?)))?;
        (size > 1).then_some(Self { rank })
    }
}
