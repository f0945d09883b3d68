//! `qless bench`: what speed costs in accuracy on this machine, for every choice that a user has.
//!
//! Every method runs on every system, in alternation and in one process; times are medians. Truth is known by construction. A method
//! that was slow on a smaller system of the same family is not tried on a larger one.

mod measure;
mod methods;
mod plot;
mod systems;
mod table;

use std::process::ExitCode;

use qless_io::write::Output;

use crate::args::BenchArgs;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::stdout;
use measure::measure;

/// Measures, prints the table and, where a folder is given, writes it with its plots.
pub fn run(args: &BenchArgs) -> Result<ExitCode, Failure> {
    if let Some(folder) = &args.output {
        drop(Output::new(folder)?);
    }
    let progress = Progress::new(args.quiet);
    let methods = methods::all();
    let mut samples = Vec::new();
    for family in systems::families(args.short) {
        progress.stage(family.name);
        samples.extend(measure(&family, &methods, args).map_err(Failure::Input)?);
    }
    drop(progress);
    let text = table::text(&samples, &methods);
    stdout::write(|out| out.write_all(text.as_bytes()))?;
    if let Some(folder) = &args.output {
        let plots = plot::all(&samples, &methods).map_err(Failure::Resource)?;
        let mut output = Output::new(folder)?;
        output.file("trade.csv", |out| out.write_all(table::csv(&samples).as_bytes()))?;
        for (name, svg) in plots {
            output.file(name, |out| out.write_all(svg.as_bytes()))?;
        }
        output.commit()?;
    }
    Ok(ExitCode::SUCCESS)
}
