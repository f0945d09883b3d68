//! `qless bench`: what speed costs in accuracy on this machine, for every choice that a user has.
//!
//! Every method runs on every system, in alternation and in one process; times are medians. Truth is known by construction. A method
//! that was stopped on a smaller system of its family is not tried on a larger one, and one that was slow runs in a process of its own,
//! which is stopped at the limit; so do other libraries (feature `peers`), which are not tried where they would be slow.

mod advice;
mod args;
mod chain;
mod child;
mod figure_15;
mod given_up;
mod gradients;
mod labels;
mod linkages;
mod measure;
mod methods;
mod page;
#[cfg(feature = "peers")]
mod peers;
mod plan;
mod plot;
mod quality;
mod run;
mod sample;
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

/// Why nothing was measured or written.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The user can correct it.
    #[error("{0}")]
    Input(String),
    /// The machine lacks something.
    #[error("{0}")]
    Resource(String),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// All measurements.
struct SelectedMethods {
    methods: Vec<methods::BenchMethod>,
    samples: Vec<sample::Sample>,
    levels: Vec<figure_15::Level>,
}

/// What a command prints with: a writer of standard output that gets all of one text.
pub type Text<'a> = &'a mut dyn FnMut(&mut dyn Write) -> io::Result<()>;

/// Measures, prints the tables with `print`, and writes the files if a folder is given. `stage` is told the name of each family of
/// systems as it begins, and is dropped before anything is printed.
///
/// # Errors
/// An unknown name, a system that cannot be made, a file that cannot be written, or the error of `print`.
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
    // Fails before hours of measuring if the folder cannot be written.
    drop(folder()?);
    let found = find(methods, &families, args, stage).map_err(BenchError::Input)?;
    print(&mut |out| out.write_all(text(&found).as_bytes()))?;
    if let Some(output) = folder()? {
        write(&found, args, output)?;
    }
    Ok(())
}

/// Figure 15 has methods of its own, so that it is left out if methods are named.
fn find(
    methods: Vec<methods::BenchMethod>,
    families: &[systems::Family],
    args: &BenchArgs,
    mut stage: impl FnMut(&'static str),
) -> Result<SelectedMethods, String> {
    let mut found = SelectedMethods { methods, samples: Vec::new(), levels: Vec::new() };
    for family in families {
        stage(family.name);
        if !args.figure_15 {
            found.samples.extend(measure(family, &found.methods, args)?);
        }
        if args.method.is_empty() && systems::TABLE_1.contains(&family.name) {
            found.levels.extend(figure_15::measure(family, args)?);
        }
    }
    Ok(found)
}

fn text(found: &SelectedMethods) -> String {
    let mut text = table::text(&found.samples, &found.methods);
    if !found.levels.is_empty() {
        text += "\nFigure 15\n\n";
        text += &figure_15::text(&found.levels);
    }
    text
}

fn write(found: &SelectedMethods, args: &BenchArgs, mut output: Output) -> Result<(), BenchError> {
    let SelectedMethods { methods, samples, levels } = found;
    let mut plots = plot::all(samples, methods).map_err(BenchError::Resource)?;
    plots.extend(figure_15::plots(levels).map_err(BenchError::Resource)?);
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

/// The system of this size.
fn scene(size: &str, family: &systems::Family) -> Result<qless_scenes::Scene, BenchError> {
    let case = family.cases.iter().find(|case| case.size == size);
    let case = case.ok_or_else(|| BenchError::Input(format!("{} has no size {size}", family.name)))?;
    case.scene().map_err(BenchError::Input)
}

/// Every name must be one that there is.
fn check_names(args: &BenchArgs) -> Result<(), BenchError> {
    let methods: Vec<&str> = methods::all(&[]).iter().map(|method| method.name).collect();
    let families: Vec<&str> = systems::families(false, &[]).iter().map(|family| family.name).collect();
    for (what, named, known) in [("method", &args.method, methods), ("family", &args.family, families)] {
        if let Some(name) = named.iter().find(|name| !known.contains(&name.as_str())) {
            return Err(BenchError::Input(format!("no {what} is called `{name}`; there are: {}", known.join("; "))));
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
