//! Writes to standard output, buffered and checked; displays progress on standard error.
//!
//! A full disk is an error, not a panic. A closed pipe, as by `head`, is no error and does not change the exit code.

use std::io::{self, BufWriter, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::failure::CliFailure;
use crate::memory::threads;
use crate::wording::layout::wrap;
use crate::wording::printable;

/// Calls `write` with a buffer, and writes its text to standard output with unprintable characters replaced.
pub fn write(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), CliFailure> {
    let mut text = Vec::new();
    write(&mut text).map_err(|error| CliFailure::from_stdout(&error))?;
    show_text(printable::text(&String::from_utf8_lossy(&text)).as_bytes())
}

/// Calls `write` with a buffer, and writes its JSON to standard output with unprintable characters escaped.
pub fn show_json(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), CliFailure> {
    let mut json = Vec::new();
    write(&mut json).map_err(|error| CliFailure::from_stdout(&error))?;
    show(&printable::report(json, true))
}

/// Writes a report to standard output. Its characters must be printable.
pub fn show(report: &[u8]) -> Result<(), CliFailure> {
    stream(|out| out.write_all(report))
}

/// Writes printable text to standard output. On a terminal, lines are broken at its width; a file or a pipe gets them unbroken.
pub fn show_text(text: &[u8]) -> Result<(), CliFailure> {
    match terminal_size::terminal_size_of(io::stdout()) {
        Some((columns, _)) => show(wrap(&String::from_utf8_lossy(text), columns.0.into()).as_bytes()),
        None => show(text),
    }
}

/// Calls `write` with standard output, and flushes it. The text must be printable; use this for text that is written step by step.
pub fn stream(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), CliFailure> {
    let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
    match write(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(CliFailure::from_stdout(&error)),
        _ => Ok(()),
    }
}

/// A spinner on standard error with the stage and the time; removed when dropped.
pub struct Progress(ProgressBar);

impl Progress {
    /// Draws nothing if `quiet` or if standard error is no terminal.
    pub fn new(quiet: bool) -> Self {
        if quiet {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::new_spinner().with_message("starting");
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} ({elapsed})") {
            bar.set_style(style.tick_chars("-\\|/ "));
        }
        // The display runs in a thread of its own, and panics if it cannot start one. So a possible thread is checked for first.
        if !bar.is_hidden() && threads::is_one_more_possible() {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        Self(bar)
    }

    /// Shows the name of a stage.
    pub fn stage(&self, name: &'static str) {
        self.0.set_message(name);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
