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

/// The ranks of an MPI job, or of a part of it.
///
/// Its messages travel on a communicator of its own and never mix with those of the code around it. All calls come from the thread
/// that made it.
///
/// # Faults
/// A rank that panics while it has a `World` ends the whole job, by `MPI_Abort` with the exit code 101, so that the others do not
/// wait for it for ever. MPI itself ends the job when a process dies, and on its own errors. Not detected is a rank that
/// leaves by an ordinary `return` while others still wait for it: agree on errors first, by [`Ranks::max`] for example.
///
/// ```no_run
/// use qless_mpi::{Message, Ranks, World};
/// let world = World::start()?;
/// // Each rank tells the next one its number.
/// let next = (world.rank() + 1) % world.size();
/// let told = world.exchange(vec![Message { rank: next, words: vec![world.rank() as u64] }]);
/// assert_eq!(told[0].words[0] as usize, told[0].rank);
/// # Ok::<(), qless_mpi::WorldError>(())
/// ```
pub struct World {
    // Freed before MPI ends: fields are dropped in their order.
    communicator: SimpleCommunicator,
    universe: Option<Universe>,
    rank: usize,
    size: usize,
    piece: usize,
    /// Rounds of `exchange` so far.
    rounds: Cell<u64>,
    /// MPI wants its calls from one thread; some libraries' handles are plain numbers, which could go to others.
    one_thread: PhantomData<*const ()>,
}

/// Why there is no [`World`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WorldError {
    /// Somebody has initialised MPI.
    #[error("MPI has been initialised before: give World::of the communicator instead of World::start")]
    Started,
    /// Nobody has initialised MPI, or it has ended.
    #[error("MPI is not running: call World::start, or MPI_Init before World::of and MPI_Finalize after its end")]
    NotRunning,
    /// The library was built without threads.
    #[error(
        "this MPI library gives no thread level of at least MPI_THREAD_FUNNELED, which is needed beside threads that compute"
    )]
    Threads,
    /// A communicator between two groups.
    #[error("this communicator joins two groups of ranks: merge it (MPI_Intercomm_merge) first")]
    TwoGroups,
}

impl World {
    /// Initialises MPI and takes all ranks of the job. MPI is finalised when this value is dropped.
    ///
    /// # Errors
    /// [`WorldError::Started`] if MPI was initialised before in this process, [`WorldError::Threads`] if the library knows no threads.
    pub fn start() -> Result<Self, WorldError> {
        let (universe, level) = mpi::initialize_with_threading(Threading::Funneled).ok_or(WorldError::Started)?;
        if level < Threading::Funneled {
            return Err(WorldError::Threads);
        }
        let mut world = Self::of(&universe.world())?;
        world.universe = Some(universe);
        Ok(world)
    }

    /// The ranks of a communicator, for codes that have initialised MPI themselves; all of its ranks call it together. The
    /// communicator is duplicated and stays as it is. Drop what is returned before `MPI_Finalize`.
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

    /// Sets the length in words of the pieces in which long messages are sent: by default 2^27 (1 GiB), at most 2^31 - 1. All ranks
    /// must set the same length.
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

    /// The MPI library decides how much of the transfer overlaps with `work`: many transfer long messages only inside MPI calls.
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
