//! Runs long calls without the interpreter lock, so that Ctrl-C can interrupt them.
//!
//! The library has no point at which a factorization can be stopped. So a long call runs on a thread of its own while the calling thread
//! waits for signals. After Ctrl-C the caller gets `KeyboardInterrupt` at once, and the thread ends when its work is done; its result is
//! dropped.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Number of coefficients below which a call takes less than a few milliseconds, and a thread would cost more than it gives.
const SHORT: usize = 20_000;
/// Time between two checks for signals, too short for a person to notice.
const LOOK: Duration = Duration::from_millis(50);

/// Runs `work` on `size` coefficients without the interpreter lock.
pub fn run<R: Send + 'static>(py: Python<'_>, size: usize, work: impl FnOnce() -> R + Send + 'static) -> PyResult<R> {
    if size < SHORT {
        return Ok(py.detach(work));
    }
    let (sender, receiver) = channel();
    // Sending fails after Ctrl-C, because the receiver no longer exists.
    let worker = std::thread::Builder::new().name("qless".to_owned()).spawn(move || _ = sender.send(work()))?;
    // The closure below borrows the receiver, which must be `Sync` for this. A lock, which no other thread takes, makes it `Sync`.
    let receiver = std::sync::Mutex::new(receiver);
    loop {
        let received = py.detach(|| match receiver.lock() {
            Ok(receiver) => receiver.recv_timeout(LOOK),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        });
        match received {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                drop(worker.join());
                return Err(PyRuntimeError::new_err("qless stopped on an internal error; please report it"));
            }
        }
    }
}
