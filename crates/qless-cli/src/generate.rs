//! `qless generate`: test models of known rank, as case folders.

use std::process::ExitCode;

use clap::CommandFactory;
use clap::error::ErrorKind;
use qless_io::write::Output;
use qless_scenes::{Scene, SceneError};

use crate::args::{Cli, command};
use crate::failure::CliFailure;
use crate::memory;
use crate::scenes::SceneArgs;
use crate::terminal::{self, Progress};

/// Writes the scene to the folder and prints its sizes and its rank.
pub fn run(args: &SceneArgs) -> Result<ExitCode, CliFailure> {
    let Some(folder) = &args.output else {
        let missing = "name the folder to write to: -o <DIR>";
        Cli::command().error(ErrorKind::MissingRequiredArgument, missing).exit()
    };
    memory::threads::start(None).map_err(CliFailure::from_threads)?;
    let progress = Progress::new(args.quiet);
    progress.stage("generating");
    let scene = args.scene.generate().map_err(|error| refused(&error))?;
    progress.stage("writing");
    let mut output = Output::new(folder)?.by(&command());
    output.case(&scene.system)?;
    output.commit()?;
    drop(progress);
    terminal::write(|out| writeln!(out, "Wrote {}: {}", folder.display(), describe(&scene)))?;
    Ok(ExitCode::SUCCESS)
}

fn refused(error: &SceneError) -> CliFailure {
    CliFailure::Input(format!("no such scene: {error}"))
}

/// Describes the scene: sizes, and the rank that its construction implies.
fn describe(scene: &Scene) -> String {
    let (system, truth) = (&scene.system, &scene.truth);
    let sizes = format!(
        "{} equations, {} DOFs ({} prescribed), {} coefficients",
        system.equations(),
        system.dofs(),
        system.prescribed().len(),
        system.matrix().nnz()
    );
    let rank = truth.rank_free.map_or_else(String::new, |rank| format!("; rank {rank}"));
    let dependent = truth.redundant.map_or_else(String::new, |count| format!(", {count} dependent"));
    let conflict = if truth.conflicting { "; conflicting" } else { "" };
    let ambiguous = if truth.ambiguous { "; the numerical rank is ambiguous" } else { "" };
    format!("{sizes}{rank}{dependent}{conflict}{ambiguous}.")
}
