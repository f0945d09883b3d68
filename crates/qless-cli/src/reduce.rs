//! `qless reduce`: writes `u_s = T u_q + G u_p + g` as a set of files with a manifest.

use std::process::ExitCode;
use std::time::Instant;

use qless::Reduction;
use qless::reduction::{FactoredBlock, Parts};
use qless_io::write::Output;
use qless_io::{Manifest, WriteError};

use crate::args::{ReduceArgs, command};
use crate::diagnose::{Diagnosis, Question, diagnose};
use crate::failure::{CliFailure, say};
use crate::report::{CommandOutcome, Reduced};
use crate::terminal::Progress;

/// Names of the files of a reduction, without the files of factors.
const FILES: [&str; 8] =
    ["T.mtx", "G.mtx", "g.txt", "slaves.txt", "masters.txt", "prescribed.txt", "cols.txt", Manifest::NAME];

/// Writes the files and prints the report; for conflicting or incomplete equations it only prints the report.
pub fn run(args: &ReduceArgs) -> Result<ExitCode, CliFailure> {
    check_place(args)?;
    let progress = Progress::new(args.model.quiet);
    let question = Question {
        report: &args.report,
        options: args.options(),
        preferences: args.preferences(),
        choice: args.choice(),
    };
    let diagnosis = diagnose(&args.model, question, &progress)?;
    if diagnosis.is_refused() || diagnosis.is_incomplete() {
        let way = if diagnosis.is_refused() { "" } else { ", or write what was read with --allow-incomplete" };
        diagnosis.print(None, &CommandOutcome::Refused, progress)?;
        say(format_args!("error: nothing was written to {}: see the report{way}", args.output.display()));
        return Ok(ExitCode::from(diagnosis.code()));
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
    let mut output = Output::new(&args.output)?.protecting(diagnosis.inputs()).by(&command());
    add(&mut output, reduction, diagnosis.system.dof_labels())?;
    for (block, k) in reduction.factored().iter().zip(1..) {
        let parts = block.parts().ok_or_else(|| beyond_range(args, k))?;
        add_block(&mut output, k, block, &parts)?;
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
    // A user does not know the column numbers of a deck, so cols.txt names the DOFs.
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

/// Adds the files of the factored block `number`.
fn add_block(output: &mut Output, number: usize, block: &FactoredBlock, parts: &Parts) -> Result<(), WriteError> {
    let name = |file: &str| format!("block{number}_{file}");
    output.matrix(&name("L.mtx"), &parts.lower)?;
    output.matrix(&name("U.mtx"), &parts.upper)?;
    output.matrix(&name("C_M.mtx"), &parts.of_masters)?;
    output.matrix(&name("C_p.mtx"), &parts.of_prescribed)?;
    output.numbers(&name("b.txt"), &parts.rhs)?;
    output.indices(&name("equations.txt"), &parts.equations)?;
    output.indices(&name("slaves.txt"), block.slaves())?;
    output.indices(&name("masters.txt"), block.masters())?;
    output.indices(&name("prescribed.txt"), block.prescribed())
}

/// Refuses an output folder that cannot be written, or in which a file of a case or an input would be overwritten.
fn check_place(args: &ReduceArgs) -> Result<(), CliFailure> {
    // A case and a reduction both have a prescribed.txt, with different meanings: refuse the folder of a case.
    if args.output.join("C.mtx").symlink_metadata().is_ok() {
        return Err(CliFailure::Input(format!(
            "{}: the folder holds a case (C.mtx) with its own prescribed.txt, which would be overwritten; name another folder with -o",
            args.output.display()
        )));
    }
    let output = Output::new(&args.output)?.protecting(args.model.inputs());
    FILES.into_iter().try_for_each(|name| output.check(name))?;
    Ok(())
}
