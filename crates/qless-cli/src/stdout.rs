//! Standard output, buffered and checked: a full disk is an error, not a panic.

use std::io::{self, BufWriter, Write};

use crate::failure::Failure;

/// Gives `write` standard output, and sees that all of it arrives.
pub fn write(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
    write(&mut out).and_then(|()| out.flush()).map_err(|error| Failure::of_stdout(&error))
}
