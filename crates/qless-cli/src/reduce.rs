//! `qless reduce`: writes `u_s = T u_q + G u_p + g` as files, all or none.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use std::{fs, io};

use qless::Reduction;
use qless::reduction::{FactoredBlock, Parts};
use qless_io::WriteError;
use qless_io::write::Output;

use crate::args::ReduceArgs;
use crate::diagnose::{Diagnosis, Question, diagnose};
use crate::failure::{CliFailure, say};
use crate::report::{CommandOutcome, Reduced};
use crate::terminal::Progress;

/// Files of every reduction, without those of factors.
const FILES: [&str; 7] = ["T.mtx", "G.mtx", "g.txt", "slaves.txt", "masters.txt", "prescribed.txt", "cols.txt"];

/// Files of a part in factor form, such as `block1_L.mtx`: their names after the number of the block.
const BLOCK_FILES: [&str; 9] =
    ["L.mtx", "U.mtx", "C_M.mtx", "C_p.mtx", "b.txt", "equations.txt", "slaves.txt", "masters.txt", "prescribed.txt"];

/// Writes the files and prints the report; for conflicting or incomplete equations it only prints the report.
pub fn run(args: &ReduceArgs) -> Result<ExitCode, CliFailure> {
    check_place(args)?;
    let progress = Progress::new(args.model.quiet);
    let question = Question { options: args.options(), preferences: args.preferences(), choice: args.choice() };
    let diagnosis = diagnose(&args.model, question, &progress)?;
    if diagnosis.is_refused() || diagnosis.is_incomplete() {
        let way = if diagnosis.is_refused() { "" } else { ", or write what was read with --allow-incomplete" };
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
    let mut output = Output::new(&args.output)?.protecting(diagnosis.inputs());
    add(&mut output, reduction, diagnosis.system.dof_labels())?;
    for (block, k) in reduction.factored().iter().zip(1..) {
        let parts = block.parts().ok_or_else(|| beyond_range(args, k))?;
        add_block(&mut output, k, block, &parts)?;
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

/// Adds the files of block `number`.
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

/// Files in a folder that are named after blocks beyond the first `count`. An earlier run wrote them, and they would look
/// like new ones.
fn stale(folder: &Path, count: usize) -> Result<BTreeSet<String>, WriteError> {
    let fail = |source| WriteError::Io { path: folder.to_path_buf(), source };
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(BTreeSet::new()),
        entries => entries.map_err(fail)?,
    };
    let mut names = BTreeSet::new();
    for entry in entries {
        let entry = entry.map_err(fail)?;
        let name = entry.file_name().into_string().ok();
        let name = name.filter(|name| block_number(name).is_some_and(|k| k > count) && !entry.path().is_dir());
        names.extend(name);
    }
    Ok(names)
}

/// Number of the block in a file name.
fn block_number(name: &str) -> Option<usize> {
    let (number, file) = name.strip_prefix("block")?.split_once('_')?;
    let is_plain = number.bytes().all(|digit| digit.is_ascii_digit()) && !number.starts_with('0');
    number.parse().ok().filter(|_| is_plain && BLOCK_FILES.contains(&file))
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
    let output = Output::new(&args.output)?.protecting(args.model.inputs());
    for name in FILES.map(String::from).into_iter().chain(stale(&args.output, 0)?) {
        output.check(&name)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{BLOCK_FILES, block_number};

    #[test]
    fn files_of_blocks_are_known_by_their_names() {
        assert!(BLOCK_FILES.iter().all(|file| block_number(&format!("block12_{file}")) == Some(12)));
        for other in
            ["L.mtx", "block_L.mtx", "block0_L.mtx", "block01_L.mtx", "block+1_L.mtx", "block1_T.mtx", "block1L.mtx"]
        {
            assert_eq!(block_number(other), None, "{other}");
        }
    }
}
