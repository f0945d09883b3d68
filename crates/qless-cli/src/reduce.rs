//! `qless reduce`: writes `u_s = T u_q + G u_p + g` as files, all or none.

mod blocks;

use std::collections::BTreeSet;
use std::io;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use qless::Reduction;
use qless_io::WriteError;
use qless_io::write::Output;

use crate::args::ReduceArgs;
use crate::diagnose::{Diagnosis, Question, diagnose};
use crate::failure::{CliFailure, say};
use crate::report::{CommandOutcome, Reduced};
use crate::terminal::Progress;

/// Files of every reduction, without those of factors.
pub const FILES: [&str; 7] = ["T.mtx", "G.mtx", "g.txt", "slaves.txt", "masters.txt", "prescribed.txt", "cols.txt"];

/// Writes the files and prints the report; for conflicting or incomplete equations it only prints the report.
pub fn run(args: &ReduceArgs) -> Result<ExitCode, CliFailure> {
    check_place(args)?;
    let progress = Progress::new(args.model.quiet);
    let question = Question { options: args.options(), preferences: args.preferences(), choice: args.choice() };
    let diagnosis = diagnose(&args.model, question, &progress)?;
    if diagnosis.is_refused() || diagnosis.is_incomplete() {
        let way = if diagnosis.is_refused() { "" } else { ", or use --allow-incomplete" };
        diagnosis.print(None, &CommandOutcome::Refused, progress)?;
        say(format_args!("error: nothing was written to {}: see the report{way}", args.output.display()));
        return Ok(diagnosis.code());
    }
    progress.stage("reducing");
    let start = Instant::now();
    let refused = |error| CliFailure::from_reduction(error, &args.model.input, &diagnosis.system);
    let reduction = diagnosis.analysis.reduction_in(args.form).map_err(refused)?;
    let time = start.elapsed();
    progress.stage("writing");
    write(args, &reduction, &diagnosis)?;
    let reduced = Reduced { reduction: &reduction, form: args.form, time };
    diagnosis.print(Some(reduced), &CommandOutcome::Written(&args.output), progress)?;
    Ok(ExitCode::SUCCESS)
}

fn write(args: &ReduceArgs, reduction: &Reduction, diagnosis: &Diagnosis) -> Result<(), CliFailure> {
    let mut output = Output::new(&args.output)?.sparing(diagnosis.inputs());
    add(&mut output, reduction, diagnosis.system.dof_labels())?;
    for (block, k) in reduction.factored().iter().zip(1..) {
        let parts = block.parts().ok_or_else(|| beyond_range(args, k))?;
        blocks::write(&mut output, k, block, &parts)?;
    }
    for name in stale(&args.output, reduction.factored().len())? {
        output.absent(&name)?;
    }
    Ok(output.commit()?)
}

fn add(output: &mut Output, reduction: &Reduction, labels: &[String]) -> Result<(), WriteError> {
    output.matrix("T.mtx", reduction.t())?;
    output.matrix("G.mtx", reduction.g_matrix())?;
    output.numbers("g.txt", reduction.g())?;
    output.indices("slaves.txt", reduction.slaves())?;
    output.indices("masters.txt", reduction.masters())?;
    output.indices("prescribed.txt", reduction.prescribed())?;
    // A user does not know the column numbers of a deck.
    if !labels.is_empty() {
        output.file("cols.txt", |out| labels.iter().try_for_each(|label| writeln!(out, "{label}")))?;
    }
    Ok(())
}

fn beyond_range(args: &ReduceArgs, number: usize) -> CliFailure {
    CliFailure::Input(format!(
        "{}: the units of block {number} differ too much: its factors would exceed 1e308; rescale its equations, or use --form \
         explicit",
        args.model.input.display()
    ))
}

/// Files of factors from an earlier run, which would look like new ones.
fn stale(folder: &Path, count: usize) -> Result<BTreeSet<String>, WriteError> {
    match blocks::stale(folder, count) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(WriteError::Io { path: folder.to_path_buf(), source: error })
        }
        found => Ok(found.unwrap_or_default()),
    }
}

/// Refuses an output folder that cannot be written, or whose files would be lost.
fn check_place(args: &ReduceArgs) -> Result<(), CliFailure> {
    // A case and a reduction both have a prescribed.txt, with different meanings.
    if args.output.join("C.mtx").symlink_metadata().is_ok() {
        return Err(CliFailure::Input(format!(
            "{}: the folder holds a case (C.mtx) with its own prescribed.txt, which would be overwritten; name another folder with -o",
            args.output.display()
        )));
    }
    let output = Output::new(&args.output)?.sparing(args.model.inputs());
    for name in FILES.map(String::from).into_iter().chain(stale(&args.output, 0)?) {
        output.check(&name)?;
    }
    Ok(())
}
