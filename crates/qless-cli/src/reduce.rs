//! `qless reduce`: `u_s = T u_q + G u_p + g` as files, all or none.

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use qless::Reduction;
use qless_io::WriteError;
use qless_io::write::Output;

use crate::args::ReduceArgs;
use crate::diagnose::diagnose;
use crate::failure::{Failure, say};
use crate::progress::Progress;
use crate::text::Outcome;

/// What is written.
pub const FILES: [&str; 7] = ["T.mtx", "G.mtx", "g.txt", "slaves.txt", "masters.txt", "prescribed.txt", "cols.txt"];

/// Writes the files and prints the report, or, for conflicting equations, prints the report only.
pub fn run(args: &ReduceArgs) -> Result<ExitCode, Failure> {
    spare_the_input(args)?;
    // A place that cannot be written to is better known before the work than after.
    drop(Output::new(&args.output)?);
    let progress = Progress::new(args.model.quiet);
    let diagnosis = diagnose(&args.model, args.options(), &progress)?;
    if diagnosis.is_refused() {
        diagnosis.print(None, &Outcome::Refused, progress)?;
        say(format_args!("error: nothing was written to {}: see the report", args.output.display()));
        return Ok(ExitCode::from(1));
    }
    progress.stage("reducing");
    let start = Instant::now();
    let refused = |error| Failure::of_reduction(error, &args.model.input, &diagnosis.system);
    let reduction = diagnosis.analysis.reduction(&diagnosis.system).map_err(refused)?;
    let time = start.elapsed();
    progress.stage("writing");
    write(&args.output, &reduction, diagnosis.system.dof_labels())?;
    diagnosis.print(Some((&reduction, time)), &Outcome::Written(&args.output), progress)?;
    Ok(ExitCode::SUCCESS)
}

fn write(folder: &Path, reduction: &Reduction, labels: &[String]) -> Result<(), WriteError> {
    let mut output = Output::new(folder)?;
    output.matrix("T.mtx", &reduction.t)?;
    output.matrix("G.mtx", &reduction.g_matrix)?;
    output.numbers("g.txt", &reduction.g)?;
    output.indices("slaves.txt", &reduction.slaves)?;
    output.indices("masters.txt", &reduction.masters)?;
    output.indices("prescribed.txt", &reduction.prescribed)?;
    // Columns of a deck are nobody's numbers.
    if !labels.is_empty() {
        output.file("cols.txt", |out| labels.iter().try_for_each(|label| writeln!(out, "{label}")))?;
    }
    output.commit()
}

/// The prescribed.txt of a reduction is not that of a case: never write one over the other.
fn spare_the_input(args: &ReduceArgs) -> Result<(), Failure> {
    let refuse = |what: String| {
        let folder = args.output.display();
        Err(Failure::Input(format!("{folder}: {what}, which would be overwritten; name another folder with -o")))
    };
    if args.output.join("C.mtx").symlink_metadata().is_ok() {
        return refuse("the folder holds a case (C.mtx) with its own prescribed.txt".to_owned());
    }
    let model = &args.model;
    let inputs = [Some(&model.input), model.rhs.as_ref(), model.prescribed.as_ref()];
    let inputs: Vec<_> = inputs.into_iter().flatten().filter_map(|path| path.canonicalize().ok()).collect();
    for name in FILES {
        if args.output.join(name).canonicalize().is_ok_and(|path| inputs.contains(&path)) {
            return refuse(format!("{name} there is part of the input"));
        }
    }
    Ok(())
}
