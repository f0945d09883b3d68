//! Handles `SIGTERM`, `SIGINT` and `SIGHUP`: removes temporary folders, and leaves no set of files half in place.
//!
//! A commit in progress is finished first. The program then ends by the signal, so that a shell sees 128 plus its number. A signal that
//! was ignored when the program started, as under `nohup`, stays ignored.

use std::io;
use std::thread::Builder;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use crate::memory::threads;

/// Starts the thread that waits for signals.
///
/// # Errors
/// The system provides no thread or no pipe.
pub fn watch() -> io::Result<()> {
    let heeded = [SIGTERM, SIGINT, SIGHUP].into_iter().filter(|&signal| !is_ignored(signal));
    let mut signals = Signals::new(heeded)?;
    threads::begin(Builder::new().name("signals".into()), move || {
        if let Some(signal) = signals.forever().next() {
            qless_io::write::abandon();
            // The call returns only if the signal cannot be raised.
            let _ = emulate_default_handler(signal);
            std::process::exit(128 + signal);
        }
    })?;
    Ok(())
}

#[expect(unsafe_code, reason = "no safe function reads the action of a signal")]
fn is_ignored(signal: i32) -> bool {
    // SAFETY: without a new action, `sigaction` only writes to `action`. That is plain data, for which zero is valid, and it is read only
    // if the call succeeded.
    unsafe {
        let mut action: libc::sigaction = std::mem::zeroed();
        libc::sigaction(signal, std::ptr::null(), &raw mut action) == 0 && action.sa_sigaction == libc::SIG_IGN
    }
}
