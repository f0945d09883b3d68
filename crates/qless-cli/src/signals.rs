//! Ends by a signal: `SIGTERM`, `SIGINT` and `SIGHUP` leave no temporary folder behind, and no set of files half in place.
//!
//! Files that are being put in place are finished; then the program ends by that signal, so that a shell sees 128 plus its number. A
//! signal that was ignored when the program started, as `nohup` does, stays ignored.

use std::io;

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

/// Starts the thread that waits for signals.
///
/// # Errors
/// The system gives no thread or no pipe.
pub fn watch() -> io::Result<()> {
    let heeded = [SIGTERM, SIGINT, SIGHUP].into_iter().filter(|&signal| !is_ignored(signal));
    let mut signals = Signals::new(heeded)?;
    std::thread::Builder::new().name("signals".into()).spawn(move || {
        if let Some(signal) = signals.forever().next() {
            qless_io::write::abandon();
            // It returns only if the signal cannot be raised.
            let _ = emulate_default_handler(signal);
            std::process::exit(128 + signal);
        }
    })?;
    Ok(())
}

#[expect(unsafe_code, reason = "nothing safe asks what is done with a signal without changing it")]
fn is_ignored(signal: i32) -> bool {
    // SAFETY: `sigaction` with no new action writes to `action` only, which is plain data that may be zero, and is read only where the
    // call has succeeded.
    unsafe {
        let mut action: libc::sigaction = std::mem::zeroed();
        libc::sigaction(signal, std::ptr::null(), &raw mut action) == 0 && action.sa_sigaction == libc::SIG_IGN
    }
}
