//! Standard output, buffered and checked: a full disk is an error, not a panic.
//!
//! A reader that has gone, as `head` does, wants no more: that is neither an error nor a word, and changes no exit code.

use std::io::{self, BufWriter, Write};

use crate::failure::Failure;

/// Gives `write` standard output, and sees that all of it arrives.
pub fn write(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
    match write(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::of_stdout(&error)),
        _ => Ok(()),
    }
}
