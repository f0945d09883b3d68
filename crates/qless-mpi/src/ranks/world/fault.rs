//! A rank that fails ends the job: the others would wait for it for ever.

use mpi::ffi;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{AsRaw, Communicator};

/// What a Rust program that panics exits with.
const EXIT_CODE: i32 = 101;

/// Ends the job when it is dropped by a panic. Stands below the requests of messages under way, so that it is
/// dropped before them.
pub(super) struct EndOnPanic;

impl Drop for EndOnPanic {
    fn drop(&mut self) {
        end_job_if_panicking();
    }
}

/// The whole job, not only the ranks of a part: those outside may wait as well.
pub(super) fn end_job_if_panicking() {
    if std::thread::panicking() && mpi::is_initialized() && !mpi::is_finalized() {
        SimpleCommunicator::world().abort(EXIT_CODE);
    }
}

/// A duplicate takes over how the host code treats errors of MPI. Ours must end the job, since rsmpi looks at no error code.
#[allow(unsafe_code)]
pub(super) fn make_fatal(communicator: &SimpleCommunicator) {
    // SAFETY: the communicator is alive, and the handler is one that MPI itself holds from its start to its end.
    unsafe {
        ffi::MPI_Comm_set_errhandler(communicator.as_raw(), ffi::RSMPI_ERRORS_ARE_FATAL);
    }
}
