//! `qless bench`: what speed costs in accuracy on this machine, for every choice that a user has.
//!
//! Every method runs on every system, in alternation and in one process; times are medians. Truth is known by construction. A method
//! that was slow on a smaller system of the same family is not tried on a larger one. Other libraries (feature `peers`) take
//! their turns in processes of their own, which are stopped at the limit.

mod advice;
mod chain;
mod child;
mod gradients;
mod linkages;
mod measure;
mod memory;
mod methods;
mod page;
#[cfg(feature = "peers")]
mod peers;
mod plot;
mod quality;
mod run;
mod spring;
mod systems;
mod table;
#[cfg(test)]
mod tests;

use std::process::ExitCode;

use qless_io::write::Output;

use crate::args::BenchArgs;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::stdout;
use measure::measure;

/// Measures, prints the table and, where a folder is given, writes it with its plots.
pub fn run(args: &BenchArgs) -> Result<ExitCode, Failure> {
    let methods = methods::all(&args.method);
    let families = systems::families(args.short, &args.family);
    if methods.is_empty() || families.is_empty() {
        return Err(Failure::Input(names()));
    }
    if let Some(size) = &args.child {
        return as_child(size, &families[0], &methods[0]);
    }
    if let Some(folder) = &args.output {
        drop(Output::new(folder)?);
    }
    let progress = Progress::new(args.quiet);
    let mut samples = Vec::new();
    for family in families {
        progress.stage(family.name);
        samples.extend(measure(&family, &methods, args).map_err(Failure::Input)?);
    }
    drop(progress);
    let text = table::text(&samples, &methods);
    stdout::write(|out| out.write_all(text.as_bytes()))?;
    if let Some(folder) = &args.output {
        let plots = plot::all(&samples, &methods).map_err(Failure::Resource)?;
        let mut output = Output::new(folder)?;
        output.file("trade.csv", |out| out.write_all(table::csv(&samples, &methods).as_bytes()))?;
        let page = page::markdown(&samples, &methods, &command(args));
        output.file("trade.md", |out| out.write_all(page.as_bytes()))?;
        for (name, svg) in plots {
            output.file(name, |out| out.write_all(svg.as_bytes()))?;
        }
        output.commit()?;
    }
    Ok(ExitCode::SUCCESS)
}

/// One method on one system, for the process that started this one.
fn as_child(size: &str, family: &systems::Family, method: &methods::Method) -> Result<ExitCode, Failure> {
    let case = family.cases.iter().find(|case| case.size == size);
    let case = case.ok_or_else(|| Failure::Input(format!("{} has no size {size}", family.name)))?;
    let scene = case.scene().map_err(Failure::Input)?;
    stdout::write(|out| child::answer(&scene, method, out))?;
    Ok(ExitCode::SUCCESS)
}

/// What there is to choose from.
fn names() -> String {
    let methods: Vec<&str> = methods::all(&[]).iter().map(|method| method.name).collect();
    let families: Vec<&str> = systems::families(false, &[]).iter().map(|family| family.name).collect();
    format!("no such family or method; families: {}; methods: {}", families.join(", "), methods.join("; "))
}

/// The command that measures the same again.
fn command(args: &BenchArgs) -> String {
    let short = if args.short { " --short" } else { "" };
    let memory = if args.memory { " --memory" } else { "" };
    let named = |option: &str, names: &[String]| {
        names.iter().flat_map(|name| [" --", option, " \"", name, "\""].map(str::to_owned)).collect::<String>()
    };
    let only = named("family", &args.family) + &named("method", &args.method);
    format!("qless bench{short} --runs {} --limit {}{memory}{only} -o docs", args.runs, args.limit)
}
