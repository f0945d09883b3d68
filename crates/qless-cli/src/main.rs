//! `qless`: says which constraint equations of a finite-element model are redundant or conflicting, and reduces them.
//!
//! | module | holds |
//! | --- | --- |
//! | [`args`] | the command line |
//! | [`check`], [`reduce`], [`clean`], [`generate`], [`bench`] | the commands, one each |
//! | [`diagnose`] | what check, reduce and clean share: read, analyse, time it |
//! | [`deck_input`] | the load cases of a deck, its warnings, what its solver refuses |
//! | [`text`], [`json`], [`html`], [`vtu`] | the forms of the report |
//! | [`signals`] | what `SIGTERM` and its like do |
//! | [`failure`] | what can go wrong, in words, and its exit code |

mod args;
mod bench;
mod check;
mod clean;
mod deck_input;
mod diagnose;
mod failure;
mod generate;
mod html;
mod json;
mod numbers;
mod progress;
mod reduce;
mod scenes;
#[cfg(unix)]
mod signals;
mod stdout;
mod text;
mod version;
mod vtu;

use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};
#[cfg(unix)]
use failure::Failure;

fn main() -> ExitCode {
    let cli = Cli::parse();
    #[cfg(unix)]
    if let Err(error) = signals::watch() {
        return Failure::Resource(format!("signals cannot be waited for: {error}")).tell();
    }
    let done = match &cli.command {
        Command::Check(args) => check::run(args),
        Command::Reduce(args) => reduce::run(args),
        Command::Clean(args) => clean::run(args),
        Command::Generate(args) => generate::run(args),
        Command::Bench(args) => bench::run(args),
    };
    done.unwrap_or_else(|failure| failure.tell())
}
