//! `qless bench`: the cost of certainty on this machine, in time and memory.
//!
//! Every method runs on every system, in turns in one process; times are medians. The rank is known by construction. A method
//! that was stopped on a smaller system of its family does not run on a larger one. A slow method runs in a process of its own,
//! which is stopped at the limit. Other libraries (feature `peers`) always run in a process of their own. They do not run if they
//! are predicted to be slow.

mod advice;
mod args;
mod chain;
mod child;
mod figure_15;
mod given_up;
mod gradients;
mod linkages;
mod measure;
mod methods;
mod page;
mod panels;
#[cfg(feature = "peers")]
mod peers;
mod plan;
mod plot;
mod quality;
mod run;
mod sample;
mod share;
mod spring;
mod systems;
mod table;
#[cfg(test)]
mod tests;

use std::io::{self, Write};

use qless_io::WriteError;
use qless_io::write::Output;

pub use args::BenchArgs;
use measure::measure;

/// Errors of `qless bench`.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// Wrong input of the user.
    #[error("{0}")]
    Input(String),
    /// A missing resource of the machine.
    #[error("{0}")]
    Resource(String),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// The methods that were chosen, and all of their measurements.
struct SelectedMethods {
    methods: Vec<methods::BenchMethod>,
    samples: Vec<sample::Sample>,
    shares: Vec<share::WrongShare>,
    levels: Vec<figure_15::FigureLevel>,
}

/// A function that writes a whole text to standard output.
pub type Text<'a> = &'a mut dyn FnMut(&mut dyn Write) -> io::Result<()>;

/// Measures, prints the tables with `print`, and writes the files if a folder is given. `stage` receives the name of each family of
/// systems when it begins, and is dropped before the output.
///
/// # Errors
/// An unknown name, a system that cannot be generated, a file that cannot be written, or the error of `print`.
pub fn run<E: From<BenchError>>(
    args: &BenchArgs,
    stage: impl FnMut(&'static str),
    print: impl Fn(Text) -> Result<(), E>,
) -> Result<(), E> {
    check_names(args)?;
    let methods = methods::all(&args.method);
    let families = systems::families(args.short, &args.family);
    if let Some(size) = &args.child {
        let scene = scene(size, &families[0])?;
        return print(&mut |out| child::answer(&scene, &methods[0], args.apart, out));
    }
    let folder = || args.output.as_deref().map(Output::new).transpose().map_err(BenchError::from);
    // If the folder cannot be written, fail before the measurements.
    drop(folder()?);
    let found = find(methods, &families, args, stage).map_err(BenchError::Input)?;
    print(&mut |out| out.write_all(text(&found).as_bytes()))?;
    if let Some(output) = folder()? {
        write(&found, args, output)?;
    }
    Ok(())
}

/// Measures the families. Figure 15 has methods of its own, so it is omitted if methods are named.
fn find(
    methods: Vec<methods::BenchMethod>,
    families: &[systems::Family],
    args: &BenchArgs,
    mut stage: impl FnMut(&'static str),
) -> Result<SelectedMethods, String> {
    let mut found = SelectedMethods { methods, samples: Vec::new(), shares: Vec::new(), levels: Vec::new() };
    for family in families {
        stage(family.name);
        if !args.figure_15 {
            found.samples.extend(measure(family, &found.methods, args)?);
        }
        if args.method.is_empty() && systems::TABLE_1.contains(&family.name) {
            found.levels.extend(figure_15::measure(family, args)?);
        }
    }
    // The seeded systems are left out if methods, families or only Figure 15 were asked for.
    if args.method.is_empty() && args.family.is_empty() && !args.figure_15 {
        stage("seeded systems");
        found.shares = share::measure(&found.methods, args.short)?;
    }
    Ok(found)
}

fn text(found: &SelectedMethods) -> String {
    let mut text = table::text(&found.samples, &found.methods);
    if !found.shares.is_empty() {
        text += "\nSeeded systems of known rank\n\n";
        text += &share::table(&found.shares);
    }
    if !found.levels.is_empty() {
        text += "\nFigure 15\n\n";
        text += &figure_15::text(&found.levels);
    }
    text
}

fn write(found: &SelectedMethods, args: &BenchArgs, mut output: Output) -> Result<(), BenchError> {
    let SelectedMethods { methods, samples, shares, levels } = found;
    let mut plots = plot::all(samples, methods).map_err(BenchError::Resource)?;
    plots.extend(figure_15::plots(levels).map_err(BenchError::Resource)?);
    if !samples.is_empty() {
        output.file("trade.csv", |out| out.write_all(table::csv(samples, methods).as_bytes()))?;
    }
    if !levels.is_empty() {
        output.file(figure_15::CSV, |out| out.write_all(figure_15::csv(levels).as_bytes()))?;
    }
    let command = command(args);
    let page = page::markdown((samples, shares), methods, levels, &command);
    output.file("trade.md", |out| out.write_all(page.as_bytes()))?;
    for (name, svg) in plots {
        output.file(name, |out| out.write_all(svg.as_bytes()))?;
    }
    Ok(output.by(&command).commit()?)
}

/// The scene of the family's system with this size.
fn scene(size: &str, family: &systems::Family) -> Result<qless_scenes::Scene, BenchError> {
    let case = family.cases.iter().find(|case| case.size == size);
    let case = case.ok_or_else(|| BenchError::Input(format!("{} has no size {size}", family.name)))?;
    case.scene().map_err(BenchError::Input)
}

/// Refuses unknown names.
fn check_names(args: &BenchArgs) -> Result<(), BenchError> {
    let methods =
        |only: &[String]| -> Vec<&'static str> { methods::all(only).iter().map(|method| method.name).collect() };
    let families = |only: &[String]| -> Vec<&'static str> {
        systems::families(false, only).iter().map(|family| family.name).collect()
    };
    check_names_of("method", &args.method, methods)?;
    check_names_of("family", &args.family, families)
}

fn check_names_of(
    what: &str,
    named: &[String],
    all: impl Fn(&[String]) -> Vec<&'static str>,
) -> Result<(), BenchError> {
    let known = all(named);
    named.iter().find(|name| !known.contains(&name.as_str())).map_or(Ok(()), |name| {
        Err(BenchError::Input(format!("no {what} is called `{name}`; there are: {}", all(&[]).join("; "))))
    })
}

/// The command that repeats the measurements.
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
