//! A rank that panics ends the job, since the others would wait for it for ever.

use mpi::ffi;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{AsRaw, Communicator};

/// The exit code of a Rust program that panics.
const EXIT_CODE: i32 = 101;

/// Ends the job if a panic drops it. Declare it after the requests of pending messages, so that it is dropped before them.
pub(super) struct EndOnPanic;

impl Drop for EndOnPanic {
    fn drop(&mut self) {
        end_job_if_panicking();
    }
}

/// Ends the whole job, not only the ranks of this communicator: the others may be waiting too.
pub(super) fn end_job_if_panicking() {
    if std::thread::panicking() && mpi::is_initialized() && !mpi::is_finalized() {
        SimpleCommunicator::world().abort(EXIT_CODE);
    }
}

/// Makes MPI errors end the job. A duplicated communicator inherits the error handler of the calling code. That handler may return error
/// codes, and rsmpi ignores them.
#[allow(unsafe_code)]
pub(super) fn make_fatal(communicator: &SimpleCommunicator) {
    // SAFETY: the communicator is alive, and the handler is one that MPI itself holds from its start to its end.
    unsafe {
        ffi::MPI_Comm_set_errhandler(communicator.as_raw(), ffi::RSMPI_ERRORS_ARE_FATAL);
    }
}
