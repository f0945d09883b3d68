//! `qless bench`: what speed costs in accuracy on this machine, for every choice that a user has.
//!
//! Every method runs on every system, in alternation and in one process; times are medians. Truth is known by construction. A method
//! that was stopped on a smaller system of its family is not tried on a larger one, and one that was slow runs in a process of its own,
//! which is stopped at the limit; so do other libraries (feature `peers`), which are not tried where they would be slow.

mod advice;
mod chain;
mod child;
mod figure_15;
mod given_up;
mod gradients;
mod labels;
mod linkages;
mod measure;
mod memory;
mod methods;
mod page;
#[cfg(feature = "peers")]
mod peers;
mod plan;
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

/// What was measured.
struct Found {
    methods: Vec<methods::Method>,
    samples: Vec<measure::Sample>,
    levels: Vec<figure_15::Level>,
}

/// Measures, prints the tables and, where a folder is given, writes them with their plots.
pub fn run(args: &BenchArgs) -> Result<ExitCode, Failure> {
    check_names(args)?;
    let methods = methods::all(&args.method);
    let families = systems::families(args.short, &args.family);
    if let Some(size) = &args.child {
        return as_child(size, &families[0], &methods[0], args.apart);
    }
    if let Some(folder) = &args.output {
        drop(Output::new(folder)?);
    }
    let found = find(methods, &families, args).map_err(Failure::Input)?;
    stdout::write(|out| out.write_all(text(&found).as_bytes()))?;
    if let Some(folder) = &args.output {
        write(&found, args, Output::new(folder)?)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Figure 15 has methods of its own, so that it is left out where methods are named.
fn find(methods: Vec<methods::Method>, families: &[systems::Family], args: &BenchArgs) -> Result<Found, String> {
    let progress = Progress::new(args.quiet);
    let mut found = Found { methods, samples: Vec::new(), levels: Vec::new() };
    for family in families {
        progress.stage(family.name);
        if !args.figure_15 {
            found.samples.extend(measure(family, &found.methods, args)?);
        }
        if args.method.is_empty() && systems::TABLE_1.contains(&family.name) {
            found.levels.extend(figure_15::measure(family, args)?);
        }
    }
    Ok(found)
}

fn text(found: &Found) -> String {
    let mut text = table::text(&found.samples, &found.methods);
    if !found.levels.is_empty() {
        text += "\nFigure 15\n\n";
        text += &figure_15::text(&found.levels);
    }
    text
}

fn write(found: &Found, args: &BenchArgs, mut output: Output) -> Result<(), Failure> {
    let Found { methods, samples, levels } = found;
    let mut plots = plot::all(samples, methods).map_err(Failure::Resource)?;
    plots.extend(figure_15::plots(levels).map_err(Failure::Resource)?);
    if !samples.is_empty() {
        output.file("trade.csv", |out| out.write_all(table::csv(samples, methods).as_bytes()))?;
    }
    if !levels.is_empty() {
        output.file(figure_15::CSV, |out| out.write_all(figure_15::csv(levels).as_bytes()))?;
    }
    let page = page::markdown(samples, methods, levels, &command(args));
    output.file("trade.md", |out| out.write_all(page.as_bytes()))?;
    for (name, svg) in plots {
        output.file(name, |out| out.write_all(svg.as_bytes()))?;
    }
    Ok(output.commit()?)
}

/// One method on one system, for the process that started this one.
fn as_child(
    size: &str,
    family: &systems::Family,
    method: &methods::Method,
    is_apart: bool,
) -> Result<ExitCode, Failure> {
    let case = family.cases.iter().find(|case| case.size == size);
    let case = case.ok_or_else(|| Failure::Input(format!("{} has no size {size}", family.name)))?;
    let scene = case.scene().map_err(Failure::Input)?;
    stdout::write(|out| child::answer(&scene, method, is_apart, out))?;
    Ok(ExitCode::SUCCESS)
}

/// Every name must be one that there is.
fn check_names(args: &BenchArgs) -> Result<(), Failure> {
    let methods: Vec<&str> = methods::all(&[]).iter().map(|method| method.name).collect();
    let families: Vec<&str> = systems::families(false, &[]).iter().map(|family| family.name).collect();
    for (what, named, known) in [("method", &args.method, methods), ("family", &args.family, families)] {
        if let Some(name) = named.iter().find(|name| !known.contains(&name.as_str())) {
            return Err(Failure::Input(format!("no {what} is called `{name}`; there are: {}", known.join("; "))));
        }
    }
    Ok(())
}

/// The command that measures the same again.
fn command(args: &BenchArgs) -> String {
    let short = if args.short { " --short" } else { "" };
    let memory = if args.memory { " --memory" } else { "" };
    let figure_15 = if args.figure_15 { " --figure-15" } else { "" };
    let named = |option: &str, names: &[String]| {
        names.iter().flat_map(|name| [" --", option, " \"", name, "\""].map(str::to_owned)).collect::<String>()
    };
    let only = named("family", &args.family) + &named("method", &args.method);
    let peers = args.peer_limit.map_or(String::new(), |limit| format!(" --peer-limit {limit}"));
    format!("qless bench{short}{figure_15} --runs {} --limit {}{peers}{memory}{only} -o docs", args.runs, args.limit)
}
