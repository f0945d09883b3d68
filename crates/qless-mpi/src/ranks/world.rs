//! The ranks of an MPI job.

mod exchange;
mod fault;
mod patience;

use std::cell::Cell;
use std::fmt;
use std::marker::PhantomData;

use mpi::Threading;
use mpi::collective::SystemOperation;
use mpi::environment::Universe;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives};

use super::{Message, Ranks};

/// The ranks of an MPI job or of a communicator.
///
/// Its messages use a communicator of their own, so they do not mix with those of the caller. All calls must come from the thread
/// that created it.
///
/// # Faults
/// A rank that panics while it has a `World` ends the whole job by `MPI_Abort` with the exit code 101, so that the others do not
/// wait for ever. MPI itself ends the job if a process dies, and on its own errors. An ordinary `return` of one rank while others
/// wait for it is not detected: agree on errors first, for example by [`crate::agree`].
///
/// ```no_run
/// use qless_mpi::{Message, Ranks, World};
/// let world = World::start()?;
/// // Each rank sends its number to the next.
/// let next = (world.rank() + 1) % world.size();
/// let received = world.exchange(vec![Message { rank: next, words: vec![world.rank() as u64] }]);
/// assert_eq!(received[0].words[0] as usize, received[0].rank);
/// # Ok::<(), qless_mpi::WorldError>(())
/// ```
pub struct World {
    // Fields are dropped in this order, so the communicator is freed before MPI ends.
    communicator: SimpleCommunicator,
    universe: Option<Universe>,
    rank: usize,
    size: usize,
    piece: usize,
    /// Number of calls of `exchange` so far.
    rounds: Cell<u64>,
    /// Makes the type `!Send`, because MPI takes calls from one thread only. Handles of some MPI libraries are numbers, which are `Send`.
    one_thread: PhantomData<*const ()>,
}

/// Why a [`World`] cannot be created.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WorldError {
    /// MPI is already initialised.
    #[error("MPI is already initialised: call World::of with a communicator instead of World::start")]
    Started,
    /// MPI is not initialised, or it is finalised.
    #[error("MPI is not running: call World::start, or MPI_Init before World::of and MPI_Finalize after its end")]
    NotRunning,
    /// The library was built without threads.
    #[error("this MPI library does not support MPI_THREAD_FUNNELED, which the threads of the analysis need")]
    Threads,
    /// The communicator is an inter-communicator.
    #[error("this is an inter-communicator: merge its two groups first (MPI_Intercomm_merge)")]
    TwoGroups,
}

impl World {
    /// Initialises MPI with all ranks of the job. Dropping the value finalises MPI.
    ///
    /// # Errors
    /// [`WorldError::Started`] if MPI was initialised before, [`WorldError::Threads`] if the library has no thread support.
    pub fn start() -> Result<Self, WorldError> {
        let (universe, level) = mpi::initialize_with_threading(Threading::Funneled).ok_or(WorldError::Started)?;
        if level < Threading::Funneled {
            return Err(WorldError::Threads);
        }
        let mut world = Self::of(&universe.world())?;
        world.universe = Some(universe);
        Ok(world)
    }

    /// The ranks of a communicator, for programs that initialise MPI themselves. Collective. The communicator is duplicated. Drop the
    /// result before `MPI_Finalize`.
    ///
    /// # Errors
    /// [`WorldError::NotRunning`] before `MPI_Init` and after `MPI_Finalize`, [`WorldError::TwoGroups`] for an inter-communicator.
    pub fn of(communicator: &impl Communicator) -> Result<Self, WorldError> {
        if !mpi::is_initialized() || mpi::is_finalized() {
            return Err(WorldError::NotRunning);
        }
        if communicator.test_inter() {
            return Err(WorldError::TwoGroups);
        }
        Ok(Self::on(communicator.duplicate()))
    }

    fn on(communicator: SimpleCommunicator) -> Self {
        fault::make_fatal(&communicator);
        let (rank, size) = (communicator.rank() as usize, communicator.size() as usize);
        let (rounds, one_thread) = (Cell::new(0), PhantomData);
        Self { communicator, universe: None, rank, size, piece: exchange::WORDS, rounds, one_thread }
    }

    /// Sends long messages in pieces of this many words: by default 2^27 (1 GiB), at most 2^31 - 1. All ranks must set the same length.
    #[must_use]
    pub fn in_pieces(mut self, words: usize) -> Self {
        self.piece = words.clamp(1, i32::MAX as usize);
        self
    }

    fn reduce(&self, numbers: &mut [u64], operation: SystemOperation) {
        let own = numbers.to_vec();
        for (from, to) in own.chunks(self.piece).zip(numbers.chunks_mut(self.piece)) {
            mpi::request::scope(|scope| {
                patience::wait(self.communicator.immediate_all_reduce_into(scope, from, to, operation));
            });
        }
    }
}

impl Ranks for World {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn exchange(&self, messages: Vec<Message>) -> Vec<Message> {
        exchange::exchange(self, messages)
    }

    /// How much of the transfer overlaps with `work` depends on the MPI library: many transfer long messages only inside MPI calls.
    fn overlap(&self, messages: Vec<Message>, from: &[usize], work: &mut dyn FnMut()) -> Vec<Message> {
        exchange::overlap(self, messages, from, work)
    }

    fn sum(&self, numbers: &mut [u64]) {
        self.reduce(numbers, SystemOperation::sum());
    }

    fn max(&self, numbers: &mut [u64]) {
        self.reduce(numbers, SystemOperation::max());
    }

    fn gather(&self, numbers: &[u64]) -> Vec<u64> {
        let count = numbers.len() * self.size;
        assert!(i32::try_from(count).is_ok(), "{count} numbers are too many to gather on every rank: at most 2^31 - 1");
        let mut all = vec![0; count];
        mpi::request::scope(|scope| {
            patience::wait(self.communicator.immediate_all_gather_into(scope, numbers, &mut all[..]));
        });
        all
    }
}

impl Drop for World {
    fn drop(&mut self) {
        fault::end_job_if_panicking();
    }
}

impl fmt::Debug for World {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "World(rank {} of {})", self.rank, self.size)
    }
}
