//! `qless`: finds redundant and conflicting constraint equations of a finite-element model, and reduces them.
//!
//! | module | holds |
//! | --- | --- |
//! | [`args`] | the command line |
//! | [`check`], [`reduce`], [`clean`], [`explain`], [`diff`], [`generate`], [`bench`] | the commands, one each |
//! | [`diagnose`] | reads and analyses a model, for check, reduce, clean, explain and diff |
//! | [`deck_input`] | load cases of a deck, constraints that were left out, reactions of the solver |
//! | [`preferences`] | lists of equations and DOFs, by numbers or names |
//! | [`report`] | renders the report: text, JSON, HTML, VTU, SARIF, JUnit |
//! | [`scenes`], [`values`] | options of the test models; parsers of option values |
//! | [`wording`] | writes equations, DOFs and numbers in limited space |
//! | [`terminal`] | standard output and the progress display |
//! | [`signals`] | reaction to `SIGTERM`, `SIGINT` and `SIGHUP` |
//! | [`memory`] | memory limit, and the end of a run without memory |
//! | [`ranks`] | runs under `mpirun` |
//! | [`failure`] | errors of the commands and their messages |
//! | [`exit_code`] | all exit codes |

mod args;
mod bench;
mod check;
mod clean;
mod deck_input;
mod diagnose;
mod diff;
mod exit_code;
mod explain;
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
mod values;
mod wording;

use std::process::ExitCode;

use clap::Parser;
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use args::{Cli, Command};
use failure::CliFailure;

#[global_allocator]
static GUARD: memory::Guard = memory::Guard;

fn main() -> ExitCode {
    memory::on_out_of_memory(qless_io::write::abandon_unless_at_work);
    match ranks::Job::from_environment() {
        Some(job) => job.run(),
        None => run(&parse().command).unwrap_or_else(|failure| failure.tell()),
    }
}

fn parse() -> Cli {
    Cli::try_parse().unwrap_or_else(|mut error| {
        advise(&mut error);
        failure::say_usage(&error);
        std::process::exit(error.exit_code())
    })
}

/// Replaces clap's advice for an unknown argument, to pass it as a value after `--`: no value of this program begins with a dash. For a
/// word without a dash, the advice is to quote values that have spaces.
fn advise(error: &mut clap::Error) {
    if error.kind() != ErrorKind::UnknownArgument {
        return;
    }
    error.remove(ContextKind::Suggested);
    let unknown = error.get(ContextKind::InvalidArg).map(ToString::to_string).unwrap_or_default();
    if !unknown.starts_with('-') {
        let quotes = StyledStr::from("quote a value with spaces, as in `qless explain deck.inp 'row 28'`");
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![quotes]));
    }
}

/// Sets the memory limit and handles signals.
fn set_up(command: &Command) -> Result<(), CliFailure> {
    if let Some(bytes) = command.memory() {
        memory::limit(bytes).map_err(CliFailure::Resource)?;
    }
    #[cfg(unix)]
    signals::watch().map_err(|error| CliFailure::from_memory(&format!("cannot wait for signals: {error}")))?;
    Ok(())
}

fn run(command: &Command) -> Result<ExitCode, CliFailure> {
    set_up(command)?;
    match command {
        Command::Check(args) => check::run(args),
        Command::Reduce(args) => reduce::run(args),
        Command::Clean(args) => clean::run(args),
        Command::Explain(args) => explain::run(args),
        Command::Diff(args) => diff::run(args),
        Command::Generate(args) => generate::run(args),
        Command::Bench(args) => bench::run(args),
    }
}
