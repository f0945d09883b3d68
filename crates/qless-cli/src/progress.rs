//! What is going on, for long runs: one line on standard error, if that is a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::memory::threads;

/// A spinner with the stage and the time; gone when dropped.
pub struct Progress(ProgressBar);

impl Progress {
    /// Draws nothing if `quiet`, nor where standard error is no terminal.
    pub fn new(quiet: bool) -> Self {
        if quiet {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} ({elapsed})") {
            bar.set_style(style.tick_chars("-\\|/ "));
        }
        // It ticks from a thread of its own, and panics where there is none to be had.
        if !bar.is_hidden() && threads::is_one_more_possible() {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
        Self(bar)
    }

    /// Names the stage that begins.
    pub fn stage(&self, name: &'static str) {
        self.0.set_message(name);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
