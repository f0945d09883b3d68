//! `qless`: says which constraint equations of a finite-element model are redundant or conflicting, and reduces them.
//!
//! | module | holds |
//! | --- | --- |
//! | [`args`] | the command line |
//! | [`check`], [`reduce`], [`clean`], [`generate`], [`bench`] | the commands, one each |
//! | [`diagnose`] | what check, reduce and clean share: read, analyse, time it |
//! | [`deck_input`] | the load cases of a deck, what was left out, what its solver refuses or drops |
//! | [`preferences`] | equations and DOFs that the user lists, by numbers or names |
//! | [`report`] | the report: text, JSON, HTML, VTU |
//! | [`wording`] | how equations, DOFs and numbers are written in limited space |
//! | [`terminal`] | standard output and the progress display |
//! | [`signals`] | what `SIGTERM` and its like do |
//! | [`memory`] | the limit on it, and the end of a run that gets none |
//! | [`ranks`] | runs under `mpirun` |
//! | [`failure`] | errors of the commands and their messages |
//! | [`exit_code`] | all exit codes |

mod args;
mod bench;
mod check;
mod clean;
mod deck_input;
mod diagnose;
mod exit_code;
mod failure;
mod generate;
mod memory;
mod preferences;
mod ranks;
mod reduce;
mod report;
mod scenes;
#[cfg(unix)]
mod signals;
mod terminal;
mod wording;

use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};
use failure::CliFailure;

#[global_allocator]
static GUARD: memory::Guard = memory::Guard;

fn main() -> ExitCode {
    memory::on_out_of_memory(qless_io::write::abandon_unless_at_work);
    match ranks::Job::of_environment() {
        Some(job) => job.run(),
        None => run(&Cli::parse().command).unwrap_or_else(|failure| failure.tell()),
    }
}

/// Sets limits on memory, and what signals do.
fn set_up(command: &Command) -> Result<(), CliFailure> {
    if let Some(bytes) = command.memory() {
        memory::limit(bytes).map_err(CliFailure::Resource)?;
    }
    #[cfg(unix)]
    signals::watch().map_err(|error| CliFailure::of_memory(&format!("signals cannot be waited for: {error}")))?;
    Ok(())
}

fn run(command: &Command) -> Result<ExitCode, CliFailure> {
    set_up(command)?;
    match command {
        Command::Check(args) => check::run(args),
        Command::Reduce(args) => reduce::run(args),
        Command::Clean(args) => clean::run(args),
        Command::Generate(args) => generate::run(args),
        Command::Bench(args) => bench::run(args),
    }
}
